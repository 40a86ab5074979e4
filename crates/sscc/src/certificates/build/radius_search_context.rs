//! The input shared by all radius searches: scaled model, contact filter, hierarchy, bounds and groups of nodes.

use super::node_groups::NodeGroups;
use crate::bounds::NodePairBounds;
use crate::filter::{PairFilter, RingPairs};
use crate::hierarchy::Hierarchy;
use crate::model::ScaledModel;

/// The input of all radius searches on one model.
#[derive(Clone, Copy)]
pub(crate) struct RadiusSearchContext<'a> {
    pub(crate) model: &'a ScaledModel,
    /// The contact filter, which also excludes exceptions.
    pub(crate) filter: &'a PairFilter,
    /// Pairs that need not keep the clearance; empty without a clearance.
    pub(crate) rings: &'a RingPairs,
    pub(crate) hierarchy: &'a Hierarchy,
    pub(crate) nodes: &'a NodePairBounds,
    pub(crate) groups: &'a NodeGroups,
}
