//! A patch: a node with the nodes around it, the affine map of its modes, and the residuals of this map.

use glam::{DMat3, DVec3};

use super::patch_model::PatchModel;
use super::residual_ellipsoid::ResidualEllipsoid;
use crate::bounds::AffineFit;
use crate::hierarchy::Hierarchy;
use crate::model::mode_rows::{dot, padded_rank};
use crate::model::rounding::larger_or_nan;
use crate::vectors::{InstructionSet, Kernel, Vectors};

/// A patch is flat if its height is at most this share of its length.
const FLAT: f64 = 0.05;

/// The number of steps of the inverse iteration towards the direction across a patch.
const INVERSE_STEPS: usize = 8;

/// The vertices of a patch, the affine map of their modes, and its residuals. Owns its memory.
pub(super) struct Patch {
    instructions: InstructionSet,
    /// For each vertex of the mesh its number in the patch; `u32::MAX` for the others.
    pub(super) numbers: Vec<u32>,
    pub(super) vertices: Vec<u32>,
    pub(super) modes: Vec<u32>,
    pub(super) row_len: usize,
    pub(super) offsets: Vec<DVec3>,
    rows: Vec<f64>,
    /// The gradient: nine rows, `G_cj` at 3 c + j, of numbers in single precision.
    pub(super) gradient: Vec<f64>,
    /// The residuals: three rows for each vertex.
    pub(super) residuals: Vec<f64>,
}

impl Patch {
    pub(super) fn new(vertices: usize) -> Self {
        Self {
            instructions: InstructionSet::default(),
            numbers: vec![u32::MAX; vertices],
            vertices: Vec::new(),
            modes: Vec::new(),
            row_len: 0,
            offsets: Vec::new(),
            rows: Vec::new(),
            gradient: Vec::new(),
            residuals: Vec::new(),
        }
    }

    /// Loads the triangles of these nodes. None if more than `most` modes move them.
    pub(super) fn load(
        &mut self,
        model: &PatchModel<'_>,
        hierarchy: &Hierarchy,
        faces: &[[u32; 3]],
        nodes: impl Iterator<Item = u32>,
        most: usize,
    ) -> Option<()> {
        self.vertices.iter().for_each(|v| self.numbers[*v as usize] = u32::MAX);
        self.vertices.clear();
        for n in nodes {
            for &t in hierarchy.triangles(&hierarchy.nodes()[n as usize]) {
                for v in faces[t as usize] {
                    if self.numbers[v as usize] == u32::MAX {
                        self.numbers[v as usize] = self.vertices.len() as u32;
                        self.vertices.push(v);
                    }
                }
            }
        }
        model.moving_modes(&self.vertices, most, &mut self.modes)?;
        // Rows consist of whole vectors of single precision; of one vector if no mode moves the patch.
        self.row_len = padded_rank(self.modes.len().max(1)).next_multiple_of(crate::vectors::LANES);
        let width = 3 * self.row_len;
        self.rows.clear();
        self.rows.resize(width * self.vertices.len(), 0.0);
        for (v, rows) in self.vertices.iter().zip(self.rows.chunks_exact_mut(width.max(1))) {
            model.write_modes(*v, &self.modes, rows);
        }
        let first = model.positions[self.vertices[0] as usize];
        self.offsets.clear();
        self.offsets.extend(self.vertices.iter().map(|v| model.positions[*v as usize] - first));
        self.fit();
        Some(())
    }

    /// Fits the affine map, and computes the residuals of its gradient in single precision.
    fn fit(&mut self) {
        let (row_len, width) = (self.row_len, 3 * self.row_len);
        self.gradient.clear();
        self.gradient.resize(9 * row_len, 0.0);
        let mut fit = AffineFit::new(row_len);
        if fit.fit(&self.offsets, |i| &self.rows[width * i..][..width]) {
            self.gradient.iter_mut().zip(fit.gradient()).for_each(|(g, x)| *g = f64::from(*x as f32));
        }
        self.residuals.clear();
        self.residuals.resize(self.rows.len(), 0.0);
        let Self { instructions, row_len, offsets, rows, gradient, residuals, .. } = self;
        instructions.run(Residuals { row_len: *row_len, offsets, rows, gradient, residuals });
    }

    /// Returns the largest Frobenius norm of a mode's gradient, rounded up; NaN if one is NaN.
    pub(super) fn steepest(&self) -> f64 {
        steepest(&self.gradient, self.row_len, self.modes.len())
    }

    /// Returns the largest Frobenius norm of a vertex's residual, rounded up; NaN if one is NaN.
    pub(super) fn largest_residual(&self) -> f64 {
        largest_norm(&self.residuals, 3 * self.row_len)
    }

    /// Returns the length of the longest offset; NaN if one is NaN.
    pub(super) fn longest(&self) -> f64 {
        self.offsets.iter().map(|d| d.length()).fold(0.0, larger_or_nan)
    }

    /// Returns a unit vector across the patch. None if the patch is not nearly flat.
    pub(super) fn across(&self) -> Option<DVec3> {
        let outer = |d: DVec3| DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        let mean = self.offsets.iter().sum::<DVec3>() / self.offsets.len() as f64;
        let moments = self.offsets.iter().fold(DMat3::ZERO, |sum, d| sum + outer(*d - mean));
        // Inverse iteration towards the direction of the smallest moment.
        let trace = moments.x_axis.x + moments.y_axis.y + moments.z_axis.z;
        let inverse = (moments + DMat3::from_diagonal(DVec3::splat(1e-12 * trace))).inverse();
        let mut across = DVec3::new(0.6, 0.64, 0.48);
        for _ in 0..INVERSE_STEPS {
            across = (inverse * across).try_normalize()?;
        }
        let heights = self.offsets.iter().map(|d| across.dot(*d));
        let (low, high) = heights.fold((0.0_f64, 0.0_f64), |(low, high), h| (low.min(h), high.max(h)));
        (high - low <= FLAT * self.longest()).then_some(across)
    }

    /// Writes the components of all vertices along a unit direction, as if they were images: each is the first number of the
    /// vertex's rows. Returns a magnitude whose rounding to single precision is at least the error of the difference of two.
    pub(super) fn heights(&self, direction: DVec3, images: &mut Vec<f32>) -> f64 {
        images.clear();
        images.resize(self.residuals.len(), 0.0);
        let mut largest = 0.0;
        for (d, rows) in self.offsets.iter().zip(images.chunks_exact_mut(3 * self.row_len)) {
            let height = direction.dot(*d);
            rows[0] = height as f32;
            largest = larger_or_nan(largest, height.abs());
        }
        // Offsets and products in double precision err by at most 4 units of 2^-53 of the longest offset, two heights by 9e-16 of
        // it. 1.2e-7 of the number that is added here counts as error: 1.2e-15 of the longest offset.
        with_mutant!(largest + 1e-8 * self.longest(), LocalHeightsExact, largest)
    }

    /// Computes the images of all residuals, in single precision: three rows for each vertex. Returns the largest norm of an
    /// image before it was rounded.
    pub(super) fn images(
        &self,
        ellipsoid: &ResidualEllipsoid,
        scratch: &mut Vec<f64>,
        images: &mut Vec<f32>,
    ) -> f64 {
        scratch.clone_from(&self.residuals);
        self.instructions.run(Divide { ellipsoid, images: scratch });
        images.clear();
        images.extend(scratch.iter().map(|x| *x as f32));
        largest_norm(scratch, 3 * self.row_len)
    }
}

/// Returns the largest norm of a column of a gradient (nine rows), among the first ones, rounded up; NaN if one is NaN.
fn steepest(gradient: &[f64], row_len: usize, columns: usize) -> f64 {
    let square = |k: usize| (0..9).map(|e| gradient[e * row_len + k].powi(2)).sum::<f64>();
    (0..columns).map(square).fold(0.0, larger_or_nan).sqrt() * (1.0 + 1e-12)
}

/// Returns the largest norm of `width` numbers each, rounded up; NaN if one is NaN: it proves nothing.
fn largest_norm(numbers: &[f64], width: usize) -> f64 {
    let squares = numbers.chunks_exact(width.max(1)).map(|rows| dot(rows, rows));
    squares.fold(0.0_f64, |l, x| if x <= l { l } else { x + 0.0 * l }).sqrt() * (1.0 + 1e-9)
}

/// Computes the residuals of all vertices.
struct Residuals<'r> {
    row_len: usize,
    offsets: &'r [DVec3],
    rows: &'r [f64],
    gradient: &'r [f64],
    residuals: &'r mut [f64],
}

impl Kernel for Residuals<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        let Self { row_len, offsets, rows, gradient, residuals } = self;
        for (i, d) in offsets.iter().enumerate() {
            for c in 0..3 {
                let [u, first] = [i, 0].map(|i| &rows[(3 * i + c) * row_len..][..row_len]);
                let [x, y, z] = [0, 1, 2].map(|j| &gradient[(3 * c + j) * row_len..][..row_len]);
                let out = &mut residuals[(3 * i + c) * row_len..][..row_len];
                for k in 0..row_len {
                    out[k] = (u[k] - first[k]) - (d.x * x[k] + d.y * y[k] + d.z * z[k]);
                }
            }
        }
    }
}

/// Computes the images of all residuals under the ellipsoid.
struct Divide<'d> {
    ellipsoid: &'d ResidualEllipsoid,
    images: &'d mut [f64],
}

impl Kernel for Divide<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        self.ellipsoid.divide(self.images);
    }
}

#[cfg(test)]
mod tests {
    use sscc_testing::Numbers;

    use super::*;
    use crate::certificates::local::residual_ellipsoid::FitEllipsoid;
    use crate::{Modes, ReducedModel, TriMesh};

    const VERTICES: u32 = 40;
    const RANK: usize = 12;

    /// Calls `check` with three patches of a strip of triangles between random points, one after the other in
    /// the same memory: with all of it, with two of its parts and with one of these. `check` also gets the
    /// vertices of each, ascending. Modes 0 to 2 are linear maps, mode 5 moves no vertex, and mode 8 moves a
    /// single one.
    fn with_patches(mut check: impl FnMut(&ReducedModel, &PatchModel<'_>, &Patch, &[u32])) {
        let random = &mut Numbers(41);
        let maps = [(); 3].map(|()| DMat3::from_cols(random.vector(), random.vector(), random.vector()));
        let positions: Vec<DVec3> = (0..VERTICES).map(|_| random.vector()).collect();
        let mut modes = Vec::new();
        for (v, p) in (0_u32..).zip(&positions) {
            modes.extend((0..RANK).map(|k| match k {
                0..3 => maps[k] * *p,
                5 => DVec3::ZERO,
                8 if v != 17 => DVec3::ZERO,
                _ => random.vector(),
            }));
        }
        let faces = (2..VERTICES).map(|v| [v - 2, v - 1, v]).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(RANK, modes).unwrap()).unwrap();
        let patch_model = PatchModel::new(&model, &[0.0; RANK]).unwrap();
        let hierarchy = Hierarchy::build(&model, model.metric());
        let faces = model.mesh().faces();
        let children: Vec<u32> = hierarchy.nodes()[0].children().collect();
        let mut patch = Patch::new(VERTICES as usize);
        for nodes in [vec![0], children[..2].to_vec(), vec![children[1]]] {
            patch.load(&patch_model, &hierarchy, faces, nodes.iter().copied(), RANK).unwrap();
            let of_node = |n: &u32| hierarchy.vertices(&hierarchy.nodes()[*n as usize], faces);
            let mut vertices: Vec<u32> = nodes.iter().flat_map(of_node).collect();
            vertices.sort_unstable();
            vertices.dedup();
            check(&model, &patch_model, &patch, &vertices);
        }
    }

    /// Certificates store this gradient. Residuals of any other map, or of other offsets, would prove nothing
    /// about it.
    #[test]
    fn residuals_are_those_of_the_stored_gradient() {
        with_patches(|model, patch_model, patch, vertices| {
            assert_eq!(patch.vertices.len(), vertices.len());
            for v in 0..VERTICES {
                // The number of other vertices is that of no vertex of the patch.
                let found = patch.vertices.get(patch.numbers[v as usize] as usize);
                assert_eq!(found, vertices.contains(&v).then_some(&v));
            }
            let moves =
                |k: &u32| vertices.iter().any(|v| model.modes().of_vertex(*v)[*k as usize] != DVec3::ZERO);
            let modes: Vec<u32> = (0..RANK as u32).filter(moves).collect();
            assert_eq!((&patch.modes, patch.row_len), (&modes, 16));
            assert!(patch.gradient.iter().all(|x| *x == f64::from(*x as f32)));
            let displacement = |i: usize, k: usize| {
                let of_vertex = model.modes().of_vertex(patch.vertices[i]);
                of_vertex[modes[k] as usize] / model.mode_displacement_bound(modes[k] as usize, 1.0)
            };
            let position = |i: usize| patch_model.positions[patch.vertices[i] as usize];
            for i in 0..vertices.len() {
                assert_eq!(patch.offsets[i], position(i) - position(0));
                for (c, k) in (0..3).flat_map(|c| (0..16).map(move |k| (c, k))) {
                    let found = patch.residuals[48 * i + 16 * c + k];
                    if k >= modes.len() {
                        assert_eq!(found, 0.0);
                        continue;
                    }
                    let row =
                        DVec3::from_array(std::array::from_fn(|j| patch.gradient[16 * (3 * c + j) + k]));
                    let affine = row.dot(position(i) - position(0));
                    let expected = (displacement(i, k) - displacement(0, k))[c] - affine;
                    assert!((found - expected).abs() < 1e-12, "{i} {c} {k}: {found} {expected}");
                    // Points all over a cube determine linear maps.
                    let is_linear = vertices.len() == VERTICES as usize && k < 3;
                    assert!(!is_linear || found.abs() < 0.05, "{i} {c} {k}: {found}");
                }
            }
        });
    }

    /// Rounding terms of certificates are proportional to these norms.
    #[test]
    fn norms_are_those_of_all_modes_and_vertices() {
        with_patches(|_, _, patch, _| {
            let norm = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>().sqrt();
            let column = |k: usize| norm(&mut patch.gradient.iter().copied().skip(k).step_by(16));
            let steepest = (0..patch.modes.len()).map(column).fold(0.0, f64::max);
            let residuals = patch.residuals.chunks(48).map(|rows| norm(&mut rows.iter().copied()));
            let largest = residuals.fold(0.0, f64::max);
            let longest = patch.offsets.iter().map(|d| norm(&mut d.to_array().into_iter()));
            let longest = longest.fold(0.0, f64::max);
            for (found, expected) in [(patch.steepest(), steepest), (patch.largest_residual(), largest)] {
                assert!(found >= expected && found < expected * (1.0 + 1e-8), "{found} {expected}");
            }
            assert!((patch.longest() - longest).abs() < 1e-14, "{} {longest}", patch.longest());
        });
    }

    /// The error of images in single precision is proportional to their largest norm.
    #[test]
    fn images_are_those_of_the_residuals() {
        with_patches(|_, _, patch, _| {
            let fit = FitEllipsoid { blocks: &patch.residuals, rank: patch.modes.len(), row_len: 16 };
            let ellipsoid = InstructionSet::default().run(fit).unwrap();
            // Memory from before is overwritten.
            let (mut scratch, mut images) = (vec![7.0; 5], vec![7.0; 5]);
            let found = patch.images(&ellipsoid, &mut scratch, &mut images);
            let (mut expected, mut largest) = (Vec::new(), 0.0_f64);
            for rows in patch.residuals.chunks(48) {
                let mut rows = rows.to_vec();
                ellipsoid.divide(&mut rows);
                largest = largest.max(rows.iter().map(|x| x * x).sum::<f64>().sqrt());
                expected.extend(rows.iter().map(|x| *x as f32));
            }
            assert_eq!(images, expected);
            assert!(found >= largest && found < largest * (1.0 + 1e-8), "{found} {largest}");
        });
    }

    /// Heights are the only numbers of their images that are not 0. Their error is relative to the largest one,
    /// and to the longest offset in double precision.
    #[test]
    fn heights_are_components_of_offsets() {
        let random = &mut Numbers(42);
        with_patches(|_, _, patch, vertices| {
            let direction = random.vector().normalize();
            let mut images = vec![7.0; 5];
            let found = patch.heights(direction, &mut images);
            assert_eq!(images.len(), 48 * vertices.len());
            let (mut highest, mut longest) = (0.0_f64, 0.0_f64);
            for (d, rows) in patch.offsets.iter().zip(images.chunks(48)) {
                let height = direction.x * d.x + direction.y * d.y + direction.z * d.z;
                assert!((f64::from(rows[0]) - height).abs() <= 6e-8 * height.abs() + 1e-15);
                assert!(rows[1..].iter().all(|x| *x == 0.0));
                (highest, longest) = (highest.max(height.abs()), longest.max(d.length()));
            }
            let expected = highest + 1e-8 * longest;
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        });
    }

    /// Returns points that have no modes.
    fn points(offsets: Vec<DVec3>) -> Patch {
        Patch { offsets, ..Patch::new(0) }
    }

    /// It is the direction of the smallest moment about the mean, also where the first point lies beside and
    /// below the others.
    #[test]
    fn directions_across_are_those_of_the_smallest_moment() {
        let random = &mut Numbers(43);
        for case in 0..100 {
            let axis = (random.vector() + DVec3::X * 1e-3).normalize();
            let turn = DMat3::from_axis_angle(axis, 3.0 * random.signed());
            let middle = DVec3::new(0.8, 0.3, 0.02);
            let mut offsets = vec![DVec3::ZERO];
            offsets.extend((0..30).map(|_| turn * (middle + random.vector() * DVec3::new(0.5, 0.5, 0.005))));
            let mean = offsets.iter().sum::<DVec3>() / 31.0;
            let across = points(offsets.clone()).across().unwrap();
            assert!((across.length() - 1.0).abs() < 1e-12);
            let moved: DVec3 = offsets.iter().map(|d| (*d - mean) * (*d - mean).dot(across)).sum();
            let trace: f64 = offsets.iter().map(|d| (*d - mean).length_squared()).sum();
            let smallest = moved.dot(across);
            assert!((moved - across * smallest).length() < 1e-9 * trace, "case {case}");
            assert!(smallest < 0.01 * trace, "case {case}: {smallest}");
        }
        // Points of one plane have a moment of 0 across it.
        let grid = (0..16).map(|i| DVec3::new(f64::from(i % 4), f64::from(i / 4), 0.0)).collect();
        let across = points(grid).across().unwrap();
        assert!((across.z.abs() - 1.0).abs() < 1e-12, "{across}");
    }

    #[test]
    fn patches_are_flat_up_to_a_share_of_their_length() {
        let random = &mut Numbers(44);
        for case in 0..20 {
            let axis = (random.vector() + DVec3::X * 1e-3).normalize();
            let turn = DMat3::from_axis_angle(axis, 3.0 * random.signed());
            for (share, is_flat) in [(0.0499, true), (0.0501, false)] {
                let height = DVec3::Z * (0.5 * share);
                let around = [DVec3::ZERO, DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, height, -height];
                let across = points(around.map(|d| turn * d * 3.0).to_vec()).across();
                assert_eq!(across.is_some(), is_flat, "case {case}: {share}");
                let is_normal = |across: DVec3| across.dot(turn * DVec3::Z).abs() > 1.0 - 1e-12;
                assert!(across.is_none_or(is_normal), "case {case}");
            }
        }
    }

    /// Rounding terms are proportional to these norms.
    #[test]
    fn no_column_is_longer_than_the_steepest() {
        // Columns of norms 3 and 5, and one that is not asked for.
        let mut gradient = vec![0.0; 27];
        gradient.chunks_exact_mut(3).for_each(|row| row.copy_from_slice(&[1.0, 5.0 / 3.0, 100.0]));
        for (columns, expected) in [(0, 0.0), (1, 3.0), (2, 5.0)] {
            let found = steepest(&gradient, 3, columns);
            assert!(found >= expected && found <= expected * (1.0 + 1e-11), "{found} {expected}");
        }
        gradient[13] = f64::NAN;
        assert!(steepest(&gradient, 3, 2).is_nan() && !steepest(&gradient, 3, 1).is_nan());
    }

    #[test]
    fn no_norm_is_larger_than_the_largest() {
        // Lengths of rows are multiples of 8.
        let row = |x: f64, y: f64| [x, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, y];
        for (rows, expected) in
            [([row(3.0, -4.0), row(1.0, 2.0)], 5.0), ([row(0.0, 1.0), row(6.0, 8.0)], 10.0)]
        {
            let found = largest_norm(rows.as_flattened(), 8);
            assert!(found >= expected && found <= expected + 1e-7, "{found} {expected}");
        }
        assert_eq!(largest_norm(&[0.0; 16], 8), 0.0);
        for rows in [[row(f64::NAN, 1.0), row(2.0, 2.0)], [row(2.0, 2.0), row(1.0, f64::NAN)]] {
            assert!(largest_norm(rows.as_flattened(), 8).is_nan());
        }
    }
}
