//! Growing basis, orthonormal under the inner product of the mass.

use faer::{Mat, MatRef};

use super::tall_matrix::{add_product, inner};

/// M-orthonormal columns and their products with M, with spare capacity.
pub(super) struct Basis {
    columns: Mat<f64>,
    m_columns: Mat<f64>,
    size: usize,
}

impl Basis {
    /// Creates an empty basis with this capacity.
    pub fn new(rows: usize, capacity: usize) -> Self {
        Self { columns: Mat::zeros(rows, capacity), m_columns: Mat::zeros(rows, capacity), size: 0 }
    }

    /// Returns the number of columns.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Adds columns and their products with M, within the capacity.
    pub fn extend(&mut self, columns: MatRef<f64>, m_columns: MatRef<f64>) {
        self.columns.as_mut().subcols_mut(self.size, columns.ncols()).copy_from(columns);
        self.m_columns.as_mut().subcols_mut(self.size, columns.ncols()).copy_from(m_columns);
        self.size += columns.ncols();
    }

    /// Projects the basis out of all columns, twice; returns the removed coefficients.
    pub fn project_out(&self, x: &mut Mat<f64>) -> Mat<f64> {
        let columns = self.columns.as_ref().subcols(0, self.size);
        let m_columns = self.m_columns.as_ref().subcols(0, self.size);
        let mut removed = Mat::zeros(self.size, x.ncols());
        for _ in 0..2 {
            let along = inner(m_columns, x.as_ref());
            add_product(x.as_mut(), columns, along.as_ref(), -1.0);
            removed += along;
        }
        removed
    }

    /// Returns the largest product of its columns with these.
    pub fn overlap(&self, x: &Mat<f64>) -> f64 {
        inner(self.m_columns.as_ref().subcols(0, self.size), x.as_ref()).norm_max()
    }

    /// Returns the columns times a matrix.
    pub fn times(&self, rotation: MatRef<f64>) -> Mat<f64> {
        let mut product = Mat::zeros(self.columns.nrows(), rotation.ncols());
        add_product(product.as_mut(), self.columns.as_ref().subcols(0, self.size), rotation, 1.0);
        product
    }

    /// Replaces the columns by their product with a matrix of orthonormal columns.
    pub fn rotate(&mut self, rotation: MatRef<f64>) {
        for half in [&mut self.columns, &mut self.m_columns] {
            let mut product = Mat::zeros(half.nrows(), rotation.ncols());
            add_product(product.as_mut(), half.as_ref().subcols(0, self.size), rotation, 1.0);
            half.as_mut().subcols_mut(0, rotation.ncols()).copy_from(&product);
        }
        self.size = rotation.ncols();
    }
}
