//! The answers at many q.

use std::fmt;

use wasm_bindgen::prelude::*;

use crate::arrays::LengthError;

/// The pairs of triangles that collide at each of n configurations.
#[wasm_bindgen]
pub struct Batch {
    offsets: Vec<u32>,
    pairs: Vec<u32>,
}

/// The reason why a batch has no answers.
#[derive(Debug)]
pub enum BatchError {
    /// The length of the array is not a multiple of the number of modes.
    Length(LengthError),
    /// A row is not a configuration of the model.
    Row(usize, sscc::Error),
}

impl fmt::Display for BatchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(error) => error.fmt(f),
            Self::Row(row, error) => write!(f, "q number {row} of the batch: {error}"),
        }
    }
}

impl std::error::Error for BatchError {}

impl Batch {
    /// Returns the answers of a query at configurations of `rank` numbers each.
    ///
    /// # Errors
    /// When the length of the array is not a multiple of `rank`; else the error of the first q that has one.
    pub(crate) fn answer(query: &mut sscc::Query, rank: usize, numbers: &[f64]) -> Result<Self, BatchError> {
        if !numbers.len().is_multiple_of(rank) {
            return Err(BatchError::Length(LengthError { name: "rows", length: numbers.len(), row: rank }));
        }
        let mut offsets = Vec::with_capacity(numbers.len() / rank + 1);
        offsets.push(0);
        let mut pairs = Vec::new();
        for (row, q) in numbers.chunks_exact(rank).enumerate() {
            let found = query.discrete(q).map_err(|error| BatchError::Row(row, error))?;
            pairs.extend(found.iter().flat_map(|&(a, b)| [a, b]));
            // Each pair has 8 bytes, so the memory is used up before 32 bits overflow.
            offsets.push((pairs.len() / 2) as u32);
        }
        Ok(Self { offsets, pairs })
    }
}

#[wasm_bindgen]
impl Batch {
    /// The number of configurations, n.
    #[wasm_bindgen(getter)]
    pub fn count(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The pairs of all configurations, sorted for each configuration, with 2 triangle numbers for each pair.
    #[wasm_bindgen(getter)]
    pub fn pairs(&self) -> Vec<u32> {
        self.pairs.clone()
    }

    /// The start of the pairs of each configuration, then the end (n + 1 numbers): the pairs of configuration i are
    /// `pairs.subarray(2 * offsets[i], 2 * offsets[i + 1])`.
    #[wasm_bindgen(getter)]
    pub fn offsets(&self) -> Vec<u32> {
        self.offsets.clone()
    }
}
