//! Integrator for reduced nonlinear dynamics: implicit Newmark (Barbic and James 2005, section 5).

use faer::Mat;
use faer::prelude::Solve;
use sscc_solid::Stiffness;

use crate::elastic_energy::{ElasticEnergy, Evaluation};
use crate::{Damping, DynamicsError};

/// Maximum number of Newton iterations in one step.
const MAX_ITERATIONS: usize = 60;

/// An iteration that leaves a larger share of the residual converges slowly; the next one computes a new derivative.
/// Iterations otherwise reuse the derivative, which changes little within a step.
const SLOW_CONVERGENCE: f64 = 0.2;

/// Minimum share of a Newton step in the line search.
const MIN_STEP_SHARE: f64 = 1e-6;

/// A step is solved when the residual is at most this share of the sum of its terms; this is close to the rounding
/// error.
const RELATIVE_TOLERANCE: f64 = 1e-11;

/// Integrator for reduced St. Venant-Kirchhoff forces, `q'' + C q' + f(q) = g`. It uses the implicit Newmark method of
/// average acceleration (second order, no numerical damping) and solves each step by Newton's method. The Rayleigh
/// damping uses the stiffness at rest.
#[derive(Clone, Debug)]
pub struct NonlinearOscillator<'a> {
    energy: &'a ElasticEnergy,
    /// Damping matrix C, r x r, row after row.
    damping: Vec<f64>,
    step: f64,
}

/// Buffers of a step. All oscillators of a thread can share them.
#[derive(Clone, Debug, Default)]
pub struct NewmarkBuffers {
    evaluation: Evaluation,
    acceleration: Vec<f64>,
    trial: Trial,
    next: Trial,
}

/// Trial acceleration of Newton's method, and the state at the end of the step with this acceleration.
#[derive(Clone, Debug, Default)]
struct Trial {
    acceleration: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    /// `C v`.
    damping_forces: Vec<f64>,
    residual: Vec<f64>,
    /// Sum of the absolute values of the residual; infinite where it is not a number.
    residual_sum: f64,
    /// Sum of the absolute values of all terms of the residual.
    term_sum: f64,
}

/// State at the start of a step, and the forces g.
#[derive(Clone, Copy)]
struct Start<'s> {
    q: &'s [f64],
    v: &'s [f64],
    acceleration: &'s [f64],
    g: &'s [f64],
}

impl<'a> NonlinearOscillator<'a> {
    /// Creates the integrator with steps of `step` seconds. `stiffness` is that at rest.
    ///
    /// # Errors
    /// When the step is not positive, the damping is negative or not finite, or stiffness and energy have different
    /// ranks.
    pub fn new(
        energy: &'a ElasticEnergy,
        stiffness: &Stiffness,
        damping: Damping,
        step: f64,
    ) -> Result<Self, DynamicsError> {
        if !(step.is_finite() && step > 0.0) {
            return Err(DynamicsError::Step { step });
        }
        let given = damping.check()?;
        let (r, found) = (energy.rank(), stiffness.rank());
        if found != r {
            return Err(DynamicsError::Rank { found, rank: r });
        }
        let mut damping: Vec<f64> = stiffness.entries().iter().map(|k| given.stiffness * k).collect();
        (0..r).for_each(|k| damping[k * (r + 1)] += given.mass);
        Ok(Self { energy, damping, step })
    }

    /// Returns the undamped acceleration `g - f(q)` under the forces g (r numbers each), then r zeros: the first step
    /// needs it.
    pub fn undamped_acceleration(&self, q: &[f64], g: &[f64], buffers: &mut NewmarkBuffers) -> Vec<f64> {
        self.energy.evaluate_forces(q, &mut buffers.evaluation);
        let undamped = g.iter().zip(buffers.evaluation.forces()).map(|(g, f)| g - f);
        undamped.chain(q.iter().map(|_| 0.0)).collect()
    }

    /// Advances q, v and the undamped acceleration by one step under the forces g (r numbers each). `undamped` has 2 r
    /// numbers: the undamped acceleration and its change in the last step. Both depend on q alone, so impulses may change
    /// v between steps.
    ///
    /// # Errors
    /// When Newton's method does not converge; then q, v and the undamped acceleration are unchanged.
    pub fn advance(
        &self,
        q: &mut [f64],
        v: &mut [f64],
        undamped: &mut [f64],
        g: &[f64],
        buffers: &mut NewmarkBuffers,
    ) -> Result<(), DynamicsError> {
        let NewmarkBuffers { evaluation, acceleration, trial, next } = buffers;
        self.set_damping_forces(v, acceleration);
        acceleration.iter_mut().zip(&*undamped).for_each(|(a, e)| *a = e - *a);
        let start = Start { q, v, acceleration, g };
        self.begin(start, undamped, evaluation, [&mut *trial, &mut *next]);
        let mut factor = Some(self.derivative(evaluation).partial_piv_lu());
        // Whether the derivative is that at the trial.
        let mut is_fresh = true;
        for _ in 0..MAX_ITERATIONS {
            let limit = RELATIVE_TOLERANCE * trial.term_sum;
            if !limit.is_finite() {
                break;
            }
            if trial.residual_sum <= limit {
                trial.finish(q, v, undamped);
                return Ok(());
            }
            let change = factor
                .get_or_insert_with(|| {
                    self.energy.evaluate_stiffness(&trial.q, evaluation);
                    self.derivative(evaluation).partial_piv_lu()
                })
                .solve(Mat::from_fn(q.len(), 1, |i, _| trial.residual[i]));
            let mut step = |share: f64| {
                next.acceleration.clear();
                let moved = |(k, b): (usize, &f64)| b - share * change[(k, 0)];
                next.acceleration.extend(trial.acceleration.iter().enumerate().map(moved));
                self.place(start, next);
                self.energy.evaluate_forces(&next.q, evaluation);
                next.weigh(evaluation.forces().iter().copied(), start.g);
                next.residual_sum
            };
            let mut residual_sum = step(1.0);
            // A shorter step in Newton's direction may lower the residual where the full step does not.
            let mut share = 1.0;
            while is_fresh && residual_sum >= trial.residual_sum && share > MIN_STEP_SHARE {
                share /= 2.0;
                residual_sum = step(share);
            }
            let left = residual_sum / trial.residual_sum;
            if left < 1.0 {
                std::mem::swap(trial, next);
            } else if is_fresh {
                break;
            }
            is_fresh = left >= SLOW_CONVERGENCE;
            if is_fresh {
                factor = None;
            }
        }
        Err(DynamicsError::Unsolved { energy: self.energy(q, v) })
    }

    /// Chooses the first trial, and evaluates the stiffness at its q: the trial has an acceleration extrapolated from the
    /// last step, or it keeps q. With modes much faster than the step, the extrapolation is a bad guess.
    fn begin(
        &self,
        start: Start<'_>,
        undamped: &[f64],
        evaluation: &mut Evaluation,
        [trial, still]: [&mut Trial; 2],
    ) {
        let (undamped, change) = undamped.split_at(start.q.len());
        self.set_damping_forces(start.acceleration, &mut trial.damping_forces);
        trial.acceleration.clear();
        let extrapolated = start.acceleration.iter().zip(change).zip(&trial.damping_forces);
        trial.acceleration.extend(extrapolated.map(|((a, change), c)| a + change - self.step * c));
        self.place(start, trial);
        self.energy.evaluate_stiffness(&trial.q, evaluation);
        trial.weigh(evaluation.forces().iter().copied(), start.g);
        still.acceleration.clear();
        let keeping_q = start.acceleration.iter().zip(start.v).map(|(a, v)| -a - 4.0 * v / self.step);
        still.acceleration.extend(keeping_q);
        self.place(start, still);
        still.weigh(start.g.iter().zip(undamped).map(|(g, e)| g - e), start.g);
        if trial.residual_sum > still.residual_sum {
            std::mem::swap(trial, still);
            self.energy.evaluate_stiffness(&trial.q, evaluation);
            // The given acceleration may belong to another q.
            trial.weigh(evaluation.forces().iter().copied(), start.g);
        }
    }

    /// Computes q, v and damping forces of a trial from its acceleration.
    fn place(&self, start: Start<'_>, trial: &mut Trial) {
        let h = self.step;
        let Trial { acceleration, q, v, damping_forces, .. } = trial;
        q.clear();
        v.clear();
        for (k, b) in acceleration.iter().enumerate() {
            let sum = start.acceleration[k] + b;
            q.push(start.q[k] + h * start.v[k] + h * h / 4.0 * sum);
            v.push(start.v[k] + h / 2.0 * sum);
        }
        self.set_damping_forces(v, damping_forces);
    }

    /// Returns the derivative of the residual with respect to the acceleration (r x r).
    fn derivative(&self, evaluation: &Evaluation) -> Mat<f64> {
        let (r, h) = (self.energy.rank(), self.step);
        Mat::from_fn(r, r, |i, j| {
            f64::from(u8::from(i == j))
                + h / 2.0 * self.damping[i * r + j]
                + h * h / 4.0 * evaluation.stiffness(i)[j]
        })
    }

    /// Returns kinetic and elastic energy.
    pub fn energy(&self, q: &[f64], v: &[f64]) -> f64 {
        self.energy.at(q, &mut Evaluation::default()) + v.iter().map(|v| v * v / 2.0).sum::<f64>()
    }

    /// Computes `C v`.
    fn set_damping_forces(&self, v: &[f64], forces: &mut Vec<f64>) {
        forces.clear();
        let row = |row: &[f64]| row.iter().zip(v).map(|(c, v)| c * v).sum::<f64>();
        forces.extend(self.damping.chunks_exact(v.len()).map(row));
    }
}

impl Trial {
    /// Computes the residual from the inner forces and the forces g.
    fn weigh(&mut self, inner: impl Iterator<Item = f64>, g: &[f64]) {
        self.residual.clear();
        (self.residual_sum, self.term_sum) = (0.0, 0.0);
        for (((inner, b), damping), g) in inner.zip(&self.acceleration).zip(&self.damping_forces).zip(g) {
            let residual = b + damping + inner - g;
            self.residual_sum += residual.abs();
            self.term_sum += b.abs() + damping.abs() + inner.abs() + g.abs();
            self.residual.push(residual);
        }
        if self.residual_sum.is_nan() {
            self.residual_sum = f64::INFINITY;
        }
    }

    /// Copies the state to q, v and the undamped acceleration.
    fn finish(&self, q: &mut [f64], v: &mut [f64], undamped: &mut [f64]) {
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        let (undamped, change) = undamped.split_at_mut(q.len());
        let accelerations = self.acceleration.iter().zip(&self.damping_forces);
        for ((e, change), (b, damping)) in undamped.iter_mut().zip(change).zip(accelerations) {
            (*change, *e) = (b + damping - *e, b + damping);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sscc_solid::ReducedForces;

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
        let energy = ElasticEnergy::new(&forces).unwrap();
        let oscillator = NonlinearOscillator::new(&energy, forces.linear(), NONE, step).unwrap();
        let (mut q, mut v) = (vec![1e-3, 0.0], vec![0.0, 0.0]);
        let buffers = &mut NewmarkBuffers::default();
        let mut a = oscillator.undamped_acceleration(&q, &[0.0; 2], buffers);
        let (mut crossings, mut last) = (Vec::new(), q[0]);
        for step in 0..4000 {
            oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers).unwrap();
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
            let energy = ElasticEnergy::new(&forces).unwrap();
            let oscillator = NonlinearOscillator::new(&energy, forces.linear(), damping, 2e-3).unwrap();
            let (mut q, mut v) = (vec![0.2, -0.1], vec![0.0, 1.0]);
            let buffers = &mut NewmarkBuffers::default();
            let mut a = oscillator.undamped_acceleration(&q, &[0.0; 2], buffers);
            let first = oscillator.energy(&q, &v);
            let (mut least, mut largest) = (first, first);
            for _ in 0..10_000 {
                oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers).unwrap();
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
        let energy = ElasticEnergy::new(&forces).unwrap();
        let oscillator = NonlinearOscillator::new(&energy, forces.linear(), damping, 1e-2).unwrap();
        let buffers = &mut NewmarkBuffers::default();
        let (mut q, mut v) = (vec![0.0; 2], vec![0.0; 2]);
        let mut a = oscillator.undamped_acceleration(&q, &force, buffers);
        for _ in 0..2000 {
            oscillator.advance(&mut q, &mut v, &mut a, &force, buffers).unwrap();
        }
        assert!((q[0] - goal[0]).abs() + (q[1] - goal[1]).abs() < 1e-9, "{q:?}");
    }

    #[test]
    fn modes_much_faster_than_the_step_are_solved() {
        let forces = forces(4e7, 9e5, 1e8);
        let energy = ElasticEnergy::new(&forces).unwrap();
        let oscillator = NonlinearOscillator::new(&energy, forces.linear(), NONE, 1e-3).unwrap();
        let buffers = &mut NewmarkBuffers::default();
        for speed in [5.0, 50.0] {
            let (mut q, mut v) = (vec![0.2, -0.1], vec![-speed, speed / 2.0]);
            let mut a = oscillator.undamped_acceleration(&q, &[0.0; 2], buffers);
            let first = oscillator.energy(&q, &v);
            for step in 0..500 {
                oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers).unwrap();
                let energy = oscillator.energy(&q, &v);
                assert!(energy < 1.5 * first, "step {step}: {energy}, not {first}");
            }
        }
    }

    #[test]
    fn invalid_arguments_and_steps_are_refused() {
        let forces = forces(1.0, 1.0, 1.0);
        let energy = ElasticEnergy::new(&forces).unwrap();
        let new = |damping, step| NonlinearOscillator::new(&energy, forces.linear(), damping, step);
        assert!(matches!(new(NONE, 0.0), Err(DynamicsError::Step { .. })));
        let wrong = Damping { mass: f64::NAN, stiffness: 0.0 };
        assert!(matches!(new(wrong, 1.0), Err(DynamicsError::Damping { .. })));
        let oscillator = new(NONE, 1.0).unwrap();
        let (mut q, mut v) = (vec![1e200, 0.0], vec![0.0, 0.0]);
        let mut a = vec![0.0; 4];
        let (before, buffers) = (q.clone(), &mut NewmarkBuffers::default());
        let answer = oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers);
        assert!(matches!(answer, Err(DynamicsError::Unsolved { .. })));
        assert_eq!(q, before);
    }
}
