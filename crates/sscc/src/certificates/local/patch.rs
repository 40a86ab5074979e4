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
    use super::*;

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
