//! The goal of a search for a radius: its cap and its precision.
//!
//! The radii that determine the root's radius are precise, and those that queries meet most often are fine
//! (`fine_radii.rs`). Larger radii are coarse: small parts of a model all collapse at about the same radius, tens of
//! times the root's, and a precise bound there would need subdivision of every pair
//! (docs/notes/bounds.md#coarse-radii).

/// The precision with which a radius is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Precision {
    /// Searches to [`COARSE_EPSILON`], or the tolerance of the options if that is larger, as far as
    /// [`COARSE_SUBDIVISIONS`] suffice.
    Coarse,
    /// Searches to [`FINE_EPSILON`], or the tolerance of the options if that is smaller, as far as [`FINE_SUBDIVISIONS`] and
    /// [`FINE_TRIANGLE_PAIRS`] suffice.
    Fine,
    /// Searches to the tolerance of the options, as far as [`FULL_SUBDIVISIONS`] suffice.
    Full,
}

/// The relative error of coarse searches.
pub(super) const COARSE_EPSILON: f64 = 0.4;

/// The maximum number of subdivisions of one triangle pair in coarse searches.
pub(super) const COARSE_SUBDIVISIONS: usize = 4;

/// The relative error of fine searches: the smaller it is, the fewer node pairs queries open (docs/notes/bounds.md#fine-radii).
pub(super) const FINE_EPSILON: f64 = 0.03;

/// The maximum number of subdivisions of one triangle pair in fine searches.
pub(super) const FINE_SUBDIVISIONS: usize = 8;

/// The maximum number of triangle pairs that a fine search subdivides. In a search within a bucket the maximum holds for each
/// node below it. Without this maximum one search in twenty takes most of the time.
pub(super) const FINE_TRIANGLE_PAIRS: usize = 32;

/// The maximum number of subdivisions of one triangle pair in full searches. When they are used up the search takes the
/// best lower bound so far: still certified, only less tight. Mostly models of rank 1 and 2 need that many.
pub(super) const FULL_SUBDIVISIONS: usize = 500;

/// The relative error of pairs in the pair tree, as far as they need no subdivision: there are many of them, and each saves
/// little.
pub(super) const PAIR_TREE_EPSILON: f64 = 0.25;

/// Returns the radius up to which coarse searches go: the cap of radii, lowered by the error that these searches may
/// have anyway. Most nodes hardly ever collide, and a proof of this up to the cap itself gains nothing.
pub(crate) fn coarse_cap(cap: f64, epsilon: f64) -> f64 {
    cap * (1.0 - COARSE_EPSILON.max(epsilon))
}

/// The cap and the precision of a search for a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SearchGoal {
    /// The result is at most this: a larger radius is of no use.
    pub(crate) cap: f64,
    /// Lower bounds of at least this are not refined.
    pub(crate) refine_up_to: f64,
    pub(crate) precision: Precision,
}

impl SearchGoal {
    /// Creates the goal of a radius of at most `cap`.
    pub(crate) fn new(cap: f64, precision: Precision) -> Self {
        Self { cap, refine_up_to: cap, precision }
    }
}
