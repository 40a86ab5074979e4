//! Symmetric sparse matrices of 3 x 3 blocks: one row of blocks for each free vertex.

use faer::{Mat, MatRef};
use rayon::prelude::*;

/// The number of a vertex that has no row: it is fixed.
pub(crate) const FIXED: u32 = u32::MAX;

/// Both triangles, row after row.
#[derive(Clone)]
pub(crate) struct BlockSparse {
    /// Where each row of blocks starts; one more at the end.
    starts: Vec<usize>,
    /// The column of each block, ascending within a row.
    columns: Vec<u32>,
    /// Row-major blocks.
    blocks: Vec<[f64; 9]>,
}

impl BlockSparse {
    /// Zeros where two vertices share an element. [`FIXED`] vertices are skipped.
    pub fn with_pattern<'a>(rows: usize, elements: impl Iterator<Item = &'a [u32]>) -> Self {
        let mut neighbours: Vec<Vec<u32>> = (0..rows).map(|i| vec![i as u32]).collect();
        for element in elements {
            for i in element.iter().filter(|i| **i != FIXED) {
                let row = &mut neighbours[*i as usize];
                row.extend(element.iter().filter(|j| **j != FIXED));
                // Rows are tidied now and then, so that they stay short.
                if row.len() > 256 {
                    row.sort_unstable();
                    row.dedup();
                }
            }
        }
        let mut matrix = Self { starts: vec![0], columns: Vec::new(), blocks: Vec::new() };
        for row in &mut neighbours {
            row.sort_unstable();
            row.dedup();
            matrix.columns.extend_from_slice(row);
            matrix.starts.push(matrix.columns.len());
        }
        matrix.blocks = vec![[0.0; 9]; matrix.columns.len()];
        matrix
    }

    /// Rows of blocks.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// The columns of the blocks of a row.
    pub fn columns(&self, row: usize) -> &[u32] {
        &self.columns[self.starts[row]..self.starts[row + 1]]
    }

    /// The blocks of a row, one for each of its columns.
    pub fn blocks(&self, row: usize) -> &[[f64; 9]] {
        &self.blocks[self.starts[row]..self.starts[row + 1]]
    }

    /// Adds to a block of the pattern.
    pub fn add(&mut self, row: u32, column: u32, block: &[f64; 9]) {
        let columns = self.columns(row as usize);
        let Ok(at) = columns.binary_search(&column) else { unreachable!("a block outside the pattern") };
        let at = self.starts[row as usize] + at;
        self.blocks[at].iter_mut().zip(block).for_each(|(sum, x)| *sum += x);
    }

    /// `a self + b other`, of the same pattern.
    pub fn combined(&self, a: f64, other: &Self, b: f64) -> Self {
        let sum = |(x, y): (&[f64; 9], &[f64; 9])| std::array::from_fn(|k| a * x[k] + b * y[k]);
        let blocks = self.blocks.iter().zip(&other.blocks).map(sum).collect();
        Self { starts: self.starts.clone(), columns: self.columns.clone(), blocks }
    }

    /// The product with a matrix of `3 rows` rows. Each row's sum has the order of its columns, on any number of
    /// threads.
    pub fn multiply(&self, x: MatRef<f64>) -> Mat<f64> {
        let width = x.ncols();
        // Row-major copies: a block touches whole rows.
        let mut packed = vec![0.0; x.nrows() * width];
        for j in 0..width {
            for i in 0..x.nrows() {
                packed[i * width + j] = x[(i, j)];
            }
        }
        let mut product = vec![0.0; packed.len()];
        product.par_chunks_mut((3 * width).max(1)).enumerate().for_each(|(row, out)| {
            for (column, block) in self.columns(row).iter().zip(self.blocks(row)) {
                let from = &packed[*column as usize * 3 * width..][..3 * width];
                let (x, yz) = from.split_at(width);
                let (y, z) = yz.split_at(width);
                for (out, b) in out.chunks_exact_mut(width).zip(block.chunks_exact(3)) {
                    for j in 0..width {
                        out[j] += b[0] * x[j] + b[1] * y[j] + b[2] * z[j];
                    }
                }
            }
        });
        Mat::from_fn(x.nrows(), width, |i, j| product[i * width + j])
    }

    /// The sum of the diagonal.
    pub fn trace(&self) -> f64 {
        (0..self.rows())
            .flat_map(|row| self.columns(row).iter().zip(self.blocks(row)).filter(move |(c, _)| **c as usize == row))
            .map(|(_, b)| b[0] + b[4] + b[8])
            .sum()
    }

    /// The lower triangle, compressed by columns: starts, rows, values.
    pub fn lower(&self) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for vertex in 0..self.rows() {
            for axis in 0..3 {
                let column = 3 * vertex + axis;
                // By symmetry the column is a row.
                for (other, block) in self.columns(vertex).iter().zip(self.blocks(vertex)) {
                    for k in 0..3 {
                        let row = 3 * *other as usize + k;
                        if row >= column {
                            rows.push(row);
                            values.push(block[3 * axis + k]);
                        }
                    }
                }
                starts.push(rows.len());
            }
        }
        (starts, rows, values)
    }
}
