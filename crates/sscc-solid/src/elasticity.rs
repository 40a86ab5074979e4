//! Elastic forces of a reduced model.

use crate::{ReducedForces, Stiffness};

/// Reduced internal forces at q, for modes whose reduced mass matrix is the identity. The eigenvalues of the stiffness
/// are then squared natural angular frequencies (1/s^2).
#[derive(Clone, Debug, PartialEq)]
pub enum Elasticity {
    /// Linear forces `K~ q`.
    Linear(Stiffness),
    /// Forces of large deformations (St. Venant-Kirchhoff); their linear part is the stiffness at rest.
    Nonlinear(ReducedForces),
}

impl Elasticity {
    /// Returns the stiffness at rest.
    pub fn stiffness(&self) -> &Stiffness {
        match self {
            Self::Linear(stiffness) => stiffness,
            Self::Nonlinear(forces) => forces.linear(),
        }
    }

    /// Returns the number of modes r.
    pub fn rank(&self) -> usize {
        self.stiffness().rank()
    }

    /// Returns the linear forces of the stiffness at rest.
    #[must_use]
    pub fn linearized(&self) -> Self {
        Self::Linear(self.stiffness().clone())
    }
}
