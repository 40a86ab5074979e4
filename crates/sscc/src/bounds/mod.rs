//! Lower bounds of `|z|`, the distance in q-space from the centre, at which two parts of a model can first meet (paper,
//! section 5).
//!
//! These files compute bounds: `separating_direction`, `affine_bound`, `pair_refiner` (both, with subdivision), `leaf_pair`,
//! `node_pair`, `configuration_line`, `upper_bound`. `pair_witness` finds proofs of the bound of a triangle pair that another
//! program can check. The other files contain parts of the bounds.
//!
//! Every lower bound is certified: it is at most the exact minimum of `|z|` over all z at which the **computed** f64
//! positions of the two parts meet, or with a clearance are nearer than it. Directions, affine maps and mean modes are
//! candidates: any heuristic in any precision may choose them, because only the final evaluation needs rounding bounds.
//!
//! `sufficient` is the lower bound at which the caller stops refining.

mod affine_bound;
mod affine_fit;
mod cone_rate;
mod configuration_line;
mod contact_estimate;
mod leaf_pair;
mod node_modes;
mod node_pair;
mod pair_corners;
mod pair_refiner;
mod pair_witness;
mod separating_direction;
mod strain;
mod sub_triangle;
#[cfg(test)]
mod tests;
mod upper_bound;

pub(crate) use affine_fit::AffineFit;
pub(crate) use configuration_line::{ConfigurationLine, MovingAabb};
pub(crate) use leaf_pair::LeafPair;
pub(crate) use node_modes::NodeModes;
pub(crate) use node_pair::{NodePairBounds, NodePairScratch};
pub(crate) use pair_corners::PairCorners;
pub(crate) use pair_refiner::{PairRefiner, RefinementTarget};
pub(crate) use pair_witness::{PairWitness, WitnessList};
pub(crate) use separating_direction::{CornerProjections, bound_along};
