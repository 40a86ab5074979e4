//! Elastic forces of a reduced model.

use crate::{ReducedForces, SolidError, Stiffness};

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

    /// Returns the forces of the body with all lengths multiplied by `factor`, of the same material. Its mass-orthonormal
    /// modes are those of this body divided by `factor^1.5`, and its energy at q is `factor^3` times that of this body
    /// at `factor^-2.5 q`.
    ///
    /// # Errors
    /// When a coefficient is beyond 2^200.
    pub fn scaled(&self, factor: f64) -> Result<Self, SolidError> {
        let times = |coefficients: &[f64], power: f64| -> Vec<f64> {
            coefficients.iter().map(|x| x * factor.powf(power)).collect()
        };
        let stiffness = Stiffness::new(self.rank(), times(self.stiffness().entries(), -2.0))?;
        Ok(match self {
            Self::Linear(_) => Self::Linear(stiffness),
            Self::Nonlinear(forces) => {
                let (quadratic, cubic) = (times(forces.quadratic(), -4.5), times(forces.cubic(), -7.0));
                Self::Nonlinear(ReducedForces::new(stiffness, quadratic, cubic)?)
            }
        })
    }
}
