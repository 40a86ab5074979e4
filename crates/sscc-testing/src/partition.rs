//! Radon partitions of the corners of two triangles; the triangles meet exactly when a partition exists.

use glam::DVec3;
use num_bigint::BigInt;
use sscc::MovingTriangle;

use crate::grid::Grid;
use crate::polynomial::{Polynomial, Root};

/// Homogeneous coordinates of a corner.
const ROWS: usize = 4;

/// All minors of the matrix of homogeneous coordinates of the corners of x, then of y, each a polynomial in time.
///
/// Coordinates are multiplied by a common power of two that makes them integers. This changes no sign and no root.
pub(crate) struct Minors {
    /// The determinant of each set of corners and rows, by their bits; empty if the two sets differ in size.
    table: Vec<Polynomial>,
}

impl Minors {
    /// Computes all minors by expansion along the first corner.
    ///
    /// # Panics
    /// When a corner is not finite.
    pub(crate) fn new(x: &MovingTriangle, y: &MovingTriangle) -> Self {
        let ends = [x, y].map(|triangle| [triangle.t0, triangle.t1]);
        let grid = Grid::of(ends.as_flattened().as_flattened());
        let corner = |p: DVec3, q: DVec3| -> [Polynomial; ROWS] {
            let linear = |row: usize| {
                let start = grid.whole(p[row]);
                let change = grid.whole(q[row]) - &start;
                Polynomial::new(vec![start, change])
            };
            [linear(0), linear(1), linear(2), Polynomial::new(vec![BigInt::from(1)])]
        };
        let corners: [_; 6] = std::array::from_fn(|i| corner(ends[i / 3][0][i % 3], ends[i / 3][1][i % 3]));
        let mut table = vec![Polynomial::new(vec![]); 1 << (6 + ROWS)];
        table[0] = Polynomial::new(vec![BigInt::from(1)]);
        for size in 1..=ROWS {
            for set in subsets(6, size) {
                for rows in subsets(ROWS, size) {
                    let others = set & (set - 1);
                    let mut sum = Polynomial::new(vec![]);
                    for (i, row) in members(rows).enumerate() {
                        let coordinate = &corners[set.trailing_zeros() as usize][row];
                        let term = coordinate.times(&table[place(others, rows & !(1 << row))]);
                        sum = sum.plus(&if i % 2 == 0 { term } else { term.negated() });
                    }
                    table[place(set, rows)] = sum;
                }
            }
        }
        Self { table }
    }

    /// Returns the determinant of these corners and as many rows, both as sets of bits.
    pub(crate) fn of(&self, set: usize, rows: usize) -> &Polynomial {
        &self.table[place(set, rows)]
    }

    /// Whether a Radon partition of at most `max_size` corners exists at that time.
    pub(crate) fn meet_at(&self, time: &Root, max_size: u32) -> bool {
        (2..=max_size as usize).any(|size| {
            subsets(6, size).any(|set| {
                let both = set & 0b111 != 0 && set >> 3 != 0;
                both && self.is_partition(set, time)
            })
        })
    }

    /// Whether the corners of a set have, at that time, exactly one linear dependency, positive on x, negative on y.
    fn is_partition(&self, set: usize, time: &Root) -> bool {
        for rows in subsets(ROWS, set.count_ones() as usize - 1) {
            // By Cramer's rule this is the only dependency within these rows, unless it is 0.
            let sign = |(i, v): (usize, usize)| {
                let sign = time.sign(self.of(set & !(1 << v), rows));
                if i % 2 == 0 { sign } else { -sign }
            };
            let signs: Vec<i8> = members(set).enumerate().map(sign).collect();
            if signs.iter().all(|s| *s == 0) {
                continue;
            }
            let side = |v: usize| if v < 3 { 1 } else { -1 };
            let positive = members(set).zip(&signs).all(|(v, s)| *s == side(v) * signs[0] && *s != 0);
            // The dependency holds in another row where the determinant with that row is 0.
            let mut others = members(0b1111 & !rows);
            return positive && others.all(|row| time.sign(self.of(set, rows | 1 << row)) == 0);
        }
        false
    }
}

fn place(set: usize, rows: usize) -> usize {
    set << ROWS | rows
}

/// Returns the numbers of the bits of a set, ascending.
fn members(set: usize) -> impl Iterator<Item = usize> {
    (0..6).filter(move |i| set >> i & 1 == 1)
}

/// Returns all subsets of `0 .. n` of this size, as sets of bits.
pub(crate) fn subsets(n: usize, size: usize) -> impl Iterator<Item = usize> {
    (0..1_usize << n).filter(move |bits| bits.count_ones() as usize == size)
}
