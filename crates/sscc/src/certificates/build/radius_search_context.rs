//! The data that searches for radii read: one model about its centre, its hierarchy, and bounds of its nodes.

use crate::bounds::NodePairBounds;
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;
use crate::model::ScaledModel;

/// Shared by all searches on one model.
#[derive(Clone, Copy)]
pub(crate) struct RadiusSearchContext<'a> {
    pub(crate) model: &'a ScaledModel,
    /// Which triangle pairs count; exceptions are left out.
    pub(crate) filter: &'a PairFilter,
    pub(crate) hierarchy: &'a Hierarchy,
    pub(crate) nodes: &'a NodePairBounds,
}
