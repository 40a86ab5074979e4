//! Integrators of q: exact for linear modes, Newmark's method for nonlinear ones, with their elastic energy.

mod broyden;
mod elastic_energy;
mod implicit_step;
mod linear_oscillator;
mod nonlinear_oscillator;
mod trial;

pub use elastic_energy::{ElasticEnergy, Evaluation};
pub use implicit_step::NewmarkBuffers;
pub use linear_oscillator::{Damping, LinearOscillator};
pub use nonlinear_oscillator::NonlinearOscillator;
