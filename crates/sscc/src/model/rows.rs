//! Sums over the modes, four lanes at a time (rows are padded with zeros to a multiple of four).

use glam::DVec3;

/// Modes are stored in rows of this multiple.
pub(crate) const LANES: usize = 4;

/// `rank` rounded up to whole lanes.
pub(crate) fn padded(rank: usize) -> usize {
    rank.div_ceil(LANES) * LANES
}

fn sum(lanes: [f64; LANES]) -> f64 {
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

/// `a . b`
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    for (a, b) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
        for i in 0..LANES {
            lanes[i] += a[i] * b[i];
        }
    }
    sum(lanes)
}

/// `|a - b|^2`
#[inline]
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

/// `out = A' n` for a point's modes `A` (three rows: x, y, z).
#[inline]
pub(crate) fn project(modes: &[f64], n: DVec3, out: &mut [f64]) {
    let row = out.len();
    let (x, rest) = modes.split_at(row);
    let (y, z) = rest.split_at(row);
    for (((out, x), y), z) in out.iter_mut().zip(x).zip(y).zip(z) {
        *out = n.x * x + n.y * y + n.z * z;
    }
}

/// `out += weight * a`
#[inline]
pub(crate) fn add_scaled(out: &mut [f64], weight: f64, a: &[f64]) {
    out.iter_mut().zip(a).for_each(|(o, a)| *o += weight * a);
}

/// The 3 x 3 Gram matrix `B B'` of three rows, as (xx, xy, xz, yy, yz, zz).
#[inline]
pub(crate) fn gram(rows: &[f64]) -> [f64; 6] {
    let row = rows.len() / 3;
    let (x, rest) = rows.split_at(row);
    let (y, z) = rest.split_at(row);
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
    lanes.map(sum)
}
