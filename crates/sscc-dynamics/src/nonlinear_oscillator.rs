//! Integrator for reduced nonlinear dynamics: implicit Newmark (Barbic and James 2005, section 5).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::inverse::{inverse, inverse_scratch};
use faer::{Mat, Par};
use sscc_solid::Stiffness;

use crate::broyden::Broyden;
use crate::elastic_energy::{ElasticEnergy, Evaluation};
use crate::trial::Trial;
use crate::{Damping, DynamicsError};

/// Maximum number of iterations in one step.
const MAX_ITERATIONS: usize = 60;

/// An iteration that leaves a larger share of the residual converges slowly; the next one is Newton's, with the derivative
/// at the trial.
const SLOW_CONVERGENCE: f64 = 0.5;

/// After a step with more iterations, the derivative is computed again, at its q.
const MAX_CHEAP_ITERATIONS: usize = 4;

/// Minimum share of a Newton step in the line search.
const MIN_STEP_SHARE: f64 = 1e-6;

/// A step is solved when the residual is at most this share of the sum of its terms: far below the error of the method, which
/// is of second order in the step.
const RELATIVE_TOLERANCE: f64 = 1e-9;

/// Integrator for reduced St. Venant-Kirchhoff forces, `q'' + C q' + f(q) = g`. It uses the implicit Newmark method of
/// average acceleration (second order, no numerical damping). The Rayleigh damping uses the stiffness at rest.
///
/// Each step is solved by Broyden's method. It begins with the derivative of an earlier step, because the derivative
/// changes little within a few steps. Where it converges slowly, an iteration of Newton's method with a line search
/// follows.
#[derive(Clone, Debug)]
pub struct NonlinearOscillator<'a> {
    energy: &'a ElasticEnergy,
    /// Damping matrix C, r x r, row after row.
    damping: Vec<f64>,
    step: f64,
    /// The q at which the derivative of the residual was computed last.
    linearised_at: Vec<f64>,
    /// Inverse of this derivative, column after column.
    inverse: Vec<f64>,
}

/// Buffers of a step. All oscillators of a thread can share them.
#[derive(Clone, Debug, Default)]
pub struct NewmarkBuffers {
    evaluation: Evaluation,
    acceleration: Vec<f64>,
    trial: Trial,
    next: Trial,
    broyden: Broyden,
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
        let (rest, linearised_at) = (vec![0.0; r], vec![0.0; r]);
        let mut oscillator = Self { energy, damping, step, linearised_at, inverse: Vec::new() };
        oscillator.linearise(&rest, &mut Evaluation::default());
        Ok(oscillator)
    }

    /// Returns the undamped acceleration `g - f(q)` under the forces g (r numbers each), then r zeros (rest): the first
    /// step needs both.
    pub fn undamped_acceleration(&self, q: &[f64], g: &[f64], buffers: &mut NewmarkBuffers) -> Vec<f64> {
        let mut undamped = vec![0.0; 2 * q.len()];
        self.update(q, &mut undamped, g, buffers);
        undamped
    }

    /// Computes the undamped acceleration at a q that was moved between steps: the first r numbers of `undamped`. Returns the
    /// elastic energy there.
    pub(crate) fn update(
        &self,
        q: &[f64],
        undamped: &mut [f64],
        g: &[f64],
        buffers: &mut NewmarkBuffers,
    ) -> f64 {
        self.energy.evaluate_forces(q, &mut buffers.evaluation);
        let forces = buffers.evaluation.forces();
        undamped.iter_mut().zip(g).zip(forces).for_each(|((undamped, g), f)| *undamped = g - f);
        buffers.evaluation.energy()
    }

    /// Advances q, v and the undamped acceleration by one step under the forces g (r numbers each). `undamped` has 2 r
    /// numbers: the undamped acceleration, and the q whose derivative the step begins with. The first depends on q alone,
    /// so impulses may change v between steps. The same numbers give the same bits, whatever the last step was. Returns the
    /// elastic energy at the end of the step.
    ///
    /// # Errors
    /// When the iterations do not converge; then q, v and `undamped` are unchanged.
    pub fn advance(
        &mut self,
        q: &mut [f64],
        v: &mut [f64],
        undamped: &mut [f64],
        g: &[f64],
        buffers: &mut NewmarkBuffers,
    ) -> Result<f64, DynamicsError> {
        let NewmarkBuffers { evaluation, acceleration, trial, next, broyden } = buffers;
        self.set_damping_forces(v, acceleration);
        acceleration.iter_mut().zip(&*undamped).for_each(|(a, e)| *a = e - *a);
        let start = Start { q, v, acceleration, g };
        let r = q.len();
        if undamped[r..] != self.linearised_at {
            self.linearise(&undamped[r..], evaluation);
        }
        self.begin(start, undamped, evaluation, [&mut *trial, &mut *next], &mut broyden.change);
        let mut is_slow = false;
        broyden.begin();
        for iteration in 0..MAX_ITERATIONS {
            let limit = RELATIVE_TOLERANCE * trial.term_sum;
            if !limit.is_finite() {
                break;
            }
            if trial.residual_sum <= limit {
                trial.finish(q, v, undamped);
                let is_old = iteration > MAX_CHEAP_ITERATIONS;
                undamped[r..].copy_from_slice(if is_old { &trial.q } else { &self.linearised_at });
                return Ok(trial.elastic_energy);
            }
            if is_slow {
                self.linearise(&trial.q, evaluation);
                broyden.begin();
            }
            multiply(&self.inverse, &trial.residual, &mut broyden.change);
            broyden.improve();
            let mut step = |share: f64| {
                next.acceleration.clear();
                let moved = |(b, change): (&f64, &f64)| b - share * change;
                next.acceleration.extend(trial.acceleration.iter().zip(&broyden.change).map(moved));
                self.place(start, next);
                self.evaluate(next, start.g, evaluation);
                next.residual_sum
            };
            let mut residual_sum = step(1.0);
            // A shorter step in Newton's direction may lower the residual where the full step does not.
            let mut share = 1.0;
            while is_slow && residual_sum >= trial.residual_sum && share > MIN_STEP_SHARE {
                share /= 2.0;
                residual_sum = step(share);
            }
            let left = residual_sum / trial.residual_sum;
            if left < 1.0 {
                std::mem::swap(trial, next);
                broyden.keep(share);
            } else if is_slow {
                break;
            }
            is_slow = left.is_nan() || left >= SLOW_CONVERGENCE;
        }
        Err(DynamicsError::Unsolved { energy: self.energy(q, v) })
    }

    /// Chooses the first trial: it keeps q, where the forces are known, or it follows from this by the given derivative.
    fn begin(
        &self,
        start: Start<'_>,
        undamped: &[f64],
        evaluation: &mut Evaluation,
        [trial, still]: [&mut Trial; 2],
        change: &mut Vec<f64>,
    ) {
        still.acceleration.clear();
        let keeping_q = start.acceleration.iter().zip(start.v).map(|(a, v)| -a - 4.0 * v / self.step);
        still.acceleration.extend(keeping_q);
        self.place(start, still);
        still.set_residual(start.g.iter().zip(undamped).map(|(g, e)| g - e), start.g);
        multiply(&self.inverse, &still.residual, change);
        trial.acceleration.clear();
        trial.acceleration.extend(still.acceleration.iter().zip(&*change).map(|(a, c)| a - c));
        self.place(start, trial);
        self.evaluate(trial, start.g, evaluation);
        if trial.residual_sum > still.residual_sum {
            std::mem::swap(trial, still);
            // The given acceleration may belong to another q.
            self.evaluate(trial, start.g, evaluation);
        }
    }

    /// Computes residual and elastic energy of a trial.
    fn evaluate(&self, trial: &mut Trial, g: &[f64], evaluation: &mut Evaluation) {
        self.energy.evaluate_forces(&trial.q, evaluation);
        trial.set_residual(evaluation.forces().iter().copied(), g);
        trial.elastic_energy = evaluation.energy();
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

    /// Computes the derivative of the residual at q, and its inverse.
    fn linearise(&mut self, q: &[f64], evaluation: &mut Evaluation) {
        self.energy.evaluate_stiffness(q, evaluation);
        self.inverse = inverted(derivative(&self.damping, self.step, |i, j| evaluation.stiffness(i)[j]));
        self.linearised_at.copy_from_slice(q);
    }

    /// Returns kinetic and elastic energy.
    pub fn energy(&self, q: &[f64], v: &[f64]) -> f64 {
        self.energy.at(q, &mut Evaluation::default()) + v.iter().map(|v| v * v / 2.0).sum::<f64>()
    }

    /// Computes `C v`.
    fn set_damping_forces(&self, v: &[f64], forces: &mut Vec<f64>) {
        // C is symmetric.
        multiply(&self.damping, v, forces);
    }
}

/// Computes the product of a matrix, given column after column, with a vector.
fn multiply(columns: &[f64], x: &[f64], product: &mut Vec<f64>) {
    product.clear();
    product.resize(x.len(), 0.0);
    for (column, x) in columns.chunks_exact(x.len()).zip(x) {
        product.iter_mut().zip(column).for_each(|(sum, c)| *sum += c * x);
    }
}

/// Returns the derivative of the residual with respect to the acceleration, `1 + h / 2 C + h^2 / 4 K` (r x r).
fn derivative(damping: &[f64], h: f64, stiffness: impl Fn(usize, usize) -> f64) -> Mat<f64> {
    let r = damping.len().isqrt();
    Mat::from_fn(r, r, |i, j| {
        f64::from(u8::from(i == j)) + h / 2.0 * damping[i * r + j] + h * h / 4.0 * stiffness(i, j)
    })
}

/// Returns the inverse of a matrix, column after column. Uses one thread, so that the order of sums is fixed.
fn inverted(mut matrix: Mat<f64>) -> Vec<f64> {
    let r = matrix.nrows();
    let (mut order, mut inverse_order, mut result) = (vec![0_usize; r], vec![0_usize; r], Mat::zeros(r, r));
    let scratch = lu_in_place_scratch::<usize, f64>(r, r, Par::Seq, Default::default())
        .or(inverse_scratch::<usize, f64>(r, Par::Seq));
    let mut memory = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut memory);
    let (rows, lu) = (matrix.as_mut(), Default::default());
    let (_, order) = lu_in_place(rows, &mut order, &mut inverse_order, Par::Seq, stack, lu);
    inverse(result.as_mut(), matrix.as_ref(), matrix.as_ref(), order, Par::Seq, stack);
    result.col_iter().flat_map(|column| column.iter().copied().collect::<Vec<_>>()).collect()
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
    fn inverses_times_their_matrices_are_the_identity() {
        for r in [1, 2, 5, 40] {
            // Rows are exchanged: the largest entry of the first column is in the last row.
            let entry = |i: usize, j: usize| {
                libm::sin((3 * i * j + i) as f64) + if i + j + 1 == r { 9.0 } else { 0.0 }
            };
            let inverse = inverted(Mat::from_fn(r, r, entry));
            for i in 0..r {
                for j in 0..r {
                    let sum: f64 = (0..r).map(|k| entry(i, k) * inverse[j * r + k]).sum();
                    assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-12, "{r} {i} {j} {sum}");
                }
            }
        }
    }

    #[test]
    fn free_vibration_has_the_exact_frequency() {
        let lambda = 40.0_f64;
        // 200 steps a period; the method lengthens the period by (omega h)^2 / 12.
        let period = std::f64::consts::TAU / lambda.sqrt();
        let step = period / 200.0;
        let forces = forces(lambda, 90.0, 0.0);
        let energy = ElasticEnergy::new(&forces).unwrap();
        let mut oscillator = NonlinearOscillator::new(&energy, forces.linear(), NONE, step).unwrap();
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
            let mut oscillator = NonlinearOscillator::new(&energy, forces.linear(), damping, 2e-3).unwrap();
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
        let mut oscillator = NonlinearOscillator::new(&energy, forces.linear(), damping, 1e-2).unwrap();
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
        let mut oscillator = NonlinearOscillator::new(&energy, forces.linear(), NONE, 1e-3).unwrap();
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
    fn a_new_oscillator_continues_with_the_same_bits() {
        let forces = forces(4e5, 9e5, 1e8);
        let energy = ElasticEnergy::new(&forces).unwrap();
        let new = || NonlinearOscillator::new(&energy, forces.linear(), NONE, 1e-3).unwrap();
        let (mut oscillator, buffers) = (new(), &mut NewmarkBuffers::default());
        let (mut q, mut v) = (vec![0.2, -0.1], vec![-5.0, 2.5]);
        let mut a = oscillator.undamped_acceleration(&q, &[0.0; 2], buffers);
        for _ in 0..100 {
            let (mut other_q, mut other_v, mut other_a) = (q.clone(), v.clone(), a.clone());
            new().advance(&mut other_q, &mut other_v, &mut other_a, &[0.0; 2], buffers).unwrap();
            oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers).unwrap();
            assert_eq!((&q, &v, &a), (&other_q, &other_v, &other_a));
        }
        // The derivative of a later step was used.
        assert!(a[2..].iter().any(|x| *x != 0.0), "{a:?}");
    }

    #[test]
    fn invalid_arguments_and_steps_are_refused() {
        let forces = forces(1.0, 1.0, 1.0);
        let energy = ElasticEnergy::new(&forces).unwrap();
        let new = |damping, step| NonlinearOscillator::new(&energy, forces.linear(), damping, step);
        assert!(matches!(new(NONE, 0.0), Err(DynamicsError::Step { .. })));
        let wrong = Damping { mass: f64::NAN, stiffness: 0.0 };
        assert!(matches!(new(wrong, 1.0), Err(DynamicsError::Damping { .. })));
        let mut oscillator = new(NONE, 1.0).unwrap();
        let (mut q, mut v) = (vec![1e200, 0.0], vec![0.0, 0.0]);
        let mut a = vec![0.0; 4];
        let (before, buffers) = (q.clone(), &mut NewmarkBuffers::default());
        let answer = oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers);
        assert!(matches!(answer, Err(DynamicsError::Unsolved { .. })));
        assert_eq!(q, before);
    }
}
