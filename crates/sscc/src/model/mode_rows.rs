//! Sums over the modes, for the bounds of section 5.
//!
//! A row has one number for each mode, padded with zeros to a multiple of four. Sums run over four lanes in a fixed order,
//! so that they have the same bits on every machine and in any instruction set (`vectors.rs`). The modes of a vertex are
//! three rows: x, y, z.

use glam::{DMat3, DVec3};

/// Lengths of rows are multiples of this number.
pub(crate) const LANES: usize = 4;

/// Returns the length of a row: `rank` rounded up to a multiple of [`LANES`].
pub(crate) fn padded_rank(rank: usize) -> usize {
    rank.div_ceil(LANES) * LANES
}

#[inline(always)]
fn sum(lanes: [f64; LANES]) -> f64 {
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

/// Returns `a . b`.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    for (a, b) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
        for i in 0..LANES {
            lanes[i] += a[i] * b[i];
        }
    }
    sum(lanes)
}

/// Returns `|a - b|^2`.
#[inline(always)]
pub(crate) fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    for (a, b) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
        for i in 0..LANES {
            let d = a[i] - b[i];
            lanes[i] += d * d;
        }
    }
    sum(lanes)
}

/// Computes `out = A' dir` for the modes `A` of a point (three rows: x, y, z).
#[inline(always)]
pub(crate) fn project(modes: &[f64], dir: DVec3, out: &mut [f64]) {
    let row_len = out.len();
    let (x, rest) = modes.split_at(row_len);
    let (y, z) = rest.split_at(row_len);
    for (((out, x), y), z) in out.iter_mut().zip(x).zip(y).zip(z) {
        *out = dir.x * x + dir.y * y + dir.z * z;
    }
}

/// Computes `out += weight * a`.
#[inline(always)]
pub(crate) fn add_scaled(out: &mut [f64], weight: f64, a: &[f64]) {
    out.iter_mut().zip(a).for_each(|(o, a)| *o += weight * a);
}

/// Returns the 3 x 3 Gram matrix `B B'` of three rows.
#[inline(always)]
pub(crate) fn gram(rows: &[f64]) -> DMat3 {
    let row_len = rows.len() / 3;
    let (x, rest) = rows.split_at(row_len);
    let (y, z) = rest.split_at(row_len);
    let mut lanes = [[0.0; LANES]; 6];
    let chunks = x.as_chunks::<LANES>().0.iter().zip(y.as_chunks::<LANES>().0).zip(z.as_chunks::<LANES>().0);
    for ((x, y), z) in chunks {
        for i in 0..LANES {
            lanes[0][i] += x[i] * x[i];
            lanes[1][i] += x[i] * y[i];
            lanes[2][i] += x[i] * z[i];
            lanes[3][i] += y[i] * y[i];
            lanes[4][i] += y[i] * z[i];
            lanes[5][i] += z[i] * z[i];
        }
    }
    let [xx, xy, xz, yy, yz, zz] = lanes.map(sum);
    DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
}
