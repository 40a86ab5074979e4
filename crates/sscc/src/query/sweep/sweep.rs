//! The result of a sweep.

use std::fmt;

use crate::Pair;

/// The result of a sweep: how far the weight of one mode can change until the shape touches itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The mode, from 0.
    pub mode: usize,
    /// The weight at which the sweep starts.
    pub from: f64,
    /// The weight at which it ends.
    pub to: f64,
    /// The shape is proven free at every weight from `from` to this one, both included. `None` if it collides at `from`.
    pub first_free: Option<f64>,
    /// A weight at which the shape collides, see [`SweepOutcome`]; `None` if no collision was found up to `to`.
    pub first_hit: Option<f64>,
    /// The pairs that collide at `first_hit`, sorted; for [`SweepOutcome::WithinTolerance`] those that come within the
    /// tolerance.
    pub pairs: Vec<Pair>,
    /// The kind of result, which determines the meaning of `first_free` and `first_hit`.
    pub outcome: SweepOutcome,
}

/// The kind of result of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepOutcome {
    /// The shape is proven free at every weight, so `first_free` is `to`.
    Free,
    /// The shape collides at `from`, exactly.
    CollidingAtStart,
    /// The shape collides at `first_hit`, exactly. `first_free` and `first_hit` are at most 1e-9 of the range apart, or
    /// neighbouring f64.
    Hit,
    /// No exact test finds a collision within 1e-9 of the range beyond `first_free`. The pairs come within the tolerance of
    /// continuous queries ([`Impact::TOLERANCE`](crate::Impact::TOLERANCE)) at `first_hit`, which is at most 1e-9 of the
    /// range from `first_free`. This is a grazing contact.
    WithinTolerance,
    /// Beyond `first_free` the distance of this pair is smaller than the rounding of positions, but larger than the tolerance:
    /// neither contact nor freedom is proven there. `first_hit` is the first of some tested weights at which the shape
    /// collides; it need not be near `first_free`.
    TooClose(Pair),
    /// The limit of steps ended the search: beyond `first_free` nothing is proven. `first_hit` is as in
    /// [`Self::TooClose`].
    StepLimit,
}

impl fmt::Display for SweepOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Free => write!(f, "free"),
            Self::CollidingAtStart => {
                write!(
                    f,
                    "the shape collides at the start: start elsewhere, or ignore the pairs that collide at rest"
                )
            }
            Self::Hit => write!(f, "it collides"),
            Self::WithinTolerance => {
                write!(
                    f,
                    "a grazing contact: no exact collision was found beside it, but one within the tolerance"
                )
            }
            Self::TooClose((i, j)) => write!(
                f,
                "beyond it triangles {i} and {j} are closer than positions are rounded, and nothing is proven"
            ),
            Self::StepLimit => write!(f, "beyond it nothing is proven: the limit of steps was reached"),
        }
    }
}
