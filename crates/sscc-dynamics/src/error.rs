//! Errors of dynamics.

use sscc::parts::short_number;

/// Error of a simulation; its message is one line that names the cause.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DynamicsError {
    /// The time step is not positive and finite.
    #[error("the time step is {step:e} s: it must be positive and finite")]
    Step {
        /// The step (s).
        step: f64,
    },
    /// A damping coefficient is negative or not finite.
    #[error(
        "the damping coefficients are {mass:e} (1/s) and {stiffness:e} (s): they must be finite and at least 0"
    )]
    Damping {
        /// Coefficient of the mass (1/s).
        mass: f64,
        /// Coefficient of the stiffness (s).
        stiffness: f64,
    },
    /// The eigenvalue of a mode is negative or not finite.
    #[error("mode {mode} (counted from 0) has the stiffness {value:e}: it must be finite and at least 0")]
    Stiffness {
        /// Number of the mode, from 0.
        mode: usize,
        /// Its eigenvalue (1/s^2).
        value: f64,
    },
    /// The stiffness of linear modes is not diagonal.
    #[error("the stiffness of linear modes is not diagonal: diagonalize it first")]
    Coupled,
    /// Nonlinear forces are not the gradient of an energy.
    #[error(
        "the forces of degree {degree} are not the gradient of an energy (asymmetry {asymmetry:e}): check the order of the coefficients"
    )]
    Asymmetric {
        /// Degree of the forces in q.
        degree: usize,
        /// Difference between two values for one coefficient of the energy, relative to the largest coefficient.
        asymmetry: f64,
    },
    /// Mass or inertia is not positive and finite.
    #[error(
        "the mass is {mass:e} and the smallest minor of the inertia tensor is {inertia:e}: both must be positive and finite; check the density and the volume of the body"
    )]
    Mass {
        /// Mass.
        mass: f64,
        /// Smallest leading minor of the inertia tensor; all must be positive.
        inertia: f64,
    },
    /// Elasticity, moments or eigenvalues have another number of modes than the model.
    #[error("the data have {found} modes, the model has {rank}: use data of this model")]
    Rank {
        /// Modes given.
        found: usize,
        /// Modes of the model.
        rank: usize,
    },
    /// Position, orientation or velocity of a body is not finite, or its orientation is 0.
    #[error("position, orientation, velocity and spin of a body must be finite, and its orientation not 0")]
    Start,
    /// An option of the world, its contacts or its ground is outside its range.
    #[error("{what} is {}: it must be {range}", short_number(*value))]
    Option {
        /// Name of the option.
        what: &'static str,
        /// Value of the option.
        value: f64,
        /// Allowed range.
        range: &'static str,
    },
    /// A body penetrates another one, itself or the ground at the start.
    #[error("body {body} (counted from 0) begins in {what} ({count} {unit}): {}", what.way_out())]
    Interpenetration {
        /// The body.
        body: usize,
        /// The penetrated obstacle.
        what: Obstacle,
        /// Number of penetrations.
        count: usize,
        /// Unit of the count: triangle pairs or vertices.
        unit: &'static str,
    },
    /// Newton's method does not converge in a step of the nonlinear forces.
    #[error(
        "Newton's method does not converge (energy {energy:e}): take a smaller time step, or more damping"
    )]
    Unsolved {
        /// Energy of the body before the step.
        energy: f64,
    },
    /// The kinetic energy exceeds the available energy or is not finite.
    #[error(
        "step {step}: the motion of body {body} (both counted from 0) diverges (energy {energy:e}): take a smaller time step, or more damping"
    )]
    Diverged {
        /// Number of the step, from 0.
        step: u64,
        /// The body.
        body: usize,
        /// Kinetic energy of the body when the divergence was detected.
        energy: f64,
    },
    /// The state does not fit the bodies of the world, or the modes of the sound bank.
    #[error(
        "a state of {found} numbers does not fit ({expected} numbers, then contacts): restore a state of the same bodies"
    )]
    State {
        /// Count of numbers in the state.
        found: usize,
        /// Count of numbers for the bodies of this world, without contacts.
        expected: usize,
    },
    /// Error of the crate `sscc`.
    #[error(transparent)]
    Core(#[from] sscc::Error),
}

/// Obstacle that a body penetrates at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// Another body.
    Body(usize),
    /// The body itself.
    Itself,
    /// The ground.
    Ground,
}

impl Obstacle {
    /// Returns the change of the body by which it no longer penetrates the obstacle.
    fn way_out(self) -> &'static str {
        match self {
            Self::Body(_) | Self::Ground => "move it, or deform it less",
            // No motion of the whole body changes how it meets itself.
            Self::Itself => "deform it less",
        }
    }
}

impl std::fmt::Display for Obstacle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Body(body) => write!(f, "body {body}"),
            Self::Itself => f.write_str("itself"),
            Self::Ground => f.write_str("the ground"),
        }
    }
}

/// Returns the error of the first body that has one.
pub(crate) fn first_error(results: Vec<Result<(), DynamicsError>>) -> Result<(), DynamicsError> {
    results.into_iter().collect()
}
