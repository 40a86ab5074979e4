//! Queries at q and between two q.

use wasm_bindgen::prelude::*;

use crate::arrays::{self, numbers};
use crate::certificates::Certificates;
use crate::impacts::Impacts;
use crate::model::Model;
use crate::statistics::Statistics;

/// Answers which triangles of a model collide. It shares the model and its certificates, which may be freed.
#[wasm_bindgen]
pub struct Query(sscc::Query);

#[wasm_bindgen]
impl Query {
    /// Makes a query. Certificates of another model are refused.
    #[wasm_bindgen(constructor)]
    pub fn new(model: &Model, certificates: &Certificates) -> Result<Query, JsError> {
        Ok(Self(sscc::Query::new(&model.model, &certificates.0)?))
    }

    /// All colliding pairs at q (r numbers), sorted, 2 triangle numbers for each. No pairs are a proof.
    pub fn discrete(&mut self, q: &[f64]) -> Result<Vec<u32>, JsError> {
        Ok(numbers(self.0.discrete(q)?))
    }

    /// At most so many of the pairs, all without a limit; which ones is not fixed. `statistics.complete` tells whether they are all.
    #[wasm_bindgen(js_name = discreteAtMost)]
    pub fn discrete_at_most(&mut self, q: &[f64], limit: Option<f64>) -> Result<Vec<u32>, JsError> {
        Ok(numbers(self.0.discrete_at_most(q, arrays::limit(limit)?)?))
    }

    /// Whether any pair collides at q.
    #[wasm_bindgen(js_name = isColliding)]
    pub fn is_colliding(&mut self, q: &[f64]) -> Result<bool, JsError> {
        Ok(self.0.first(q)?.is_some())
    }

    /// The number of colliding pairs at q.
    pub fn count(&mut self, q: &[f64]) -> Result<usize, JsError> {
        Ok(self.0.count(q)?)
    }

    /// The pairs that touch while all vertices move on straight lines from their positions at `q0` to those at `q1`.
    pub fn continuous(&mut self, q0: &[f64], q1: &[f64]) -> Result<Impacts, JsError> {
        Ok(self.0.continuous(q0, q1)?.into())
    }

    /// The largest certified s: `centre + t (q - centre)` is free for all t from 0 to s.
    #[wasm_bindgen(js_name = safeScale)]
    pub fn safe_scale(&mut self, q: &[f64]) -> Result<f64, JsError> {
        Ok(self.0.safe_scale(q)?)
    }

    /// What the last answer took.
    #[wasm_bindgen(getter)]
    pub fn statistics(&self) -> Statistics {
        self.0.statistics().into()
    }
}
