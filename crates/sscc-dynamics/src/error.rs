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
    /// Linear forces of modes that do not swing by themselves.
    #[error("the stiffness of linear modes is not diagonal: diagonalize it first")]
    Coupled,
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
    /// Elasticity, moments or a state of another number of modes.
    #[error("{found} modes where the model has {rank}")]
    Rank {
        /// Modes given.
        found: usize,
        /// Modes of the model.
        rank: usize,
    },
    /// A body cannot begin there.
    #[error("a body's position, orientation, velocity and spin must be finite, its orientation not 0")]
    Start,
    /// Gravity, ground or contacts that cannot be.
    #[error("{what} is {value}: it must be {range}")]
    Option {
        /// What is wrong.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// A body that begins in another one, in itself or in the ground.
    #[error("body {body} (counted from 0) begins in {what} ({count} {unit}): move it, or deform it less")]
    Interpenetration {
        /// The body.
        body: usize,
        /// What it begins in.
        what: Obstacle,
        /// How many.
        count: usize,
        /// Of what.
        unit: &'static str,
    },
    /// A step of the nonlinear forces that has no solution within reach.
    #[error("a step cannot be solved (energy {energy:e}): take a smaller one, or more damping")]
    Unsolved {
        /// The energy before it.
        energy: f64,
    },
    /// The motion grows without bound.
    #[error(
        "step {step}: the motion of body {body} (both counted from 0) diverges (energy {energy:e}): take a smaller time step, or more damping"
    )]
    Diverged {
        /// The step.
        step: u64,
        /// The body.
        body: usize,
        /// Its energy when it was noticed.
        energy: f64,
    },
    /// A state of other bodies.
    #[error("the state is of another world: {found} numbers where {expected} belong")]
    State {
        /// Numbers found.
        found: usize,
        /// Numbers of this world's state.
        expected: usize,
    },
    /// What the core refuses.
    #[error(transparent)]
    Core(#[from] sscc::Error),
}

/// What a body can begin in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// Another body.
    Body(usize),
    /// Itself.
    Itself,
    /// The ground.
    Ground,
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
