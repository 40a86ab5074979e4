//! Reduced internal forces: cubic polynomials of q.

use sscc::limits;

use crate::{SolidError, Stiffness, monomials};

/// Reduced internal forces `U' f(U q)` of a body under modes U, for the St. Venant-Kirchhoff material: a polynomial of
/// degree 3 in q without a constant term, the gradient of an energy (Barbic and James 2005).
///
/// Coefficients are stored force by force. Within a force, monomials are in lexicographic order ([`monomials`]): `q_0
/// q_0, q_0 q_1, .., q_1 q_1, ..`. VegaFEM's `.cub` has the same layout.
#[derive(Clone, Debug, PartialEq)]
pub struct ReducedForces {
    linear: Stiffness,
    quadratic: Vec<f64>,
    cubic: Vec<f64>,
}

impl ReducedForces {
    /// Creates forces from the stiffness at rest, r rows of r (r + 1) / 2 coefficients of `q_i q_j` with i <= j, and r
    /// rows of r (r + 1) (r + 2) / 6 coefficients of `q_i q_j q_k` with i <= j <= k.
    ///
    /// # Errors
    /// When the number of coefficients is wrong, or one is not finite or beyond 2^200. The constructor does not check
    /// that the forces are the gradient of an energy: see [`ReducedForces::asymmetry`].
    pub fn new(linear: Stiffness, quadratic: Vec<f64>, cubic: Vec<f64>) -> Result<Self, SolidError> {
        check(linear.rank(), 2, &quadratic)?;
        check(linear.rank(), 3, &cubic)?;
        Ok(Self { linear, quadratic, cubic })
    }

    /// Replaces the stiffness at rest.
    ///
    /// # Errors
    /// When it is of another rank.
    pub fn with_linear(self, linear: Stiffness) -> Result<Self, SolidError> {
        Self::new(linear, self.quadratic, self.cubic)
    }

    /// Returns the number of modes and forces r.
    pub fn rank(&self) -> usize {
        self.linear.rank()
    }

    /// Returns the stiffness at rest.
    pub fn linear(&self) -> &Stiffness {
        &self.linear
    }

    /// Returns the coefficients of `q_i q_j` (r rows of r (r + 1) / 2).
    pub fn quadratic(&self) -> &[f64] {
        &self.quadratic
    }

    /// Returns the coefficients of `q_i q_j q_k` (r rows of r (r + 1) (r + 2) / 6).
    pub fn cubic(&self) -> &[f64] {
        &self.cubic
    }

    /// Returns the internal forces at q (r numbers). Costs O(r^4).
    ///
    /// # Panics
    /// When q has another length than r.
    pub fn at(&self, q: &[f64]) -> Vec<f64> {
        let r = self.rank();
        assert_eq!(q.len(), r, "q of another rank");
        let (squares, cubes) = (monomials::values(q, 2), monomials::values(q, 3));
        let row = |coefficients: &[f64], i: usize, values: &[f64]| {
            dot(&coefficients[i * values.len()..][..values.len()], values)
        };
        let linear = self.linear.entries();
        (0..r)
            .map(|i| row(linear, i, q) + row(&self.quadratic, i, &squares) + row(&self.cubic, i, &cubes))
            .collect()
    }

    /// Returns the stiffness at q, the derivative of the forces (r x r, row after row). Costs O(r^4).
    ///
    /// # Panics
    /// When q has another length than r.
    pub fn stiffness(&self, q: &[f64]) -> Vec<f64> {
        let r = self.rank();
        assert_eq!(q.len(), r, "q of another rank");
        let mut stiffness = self.linear.entries().to_vec();
        let squares = monomials::values(q, 2);
        for i in 0..r {
            let row = &mut stiffness[i * r..][..r];
            let quadratic = &self.quadratic[i * squares.len()..][..squares.len()];
            let mut at = 0;
            for a in 0..r {
                for b in a..r {
                    let c = quadratic[at];
                    row[a] += c * q[b];
                    row[b] += c * q[a];
                    at += 1;
                }
            }
            let count = monomials::count(r, 3);
            let cubic = &self.cubic[i * count..][..count];
            let mut at = 0;
            for a in 0..r {
                for b in a..r {
                    let q_ab = q[a] * q[b];
                    let coefficients = &cubic[at..][..r - b];
                    at += r - b;
                    // The derivatives with respect to a and b share this sum.
                    let ab = dot(coefficients, &q[b..]);
                    row[b..].iter_mut().zip(coefficients).for_each(|(sum, c)| *sum += c * q_ab);
                    row[a] += ab * q[b];
                    row[b] += ab * q[a];
                }
            }
        }
        stiffness
    }

    /// Returns the elastic energy at q: `q . (f1 / 2 + f2 / 3 + f3 / 4)` for the forces of each degree.
    ///
    /// # Panics
    /// When q has another length than r.
    pub fn energy(&self, q: &[f64]) -> f64 {
        assert_eq!(q.len(), self.rank(), "q of another rank");
        let (squares, cubes) = (monomials::values(q, 2), monomials::values(q, 3));
        let part = |coefficients: &[f64], values: &[f64]| -> f64 {
            q.iter().zip(coefficients.chunks_exact(values.len())).map(|(q, row)| q * dot(row, values)).sum()
        };
        part(self.linear.entries(), q) / 2.0
            + part(&self.quadratic, &squares) / 3.0
            + part(&self.cubic, &cubes) / 4.0
    }

    /// Returns the deviation from the gradient of an energy: the maximum difference of the coefficients of `d f_i / d
    /// q_j` and `d f_j / d q_i`, relative to the largest coefficient of that degree. 0 for exact forces; about 1 for
    /// coefficients in another order.
    pub fn asymmetry(&self) -> f64 {
        let parts = [(1, self.linear.entries()), (2, &self.quadratic), (3, &self.cubic)];
        parts.into_iter().map(|(degree, part)| self.asymmetry_of(degree, part)).fold(0.0, f64::max)
    }

    fn asymmetry_of(&self, degree: usize, part: &[f64]) -> f64 {
        let r = self.rank();
        let count = monomials::count(r, degree);
        let largest = part.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut worst = 0.0_f64;
        // The coefficient of monomial m in d f_i / d q_j is (m_j + 1) times that of m q_j in f_i.
        let coefficient = |i: usize, j: usize, m: &[usize]| {
            let mut product = m.to_vec();
            product.push(j);
            product.sort_unstable();
            let power = product.iter().filter(|k| **k == j).count();
            power as f64 * part[i * count + monomials::place(r, &product)]
        };
        for m in monomials::all(r, degree - 1) {
            for i in 0..r {
                for j in 0..i {
                    worst = worst.max((coefficient(i, j, &m) - coefficient(j, i, &m)).abs());
                }
            }
        }
        if worst == 0.0 { 0.0 } else { worst / largest }
    }
}

/// Checks the number and the range of the coefficients of a degree.
fn check(rank: usize, degree: usize, coefficients: &[f64]) -> Result<(), SolidError> {
    let columns = monomials::count(rank, degree);
    let (found, expected) = (coefficients.len(), rank.saturating_mul(columns));
    if found != expected {
        return Err(SolidError::ForceLength { degree, found, rank, expected });
    }
    match coefficients.iter().position(|x| x.is_nan() || x.abs() > limits::LARGEST) {
        Some(at) => {
            let (row, column, value) = (at / columns, at % columns, coefficients[at]);
            Err(SolidError::ForceEntry { degree, row, column, value })
        }
        None => Ok(()),
    }
}

/// Returns the sum of products, as eight partial sums that the processor adds in parallel.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a, b) = (a.chunks_exact(sums.len()), b.chunks_exact(sums.len()));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        sums.iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += a * b);
    }
    rest + sums.iter().sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces of the energy `(x^2 + 4 y^2) / 2 + s (x^2 + x y)^2 / 4`.
    fn forces(s: f64) -> ReducedForces {
        let cubic = [1.0, 1.5, 0.5, 0.0, 0.5, 0.5, 0.0, 0.0].map(|c| s * c).to_vec();
        ReducedForces::new(Stiffness::from_diagonal(&[1.0, 4.0]).unwrap(), vec![0.0; 6], cubic).unwrap()
    }

    #[test]
    fn forces_and_stiffness_follow_from_the_energy() {
        let (forces, q, h) = (forces(3.0), [0.7, -0.4], 1e-5);
        let [x, y] = q;
        let expected = (x * x + 4.0 * y * y) / 2.0 + 0.75 * (x * x + x * y) * (x * x + x * y);
        assert!((forces.energy(&q) - expected).abs() < 1e-15);
        let (force, stiffness) = (forces.at(&q), forces.stiffness(&q));
        for j in 0..2 {
            let moved = |h: f64| {
                let mut q = q;
                q[j] += h;
                q
            };
            let slope = (forces.energy(&moved(h)) - forces.energy(&moved(-h))) / (2.0 * h);
            assert!((slope - force[j]).abs() < 1e-9);
            let (plus, minus) = (forces.at(&moved(h)), forces.at(&moved(-h)));
            for i in 0..2 {
                assert!(((plus[i] - minus[i]) / (2.0 * h) - stiffness[2 * i + j]).abs() < 1e-9);
            }
        }
        assert_eq!(forces.asymmetry(), 0.0);
    }

    #[test]
    fn invalid_coefficients_are_rejected() {
        let new = |quadratic: Vec<f64>, cubic: Vec<f64>| {
            ReducedForces::new(Stiffness::from_diagonal(&[1.0; 2]).unwrap(), quadratic, cubic)
        };
        let short = SolidError::ForceLength { degree: 3, found: 7, rank: 2, expected: 8 };
        assert_eq!(new(vec![0.0; 6], vec![0.0; 7]).unwrap_err(), short);
        assert!(matches!(new(vec![0.0; 5], vec![0.0; 8]), Err(SolidError::ForceLength { degree: 2, .. })));
        let mut cubic = vec![0.0; 8];
        cubic[6] = 1e61;
        let entry = SolidError::ForceEntry { degree: 3, row: 1, column: 2, value: 1e61 };
        assert_eq!(new(vec![0.0; 6], cubic).unwrap_err(), entry);
        let nan = new(vec![f64::NAN; 6], vec![0.0; 8]).unwrap_err().to_string();
        assert!(nan.starts_with("a coefficient of degree 2 is NaN at row 0, column 0"), "{nan}");
    }
}
