//! The projection of a point onto an intersection of half-spaces: a dual active-set method (Goldfarb and Idnani 1983, *A
//! Numerically Stable Dual Method for Solving Strictly Convex Quadratic Programs*, for the identity matrix).
//!
//! The caller adds half-spaces that the current point violates, one after the other. After each addition, the point is
//! the nearest one to the target within the active half-spaces, so it only moves away from the target. At most r
//! half-spaces are active at a time; others may be violated again, and can be added again.

use std::fmt;

/// Two normals with a smaller sine between them count as parallel.
const MIN_SINE: f64 = 1e-7;

/// The error if a half-space cannot be added: up to rounding, it has no point in common with the active ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Infeasible;

impl fmt::Display for Infeasible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the half-spaces have no point in common")
    }
}

/// The point nearest to a target within the active half-spaces.
///
/// The normals of the active half-spaces are the columns of `Q R`: Q has orthonormal columns, R is upper triangular.
pub(super) struct Projection {
    point: Vec<f64>,
    /// The columns of Q.
    basis: Vec<Vec<f64>>,
    /// The columns of R, each down to its diagonal entry.
    columns: Vec<Vec<f64>>,
    /// The multipliers of the active half-spaces: none is negative.
    multipliers: Vec<f64>,
}

impl Projection {
    /// Creates a projection without half-spaces, whose point is the target.
    pub(super) fn new(target: Vec<f64>) -> Self {
        Self { point: target, basis: Vec::new(), columns: Vec::new(), multipliers: Vec::new() }
    }

    /// Returns the nearest point so far.
    pub(super) fn point(&self) -> &[f64] {
        &self.point
    }

    /// Returns the number of active half-spaces.
    #[cfg(test)]
    fn active(&self) -> usize {
        self.multipliers.len()
    }

    /// Adds the half-space `normal . x >= offset`, and moves the point into it. Does nothing if the point is in it.
    ///
    /// # Errors
    /// When no point is in it and in the active half-spaces, or a number is not finite.
    pub(super) fn add(&mut self, normal: &[f64], offset: f64) -> Result<(), Infeasible> {
        let length = length(normal);
        if length <= f64::MIN_POSITIVE {
            return if offset <= 0.0 { Ok(()) } else { Err(Infeasible) };
        }
        let normal: Vec<f64> = normal.iter().map(|x| x / length).collect();
        let mut violation = offset / length - dot(&normal, &self.point);
        let mut multiplier = 0.0;
        while violation > 0.0 {
            // The coefficients of the normal over the basis of the active normals, and the remainder.
            let (along, across) = self.split(&normal);
            let rates = self.solve(&along);
            let square = dot(&across, &across);
            let primal = if square > MIN_SINE * MIN_SINE { violation / square } else { f64::INFINITY };
            let leaves = |(at, rate): (usize, &f64)| (*rate > 0.0).then(|| (self.multipliers[at] / rate, at));
            let first = rates.iter().enumerate().filter_map(leaves).min_by(|a, b| a.0.total_cmp(&b.0));
            let step = first.map_or(primal, |(dual, _)| dual.min(primal));
            if !step.is_finite() {
                return Err(Infeasible);
            }
            if primal.is_finite() {
                self.point.iter_mut().zip(&across).for_each(|(x, d)| *x += step * d);
                violation -= step * square;
            }
            self.multipliers.iter_mut().zip(&rates).for_each(|(u, rate)| *u = (*u - step * rate).max(0.0));
            multiplier += step;
            match first {
                Some((dual, at)) if dual < primal => self.remove(at),
                _ => {
                    self.push(along, &across, square.sqrt(), multiplier);
                    break;
                }
            }
        }
        if violation.is_nan() { Err(Infeasible) } else { Ok(()) }
    }

    /// Returns the coefficients of a vector over the basis, and the remainder of the vector.
    fn split(&self, vector: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut along = vec![0.0; self.basis.len()];
        let mut across = vector.to_vec();
        // Two passes are enough for orthogonality up to rounding.
        for _ in 0..2 {
            for (coefficient, q) in along.iter_mut().zip(&self.basis) {
                let part = dot(q, &across);
                *coefficient += part;
                across.iter_mut().zip(q).for_each(|(x, q)| *x -= part * q);
            }
        }
        (along, across)
    }

    /// Returns `R^-1 x`.
    fn solve(&self, x: &[f64]) -> Vec<f64> {
        let mut solution = x.to_vec();
        for i in (0..solution.len()).rev() {
            solution[i] /= self.columns[i][i];
            let value = solution[i];
            for (x, r) in solution[..i].iter_mut().zip(&self.columns[i]) {
                *x -= value * r;
            }
        }
        solution
    }

    /// Makes a half-space active.
    fn push(&mut self, mut along: Vec<f64>, across: &[f64], length: f64, multiplier: f64) {
        along.push(length);
        self.basis.push(across.iter().map(|x| x / length).collect());
        self.columns.push(along);
        self.multipliers.push(multiplier);
    }

    /// Makes an active half-space inactive. Rotations make R triangular again.
    fn remove(&mut self, at: usize) {
        self.columns.remove(at);
        self.multipliers.remove(at);
        for i in at..self.columns.len() {
            // Column i has an entry below its diagonal, in row i + 1.
            let (a, b) = (self.columns[i][i], self.columns[i][i + 1]);
            let norm = a.hypot(b);
            let (cos, sin) = (a / norm, b / norm);
            for column in &mut self.columns[i..] {
                let (x, y) = (column[i], column[i + 1]);
                (column[i], column[i + 1]) = (cos * x + sin * y, cos * y - sin * x);
            }
            self.columns[i].truncate(i + 1);
            let (upper, lower) = self.basis.split_at_mut(i + 1);
            for (x, y) in upper[i].iter_mut().zip(&mut lower[0]) {
                (*x, *y) = (cos * *x + sin * *y, cos * *y - sin * *x);
            }
        }
        self.basis.pop();
    }
}

/// Returns `a . b`.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns `|a|`.
pub(super) fn length(a: &[f64]) -> f64 {
    let largest = a.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest > 0.0 && largest.is_finite() {
        largest * a.iter().map(|x| (x / largest) * (x / largest)).sum::<f64>().sqrt()
    } else {
        largest
    }
}

#[cfg(test)]
mod tests;
