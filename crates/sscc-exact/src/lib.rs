//! When two moving triangles first meet, in exact arithmetic: slow, and as simple as can be. The oracle of tests and
//! benches.
//!
//! Two hulls meet exactly when some of the corners of one and some of the other, at most five together, form a Radon
//! partition: their homogeneous coordinates have exactly one linear dependency, and it is positive on the one
//! side and negative on the other. One of five corners is stable, so when they first meet (after time 0) it is one of
//! at most four, which are then in one plane: the time is a root of a determinant of those corners. Where that
//! vanishes all the time, it is a root of a smaller one. So it is enough to try time 0 and all these roots.

mod distance;
mod polynomial;

pub use distance::{distance, squared_distance};

use glam::DVec3;
use num_rational::BigRational;
use num_traits::{One, Zero};
use polynomial::Polynomial;
pub use polynomial::Root;
use sscc::MovingTriangle;

/// The corners of x, then of y: homogeneous coordinates, linear in t.
type Corners = [[Polynomial; 4]; 6];

/// The exact time at which they first have a point in common, if they do in [0, 1]. Touching counts.
///
/// # Panics
/// When a corner is not finite.
pub fn first_contact(x: &MovingTriangle, y: &MovingTriangle) -> Option<Root> {
    let corners = corners(x, y);
    let start = Root::at(BigRational::zero());
    if meet_at(&corners, &start, 5) {
        return Some(start);
    }
    let mut polynomials: Vec<Polynomial> =
        subsets(6, 4).map(|set| minor(&corners, &set, &[0, 1, 2, 3])).collect();
    if polynomials.iter().any(Polynomial::is_zero) {
        for size in 2..4 {
            for set in subsets(6, size) {
                polynomials.extend(subsets(4, size).map(|rows| minor(&corners, &set, &rows)));
            }
        }
    }
    polynomials.sort();
    polynomials.dedup();
    let roots = polynomials.iter().filter(|p| !p.is_zero()).flat_map(Polynomial::roots);
    let mut first: Option<Root> = None;
    for root in roots {
        let earlier = first.as_ref().is_none_or(|first| root.lower() < first.lower());
        if earlier && meet_at(&corners, &root, 4) {
            first = Some(root);
        }
    }
    first
}

/// The corners of both triangles as polynomials in time.
fn corners(x: &MovingTriangle, y: &MovingTriangle) -> Corners {
    let of = |p: DVec3, q: DVec3| -> [Polynomial; 4] {
        let exact = |x: f64| BigRational::from_float(x).expect("corners are finite");
        let linear = |i: usize| Polynomial::new(vec![exact(p[i]), exact(q[i]) - exact(p[i])]);
        [linear(0), linear(1), linear(2), Polynomial::new(vec![BigRational::one()])]
    };
    std::array::from_fn(|i| if i < 3 { of(x.t0[i], x.t1[i]) } else { of(y.t0[i - 3], y.t1[i - 3]) })
}

/// Whether a Radon partition of at most `most` corners exists at that time.
fn meet_at(corners: &Corners, time: &Root, most: usize) -> bool {
    (2..=most).any(|size| {
        subsets(6, size).any(|set| {
            let both = set[0] < 3 && set[size - 1] >= 3;
            both && is_partition(corners, &set, time)
        })
    })
}

/// Whether the corners of a set have, at that time, exactly one linear dependency, positive on x, negative on y.
fn is_partition(corners: &Corners, set: &[usize], time: &Root) -> bool {
    for rows in subsets(4, set.len() - 1) {
        // By Cramer's rule the only dependency within these rows, unless it is 0.
        let dependency: Vec<Polynomial> = (0..set.len())
            .map(|leave| {
                let others: Vec<usize> = set.iter().copied().filter(|&v| v != set[leave]).collect();
                let minor = minor(corners, &others, &rows);
                if leave % 2 == 0 { minor } else { minor.negated() }
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

/// The determinant of some corners and as many rows.
fn minor(corners: &Corners, set: &[usize], rows: &[usize]) -> Polynomial {
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

/// All ascending subsets of `0 .. n` of that size.
fn subsets(n: usize, size: usize) -> impl Iterator<Item = Vec<usize>> {
    (0..1_usize << n)
        .filter(move |bits| bits.count_ones() as usize == size)
        .map(move |bits| (0..n).filter(|i| bits >> i & 1 == 1).collect())
}
