//! Bases that grow, under the inner product of the mass.

use faer::{Mat, MatRef};

use super::tall::{add_product, inner};

/// M-orthonormal columns beside M times them, with room for more.
pub(super) struct Basis {
    columns: Mat<f64>,
    heavy: Mat<f64>,
    size: usize,
}

impl Basis {
    /// No columns, with room for so many.
    pub fn new(rows: usize, capacity: usize) -> Self {
        Self { columns: Mat::zeros(rows, capacity), heavy: Mat::zeros(rows, capacity), size: 0 }
    }

    /// Number of columns.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Adds columns, and M times them. There is room.
    pub fn extend(&mut self, columns: MatRef<f64>, heavy: MatRef<f64>) {
        self.columns.as_mut().subcols_mut(self.size, columns.ncols()).copy_from(columns);
        self.heavy.as_mut().subcols_mut(self.size, columns.ncols()).copy_from(heavy);
        self.size += columns.ncols();
    }

    /// Takes the basis out of all columns, twice; how much of it there was.
    pub fn take_out(&self, x: &mut Mat<f64>) -> Mat<f64> {
        let columns = self.columns.as_ref().subcols(0, self.size);
        let heavy = self.heavy.as_ref().subcols(0, self.size);
        let mut taken = Mat::zeros(self.size, x.ncols());
        for _ in 0..2 {
            let along = inner(heavy, x.as_ref());
            add_product(x.as_mut(), columns, along.as_ref(), -1.0);
            taken += along;
        }
        taken
    }

    /// The largest product of its columns with these.
    pub fn overlap(&self, x: &Mat<f64>) -> f64 {
        inner(self.heavy.as_ref().subcols(0, self.size), x.as_ref()).norm_max()
    }

    /// The columns times a matrix.
    pub fn times(&self, turn: MatRef<f64>) -> Mat<f64> {
        let mut product = Mat::zeros(self.columns.nrows(), turn.ncols());
        add_product(product.as_mut(), self.columns.as_ref().subcols(0, self.size), turn, 1.0);
        product
    }

    /// Becomes the columns times a matrix with orthonormal columns.
    pub fn turn(&mut self, turn: MatRef<f64>) {
        for half in [&mut self.columns, &mut self.heavy] {
            let mut product = Mat::zeros(half.nrows(), turn.ncols());
            add_product(product.as_mut(), half.as_ref().subcols(0, self.size), turn, 1.0);
            half.as_mut().subcols_mut(0, turn.ncols()).copy_from(&product);
        }
        self.size = turn.ncols();
    }
}
