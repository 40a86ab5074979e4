//! Matrices of the caller, with strides.
#![allow(unsafe_code, reason = "pointers from C")]

use glam::DVec3;

use crate::pointers;
use crate::status::{Failure, Result, sscc_status};

/// A matrix of doubles of the caller: element (i, j) is `data[i * row_stride + j * column_stride]`. Strides are numbers of
/// elements. If both are 0, rows have no gaps (`column_stride` 1, `row_stride` the number of columns).
///
/// Positions are V x 3; modes are 3V x r, beginning with the rows x, y, z of the first vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct sscc_matrix {
    /// The first element.
    pub data: *const f64,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// The distance from a row to the next one, in elements.
    pub row_stride: usize,
    /// The distance from a column to the next one, in elements.
    pub column_stride: usize,
}

/// A matrix of 32-bit numbers of the caller, with strides as in sscc_matrix. Faces are F x 3: vertices, counted from 0.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct sscc_index_matrix {
    /// The first element.
    pub data: *const u32,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// The distance from a row to the next one, in elements.
    pub row_stride: usize,
    /// The distance from a column to the next one, in elements.
    pub column_stride: usize,
}

/// A checked matrix.
#[derive(Clone, Copy)]
pub struct Matrix<T> {
    data: *const T,
    pub rows: usize,
    pub columns: usize,
    row_stride: usize,
    column_stride: usize,
}

impl<T: Copy> Matrix<T> {
    /// Returns an element.
    #[inline(always)]
    pub fn get(&self, row: usize, column: usize) -> T {
        assert!(row < self.rows && column < self.columns);
        // SAFETY: `new` has checked that the element is within the matrix, and its caller guarantees that it exists.
        unsafe { self.data.add(row * self.row_stride + column * self.column_stride).read() }
    }

    /// Checks a matrix.
    ///
    /// # Errors
    /// For a matrix with elements: when the data is NULL, misaligned or larger than memory; when two elements overlap,
    /// or neither rows nor columns follow each other (they are interleaved).
    ///
    /// # Safety
    /// All elements are initialized, and do not change during the call.
    #[inline]
    unsafe fn new(
        data: *const T,
        [rows, columns]: [usize; 2],
        [row_stride, column_stride]: [usize; 2],
        name: &str,
    ) -> Result<Self> {
        let [row_stride, column_stride] =
            if [row_stride, column_stride] == [0, 0] { [columns, 1] } else { [row_stride, column_stride] };
        if rows == 0 || columns == 0 {
            return Ok(Self { data, rows, columns, row_stride, column_stride });
        }
        let along = |count: usize, stride: usize| (count - 1).checked_mul(stride);
        let [Some(row), Some(column)] = [along(rows, row_stride), along(columns, column_stride)] else {
            return Err(Failure::argument(format!("{name} is larger than memory")));
        };
        let Some(length) = row.checked_add(column).and_then(|last| last.checked_add(1)) else {
            return Err(Failure::argument(format!("{name} is larger than memory")));
        };
        // Either rows follow each other without overlap, or columns do.
        let is_nested = |outer: [usize; 2], inner: [usize; 2], inner_extent: usize| {
            (outer[0] == 1 || outer[1] > inner_extent) && (inner[0] == 1 || inner[1] > 0)
        };
        let sides = [[rows, row_stride], [columns, column_stride]];
        if !is_nested(sides[0], sides[1], column) && !is_nested(sides[1], sides[0], row) {
            let message = format!(
                "{name}: elements overlap or are interleaved by the strides {row_stride} and {column_stride}: each row, or each \
                 column, must end before the next one begins"
            );
            return Err(Failure::new(sscc_status::Overlap, message));
        }
        pointers::check(data, length, name)?;
        Ok(Self { data, rows, columns, row_stride, column_stride })
    }
}

impl Matrix<f64> {
    /// Checks a matrix of positions.
    ///
    /// # Errors
    /// As [`Matrix::new`], and when it does not have three columns.
    ///
    /// # Safety
    /// As [`Matrix::new`].
    #[inline]
    pub unsafe fn positions(matrix: &sscc_matrix, name: &str) -> Result<Self> {
        // SAFETY: by the caller's guarantee.
        let matrix = unsafe { Self::any(matrix, name) }?;
        if matrix.columns == 3 { Ok(matrix) } else { Err(not_three(matrix.columns, name)) }
    }

    /// Checks any matrix.
    ///
    /// # Errors
    /// As [`Matrix::new`].
    ///
    /// # Safety
    /// As [`Matrix::new`].
    #[inline]
    pub unsafe fn any(matrix: &sscc_matrix, name: &str) -> Result<Self> {
        let sscc_matrix { data, rows, columns, row_stride, column_stride } = *matrix;
        // SAFETY: by the caller's guarantee.
        unsafe { Self::new(data, [rows, columns], [row_stride, column_stride], name) }
    }

    /// Returns the rows as vectors: the caller's memory if rows have no gaps, otherwise a copy in `buffer`.
    #[inline]
    pub fn vectors<'a>(&'a self, buffer: &'a mut Vec<DVec3>) -> &'a [DVec3] {
        const { assert!(size_of::<DVec3>() == 24 && align_of::<DVec3>() == align_of::<f64>()) };
        if self.rows > 0 && [self.row_stride, self.column_stride] == [3, 1] {
            // SAFETY: three doubles each, in the layout of C, which `new` has checked.
            return unsafe { std::slice::from_raw_parts(self.data.cast(), self.rows) };
        }
        buffer.clear();
        buffer.extend((0..self.rows).map(|i| DVec3::from_array([0, 1, 2].map(|j| self.get(i, j)))));
        buffer
    }
}

impl Matrix<u32> {
    /// Checks a matrix of faces.
    ///
    /// # Errors
    /// As [`Matrix::positions`].
    ///
    /// # Safety
    /// As [`Matrix::new`].
    pub unsafe fn faces(matrix: &sscc_index_matrix, name: &str) -> Result<Self> {
        let sscc_index_matrix { data, rows, columns, row_stride, column_stride } = *matrix;
        // SAFETY: by the caller's guarantee.
        let matrix = unsafe { Self::new(data, [rows, columns], [row_stride, column_stride], name) }?;
        if matrix.columns == 3 { Ok(matrix) } else { Err(not_three(matrix.columns, name)) }
    }

    /// Returns the rows.
    pub fn triples(&self) -> Vec<[u32; 3]> {
        (0..self.rows).map(|i| [0, 1, 2].map(|j| self.get(i, j))).collect()
    }
}

#[cold]
fn not_three(columns: usize, name: &str) -> Failure {
    Failure::argument(format!("{name} has {columns} columns: it must have 3"))
}
