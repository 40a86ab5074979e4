//! `sscc.KineticQuery`: queries for sequences of q with small steps.

use std::sync::Arc;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use sscc::Error;
use sscc_tasks::text::counted;

use crate::answer::Answer;
use crate::arrays::vector;
use crate::errors::refused;
use crate::interrupt::answer;
use crate::pool::{Kinetic, Pool};

#[pyclass(frozen, module = "sscc", name = "KineticQuery")]
pub struct KineticQuery {
    kinetic: Kinetic,
}

impl KineticQuery {
    pub fn of(pool: Arc<Pool>) -> Result<Self, Error> {
        Ok(Self { kinetic: Kinetic::of(pool)? })
    }
}

#[pymethods]
impl KineticQuery {
    fn check(&self, py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<Answer> {
        let q = vector(q, "q")?;
        let found = answer(py, || {
            self.kinetic.with_query(|query| {
                let pairs = query.discrete(&q)?.to_vec();
                Ok(Answer::of(pairs, query.statistics()))
            })
        })?;
        let found = found.ok_or_else(|| {
            PyRuntimeError::new_err(
                "this KineticQuery is already in a call: create another one by certs.kinetic()",
            )
        })?;
        found.map_err(|error: Error| refused(&error, "q"))
    }

    fn __repr__(&self) -> String {
        let model = &self.kinetic.pool.certified.loaded.model;
        let (triangles, rank) = (model.mesh().faces().len() as u64, model.rank() as u64);
        format!("<sscc.KineticQuery: {}, {}>", counted(triangles, "triangle"), counted(rank, "mode"))
    }
}
