//! Radon partitions of the corners of two triangles; the triangles meet exactly when a partition exists.

use glam::DVec3;
use num_rational::BigRational;
use num_traits::One;
use sscc::MovingTriangle;

use crate::polynomial::{Polynomial, Root};

/// Homogeneous coordinates of the corners of x, then of y, each linear in t.
pub(crate) type Corners = [[Polynomial; 4]; 6];

/// Returns the corners of both triangles as polynomials in time.
pub(crate) fn corners(x: &MovingTriangle, y: &MovingTriangle) -> Corners {
    let of = |p: DVec3, q: DVec3| -> [Polynomial; 4] {
        let exact = |x: f64| BigRational::from_float(x).expect("corners are finite");
        let linear = |i: usize| Polynomial::new(vec![exact(p[i]), exact(q[i]) - exact(p[i])]);
        [linear(0), linear(1), linear(2), Polynomial::new(vec![BigRational::one()])]
    };
    std::array::from_fn(|i| if i < 3 { of(x.t0[i], x.t1[i]) } else { of(y.t0[i - 3], y.t1[i - 3]) })
}

/// Whether a Radon partition of at most `max_size` corners exists at that time.
pub(crate) fn meet_at(corners: &Corners, time: &Root, max_size: usize) -> bool {
    (2..=max_size).any(|size| {
        subsets(6, size).any(|set| {
            let both = set[0] < 3 && set[size - 1] >= 3;
            both && is_partition(corners, &set, time)
        })
    })
}

/// Whether the corners of a set have, at that time, exactly one linear dependency, positive on x, negative on y.
fn is_partition(corners: &Corners, set: &[usize], time: &Root) -> bool {
    for rows in subsets(4, set.len() - 1) {
        // By Cramer's rule this is the only dependency within these rows, unless it is 0.
        let dependency: Vec<Polynomial> = (0..set.len())
            .map(|omitted| {
                let others: Vec<usize> = set.iter().copied().filter(|&v| v != set[omitted]).collect();
                let minor = minor(corners, &others, &rows);
                if omitted % 2 == 0 { minor } else { minor.negated() }
            })
            .collect();
        let signs: Vec<i8> = dependency.iter().map(|p| time.sign(p)).collect();
        if signs.iter().all(|s| *s == 0) {
            continue;
        }
        let side = |v: usize| if v < 3 { 1 } else { -1 };
        let positive = set.iter().zip(&signs).all(|(v, s)| *s == side(*v) * signs[0] && *s != 0);
        let holds = (0..4).all(|row| {
            let sum = set
                .iter()
                .zip(&dependency)
                .fold(Polynomial::new(vec![]), |sum, (v, p)| sum.plus(&p.times(&corners[*v][row])));
            time.sign(&sum) == 0
        });
        return positive && holds;
    }
    false
}

/// Returns the determinant of the given corners and as many rows.
pub(crate) fn minor(corners: &Corners, set: &[usize], rows: &[usize]) -> Polynomial {
    if set.is_empty() {
        return Polynomial::new(vec![BigRational::one()]);
    }
    let mut sum = Polynomial::new(vec![]);
    for (i, &row) in rows.iter().enumerate() {
        let others: Vec<usize> = rows.iter().copied().filter(|&r| r != row).collect();
        let term = corners[set[0]][row].times(&minor(corners, &set[1..], &others));
        sum = sum.plus(&if i % 2 == 0 { term } else { term.negated() });
    }
    sum
}

/// Returns all subsets of `0 .. n` of this size, each ascending.
pub(crate) fn subsets(n: usize, size: usize) -> impl Iterator<Item = Vec<usize>> {
    (0..1_usize << n)
        .filter(move |bits| bits.count_ones() as usize == size)
        .map(move |bits| (0..n).filter(|i| bits >> i & 1 == 1).collect())
}
