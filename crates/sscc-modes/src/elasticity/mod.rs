//! Elasticity of solids: elements, full-space forces, reduced forces.

mod element;
mod forces;
mod reduce;
mod stvk;

pub(crate) use element::cube_is_inverted;
pub use forces::ReducedForces;
pub(crate) use reduce::reduced_forces;
pub(crate) use stvk::second_derivatives;

#[cfg(test)]
mod tests;
