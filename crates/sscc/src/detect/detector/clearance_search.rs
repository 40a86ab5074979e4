//! The search of a detector for near pairs.

use super::detector_search::DetectorSearch;
use crate::detect::narrow_phase::ClearanceHits;

/// The search for near pairs, and its margin.
#[derive(Clone)]
pub(super) struct ClearanceSearch {
    /// The distance by which AABBs were widened.
    pub(super) margin: f64,
    pub(super) search: DetectorSearch<1, ClearanceHits>,
}
