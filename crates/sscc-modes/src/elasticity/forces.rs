//! Reduced internal forces: cubic polynomials of q.

use std::ops::Range;

/// The reduced internal forces of a body under modes U, `U' f(U q)`, for the St. Venant-Kirchhoff material: a
/// polynomial of degree 3 in q without a constant term (Barbic and James 2005), the gradient of an energy.
///
/// Coefficients are those of force 0, then of force 1, and so on; within one force the monomials are in lexicographic
/// order: `q_0 q_0, q_0 q_1, .., q_1 q_1, ..`. That is the layout of VegaFEM's `.cub`.
#[derive(Clone, Debug, PartialEq)]
pub struct ReducedForces {
    /// Length of q, and the number of forces.
    pub rank: usize,
    /// r x r, row after row: the stiffness at rest.
    pub linear: Vec<f64>,
    /// r rows of r (r + 1) / 2: of `q_i q_j`, i <= j.
    pub quadratic: Vec<f64>,
    /// r rows of r (r + 1) (r + 2) / 6: of `q_i q_j q_k`, i <= j <= k.
    pub cubic: Vec<f64>,
}

/// The number of monomials of a degree in r variables.
pub(crate) fn monomials(rank: usize, degree: usize) -> usize {
    (0..degree).fold(1, |product, k| product * (rank + k) / (k + 1))
}

/// The place of the monomial with these indices, ascending, in lexicographic order.
pub(crate) fn place(rank: usize, indices: &[usize]) -> usize {
    let mut place = 0;
    let mut least = 0;
    for (at, index) in indices.iter().enumerate() {
        let left = indices.len() - at - 1;
        // Monomials with a smaller index here: what follows starts at that index.
        place += (least..*index).map(|k| monomials(rank - k, left)).sum::<usize>();
        least = *index;
    }
    place
}

impl ReducedForces {
    /// The forces at q (r numbers): what it takes to hold the body there.
    ///
    /// # Panics
    /// When q has another length than r.
    pub fn at(&self, q: &[f64]) -> Vec<f64> {
        let r = self.rank;
        assert_eq!(q.len(), r, "q of another rank");
        let (squares, cubes) = (products(q, 2), products(q, 3));
        let row = |coefficients: &[f64], i: usize, values: &[f64]| {
            dot(&coefficients[i * values.len()..][..values.len()], values)
        };
        (0..r)
            .map(|i| {
                row(&self.linear, i, q) + row(&self.quadratic, i, &squares) + row(&self.cubic, i, &cubes)
            })
            .collect()
    }

    /// The stiffness at q, the derivative of the forces (r x r, row after row).
    ///
    /// # Panics
    /// When q has another length than r.
    pub fn stiffness(&self, q: &[f64]) -> Vec<f64> {
        let r = self.rank;
        assert_eq!(q.len(), r, "q of another rank");
        let mut stiffness = self.linear.clone();
        let squares = products(q, 2);
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
            let count = monomials(r, 3);
            let cubic = &self.cubic[i * count..][..count];
            let mut at = 0;
            for a in 0..r {
                for b in a..r {
                    let q_ab = q[a] * q[b];
                    let coefficients = &cubic[at..][..r - b];
                    at += r - b;
                    // Common to the derivatives by a and by b.
                    let ab = dot(coefficients, &q[b..]);
                    row[b..].iter_mut().zip(coefficients).for_each(|(sum, c)| *sum += c * q_ab);
                    row[a] += ab * q[b];
                    row[b] += ab * q[a];
                }
            }
        }
        stiffness
    }

    /// The elastic energy at q: `q . (f1 / 2 + f2 / 3 + f3 / 4)` for the forces of each degree.
    ///
    /// # Panics
    /// When q has another length than r.
    pub fn energy(&self, q: &[f64]) -> f64 {
        let (squares, cubes) = (products(q, 2), products(q, 3));
        let part = |coefficients: &[f64], values: &[f64]| -> f64 {
            q.iter().zip(coefficients.chunks_exact(values.len())).map(|(q, row)| q * dot(row, values)).sum()
        };
        part(&self.linear, q) / 2.0 + part(&self.quadratic, &squares) / 3.0 + part(&self.cubic, &cubes) / 4.0
    }

    /// How far the polynomial is from being the gradient of an energy: the largest difference of `d f_i / d q_j` and
    /// `d f_j / d q_i`, coefficient by coefficient, as a share of the largest coefficient of that degree. 0 for exact
    /// forces; about 1 where coefficients are in another order.
    pub fn asymmetry(&self) -> f64 {
        let parts = [(1, &self.linear), (2, &self.quadratic), (3, &self.cubic)];
        parts.into_iter().map(|(degree, part)| self.asymmetry_of(degree, part)).fold(0.0, f64::max)
    }

    fn asymmetry_of(&self, degree: usize, part: &[f64]) -> f64 {
        let r = self.rank;
        let count = monomials(r, degree);
        let largest = part.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut worst = 0.0_f64;
        // The coefficient of monomial m in d f_i / d q_j is (m_j + 1) times that of m q_j in f_i.
        let coefficient = |i: usize, j: usize, m: &[usize]| {
            let mut with = m.to_vec();
            with.push(j);
            with.sort_unstable();
            let times = with.iter().filter(|k| **k == j).count();
            times as f64 * part[i * count + place(r, &with)]
        };
        for m in all_monomials(r, degree - 1) {
            for i in 0..r {
                for j in 0..i {
                    worst = worst.max((coefficient(i, j, &m) - coefficient(j, i, &m)).abs());
                }
            }
        }
        if worst == 0.0 { 0.0 } else { worst / largest }
    }
}

/// All monomials of a degree, as ascending indices, in lexicographic order.
pub(crate) fn all_monomials(rank: usize, degree: usize) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new()];
    for _ in 0..degree {
        let longer = |m: &Vec<usize>| {
            let from: Range<usize> = m.last().copied().unwrap_or(0)..rank;
            let m = m.clone();
            from.map(move |k| [&m[..], &[k]].concat())
        };
        all = all.iter().flat_map(longer).collect();
    }
    all
}

/// The values of all monomials of degree 2 or 3.
fn products(q: &[f64], degree: usize) -> Vec<f64> {
    let r = q.len();
    let mut values = Vec::with_capacity(monomials(r, degree));
    for a in 0..r {
        for b in a..r {
            let ab = q[a] * q[b];
            match degree {
                2 => values.push(ab),
                _ => values.extend(q[b..].iter().map(|c| ab * c)),
            }
        }
    }
    values
}

/// The sum of products: in so many sums, which the processor adds side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a, b) = (a.chunks_exact(sums.len()), b.chunks_exact(sums.len()));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        sums.iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += a * b);
    }
    rest + sums.iter().sum::<f64>()
}
