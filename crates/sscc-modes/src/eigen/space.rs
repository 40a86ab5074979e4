//! Displacements under the inner product of the mass.

use faer::prelude::Reborrow;
use faer::{Mat, MatRef};

use super::basis::Basis;
use super::tall_matrix::{Random, add_product, inner};
use crate::sparse::BlockSparse;

/// Maximum length that orthogonalization leaves of a dependent column, relative to its length.
const DEPENDENCE_TOLERANCE: f64 = 1e-14;

/// Maximum product of a unit column with the basis or a rigid motion.
const ORTHOGONALITY_TOLERANCE: f64 = 1e-13;

/// Maximum number of passes to orthonormalise a block. Two are sufficient unless columns are dependent.
const MAX_PASSES: usize = 5;

/// Displacements under the inner product of the mass, without the rigid motions.
pub(super) struct Space<'a> {
    pub mass: &'a BlockSparse,
    rigid: MatRef<'a, f64>,
    m_rigid: Mat<f64>,
}

impl<'a> Space<'a> {
    /// Creates the space. `rigid` has M-orthonormal columns, maybe none.
    pub fn new(mass: &'a BlockSparse, rigid: MatRef<'a, f64>) -> Self {
        Self { mass, rigid, m_rigid: mass.multiply(rigid) }
    }

    /// Returns the number of rows.
    pub fn size(&self) -> usize {
        3 * self.mass.rows()
    }

    /// Projects the rigid motions out of all columns.
    pub fn deflate(&self, x: &mut Mat<f64>) {
        for _ in 0..2 {
            let along = inner(self.m_rigid.as_ref(), x.as_ref());
            add_product(x.as_mut(), self.rigid, along.as_ref(), -1.0);
        }
    }

    /// Makes the columns M-orthonormal and M-orthogonal to the basis and the rigid motions. Returns `M x` and R, where
    /// the columns were `x R`. A dependent column becomes a random one, with zeros in its row of R. None if the passes
    /// fail, because the space has no room beside the basis.
    pub fn orthonormalise(
        &self,
        x: &mut Mat<f64>,
        basis: &Basis,
        random: &mut Random,
    ) -> Option<(Mat<f64>, Mat<f64>)> {
        let width = x.ncols();
        let mut total = Mat::<f64>::identity(width, width);
        for _ in 0..MAX_PASSES {
            let mut m_x = self.mass.multiply(x.as_ref());
            let (triangle, dependent) = gram_schmidt(x, &mut m_x);
            total = &triangle * &total;
            let overlap = inner(self.m_rigid.as_ref(), x.as_ref()).norm_max().max(basis.overlap(x));
            if dependent.is_empty() && overlap <= ORTHOGONALITY_TOLERANCE {
                return Some((m_x, total));
            }
            for j in dependent {
                x.col_mut(j).iter_mut().for_each(|entry| *entry = random.next());
            }
            // Normalizing a short column amplifies its rounding errors along the basis.
            self.deflate(x);
            basis.project_out(x);
        }
        None
    }
}

/// Modified Gram-Schmidt, twice for each column. Updates `m_x` = M x, too. Returns R and the indices of dependent columns.
#[expect(clippy::unreachable, reason = "columns of a Mat are contiguous")]
fn gram_schmidt(x: &mut Mat<f64>, m_x: &mut Mat<f64>) -> (Mat<f64>, Vec<usize>) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let take = |to: &mut [f64], from: &[f64], factor: f64| {
        to.iter_mut().zip(from).for_each(|(to, from)| *to -= factor * from);
    };
    let width = x.ncols();
    let (mut triangle, mut dependent) = (Mat::zeros(width, width), Vec::new());
    for j in 0..width {
        let (before, mut own) = x.as_mut().split_at_col_mut(j);
        let (m_before, mut m_own) = m_x.as_mut().split_at_col_mut(j);
        let (Some(own), Some(m_own)) = (
            own.as_mut().col_mut(0).try_as_col_major_mut(),
            m_own.as_mut().col_mut(0).try_as_col_major_mut(),
        ) else {
            unreachable!("columns of a Mat are contiguous")
        };
        let (own, m_own) = (own.as_slice_mut(), m_own.as_slice_mut());
        let length = dot(own, m_own).max(0.0).sqrt();
        for _ in 0..2 {
            for i in (0..j).filter(|i| !dependent.contains(i)) {
                let (Some(other), Some(m_other)) =
                    (before.rb().col(i).try_as_col_major(), m_before.rb().col(i).try_as_col_major())
                else {
                    unreachable!("columns of a Mat are contiguous")
                };
                let along = dot(other.as_slice(), m_own);
                take(own, other.as_slice(), along);
                take(m_own, m_other.as_slice(), along);
                triangle[(i, j)] += along;
            }
        }
        let new = dot(own, m_own).max(0.0).sqrt();
        if new > DEPENDENCE_TOLERANCE * length && new.is_normal() {
            own.iter_mut().chain(m_own).for_each(|entry| *entry /= new);
            triangle[(j, j)] = new;
        } else {
            dependent.push(j);
        }
    }
    (triangle, dependent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigen::lattice::Lattice;

    #[test]
    fn dependent_columns_are_replaced_and_the_product_is_unchanged() {
        let body = Lattice::free(4, 4, 4);
        let space = Space::new(&body.mass, body.rigid.as_ref());
        let mut random = Random(7);
        let mut basis = random.matrix(192, 9);
        let (m_x, _) = space.orthonormalise(&mut basis, &Basis::new(192, 0), &mut random).unwrap();
        let mut all = Basis::new(192, 9);
        all.extend(basis.as_ref(), m_x.as_ref());
        let mut block = random.matrix(192, 6);
        space.deflate(&mut block);
        all.project_out(&mut block);
        // Column 2 is a sum of others, column 4 nearly so, and column 5 is 0.
        for i in 0..192 {
            block[(i, 2)] = block[(i, 0)] - 2.0 * block[(i, 1)];
            block[(i, 4)] = block[(i, 0)] + 1e-9 * block[(i, 4)];
            block[(i, 5)] = 0.0;
        }
        let before = block.clone();
        let (m_x, triangle) = space.orthonormalise(&mut block, &all, &mut random).unwrap();
        assert!((m_x - body.mass.multiply(block.as_ref())).norm_max() < 1e-13);
        assert!((&block * &triangle - before).norm_max() < 1e-13);
        assert!((0..6).all(|j| triangle[(5, j)] == 0.0));
        let gram = inner(block.as_ref(), body.mass.multiply(block.as_ref()).as_ref());
        assert!((gram - Mat::<f64>::identity(6, 6)).norm_max() < 1e-13);
        for other in [basis.as_ref(), body.rigid.as_ref()] {
            assert!(inner(other, body.mass.multiply(block.as_ref()).as_ref()).norm_max() < 1e-13);
        }
    }

    #[test]
    fn a_full_space_is_detected() {
        let body = Lattice::free(2, 2, 2);
        let space = Space::new(&body.mass, body.rigid.as_ref());
        let mut random = Random(7);
        let mut columns = random.matrix(24, 16);
        let (m_x, _) = space.orthonormalise(&mut columns, &Basis::new(24, 0), &mut random).unwrap();
        let mut basis = Basis::new(24, 16);
        basis.extend(columns.as_ref(), m_x.as_ref());
        assert!(space.orthonormalise(&mut random.matrix(24, 2), &basis, &mut random).is_some());
        assert!(space.orthonormalise(&mut random.matrix(24, 5), &basis, &mut random).is_none());
    }
}
