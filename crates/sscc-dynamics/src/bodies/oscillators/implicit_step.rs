//! One implicit step of reduced nonlinear forces, solved by Broyden's and Newton's methods.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::inverse::{inverse, inverse_scratch};
use faer::{Mat, Par};

use super::broyden::Broyden;
use super::elastic_energy::{ElasticEnergy, Evaluation};
use super::trial::Trial;

/// Maximum number of iterations in one step.
const MAX_ITERATIONS: usize = 60;

/// An iteration that leaves at least this share of the residual converges slowly. The next iteration is Newton's, with
/// the derivative at the trial.
const SLOW_CONVERGENCE: f64 = 0.5;

/// After a step with more iterations, the derivative is computed again, at its q.
const MAX_CHEAP_ITERATIONS: usize = 4;

/// The line search halves a Newton step until its fraction is at most this.
const MIN_STEP_SHARE: f64 = 1e-6;

/// A step is solved when the residual is at most this share of the sum of its terms: far below the error of the method, which
/// is of second order in the step.
const RELATIVE_TOLERANCE: f64 = 1e-9;

/// Elastic force that acts in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Rule {
    /// Newmark's average acceleration: the mean of the forces at both ends.
    Newmark,
    /// The mean of the forces on the straight line between both ends (average vector field). Forces are cubic, so Simpson's
    /// quadrature gives this mean exactly, and its work is the change of the elastic energy: a step adds no energy.
    Conserving,
}

/// State at the start of a step, and the forces g (r numbers each).
#[derive(Clone, Copy)]
pub(crate) struct Start<'s> {
    pub q: &'s [f64],
    pub v: &'s [f64],
    /// Acceleration without damping, `g - f(q)`.
    pub undamped: &'s [f64],
    pub g: &'s [f64],
}

/// Buffers of a step. All oscillators of a thread can share them.
#[derive(Clone, Debug, Default)]
pub struct NewmarkBuffers {
    pub(crate) evaluation: Evaluation,
    /// The end of the step, once it is solved.
    pub(crate) trial: Trial,
    next: Trial,
    acceleration: Vec<f64>,
    middle: Vec<f64>,
    broyden: Broyden,
}

/// Solver of the equation of motion at the end of a step.
///
/// Each step is solved by Broyden's method. It begins with the derivative of an earlier step, because the derivative
/// changes little within a few steps. Where it converges slowly, an iteration of Newton's method with a line search
/// follows.
#[derive(Clone, Debug)]
pub(crate) struct ImplicitStep {
    energy: Arc<ElasticEnergy>,
    /// Damping matrix C, r x r, row after row.
    damping: Vec<f64>,
    /// The q, the step and the [`Rule`] for which the derivative of the residual was computed last.
    linearised_at: Vec<f64>,
    linearised_for: (Rule, f64),
    /// Inverse of this derivative, column after column.
    inverse: Vec<f64>,
}

impl ImplicitStep {
    /// Creates the solver; `damping` is the matrix C (r x r), and `step` the usual step (s).
    pub fn new(energy: Arc<ElasticEnergy>, damping: Vec<f64>, step: f64) -> Self {
        let rest = vec![0.0; energy.rank()];
        let linearised_for = (Rule::Newmark, step);
        let mut solver =
            Self { energy, damping, linearised_at: rest.clone(), linearised_for, inverse: Vec::new() };
        solver.linearise(&rest, &rest, &mut NewmarkBuffers::default());
        solver
    }

    /// Returns the q at which the derivative was computed last (r numbers).
    pub fn linearised_at(&self) -> &[f64] {
        &self.linearised_at
    }

    /// Finds the end of a step of h seconds and stores it as the trial of `buffers`. Begins with the derivative at
    /// `linearise_at`. Returns whether few iterations were needed; None if no solution was found.
    pub fn solve(
        &mut self,
        rule: Rule,
        h: f64,
        start: Start<'_>,
        linearise_at: &[f64],
        buffers: &mut NewmarkBuffers,
    ) -> Option<bool> {
        if (rule, h) != self.linearised_for || linearise_at != self.linearised_at {
            self.linearised_for = (rule, h);
            self.linearise(linearise_at, linearise_at, buffers);
        }
        self.set_damping_forces(start.v, &mut buffers.acceleration);
        buffers.acceleration.iter_mut().zip(start.undamped).for_each(|(a, e)| *a = e - *a);
        self.begin(start, buffers);
        let mut is_slow = false;
        buffers.broyden.begin();
        for iteration in 0..MAX_ITERATIONS {
            let limit = RELATIVE_TOLERANCE * buffers.trial.term_sum;
            if !limit.is_finite() {
                break;
            }
            if buffers.trial.residual_sum <= limit {
                return Some(iteration <= MAX_CHEAP_ITERATIONS);
            }
            if is_slow {
                let at = std::mem::take(&mut buffers.trial.q);
                self.linearise(start.q, &at, buffers);
                buffers.trial.q = at;
                buffers.broyden.begin();
            }
            multiply(&self.inverse, &buffers.trial.residual, &mut buffers.broyden.change);
            buffers.broyden.improve();
            let mut residual_sum = self.step(1.0, start, buffers);
            // A shorter step in Newton's direction may lower the residual where the full step does not.
            let mut share = 1.0;
            while is_slow && residual_sum >= buffers.trial.residual_sum && share > MIN_STEP_SHARE {
                share /= 2.0;
                residual_sum = self.step(share, start, buffers);
            }
            let left = residual_sum / buffers.trial.residual_sum;
            if left < 1.0 {
                std::mem::swap(&mut buffers.trial, &mut buffers.next);
                buffers.broyden.keep(share);
            } else if is_slow {
                break;
            }
            is_slow = left.is_nan() || left >= SLOW_CONVERGENCE;
        }
        None
    }

    /// Computes the next trial by a fraction `share` of the change, and returns the sum of its residual.
    fn step(&self, share: f64, start: Start<'_>, buffers: &mut NewmarkBuffers) -> f64 {
        let NewmarkBuffers { evaluation, trial, next, acceleration, middle, broyden } = buffers;
        next.acceleration.clear();
        let moved = |(b, change): (&f64, &f64)| b - share * change;
        next.acceleration.extend(trial.acceleration.iter().zip(&broyden.change).map(moved));
        self.place(start, acceleration, next);
        self.evaluate(next, start, evaluation, middle);
        next.residual_sum
    }

    /// Chooses the first trial: of two trials, the one with the smaller residual. One keeps q, where the forces are
    /// known. The derivative yields the other one from it.
    fn begin(&self, start: Start<'_>, buffers: &mut NewmarkBuffers) {
        let NewmarkBuffers { evaluation, trial, next: still, acceleration, middle, broyden } = buffers;
        let h = self.linearised_for.1;
        still.acceleration.clear();
        let keeping_q = acceleration.iter().zip(start.v).map(|(a, v)| -a - 4.0 * v / h);
        still.acceleration.extend(keeping_q);
        self.place(start, acceleration, still);
        still.set_residual(start.g.iter().zip(start.undamped).map(|(g, e)| g - e), start.g);
        multiply(&self.inverse, &still.residual, &mut broyden.change);
        trial.acceleration.clear();
        trial.acceleration.extend(still.acceleration.iter().zip(&broyden.change).map(|(a, c)| a - c));
        self.place(start, acceleration, trial);
        self.evaluate(trial, start, evaluation, middle);
        if trial.residual_sum > still.residual_sum {
            std::mem::swap(trial, still);
            // `start.undamped` may belong to another q.
            self.evaluate(trial, start, evaluation, middle);
        }
    }

    /// Computes residual and elastic energy of a trial.
    fn evaluate(
        &self,
        trial: &mut Trial,
        start: Start<'_>,
        evaluation: &mut Evaluation,
        middle: &mut Vec<f64>,
    ) {
        if self.linearised_for.0 == Rule::Newmark {
            self.energy.evaluate_forces(&trial.q, evaluation);
            trial.set_residual(evaluation.forces().iter().copied(), start.g);
        } else {
            middle.clear();
            middle.extend(start.q.iter().zip(&trial.q).map(|(a, b)| (a + b) / 2.0));
            self.energy.evaluate_forces(middle, evaluation);
            middle.copy_from_slice(evaluation.forces());
            self.energy.evaluate_forces(&trial.q, evaluation);
            // With this force at the end, Newmark's mean of the forces at both ends is Simpson's mean.
            let known = start.g.iter().zip(start.undamped).map(|(g, e)| g - e);
            let forces = middle.iter().zip(evaluation.forces()).zip(known);
            trial.set_residual(forces.map(|((m, f), f0)| (4.0 * m + f - 2.0 * f0) / 3.0), start.g);
        }
        trial.elastic_energy = evaluation.energy();
    }

    /// Computes q, v and damping forces of a trial from its acceleration and the acceleration at the start.
    fn place(&self, start: Start<'_>, acceleration: &[f64], trial: &mut Trial) {
        let h = self.linearised_for.1;
        let Trial { acceleration: end, q, v, damping_forces, .. } = trial;
        q.clear();
        v.clear();
        for (k, b) in end.iter().enumerate() {
            let sum = acceleration[k] + b;
            q.push(start.q[k] + h * start.v[k] + h * h / 4.0 * sum);
            v.push(start.v[k] + h / 2.0 * sum);
        }
        self.set_damping_forces(v, damping_forces);
    }

    /// Computes the derivative of the residual at q, and its inverse, in a step that begins at `start`.
    fn linearise(&mut self, start: &[f64], q: &[f64], buffers: &mut NewmarkBuffers) {
        let (rule, h) = self.linearised_for;
        let (evaluation, r) = (&mut buffers.evaluation, q.len());
        self.energy.evaluate_stiffness(q, evaluation);
        let end = derivative(&self.damping, h, |i, j| evaluation.stiffness(i)[j]);
        self.inverse = inverted(if rule == Rule::Newmark || start == q {
            end
        } else {
            let middle: Vec<f64> = start.iter().zip(q).map(|(a, b)| (a + b) / 2.0).collect();
            self.energy.evaluate_stiffness(&middle, evaluation);
            let middle = derivative(&self.damping, h, |i, j| evaluation.stiffness(i)[j]);
            Mat::from_fn(r, r, |i, j| (2.0 * middle[(i, j)] + end[(i, j)]) / 3.0)
        });
        self.linearised_at.copy_from_slice(q);
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
}
