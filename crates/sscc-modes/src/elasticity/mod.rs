//! Elasticity of solids: forces in the full space and their reduction.

mod reduce;
mod stvk;

pub(crate) use reduce::reduced_forces;
pub(crate) use stvk::second_derivatives;

#[cfg(test)]
mod tests;
