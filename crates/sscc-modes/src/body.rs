//! Solids with fixed vertices: mass and stiffness matrices, and rigid motions.

use faer::Mat;
use glam::{DMat3, DVec3};
use sscc::Progress;
use sscc_solid::Solid;

use crate::ModesError;
use crate::eigen::dense::symmetric_eigen;
use crate::eigen::tall_matrix::{add_product, inner, product};
use crate::eigen::{LowestModes, lowest_modes};
use crate::sparse::{BlockSparse, FIXED};

/// Maximum eigenvalue of the constraints by fixed vertices that counts as 0. Motions with such eigenvalues are free.
const RANK_TOLERANCE: f64 = 1e-10;

/// Solid with optional fixed vertices, and its matrices at rest.
pub(crate) struct Body<'a> {
    /// The solid.
    pub solid: &'a Solid,
    /// Row of each vertex in the matrices, or [`FIXED`].
    rows: Vec<u32>,
    /// Rest positions of the free vertices.
    free: Vec<DVec3>,
    /// Stiffness at rest.
    pub stiffness: BlockSparse,
    /// Consistent mass.
    pub mass: BlockSparse,
    /// M-orthonormal rigid motions that the fixed vertices permit: six columns for a free body.
    pub rigid: Mat<f64>,
}

impl<'a> Body<'a> {
    /// Assembles the matrices of a solid with fixed vertices.
    ///
    /// # Errors
    /// When a fixed vertex does not exist, all are fixed, or numbers are out of range.
    pub fn new(solid: &'a Solid, fixed: &[u32]) -> Result<Self, ModesError> {
        let vertices = solid.vertices().len();
        let mut rows = vec![0; vertices];
        for vertex in fixed {
            match rows.get_mut(*vertex as usize) {
                Some(row) => *row = FIXED,
                None => return Err(ModesError::FixedVertex { vertex: *vertex, vertices }),
            }
        }
        let mut free = Vec::new();
        for (row, p) in rows.iter_mut().zip(solid.vertices()).filter(|(row, _)| **row != FIXED) {
            *row = free.len() as u32;
            free.push(*p);
        }
        if free.is_empty() {
            return Err(ModesError::AllFixed { vertices });
        }
        let (stiffness, mass) = assemble(solid, &rows, free.len());
        let mut body = Self { solid, rows, free, stiffness, mass, rigid: Mat::zeros(0, 0) };
        body.rigid = body.rigid_motions()?;
        Ok(body)
    }

    /// Computes the `count` lowest vibrations, without rigid motions.
    pub fn lowest(&self, count: usize, progress: &dyn Progress) -> Result<LowestModes, ModesError> {
        lowest_modes(&self.stiffness, &self.mass, &self.free, self.rigid.as_ref(), count, progress)
    }

    /// Removes the rigid motions, M-orthogonally.
    pub fn without_rigid(&self, x: &mut Mat<f64>) {
        if self.rigid.ncols() > 0 {
            for _ in 0..2 {
                let coefficients = inner(self.rigid.as_ref(), self.mass.multiply(x.as_ref()).as_ref());
                add_product(x.as_mut(), self.rigid.as_ref(), coefficients.as_ref(), -1.0);
            }
        }
    }

    /// Returns the diagonal of the solid's bounding box (model unit).
    pub fn diagonal(&self) -> f64 {
        let vertices = self.solid.vertices();
        let low = vertices.iter().fold(DVec3::INFINITY, |m, p| m.min(*p));
        vertices.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p)).distance(low)
    }

    /// Extends a field on the free vertices to all vertices, with zeros.
    pub fn on_all(&self, field: &[f64]) -> Vec<DVec3> {
        let at = |row: &u32| match *row {
            FIXED => DVec3::ZERO,
            row => DVec3::from_slice(&field[3 * row as usize..]),
        };
        self.rows.iter().map(at).collect()
    }

    /// Restricts a field on all vertices to the free ones.
    pub fn on_free(&self, field: &[DVec3]) -> Vec<f64> {
        let free = self.rows.iter().zip(field).filter(|(row, _)| **row != FIXED);
        free.flat_map(|(_, u)| u.to_array()).collect()
    }

    /// Returns the translations and rotations that vanish at the fixed vertices, M-orthonormal.
    fn rigid_motions(&self) -> Result<Mat<f64>, ModesError> {
        let centre = self.free.iter().sum::<DVec3>() / self.free.len() as f64;
        let size = self.diagonal();
        let motion = |p: DVec3, k: usize| match k {
            0..3 => DVec3::AXES[k],
            _ => DVec3::AXES[k - 3].cross((p - centre) / size),
        };
        let fixed: Vec<DVec3> = self
            .rows
            .iter()
            .zip(self.solid.vertices())
            .filter(|(r, _)| **r == FIXED)
            .map(|(_, p)| *p)
            .collect();
        let held =
            Mat::from_fn(6, 6, |i, j| fixed.iter().map(|p| motion(*p, i).dot(motion(*p, j))).sum::<f64>());
        let (values, vectors) = symmetric_eigen(held.as_ref())?;
        let allowed: Vec<usize> = (0..6).filter(|k| values[*k] <= RANK_TOLERANCE).collect();
        let motions = Mat::from_fn(3 * self.free.len(), allowed.len(), |row, column| {
            (0..6).map(|k| motion(self.free[row / 3], k)[row % 3] * vectors[(k, allowed[column])]).sum()
        });
        m_orthonormal(&self.mass, motions, 1e-14, 6)
    }
}

/// Returns an M-orthonormal basis of the columns: at most `max_count` directions of the largest mass, without those below
/// `tolerance` times the largest.
pub(crate) fn m_orthonormal(
    mass: &BlockSparse,
    mut x: Mat<f64>,
    tolerance: f64,
    max_count: usize,
) -> Result<Mat<f64>, ModesError> {
    for _ in 0..2 {
        if x.ncols() == 0 {
            break; // faer cannot decompose an empty matrix
        }
        let transform = whitening(mass, &x, tolerance, max_count)?;
        x = product(x.as_ref(), transform.as_ref());
    }
    Ok(x)
}

/// Returns the matrix T for which the columns of `X T` are M-orthonormal; the directions are those of
/// [`m_orthonormal`].
pub(crate) fn whitening(
    mass: &BlockSparse,
    x: &Mat<f64>,
    tolerance: f64,
    max_count: usize,
) -> Result<Mat<f64>, ModesError> {
    let gram = inner(x.as_ref(), mass.multiply(x.as_ref()).as_ref());
    let (values, vectors) = symmetric_eigen(gram.as_ref())?;
    let size = values.len();
    let kept: Vec<usize> =
        (0..size).rev().filter(|k| values[*k] > tolerance * values[size - 1]).take(max_count).collect();
    Ok(Mat::from_fn(size, kept.len(), |i, j| vectors[(i, kept[j])] / values[kept[j]].sqrt()))
}

/// Assembles stiffness and mass of the free vertices.
fn assemble(solid: &Solid, rows: &[u32], free: usize) -> (BlockSparse, BlockSparse) {
    let elements: Vec<Vec<u32>> = (0..solid.element_count())
        .map(|index| solid.element(index).vertices.iter().map(|v| rows[*v as usize]).collect())
        .collect();
    let mut stiffness = BlockSparse::with_pattern(free, elements.iter().map(Vec::as_slice));
    let mut mass = stiffness.clone();
    for (index, rows) in elements.iter().enumerate() {
        let element = solid.element(index);
        let masses = element.masses();
        for (a, row) in rows.iter().enumerate().filter(|(_, row)| **row != FIXED) {
            for (b, column) in rows.iter().enumerate().filter(|(_, column)| **column != FIXED) {
                let mut block = DMat3::ZERO;
                let (lambda, mu) = (element.material.lame_lambda(), element.material.lame_mu());
                for point in element.points() {
                    let (g, h) = (point.gradients[a], point.gradients[b]);
                    let outer = |x: DVec3, y: DVec3| DMat3::from_cols(x * y.x, x * y.y, x * y.z);
                    let sum = outer(g, h) * lambda
                        + (outer(h, g) + DMat3::from_diagonal(DVec3::splat(g.dot(h)))) * mu;
                    block += sum * point.volume;
                }
                let block = block.transpose().to_cols_array();
                stiffness.add(*row, *column, &block);
                let m = masses[a][b];
                mass.add(*row, *column, &[m, 0.0, 0.0, 0.0, m, 0.0, 0.0, 0.0, m]);
            }
        }
    }
    (stiffness, mass)
}

#[cfg(test)]
mod tests {
    use sscc_solid::Material;

    use super::*;

    /// Tetrahedra of second order with curved edges: a cube whose centre is a vertex, so that all edges at it are inside.
    fn curved() -> Solid {
        let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2));
        let mut vertices: Vec<DVec3> = (0..8).map(corner).collect();
        vertices.push(DVec3::new(0.5, 0.45, 0.55));
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let tets = faces.into_iter().flat_map(|[a, b, c, d]| [[8, a, b, c], [8, a, c, d]]).collect();
        let linear = Solid::uniform(vertices, tets, vec![], Material::default()).unwrap();
        let (straight, edges) = linear.elevated().unwrap();
        let mut vertices = straight.vertices().to_vec();
        for (k, _) in edges.iter().enumerate().filter(|(_, edge)| edge.contains(&8)) {
            let t = k as f64;
            vertices[9 + k] += 0.04 * DVec3::new(t.sin(), t.cos(), (2.0 * t).sin());
        }
        let middles: Vec<[u32; 6]> =
            straight.tets10().iter().map(|nodes| std::array::from_fn(|k| nodes[4 + k])).collect();
        let materials = (vec![Material::default()], vec![0; 12]);
        Solid::with_middles(vertices, straight.tets().to_vec(), &middles, vec![], materials.0, materials.1)
            .unwrap()
    }

    #[test]
    fn curved_elements_pass_the_patch_test_and_rigid_motions_have_no_energy() {
        let solid = curved();
        let body = Body::new(&solid, &[]).unwrap();
        let map = DMat3::from_cols_array(&[0.1, 0.2, -0.1, 0.05, 0.3, 0.0, 0.02, -0.04, 0.15]);
        let turn = |p: DVec3| DVec3::new(1.0, -2.0, 3.0).cross(p) + DVec3::new(0.3, 0.2, 0.1);
        let field = |of: &dyn Fn(DVec3) -> DVec3| {
            let u: Vec<DVec3> = solid.vertices().iter().map(|p| of(*p)).collect();
            let u = body.on_free(&u);
            let u = Mat::from_fn(u.len(), 1, |row, _| u[row]);
            let force = body.stiffness.multiply(u.as_ref());
            (inner(u.as_ref(), force.as_ref())[(0, 0)], force)
        };
        let (energy, force) = field(&|p| map * p);
        let is_inside = |p: &DVec3| p.min_element() > 0.0 && p.max_element() < 1.0;
        let scale = (0..force.nrows()).map(|row| force[(row, 0)].abs()).fold(0.0, f64::max);
        assert!(energy > 0.0 && solid.vertices().iter().filter(|p| is_inside(p)).count() > 6);
        for (vertex, _) in solid.vertices().iter().enumerate().filter(|(_, p)| is_inside(p)) {
            assert!((0..3).all(|axis| force[(3 * vertex + axis, 0)].abs() < 1e-13 * scale), "{vertex}");
        }
        // The energy of the constant strain in the cube of volume 1.
        let (strain, material) = ((map + map.transpose()) * 0.5, Material::default());
        let trace = strain.x_axis.x + strain.y_axis.y + strain.z_axis.z;
        let square: f64 = strain.to_cols_array().iter().map(|x| x * x).sum();
        let exact = material.lame_lambda() * trace * trace + 2.0 * material.lame_mu() * square;
        assert!((energy / exact - 1.0).abs() < 1e-12);
        let (rigid, _) = field(&turn);
        assert!(rigid.abs() < 1e-9 * energy, "{rigid} {energy}");
    }
}
