//! Integrator for reduced nonlinear dynamics: implicit Newmark (Barbic and James 2005, section 5).

use faer::Mat;
use faer::prelude::Solve;
use sscc_solid::ReducedForces;

use crate::{Damping, DynamicsError};

/// Maximum number of Newton iterations in one step.
const MAX_ITERATIONS: usize = 60;

/// An iteration that leaves a larger share of the residual converges slowly; the next one computes a new derivative.
/// Iterations otherwise reuse the derivative: a stiffness costs several times as much as forces, and changes little
/// within a step.
const SLOW_CONVERGENCE: f64 = 0.2;

/// Minimum share of a Newton step in the line search.
const MIN_STEP_SHARE: f64 = 1e-6;

/// A step is solved when the residual is at most this share of the sum of its terms; this is close to the rounding
/// error.
const RELATIVE_TOLERANCE: f64 = 1e-11;

/// Trial acceleration of Newton's method, and the state at the end of the step with this acceleration.
struct Trial {
    acceleration: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    residual: Vec<f64>,
    /// Sum of the absolute values of the residual; infinite where it is not a number.
    residual_sum: f64,
    /// Sum of the absolute values of all terms of the residual.
    term_sum: f64,
}

/// Integrator for reduced St. Venant-Kirchhoff forces, `q'' + C q' + f(q) = g`. It uses the implicit Newmark method of
/// average acceleration (second order, no numerical damping) and solves each step by Newton's method. The Rayleigh
/// damping uses the stiffness at rest.
#[derive(Clone, Debug)]
pub struct NonlinearOscillator<'a> {
    forces: &'a ReducedForces,
    /// Damping matrix C, r x r, row after row.
    damping: Vec<f64>,
    step: f64,
}

impl<'a> NonlinearOscillator<'a> {
    /// Creates the integrator with steps of `step` seconds.
    ///
    /// # Errors
    /// When the step is not positive, or the damping is negative or not finite.
    pub fn new(forces: &'a ReducedForces, damping: Damping, step: f64) -> Result<Self, DynamicsError> {
        if !(step.is_finite() && step > 0.0) {
            return Err(DynamicsError::Step { step });
        }
        let given = damping.check()?;
        let r = forces.rank();
        let mut damping: Vec<f64> = forces.linear().entries().iter().map(|k| given.stiffness * k).collect();
        (0..r).for_each(|k| damping[k * (r + 1)] += given.mass);
        Ok(Self { forces, damping, step })
    }

    /// Returns the acceleration at (q, v) under the forces g (r numbers each); the first step needs it.
    pub fn acceleration(&self, q: &[f64], v: &[f64], g: &[f64]) -> Vec<f64> {
        let (inner, damping_forces) = (self.forces.at(q), self.damping_forces(v));
        g.iter().zip(inner).zip(damping_forces).map(|((g, f), c)| g - f - c).collect()
    }

    /// Advances q, v and the acceleration `a` by one step under the forces g (r numbers each).
    ///
    /// # Errors
    /// When Newton's method does not converge; then q, v and `a` are unchanged.
    pub fn advance(
        &self,
        q: &mut [f64],
        v: &mut [f64],
        a: &mut [f64],
        g: &[f64],
    ) -> Result<(), DynamicsError> {
        let (r, h) = (self.forces.rank(), self.step);
        let trial_with = |b: Vec<f64>| {
            let x: Vec<f64> = (0..r).map(|k| q[k] + h * v[k] + h * h / 4.0 * (a[k] + b[k])).collect();
            let y: Vec<f64> = (0..r).map(|k| v[k] + h / 2.0 * (a[k] + b[k])).collect();
            let (inner, damping_forces) = (self.forces.at(&x), self.damping_forces(&y));
            let residual: Vec<f64> = (0..r).map(|k| b[k] + damping_forces[k] + inner[k] - g[k]).collect();
            let terms = |k: usize| b[k].abs() + damping_forces[k].abs() + inner[k].abs() + g[k].abs();
            let term_sum = (0..r).map(terms).sum();
            let residual_sum: f64 = residual.iter().map(|x| x.abs()).sum();
            let residual_sum = if residual_sum.is_nan() { f64::INFINITY } else { residual_sum };
            Trial { acceleration: b, q: x, v: y, residual, residual_sum, term_sum }
        };
        // The first trial has the last acceleration, or it keeps q: with modes much faster than the step, the last
        // acceleration is a bad guess.
        let [last, still] = [a.to_vec(), (0..r).map(|k| -a[k] - 4.0 * v[k] / h).collect()].map(trial_with);
        let mut trial = if last.residual_sum <= still.residual_sum { last } else { still };
        let mut factor = None;
        for _ in 0..MAX_ITERATIONS {
            if !trial.term_sum.is_finite() {
                break;
            }
            if trial.residual_sum <= RELATIVE_TOLERANCE * trial.term_sum {
                q.copy_from_slice(&trial.q);
                v.copy_from_slice(&trial.v);
                a.copy_from_slice(&trial.acceleration);
                return Ok(());
            }
            let is_fresh = factor.is_none();
            let change = factor
                .get_or_insert_with(|| self.derivative(&trial.q).partial_piv_lu())
                .solve(Mat::from_fn(r, 1, |i, _| trial.residual[i]));
            let step = |share: f64| {
                trial_with((0..r).map(|k| trial.acceleration[k] - share * change[(k, 0)]).collect())
            };
            let mut next = step(1.0);
            // A shorter step in Newton's direction may lower the residual where the full step does not.
            let mut share = 1.0;
            while is_fresh && next.residual_sum >= trial.residual_sum && share > MIN_STEP_SHARE {
                share /= 2.0;
                next = step(share);
            }
            let is_slow = next.residual_sum >= SLOW_CONVERGENCE * trial.residual_sum;
            if next.residual_sum < trial.residual_sum {
                trial = next;
            } else if is_fresh {
                break;
            }
            if is_slow {
                factor = None;
            }
        }
        Err(DynamicsError::Unsolved { energy: self.energy(q, v) })
    }

    /// Returns the derivative of the residual with respect to the acceleration, at q = x (r x r).
    fn derivative(&self, x: &[f64]) -> Mat<f64> {
        let (r, h, stiffness) = (self.forces.rank(), self.step, self.forces.stiffness(x));
        Mat::from_fn(r, r, |i, j| {
            f64::from(u8::from(i == j))
                + h / 2.0 * self.damping[i * r + j]
                + h * h / 4.0 * stiffness[i * r + j]
        })
    }

    /// Returns kinetic and elastic energy.
    pub fn energy(&self, q: &[f64], v: &[f64]) -> f64 {
        self.forces.energy(q) + v.iter().map(|v| v * v / 2.0).sum::<f64>()
    }

    /// Returns `C v`.
    fn damping_forces(&self, v: &[f64]) -> Vec<f64> {
        let row = |row: &[f64]| row.iter().zip(v).map(|(c, v)| c * v).sum();
        self.damping.chunks_exact(v.len()).map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sscc_solid::Stiffness;

    const NONE: Damping = Damping { mass: 0.0, stiffness: 0.0 };

    /// Forces of two modes with the energy `l1 x^2 / 2 + l2 y^2 / 2 + s (x^2 + x y)^2 / 4`.
    fn forces(l1: f64, l2: f64, s: f64) -> ReducedForces {
        // d/dx: l1 x + s (x^2 + x y) (2 x + y) / 2 = .. + s (2 x^3 + 3 x^2 y + x y^2) / 2
        // d/dy: l2 y + s (x^2 + x y) x / 2 = .. + s (x^3 + x^2 y) / 2
        let cubic = [1.0, 1.5, 0.5, 0.0, 0.5, 0.5, 0.0, 0.0].map(|c| s * c).to_vec();
        ReducedForces::new(Stiffness::from_diagonal(&[l1, l2]).unwrap(), vec![0.0; 6], cubic).unwrap()
    }

    #[test]
    fn free_vibration_has_the_exact_frequency() {
        let lambda = 40.0_f64;
        // 200 steps a period; the method lengthens the period by (omega h)^2 / 12.
        let period = std::f64::consts::TAU / lambda.sqrt();
        let step = period / 200.0;
        let forces = forces(lambda, 90.0, 0.0);
        let oscillator = NonlinearOscillator::new(&forces, NONE, step).unwrap();
        let (mut q, mut v) = (vec![1e-3, 0.0], vec![0.0, 0.0]);
        let mut a = oscillator.acceleration(&q, &v, &[0.0; 2]);
        let (mut crossings, mut last) = (Vec::new(), q[0]);
        for step in 0..4000 {
            oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2]).unwrap();
            if last > 0.0 && q[0] <= 0.0 {
                crossings.push(f64::from(step) + last / (last - q[0]));
            }
            last = q[0];
        }
        let measured = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64 / 200.0;
        assert!((measured - 1.0).abs() < 1e-3, "{measured} periods");
    }

    #[test]
    fn energy_stays_bounded_without_damping_and_falls_with_it() {
        let forces = forces(40.0, 90.0, 3e4);
        for (damping, grows) in [(NONE, false), (Damping { mass: 0.1, stiffness: 1e-3 }, true)] {
            let oscillator = NonlinearOscillator::new(&forces, damping, 2e-3).unwrap();
            let (mut q, mut v) = (vec![0.2, -0.1], vec![0.0, 1.0]);
            let mut a = oscillator.acceleration(&q, &v, &[0.0; 2]);
            let first = oscillator.energy(&q, &v);
            let (mut least, mut largest) = (first, first);
            for _ in 0..10_000 {
                oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2]).unwrap();
                let energy = oscillator.energy(&q, &v);
                (least, largest) = (least.min(energy), largest.max(energy));
            }
            assert!(largest < 1.01 * first, "{first} to {largest}");
            assert_eq!(least < 0.9 * first, grows, "{first} to {least}");
        }
    }

    #[test]
    fn a_constant_force_leads_to_its_static_solution() {
        let forces = forces(40.0, 90.0, 3e4);
        let goal = [0.05, -0.02];
        let force = forces.at(&goal);
        let damping = Damping { mass: 10.0, stiffness: 0.0 };
        let oscillator = NonlinearOscillator::new(&forces, damping, 1e-2).unwrap();
        let (mut q, mut v, mut a) = (vec![0.0; 2], vec![0.0; 2], force.clone());
        for _ in 0..2000 {
            oscillator.advance(&mut q, &mut v, &mut a, &force).unwrap();
        }
        assert!((q[0] - goal[0]).abs() + (q[1] - goal[1]).abs() < 1e-9, "{q:?}");
    }

    #[test]
    fn modes_much_faster_than_the_step_are_solved() {
        let forces = forces(4e7, 9e5, 1e8);
        let oscillator = NonlinearOscillator::new(&forces, NONE, 1e-3).unwrap();
        for speed in [5.0, 50.0] {
            let (mut q, mut v) = (vec![0.2, -0.1], vec![-speed, speed / 2.0]);
            let mut a = oscillator.acceleration(&q, &v, &[0.0; 2]);
            let first = oscillator.energy(&q, &v);
            for step in 0..500 {
                oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2]).unwrap();
                let energy = oscillator.energy(&q, &v);
                assert!(energy < 1.5 * first, "step {step}: {energy}, not {first}");
            }
        }
    }

    #[test]
    fn invalid_arguments_and_steps_are_refused() {
        let forces = forces(1.0, 1.0, 1.0);
        let new = |damping, step| NonlinearOscillator::new(&forces, damping, step);
        assert!(matches!(new(NONE, 0.0), Err(DynamicsError::Step { .. })));
        let wrong = Damping { mass: f64::NAN, stiffness: 0.0 };
        assert!(matches!(new(wrong, 1.0), Err(DynamicsError::Damping { .. })));
        let oscillator = new(NONE, 1.0).unwrap();
        let (mut q, mut v) = (vec![1e200, 0.0], vec![0.0, 0.0]);
        let mut a = vec![0.0; 2];
        let before = q.clone();
        let answer = oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2]);
        assert!(matches!(answer, Err(DynamicsError::Unsolved { .. })));
        assert_eq!(q, before);
    }
}
