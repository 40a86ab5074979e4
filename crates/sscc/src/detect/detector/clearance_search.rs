//! The search of a detector for near pairs.

use super::detector_search::DetectorSearch;
use crate::detect::narrow_phase::ClearanceHits;

/// Its frames and its list.
#[derive(Clone)]
pub(super) struct ClearanceSearch {
    /// That of the frames in which boxes were widened.
    pub(super) margin: f64,
    pub(super) search: DetectorSearch<1, ClearanceHits>,
}
