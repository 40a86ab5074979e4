//! The hull of one node: its centre, the affine map fitted to its modes, core points, and bounds of the residuals.

use glam::{DMat3, DVec3, Vec4};

use super::core_points::{self, CORE_POINTS, CorePoints};
use super::residuals::{Residuals, VECTORS, up};

/// Positions and modes in units in which they are at most about 1: positions about the centre of the shape, relative to
/// its half size; displacements relative to the largest one by the same mode.
pub(super) struct Vertices<'t> {
    pub(super) positions: &'t [DVec3],
    /// `[vertex * rank + mode]`
    pub(super) modes: &'t [DVec3],
    pub(super) rank: usize,
}

/// The part of the frame of a hull that follows one mode: for each axis a row of G and the component of A, then the
/// bounds of the residual.
pub(super) type FrameRate = [Vec4; 4];

/// The hull of a node. Its numbers count as exact; the bounds cover all deviations from them.
pub(super) struct NodeHull {
    /// The part of the frame at rest, then the part for each mode.
    pub(super) frame: Vec<FrameRate>,
    pub(super) shape: HullShape,
}

/// The core points of a hull, and its bounds.
pub(super) struct HullShape {
    /// For each axis the coordinates of the core points, relative to the largest offset.
    pub(super) core: [[f32; CORE_POINTS]; 3],
    /// `eps`, in the units of the core points.
    pub(super) distance: f32,
    /// `g_j` and `rho` of the residuals.
    pub(super) along: [f32; VECTORS],
    pub(super) remainder: f32,
}

/// Vertices nearly in a plane do not determine the gradient across it: this share of the trace, added to the diagonal, keeps that
/// part of the gradient small.
const REGULARIZATION: f64 = 1e-4;

/// Rounding of a residual, relative to the terms of the map: four products and their sums (7 eps), a difference, and the scaled
/// mode (2 eps). That of positions and offsets is not part of it: the residual is that of the offsets as computed, and where
/// these place a vertex is within the rounding bound of the shape.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl NodeHull {
    /// Fits a hull to these vertices, at least one. `residuals` is scratch.
    pub(super) fn fit(vertices: &Vertices<'_>, indices: &[u32], residuals: &mut Vec<DVec3>) -> Self {
        let (rank, count) = (vertices.rank, indices.len() as f64);
        let position = |i: &u32| vertices.positions[*i as usize];
        let center = (indices.iter().map(position).sum::<DVec3>() / count).as_vec3().as_dvec3();
        let most = indices.iter().map(|i| (position(i) - center).length()).fold(0.0, f64::max);
        // The number need not be a power of two: the frame contains it exactly, as the identity's part.
        let size = f64::from(((most * (1.0 + 1e-6)) as f32).next_up().max(f32::MIN_POSITIVE));
        let offsets: Vec<DVec3> = indices.iter().map(|i| (position(i) - center) / size).collect();
        let mean = offsets.iter().sum::<DVec3>() / count;
        let mut moment = DMat3::ZERO;
        for d in offsets.iter().map(|d| *d - mean) {
            moment += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        }
        let trace = moment.x_axis.x + moment.y_axis.y + moment.z_axis.z;
        let inverse = (moment + DMat3::from_diagonal(DVec3::splat(REGULARIZATION * trace))).inverse();
        // For each mode the mean, and the columns of the gradient.
        let mut fits = vec![[DVec3::ZERO; 4]; rank];
        for (i, d) in indices.iter().zip(&offsets) {
            let weight = inverse * (*d - mean);
            let weight = if weight.is_finite() { weight } else { DVec3::ZERO };
            let modes = &vertices.modes[*i as usize * rank..][..rank];
            for ([a, x, y, z], u) in fits.iter_mut().zip(modes) {
                *a += *u;
                *x += *u * weight.x;
                *y += *u * weight.y;
                *z += *u * weight.z;
            }
        }
        let of_axis = |x: DVec3, y: DVec3, z: DVec3, a: DVec3, i: usize| {
            Vec4::new(x[i] as f32, y[i] as f32, z[i] as f32, a[i] as f32)
        };
        let rest = [DVec3::X * size, DVec3::Y * size, DVec3::Z * size];
        let mut frame = Vec::with_capacity(rank + 1);
        let rest = |i: usize| of_axis(rest[0], rest[1], rest[2], center, i);
        frame.push([rest(0), rest(1), rest(2), Vec4::ZERO]);
        for [a, x, y, z] in &fits {
            let a = *a / count - (*x * mean.x + *y * mean.y + *z * mean.z);
            let row = |i: usize| of_axis(*x, *y, *z, a, i);
            frame.push([row(0), row(1), row(2), Vec4::ZERO]);
        }
        residuals.clear();
        let mut error = vec![0.0_f64; rank];
        for (i, d) in indices.iter().zip(&offsets) {
            let d = d.extend(1.0);
            let modes = &vertices.modes[*i as usize * rank..][..rank];
            for ((u, rows), error) in modes.iter().zip(&frame[1..]).zip(&mut error) {
                let rows: [_; 3] = std::array::from_fn(|axis| rows[axis].as_dvec4());
                let map = DVec3::from_array(rows.map(|row| row.dot(d)));
                let terms = rows.iter().map(|row| row.abs().element_sum()).fold(1.0, f64::max);
                *error = error.max(ROUNDING * terms);
                residuals.push(*u - map);
            }
        }
        // Where the map is zero, the residual is the scaled mode itself. Its rounding is covered by `up` (e_k) and by the
        // rounding of remainders.
        for (error, rows) in error.iter_mut().zip(&frame[1..]) {
            let is_still = rows[..3].iter().all(|row| *row == Vec4::ZERO);
            if is_still {
                *error = 0.0;
            }
        }
        let Residuals { rates, along, remainder } = if rank > 0 {
            Residuals::new(residuals, &error)
        } else {
            Residuals { rates: Vec::new(), along: [0.0; VECTORS], remainder: 0.0 }
        };
        frame[1..].iter_mut().zip(rates).for_each(|(rate, r)| rate[3] = Vec4::from_array(r));
        let CorePoints { points, distance } = core_points::choose(&offsets);
        let core = std::array::from_fn(|axis| points.map(|point| point[axis]));
        let distance = with_mutant!(up(distance), HullCoreExact, 0.0);
        Self { frame, shape: HullShape { core, distance, along, remainder } }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec4, Vec3};

    use super::*;
    use crate::test_models::Random;

    /// Affine modes leave no residual but that of the regularization, also in a node that is so small that the rounding of its
    /// centre to single precision is a large part of it.
    #[test]
    fn affine_modes_leave_small_residuals() {
        let corner = |i: usize| DVec3::from_array([1, 2, 4].map(|bit| if i & bit == 0 { -1.0 } else { 1.0 }));
        let along = DVec3::new(0.6, -0.5, 0.4);
        for size in [0.1, 1e-7] {
            let positions: Vec<DVec3> =
                (0..8).map(|i| DVec3::new(0.7, -0.6, 0.8) + corner(i) * size).collect();
            // Each mode moves the corners by one of their coordinates.
            let modes: Vec<DVec3> = (0..8).flat_map(|i| corner(i).to_array().map(|x| along * x)).collect();
            let vertices = Vertices { positions: &positions, modes: &modes, rank: 3 };
            let hull = NodeHull::fit(&vertices, &[0, 1, 2, 3, 4, 5, 6, 7], &mut Vec::new());
            for rate in &hull.frame[1..] {
                assert!(rate[3].x < 1e-3, "{size}: {rate:?}");
            }
        }
    }

    /// Each map is the least-squares fit with a small weight on the gradient: the sum of all residuals is 0, and that of
    /// their products with the offsets is the gradient times the weight. The size is that of the farthest vertex, and the
    /// bound of each mode is that of the residuals of the map as it is stored. Half of the nodes are so small that the
    /// rounding of their centre to single precision is a large part of them.
    #[test]
    fn maps_solve_the_normal_equations() {
        let random = &mut Random(51);
        for case in 0..12 {
            let (rank, node) = ([1, 2, 5][case % 3], [1.0, 1e-7][case / 3 % 2]);
            let corners: Vec<DVec3> = (0..30).map(|_| random.vector()).collect();
            let positions: Vec<DVec3> =
                corners.iter().map(|x| DVec3::new(0.7, -0.6, 0.8) + *x * node).collect();
            let ways: Vec<[DVec3; 3]> = (0..rank).map(|_| std::array::from_fn(|_| random.vector())).collect();
            let mut modes = Vec::new();
            for x in &corners {
                let noisy = |[a, b, c]: &[DVec3; 3]| (*a * x.dot(*b) + *c) * 0.3 + random.vector() * 0.1;
                modes.extend(ways.iter().map(noisy));
            }
            let vertices = Vertices { positions: &positions, modes: &modes, rank };
            let indices: Vec<u32> = (0..30).collect();
            let NodeHull { frame, shape } = NodeHull::fit(&vertices, &indices, &mut Vec::new());
            assert_eq!(frame.len(), rank + 1);

            let size = f64::from(frame[0][0].x);
            let center = DVec3::from_array([0, 1, 2].map(|axis| f64::from(frame[0][axis].w)));
            for axis in 0..3 {
                assert_eq!(frame[0][axis].truncate(), Vec3::AXES[axis] * frame[0][0].x);
            }
            let middle = positions.iter().sum::<DVec3>() / 30.0;
            assert!(center.abs_diff_eq(middle, 1e-7), "case {case}: {center} {middle}");
            let most = positions.iter().map(|x| (*x - center).length()).fold(0.0, f64::max);
            assert!((1.0..1.0 + 2e-6).contains(&(size / most)), "case {case}: {size} {most}");

            let offsets: Vec<DVec3> = positions.iter().map(|x| (*x - center) / size).collect();
            let mean = offsets.iter().sum::<DVec3>() / 30.0;
            let trace = offsets.iter().map(|d| (*d - mean).length_squared()).sum::<f64>();
            for (k, rate) in frame[1..].iter().enumerate() {
                let rows: [DVec4; 3] = std::array::from_fn(|axis| rate[axis].as_dvec4());
                let (mut sum, mut products, mut most) = (DVec3::ZERO, [DVec3::ZERO; 3], 0.0_f64);
                for (v, d) in offsets.iter().enumerate() {
                    let map = DVec3::from_array(rows.map(|row| row.dot(d.extend(1.0))));
                    let residual = modes[v * rank + k] - map;
                    sum += residual;
                    (0..3).for_each(|axis| products[axis] += *d * residual[axis]);
                    most = most.max(residual.length());
                }
                assert!(sum.length() < 1e-5, "case {case}, mode {k}: {sum}");
                for axis in 0..3 {
                    let error = products[axis] - rows[axis].truncate() * (REGULARIZATION * trace);
                    assert!(error.length() < 1e-5, "case {case}, mode {k}, axis {axis}: {error}");
                }
                let bound = f64::from(rate[3].x) / most;
                assert!((1.0..1.0 + 1e-6).contains(&bound), "case {case}, mode {k}: {bound}");
            }
            for i in 0..CORE_POINTS {
                let point = DVec3::from_array(shape.core.map(|axis| f64::from(axis[i])));
                assert!(point.length() <= 1.0, "case {case}: {point}");
                assert!(offsets.iter().any(|d| d.distance(point) < 1e-7), "case {case}: {point}");
            }
        }
    }

    /// A mode that moves all vertices alike leaves the rounding of its map, and one that moves none leaves nothing.
    #[test]
    fn constant_modes_leave_the_rounding_of_their_map() {
        let corner = |i: usize| DVec3::from_array([1, 2, 4].map(|bit| if i & bit == 0 { -0.5 } else { 0.5 }));
        let positions: Vec<DVec3> = (0..8).map(corner).collect();
        let modes = [DVec3::new(5.0, 4.0, 3.0), DVec3::ZERO].repeat(8);
        let vertices = Vertices { positions: &positions, modes: &modes, rank: 2 };
        let hull = NodeHull::fit(&vertices, &[0, 1, 2, 3, 4, 5, 6, 7], &mut Vec::new());
        let share = f64::from(hull.frame[1][3].x) / (5.0 * ROUNDING);
        assert!((1.0..1.3).contains(&share), "{share}");
        assert_eq!(hull.frame[2], [Vec4::ZERO; 4]);
    }

    #[test]
    fn hulls_without_modes_have_no_residual() {
        let vertices = Vertices { positions: &[DVec3::X, DVec3::Y, DVec3::Z], modes: &[], rank: 0 };
        let NodeHull { frame, shape } = NodeHull::fit(&vertices, &[0, 1, 2], &mut Vec::new());
        assert_eq!((frame.len(), shape.along, shape.remainder), (1, [0.0; VECTORS], 0.0));
    }
}
