//! Why something cannot be simulated.

/// A simulation cannot begin, or not go on. One line, naming the cause.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DynamicsError {
    /// A step of no length, of a negative one, or none at all.
    #[error("a time step of {step:e} s: it must be positive and finite")]
    Step {
        /// The step (s).
        step: f64,
    },
    /// Damping that would drive.
    #[error(
        "damping with the coefficients {mass:e} (1/s) and {stiffness:e} (s): they must be finite and at least 0"
    )]
    Damping {
        /// Of mass.
        mass: f64,
        /// Of stiffness.
        stiffness: f64,
    },
    /// A stiffness that no rest pose has.
    #[error("mode {mode} (counted from 0) has the stiffness {value:e}: it must be finite and at least 0")]
    Stiffness {
        /// The mode.
        mode: usize,
        /// Its eigenvalue (1/s^2).
        value: f64,
    },
    /// A body without mass or inertia.
    #[error(
        "a mass of {mass:e} with the least moment of inertia {inertia:e}: both must be positive and finite"
    )]
    Mass {
        /// Mass.
        mass: f64,
        /// Least principal moment of inertia.
        inertia: f64,
    },
    /// The motion grows without bound.
    #[error("the motion diverges (energy {energy:e}): take a smaller time step, or more damping")]
    Diverged {
        /// The energy when it was noticed.
        energy: f64,
    },
}
