//! The goal of a search for a radius: how far and how precisely.
//!
//! The radii that determine the root's radius are precise, and those that queries meet most often are fine
//! (`fine_radii.rs`). Larger radii are coarse: small parts of a model all collapse at about the same radius, tens of
//! times the root's, and a precise bound there would need subdivision of every pair
//! (docs/notes/bounds.md#coarse-radii).

/// How closely a radius is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Precision {
    /// To [`COARSE_EPSILON`], as far as [`COARSE_SUBDIVISIONS`] suffice.
    Coarse,
    /// To [`FINE_EPSILON`], or the tolerance of the options if that is smaller, as far as [`FINE_SUBDIVISIONS`] and
    /// [`FINE_TRIANGLE_PAIRS`] suffice.
    Fine,
    /// To the tolerance of the options.
    Full,
}

/// The relative error of coarse searches.
pub(super) const COARSE_EPSILON: f64 = 0.4;

/// The maximum number of subdivisions of one triangle pair in coarse searches.
pub(super) const COARSE_SUBDIVISIONS: usize = 4;

/// The relative error of fine searches: the less, the fewer node pairs queries open
/// (docs/notes/bounds.md#fine-radii).
pub(super) const FINE_EPSILON: f64 = 0.03;

/// The maximum number of subdivisions of one triangle pair in fine searches.
pub(super) const FINE_SUBDIVISIONS: usize = 8;

/// The maximum number of triangle pairs that a fine search subdivides. In a search within a bucket the maximum holds for each
/// node below it. Without it one search in twenty takes most of the time.
pub(super) const FINE_TRIANGLE_PAIRS: usize = 32;

/// The maximum number of subdivisions of one triangle pair in full searches. When they are used up the search takes the
/// best lower bound so far: still certified, only less tight. Mostly modes of rank 1 and 2 need so many.
pub(super) const FULL_SUBDIVISIONS: usize = 500;

/// The relative error of pairs in the pair tree, as far as they need no subdivision: they are many, and each saves
/// little.
pub(super) const PAIR_TREE_EPSILON: f64 = 0.25;

/// The radius up to which coarse searches go: `R_global` with the error that they may have anyway. Most nodes can hardly
/// collide at all, and proving that up to `R_global` itself gains nothing.
pub(crate) fn coarse_cap(global_radius: f64, epsilon: f64) -> f64 {
    global_radius * (1.0 - COARSE_EPSILON.max(epsilon))
}

/// How far and how precisely a radius is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SearchGoal {
    /// The result is at most this: a larger radius is of no use.
    pub(crate) cap: f64,
    /// Lower bounds of at least this are not refined.
    pub(crate) refine_up_to: f64,
    pub(crate) precision: Precision,
}

impl SearchGoal {
    /// A radius of at most `cap`.
    pub(crate) fn new(cap: f64, precision: Precision) -> Self {
        Self { cap, refine_up_to: cap, precision }
    }
}
