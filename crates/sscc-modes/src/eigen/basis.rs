//! Tall matrices under the inner product of the mass.

use faer::linalg::matmul::matmul;
use faer::prelude::Reborrow;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use rayon::prelude::*;

use crate::sparse::BlockSparse;

/// Rows that one thread takes at once. Fixed, so that sums do not depend on the number of threads.
const ROWS: usize = 4096;

/// Of a column's length, at most this share is new: the column depends on those before it.
const LOST: f64 = 1e-14;

/// Attempts to find an orthonormal block. Two are enough unless columns are lost.
const PASSES: usize = 5;

/// `a' b`, for tall matrices.
pub(super) fn inner(a: MatRef<f64>, b: MatRef<f64>) -> Mat<f64> {
    if a.nrows() == 0 || a.ncols() == 0 || b.ncols() == 0 {
        return Mat::zeros(a.ncols(), b.ncols());
    }
    let parts: Vec<Mat<f64>> = a
        .par_row_chunks(ROWS)
        .zip(b.par_row_chunks(ROWS))
        .map(|(a, b)| {
            let mut part = Mat::zeros(a.ncols(), b.ncols());
            matmul(&mut part, Accum::Replace, a.transpose(), b, 1.0, Par::Seq);
            part
        })
        .collect();
    parts.iter().fold(Mat::zeros(a.ncols(), b.ncols()), |sum, part| sum + part)
}

/// Adds `factor a b` to `to`, for tall `a`.
pub(super) fn add_product(to: MatMut<f64>, a: MatRef<f64>, b: MatRef<f64>, factor: f64) {
    if to.nrows() == 0 || to.ncols() == 0 || a.ncols() == 0 {
        return;
    }
    to.par_row_chunks_mut(ROWS)
        .zip(a.par_row_chunks(ROWS))
        .for_each(|(to, a)| matmul(to, Accum::Add, a, b, factor, Par::Seq));
}

/// Displacements under the inner product of the mass, without the rigid motions.
pub(super) struct Space<'a> {
    pub mass: &'a BlockSparse,
    rigid: MatRef<'a, f64>,
    heavy_rigid: Mat<f64>,
}

impl<'a> Space<'a> {
    /// `rigid` has M-orthonormal columns, maybe none.
    pub fn new(mass: &'a BlockSparse, rigid: MatRef<'a, f64>) -> Self {
        Self { mass, rigid, heavy_rigid: mass.multiply(rigid) }
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        3 * self.mass.rows()
    }

    /// Takes the rigid motions out of all columns.
    pub fn deflate(&self, x: &mut Mat<f64>) {
        for _ in 0..2 {
            let along = inner(self.heavy_rigid.as_ref(), x.as_ref());
            add_product(x.as_mut(), self.rigid, along.as_ref(), -1.0);
        }
    }

    /// Takes an M-orthonormal basis out of all columns, twice; how much of it there was.
    pub fn take_out(&self, x: &mut Mat<f64>, basis: MatRef<f64>) -> Mat<f64> {
        let mut taken = Mat::zeros(basis.ncols(), x.ncols());
        for _ in 0..2 {
            let along = inner(basis, self.mass.multiply(x.as_ref()).as_ref());
            add_product(x.as_mut(), basis, along.as_ref(), -1.0);
            taken += along;
        }
        taken
    }

    /// Makes the columns M-orthonormal and M-orthogonal to the basis and the rigid motions. Gives R: the columns
    /// were `x R`. A column that depends on those before it becomes a random one, with zeros in its row of R.
    /// None when that fails again and again: there is no room beside the basis.
    pub fn orthonormalise(
        &self,
        x: &mut Mat<f64>,
        basis: MatRef<f64>,
        random: &mut Random,
    ) -> Option<Mat<f64>> {
        let width = x.ncols();
        let mut total = Mat::<f64>::identity(width, width);
        for pass in 0..PASSES {
            let mut heavy = self.mass.multiply(x.as_ref());
            let (triangle, lost) = gram_schmidt(x, &mut heavy);
            total = &triangle * &total;
            if pass > 0 && lost.is_empty() {
                return Some(total);
            }
            for j in lost {
                x.col_mut(j).iter_mut().for_each(|entry| *entry = random.next());
            }
            // A short column was made longer, and with it what it held of the basis by rounding.
            self.deflate(x);
            self.take_out(x, basis);
        }
        None
    }
}

/// Modified Gram-Schmidt, twice for each column. `heavy` is M x, and is kept so. Gives R, and which columns are lost.
fn gram_schmidt(x: &mut Mat<f64>, heavy: &mut Mat<f64>) -> (Mat<f64>, Vec<usize>) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let take = |to: &mut [f64], from: &[f64], factor: f64| {
        to.iter_mut().zip(from).for_each(|(to, from)| *to -= factor * from);
    };
    let width = x.ncols();
    let (mut triangle, mut lost) = (Mat::zeros(width, width), Vec::new());
    for j in 0..width {
        let (before, mut own) = x.as_mut().split_at_col_mut(j);
        let (heavy_before, mut heavy_own) = heavy.as_mut().split_at_col_mut(j);
        let (Some(own), Some(heavy_own)) = (
            own.as_mut().col_mut(0).try_as_col_major_mut(),
            heavy_own.as_mut().col_mut(0).try_as_col_major_mut(),
        ) else {
            unreachable!("columns of a Mat are contiguous")
        };
        let (own, heavy_own) = (own.as_slice_mut(), heavy_own.as_slice_mut());
        let length = dot(own, heavy_own).max(0.0).sqrt();
        for _ in 0..2 {
            for i in (0..j).filter(|i| !lost.contains(i)) {
                let (Some(other), Some(heavy_other)) =
                    (before.rb().col(i).try_as_col_major(), heavy_before.rb().col(i).try_as_col_major())
                else {
                    unreachable!("columns of a Mat are contiguous")
                };
                let along = dot(other.as_slice(), heavy_own);
                take(own, other.as_slice(), along);
                take(heavy_own, heavy_other.as_slice(), along);
                triangle[(i, j)] += along;
            }
        }
        let new = dot(own, heavy_own).max(0.0).sqrt();
        if new > LOST * length && new.is_normal() {
            own.iter_mut().chain(heavy_own).for_each(|entry| *entry /= new);
            triangle[(j, j)] = new;
        } else {
            lost.push(j);
        }
    }
    (triangle, lost)
}

/// Pseudo-random numbers between -1 and 1, the same in every run (Steele, Lea and Flood 2014: splitmix64).
pub(super) struct Random(pub u64);

impl Random {
    /// The next number.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A matrix of them.
    pub fn matrix(&mut self, rows: usize, columns: usize) -> Mat<f64> {
        Mat::from_fn(rows, columns, |_, _| self.next())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigen::lattice::Lattice;

    #[test]
    fn dependent_columns_are_replaced_and_the_product_stays() {
        let body = Lattice::free(4, 4, 4);
        let space = Space::new(&body.mass, body.rigid.as_ref());
        let mut random = Random(7);
        let mut basis = random.matrix(192, 9);
        space.orthonormalise(&mut basis, Mat::zeros(192, 0).as_ref(), &mut random).unwrap();
        let mut block = random.matrix(192, 6);
        space.deflate(&mut block);
        space.take_out(&mut block, basis.as_ref());
        // Column 2 is a sum, column 4 nearly one, column 5 nothing.
        for i in 0..192 {
            block[(i, 2)] = block[(i, 0)] - 2.0 * block[(i, 1)];
            block[(i, 4)] = block[(i, 0)] + 1e-9 * block[(i, 4)];
            block[(i, 5)] = 0.0;
        }
        let before = block.clone();
        let triangle = space.orthonormalise(&mut block, basis.as_ref(), &mut random).unwrap();
        assert!((&block * &triangle - before).norm_max() < 1e-13);
        assert!((0..6).all(|j| triangle[(5, j)] == 0.0));
        let gram = inner(block.as_ref(), body.mass.multiply(block.as_ref()).as_ref());
        assert!((gram - Mat::<f64>::identity(6, 6)).norm_max() < 1e-13);
        for other in [basis.as_ref(), body.rigid.as_ref()] {
            assert!(inner(other, body.mass.multiply(block.as_ref()).as_ref()).norm_max() < 1e-13);
        }
    }

    #[test]
    fn no_room_beside_the_basis_is_noticed() {
        let body = Lattice::free(2, 2, 2);
        let space = Space::new(&body.mass, body.rigid.as_ref());
        let mut random = Random(7);
        let mut basis = random.matrix(24, 16);
        space.orthonormalise(&mut basis, Mat::zeros(24, 0).as_ref(), &mut random).unwrap();
        assert!(space.orthonormalise(&mut random.matrix(24, 2), basis.as_ref(), &mut random).is_some());
        assert!(space.orthonormalise(&mut random.matrix(24, 5), basis.as_ref(), &mut random).is_none());
    }
}
