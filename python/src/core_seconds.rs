//! The cost of queries without Python, for `python/benches/`.

use std::time::Instant;

use pyo3::prelude::*;

use crate::arrays::floats;
use crate::batch::{entries, rows};
use crate::certificates::Certificates;
use crate::errors::refused;

/// Returns the time (s) of the core for the rows of Q: as one batch, and, if `one_by_one`, for each row as a single
/// query.
#[pyfunction]
#[pyo3(signature = (certificates, Q, threads, one_by_one=true))]
#[allow(non_snake_case)]
pub fn _core_seconds(
    py: Python<'_>,
    certificates: &Certificates,
    Q: &Bound<'_, PyAny>,
    threads: Option<usize>,
    one_by_one: bool,
) -> PyResult<(f64, Vec<f64>)> {
    let pool = &certificates.pool;
    let rank = pool.certified.loaded.model.rank();
    let entries = entries(&floats(Q, "Q")?, rank)?;
    let rows = rows(&entries, rank)?;
    let measured = py.detach(|| {
        let start = Instant::now();
        pool.first().batch(&rows, threads, &())?;
        let batch = start.elapsed().as_secs_f64();
        let mut query = pool.first().clone();
        let mut single = Vec::with_capacity(rows.len());
        for q in rows.iter().filter(|_| one_by_one) {
            let start = Instant::now();
            query.discrete(q)?;
            single.push(start.elapsed().as_secs_f64());
        }
        Ok((batch, single))
    });
    measured.map_err(|error: sscc::Error| refused(&error, "Q"))
}
