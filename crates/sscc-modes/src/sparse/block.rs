//! Symmetric sparse matrices of 3 x 3 blocks: one row of blocks for each free vertex.

use faer::{Mat, MatRef};
use rayon::prelude::*;

/// Row number of a fixed vertex, which has no row.
pub(crate) const FIXED: u32 = u32::MAX;

/// Number of rows per task of a copy.
const ROWS_PER_TASK: usize = 1024;

/// Symmetric sparse matrix with both triangles, row after row of blocks.
#[derive(Clone, Debug)]
pub(crate) struct BlockSparse {
    /// Start of each row, and the end of the last one.
    starts: Vec<usize>,
    /// Column of each block, ascending within a row.
    columns: Vec<u32>,
    /// Blocks, row-major.
    blocks: Vec<[f64; 9]>,
}

impl BlockSparse {
    /// Creates a matrix of zeros with blocks on the diagonal and for vertices that share an element. [`FIXED`] vertices
    /// are skipped.
    pub fn with_pattern<'a>(rows: usize, elements: impl Iterator<Item = &'a [u32]>) -> Self {
        let sort = |row: &mut Vec<u32>| {
            row.sort_unstable();
            row.dedup();
        };
        let mut neighbours: Vec<Vec<u32>> = (0..rows).map(|i| vec![i as u32]).collect();
        for element in elements {
            for i in element.iter().filter(|i| **i != FIXED) {
                let row = &mut neighbours[*i as usize];
                row.extend(element.iter().filter(|j| **j != FIXED));
                // Removing duplicates before growing limits memory and time for vertices of many elements.
                if row.len() + element.len() > row.capacity() {
                    sort(row);
                    row.reserve(row.len() + element.len());
                }
            }
        }
        let (mut starts, mut columns) = (vec![0], Vec::new());
        for mut row in neighbours {
            sort(&mut row);
            columns.extend_from_slice(&row);
            starts.push(columns.len());
        }
        let blocks = vec![[0.0; 9]; columns.len()];
        Self { starts, columns, blocks }
    }

    /// Returns the number of rows of blocks: a third of the rows.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the columns of a row's blocks, ascending.
    pub fn columns(&self, row: usize) -> &[u32] {
        &self.columns[self.starts[row]..self.starts[row + 1]]
    }

    /// Returns the blocks of a row, one for each of its columns.
    pub fn blocks(&self, row: usize) -> &[[f64; 9]] {
        &self.blocks[self.starts[row]..self.starts[row + 1]]
    }

    /// Adds to one block. The caller must add the transpose to the mirrored block.
    ///
    /// # Panics
    /// When the pattern has no such block.
    pub fn add(&mut self, row: u32, column: u32, block: &[f64; 9]) {
        let found = self.columns(row as usize).binary_search(&column);
        assert!(found.is_ok(), "block {row}, {column} is not in the pattern");
        let at = self.starts[row as usize] + found.unwrap_or_default();
        self.blocks[at].iter_mut().zip(block).for_each(|(sum, x)| *sum += x);
    }

    /// Returns `a self + b other`. Both must have the same pattern.
    pub fn combined(&self, a: f64, other: &Self, b: f64) -> Self {
        debug_assert_eq!(self.columns, other.columns);
        let sum = |(x, y): (&[f64; 9], &[f64; 9])| std::array::from_fn(|k| a * x[k] + b * y[k]);
        let blocks = self.blocks.iter().zip(&other.blocks).map(sum).collect();
        Self { starts: self.starts.clone(), columns: self.columns.clone(), blocks }
    }

    /// Returns the sum of the diagonal.
    pub fn trace(&self) -> f64 {
        (0..self.rows()).map(|row| self.diagonal(row).iter().sum::<f64>()).sum()
    }

    /// Returns the smallest and the largest entry of the diagonal.
    pub fn diagonal_range(&self) -> (f64, f64) {
        let entries = (0..self.rows()).flat_map(|row| self.diagonal(row));
        entries.fold((f64::INFINITY, 0.0), |(low, high), x| (x.min(low), x.max(high)))
    }

    /// Returns the three entries of the diagonal in a row of blocks.
    fn diagonal(&self, row: usize) -> [f64; 3] {
        let at = self.columns(row).binary_search(&(row as u32)).unwrap_or_default();
        let block = &self.blocks(row)[at];
        [block[0], block[4], block[8]]
    }

    /// Returns the product with a matrix of `3 rows` rows. Each entry is one sum in the order of the columns, for any
    /// number of threads.
    pub fn multiply(&self, x: MatRef<f64>) -> Mat<f64> {
        let width = x.ncols();
        if width == 0 {
            return Mat::zeros(x.nrows(), 0);
        }
        // Row-major copies, because a block takes three whole rows of x.
        let mut packed = vec![0.0; x.nrows() * width];
        packed.par_chunks_mut(ROWS_PER_TASK * width).zip(x.par_row_chunks(ROWS_PER_TASK)).for_each(
            |(packed, x)| {
                for (j, column) in x.col_iter().enumerate() {
                    packed[j..].iter_mut().step_by(width).zip(column.iter()).for_each(|(to, x)| *to = *x);
                }
            },
        );
        let mut product = vec![0.0; packed.len()];
        product.par_chunks_mut(3 * width).enumerate().for_each(|(row, sums)| {
            for (column, block) in self.columns(row).iter().zip(self.blocks(row)) {
                let from = &packed[*column as usize * 3 * width..][..3 * width];
                let (x, yz) = from.split_at(width);
                let (y, z) = yz.split_at(width);
                for (sums, b) in sums.chunks_exact_mut(width).zip(block.chunks_exact(3)) {
                    for (((sum, x), y), z) in sums.iter_mut().zip(x).zip(y).zip(z) {
                        *sum += b[0] * x + b[1] * y + b[2] * z;
                    }
                }
            }
        });
        let mut unpacked = Mat::zeros(x.nrows(), width);
        unpacked.par_row_chunks_mut(ROWS_PER_TASK).zip(product.par_chunks(ROWS_PER_TASK * width)).for_each(
            |(to, from)| {
                for (j, column) in to.col_iter_mut().enumerate() {
                    column.iter_mut().zip(from[j..].iter().step_by(width)).for_each(|(to, x)| *to = *x);
                }
            },
        );
        unpacked
    }

    /// Returns the lower triangle, compressed by columns: starts of columns, rows (ascending) and entries.
    pub fn lower(&self) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let (mut starts, mut rows, mut entries) = (vec![0], Vec::new(), Vec::new());
        for column in 0..3 * self.rows() {
            let (vertex, axis) = (column / 3, column % 3);
            // By symmetry, the column equals a row.
            for (other, block) in self.columns(vertex).iter().zip(self.blocks(vertex)) {
                for (k, entry) in block[3 * axis..3 * axis + 3].iter().enumerate() {
                    let row = 3 * *other as usize + k;
                    if row >= column {
                        rows.push(row);
                        entries.push(*entry);
                    }
                }
            }
            starts.push(rows.len());
        }
        (starts, rows, entries)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigen::lattice::{dense, random_matrix};

    #[test]
    fn the_product_matches_the_dense_matrix() {
        let elements: [&[u32]; 4] = [&[0, 1, FIXED], &[1, 3, 2], &[4], &[2, FIXED, 4, 2]];
        let mut matrix = BlockSparse::with_pattern(6, elements.into_iter());
        assert_eq!(matrix.rows(), 6);
        assert_eq!(
            (matrix.columns(0), matrix.columns(2), matrix.columns(5)),
            (&[0, 1][..], &[1, 2, 3, 4][..], &[5][..])
        );
        for i in 0..6 {
            for j in matrix.columns(i).to_vec() {
                let block = std::array::from_fn(|k| (1 + i * 7 + j as usize * 3 + k) as f64);
                matrix.add(i as u32, j, &block);
                matrix.add(i as u32, j, &block);
            }
        }
        let x = random_matrix(18, 5);
        let wanted = dense(&matrix) * &x;
        assert!((matrix.multiply(x.as_ref()) - &wanted).norm_max() < 1e-12 * wanted.norm_max());
        let sum = matrix.combined(2.0, &matrix, -0.5);
        assert!((dense(&sum) - faer::Scale(1.5) * dense(&matrix)).norm_max() < 1e-12);
        assert_eq!(matrix.trace(), (0..18).map(|i| dense(&matrix)[(i, i)]).sum::<f64>());
        assert_eq!(matrix.multiply(Mat::zeros(18, 0).as_ref()).ncols(), 0);
    }

    #[test]
    #[should_panic(expected = "not in the pattern")]
    fn a_block_outside_the_pattern_is_rejected() {
        BlockSparse::with_pattern(2, std::iter::empty()).add(0, 1, &[0.0; 9]);
    }
}
