//! Elastic energy of reduced nonlinear forces as one packed polynomial, with its gradient and its Hessian.
//!
//! With `p = (1, q)` the energy is a form of degree 4 in p, with one coefficient for each product `p_i p_j p_k p_l` and
//! i <= j <= k <= l. These are a quarter of the coefficients of the forces. With the vector z of all `p_k p_l`, k <= l,
//! in lexicographic order, the energy is `z' P z`. Row (i, j) of P has entries only in the columns (k, l) with k >= j,
//! a suffix of z. One pass over P computes `y = (P + P') z`, and the gradient is `J' y`, where J is the derivative of z.

use pulp::{Simd, WithSimd};
use sscc_solid::{ReducedForces, monomials};

use crate::DynamicsError;
use crate::packed_rows::{ROW_LANES, add_row_twice, add_rows, dispatch};

/// Maximum asymmetry of the forces: the difference between two values for a coefficient of the energy, relative to the
/// largest coefficient of its degree. Rounding to single precision causes less.
const MAX_ASYMMETRY: f64 = 1e-6;

/// Polynomial of the elastic energy of [`ReducedForces`]. It evaluates forces several times as fast as their own
/// coefficients do, and to the same values up to rounding.
#[derive(Clone, Debug)]
pub struct ElasticEnergy {
    rank: usize,
    /// The rows of P in the order of j, then of i <= j, each padded with zeros to a multiple of [`ROW_LANES`].
    coefficients: Vec<f64>,
    /// The rows of each j.
    blocks: Vec<Block>,
}

/// The rows (0, j) to (j, j) of P for one j.
#[derive(Clone, Copy, Debug)]
struct Block {
    /// Index of the first coefficient.
    start: usize,
    /// Number of coefficients of a row, with padding.
    stride: usize,
    /// Index in z of the first column, (j, j).
    column: usize,
}

/// Result of an evaluation, and its buffers.
#[derive(Clone, Debug, Default)]
pub struct Evaluation {
    /// The gradient with respect to p.
    gradient: Vec<f64>,
    /// The Hessian with respect to p, row after row.
    hessian: Vec<f64>,
    p: Vec<f64>,
    /// The products `p_k p_l`, padded.
    z: Vec<f64>,
    /// `(P + P') z`, padded.
    y: Vec<f64>,
    /// `J_i' P` for one i.
    row: Vec<f64>,
    /// For each j the sum over i <= j of `p_i` times row (i, j), with the strides of the blocks.
    columns: Vec<f64>,
}

impl Evaluation {
    /// Returns the forces: the gradient with respect to q (r numbers).
    pub fn forces(&self) -> &[f64] {
        &self.gradient[1..]
    }

    /// Returns the energy.
    pub fn energy(&self) -> f64 {
        // Euler's theorem for a form of degree 4.
        self.p.iter().zip(&self.gradient).map(|(p, g)| p * g).sum::<f64>() / 4.0
    }

    /// Returns row i of the stiffness, the Hessian with respect to q (r numbers).
    pub fn stiffness(&self, i: usize) -> &[f64] {
        let n = self.gradient.len();
        &self.hessian[(i + 1) * n + 1..][..n - 1]
    }

    /// Computes p and z, and sets y to 0.
    #[inline(always)]
    fn begin(&mut self, q: &[f64]) {
        self.p.clear();
        self.p.push(1.0);
        self.p.extend_from_slice(q);
        self.z.clear();
        for k in 0..self.p.len() {
            let factor = self.p[k];
            self.z.extend(self.p[k..].iter().map(|x| factor * x));
        }
        self.z.extend([0.0; ROW_LANES]);
        self.y.clear();
        self.y.resize(self.z.len(), 0.0);
    }

    /// Computes the gradient `J' y`.
    #[inline(always)]
    fn finish_gradient(&mut self) {
        self.gradient.clear();
        self.gradient.resize(self.p.len(), 0.0);
        add_transposed_derivative(&self.p, &self.y, &mut self.gradient);
    }
}

impl ElasticEnergy {
    /// Creates the energy of these forces.
    ///
    /// # Errors
    /// When the forces are not the gradient of an energy: see [`ReducedForces::asymmetry`].
    pub fn new(forces: &ReducedForces) -> Result<Self, DynamicsError> {
        let rank = forces.rank();
        let n = rank + 1;
        let (mut blocks, mut start) = (Vec::new(), 0);
        for j in 0..n {
            let stride = monomials::count(n - j, 2).next_multiple_of(ROW_LANES);
            blocks.push(Block { start, stride, column: pair(n, j, j) });
            start += (j + 1) * stride;
        }
        let mut energy = Self { rank, coefficients: vec![0.0; start], blocks };
        let parts = [(1, forces.linear().entries()), (2, forces.quadratic()), (3, forces.cubic())];
        for (degree, part) in parts {
            energy.add(degree, part)?;
        }
        Ok(energy)
    }

    /// Adds the energy of the forces of one degree.
    fn add(&mut self, degree: usize, part: &[f64]) -> Result<(), DynamicsError> {
        let (r, largest) = (self.rank, part.iter().fold(0.0_f64, |m, x| m.max(x.abs())));
        let monomials = monomials::all(r, degree);
        // The coefficient of m in the energy is that of m / q_i in f_i, divided by the power of q_i in m. It is the same for
        // each q_i in m, so the mean over all factors of m is used.
        let products = |i: usize, row: &'_ [f64]| -> Vec<(usize, f64, f64)> {
            let of = |(m, c): (&Vec<usize>, &f64)| {
                let mut factors = [0; 4];
                let first = factors.len() - degree - 1;
                factors[first] = i + 1;
                factors[first + 1..].iter_mut().zip(m).for_each(|(factor, k)| *factor = k + 1);
                factors.sort_unstable();
                let power = factors.iter().filter(|k| **k == i + 1).count();
                (self.index(factors), *c, power as f64)
            };
            monomials.iter().zip(row).map(of).collect()
        };
        let rows: Vec<_> =
            part.chunks_exact(monomials.len()).enumerate().map(|(i, row)| products(i, row)).collect();
        for (at, c, _) in rows.iter().flatten() {
            self.coefficients[*at] += c / (degree + 1) as f64;
        }
        let differences =
            rows.iter().flatten().map(|(at, c, power)| (self.coefficients[*at] - c / power).abs());
        let asymmetry = differences.fold(0.0, f64::max);
        if asymmetry <= MAX_ASYMMETRY * largest {
            Ok(())
        } else {
            Err(DynamicsError::Asymmetric { degree, asymmetry: asymmetry / largest })
        }
    }

    /// Returns the index of the coefficient of `p_i p_j p_k p_l`, for i <= j <= k <= l.
    fn index(&self, [i, j, k, l]: [usize; 4]) -> usize {
        let Block { start, stride, column } = self.blocks[j];
        start + i * stride + pair(self.rank + 1, k, l) - column
    }

    /// Returns the number of modes r.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Returns the energy at q (r numbers). Costs O(r^4).
    pub fn at(&self, q: &[f64], evaluation: &mut Evaluation) -> f64 {
        self.evaluate_forces(q, evaluation);
        evaluation.energy()
    }

    /// Computes the forces at q (r numbers): see [`Evaluation::forces`]. Costs O(r^4).
    ///
    /// # Panics
    /// When q has another length than r.
    pub fn evaluate_forces(&self, q: &[f64], evaluation: &mut Evaluation) {
        assert_eq!(q.len(), self.rank, "q of another rank");
        dispatch(Evaluate { energy: self, q, evaluation, with_stiffness: false });
    }

    /// Computes the forces and the stiffness at q (r numbers): see [`Evaluation::forces`] and
    /// [`Evaluation::stiffness`]. Costs O(r^4), about twice as much as the forces alone.
    ///
    /// The Hessian is `B + B'` with `B = J' P J`, plus the second derivatives of z weighted by y. Row i of `J' P` is the
    /// sum over j >= i of `p_j` times row (i, j) of P, plus the sum over j <= i of `p_j` times row (j, i).
    ///
    /// # Panics
    /// When q has another length than r.
    pub fn evaluate_stiffness(&self, q: &[f64], evaluation: &mut Evaluation) {
        assert_eq!(q.len(), self.rank, "q of another rank");
        dispatch(Evaluate { energy: self, q, evaluation, with_stiffness: true });
    }

    /// See [`Self::evaluate_forces`].
    #[inline(always)]
    fn add_forces<S: Simd>(&self, simd: S, q: &[f64], evaluation: &mut Evaluation) {
        evaluation.begin(q);
        let (n, Evaluation { p, z, y, .. }) = (self.rank + 1, &mut *evaluation);
        for (j, block) in self.blocks.iter().enumerate() {
            let Block { start, stride, column } = *block;
            let (z, row) =
                (&z[column..][..stride], |i: usize| &self.coefficients[start + i * stride..][..stride]);
            let mut i = 0;
            while i + 4 <= j + 1 {
                let all = [i, i + 1, i + 2, i + 3];
                let weights = all.map(|i| p[i] * p[j]);
                let sums = add_rows(simd, all.map(row), weights, z, &mut y[column..][..stride]);
                all.iter().zip(sums).for_each(|(i, sum)| y[pair(n, *i, j)] += sum);
                i += 4;
            }
            for i in i..=j {
                let [sum] = add_rows(simd, [row(i)], [p[i] * p[j]], z, &mut y[column..][..stride]);
                y[pair(n, i, j)] += sum;
            }
        }
        evaluation.finish_gradient();
    }

    /// See [`Self::evaluate_stiffness`].
    #[inline(always)]
    fn add_stiffness<S: Simd>(&self, simd: S, q: &[f64], evaluation: &mut Evaluation) {
        evaluation.begin(q);
        let n = self.rank + 1;
        let Evaluation { p, z, y, row, columns, hessian, .. } = &mut *evaluation;
        let first_column = |j: usize| self.blocks[..j].iter().map(|block| block.stride).sum::<usize>();
        columns.clear();
        columns.resize(first_column(n), 0.0);
        hessian.clear();
        hessian.resize(n * n, 0.0);
        for i in 0..n {
            row.clear();
            row.resize(z.len(), 0.0);
            let mut at = first_column(i);
            for (j, block) in self.blocks.iter().enumerate().skip(i) {
                let Block { start, stride, column } = *block;
                let coefficients = &self.coefficients[start + i * stride..][..stride];
                let (sum, next) = (&mut columns[at..][..stride], &mut row[column..][..stride]);
                let product =
                    add_row_twice(simd, coefficients, &z[column..][..stride], [p[i], p[j]], [sum, next]);
                y[pair(n, i, j)] += product;
                at += stride;
            }
            // The rows (j, i) with j <= i are complete.
            let Block { stride, column, .. } = self.blocks[i];
            let own = &columns[first_column(i)..][..stride];
            for ((sum, row), y) in own.iter().zip(&mut row[column..]).zip(&mut y[column..]) {
                *row += sum;
                *y += p[i] * sum;
            }
            add_transposed_derivative(p, row, &mut hessian[i * n..][..n]);
        }
        for k in 0..n {
            for l in k..n {
                let second = y[pair(n, k, l)];
                let sum =
                    hessian[k * n + l] + hessian[l * n + k] + if k == l { 2.0 * second } else { second };
                hessian[k * n + l] = sum;
                hessian[l * n + k] = sum;
            }
        }
        evaluation.finish_gradient();
    }
}

/// Evaluation of the forces, and of the stiffness if wanted, compiled for several instruction sets.
struct Evaluate<'e> {
    energy: &'e ElasticEnergy,
    q: &'e [f64],
    evaluation: &'e mut Evaluation,
    with_stiffness: bool,
}

impl WithSimd for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if self.with_stiffness {
            self.energy.add_stiffness(simd, self.q, self.evaluation);
        } else {
            self.energy.add_forces(simd, self.q, self.evaluation);
        }
    }
}

/// Returns the index of `p_k p_l` in z, for k <= l < n.
#[inline(always)]
fn pair(n: usize, k: usize, l: usize) -> usize {
    k * n - k * k.saturating_sub(1) / 2 + l - k
}

/// Adds `J' y` to `sum`, where J is the derivative of z.
#[inline(always)]
fn add_transposed_derivative(p: &[f64], y: &[f64], sum: &mut [f64]) {
    let mut rest = y;
    for k in 0..p.len() {
        let (row, others) = rest.split_at(p.len() - k);
        rest = others;
        for (y, sum) in row.iter().zip(&mut sum[k..]) {
            *sum += y * p[k];
        }
        sum[k] += product(row, &p[k..]);
    }
}

/// Returns the product of two vectors, from four partial sums.
#[inline(always)]
fn product(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..4 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use sscc_solid::Stiffness;

    /// Returns the next of a fixed sequence of pseudo-random numbers in [-1, 1).
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 33) as f64 / 2.0_f64.powi(30) - 1.0
    }

    /// Forces of an energy with random coefficients.
    fn forces(r: usize, state: &mut u64) -> ReducedForces {
        let mut part = |degree: usize| -> Vec<f64> {
            let energy: Vec<f64> = (0..monomials::count(r, degree + 1)).map(|_| random(state)).collect();
            let mut part = Vec::new();
            for i in 0..r {
                for mut m in monomials::all(r, degree) {
                    m.push(i);
                    m.sort_unstable();
                    let power = m.iter().filter(|k| **k == i).count();
                    part.push(power as f64 * energy[monomials::place(r, &m)]);
                }
            }
            part
        };
        let (linear, quadratic, cubic) = (part(1), part(2), part(3));
        ReducedForces::new(Stiffness::new(r, linear).unwrap(), quadratic, cubic).unwrap()
    }

    #[test]
    fn values_are_those_of_the_forces() {
        let state = &mut 5;
        for r in [1, 2, 3, 4, 5, 8, 13] {
            let forces = forces(r, state);
            let energy = ElasticEnergy::new(&forces).unwrap();
            let mut evaluation = Evaluation::default();
            for size in [0.0, 1e-3, 1.0, 30.0] {
                let q: Vec<f64> = (0..r).map(|_| size * random(state)).collect();
                let is_near = |a: &[f64], b: &[f64]| {
                    let largest = b.iter().fold(1e-300_f64, |m, x| m.max(x.abs()));
                    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-12 * largest)
                };
                // The sum of all terms bounds the rounding error.
                let expected = (forces.energy(&q), size + size.powi(4) * r.pow(4) as f64);
                assert!(
                    (energy.at(&q, &mut evaluation) - expected.0).abs() <= 1e-14 * expected.1,
                    "{r} {size}"
                );
                energy.evaluate_forces(&q, &mut evaluation);
                assert!(is_near(evaluation.forces(), &forces.at(&q)), "{r} {size}");
                energy.evaluate_stiffness(&q, &mut evaluation);
                assert!(is_near(evaluation.forces(), &forces.at(&q)), "{r} {size}");
                let stiffness: Vec<f64> = (0..r).flat_map(|i| evaluation.stiffness(i).to_vec()).collect();
                assert!(is_near(&stiffness, &forces.stiffness(&q)), "{r} {size}");
            }
        }
    }

    #[test]
    fn forces_that_are_no_gradient_are_refused() {
        let forces = forces(3, &mut 1);
        let mut cubic = forces.cubic().to_vec();
        let with = |cubic: Vec<f64>| {
            ElasticEnergy::new(
                &ReducedForces::new(forces.linear().clone(), forces.quadratic().to_vec(), cubic).unwrap(),
            )
        };
        cubic[4] += 1e-9;
        assert!(with(cubic.clone()).is_ok());
        cubic[4] += 1e-3;
        let error = with(cubic).unwrap_err();
        assert!(matches!(error, DynamicsError::Asymmetric { degree: 3, .. }), "{error}");
        let zero =
            ReducedForces::new(Stiffness::from_diagonal(&[1.0]).unwrap(), vec![0.0], vec![0.0]).unwrap();
        assert!(ElasticEnergy::new(&zero).is_ok());
    }
}
