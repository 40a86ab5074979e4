//! Elastic forces of a reduced model.

use crate::{ReducedForces, Stiffness};

/// The reduced internal forces at q, for modes of which the reduced mass matrix is the identity. So the eigenvalues of
/// the stiffness are squared natural angular frequencies (1/s^2).
#[derive(Clone, Debug, PartialEq)]
pub enum Elasticity {
    /// The forces are `K~ q`.
    Linear(Stiffness),
    /// The forces of large deformations (St. Venant-Kirchhoff); their linear part is the stiffness at rest.
    Nonlinear(ReducedForces),
}

impl Elasticity {
    /// The stiffness at rest.
    pub fn stiffness(&self) -> &Stiffness {
        match self {
            Self::Linear(stiffness) => stiffness,
            Self::Nonlinear(forces) => forces.linear(),
        }
    }

    /// Number of modes r.
    pub fn rank(&self) -> usize {
        self.stiffness().rank()
    }

    /// The same body in small deformations: the stiffness at rest alone.
    #[must_use]
    pub fn linearized(&self) -> Self {
        Self::Linear(self.stiffness().clone())
    }
}
