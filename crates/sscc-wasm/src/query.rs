//! Queries at q and between two q.

use wasm_bindgen::prelude::*;

use crate::arrays::{self, numbers};
use crate::batch::Batch;
use crate::certificates::Certificates;
use crate::impacts::Impacts;
use crate::model::Model;
use crate::statistics::Statistics;

/// Answers which triangles of a model collide. It shares the model and its certificates, which may be freed.
#[wasm_bindgen]
pub struct Query {
    query: sscc::Query,
    /// The memory to which `queries.js` writes q (r numbers).
    q: Vec<f64>,
    /// The memory from which `queries.js` reads pairs.
    pairs: Vec<u32>,
}

#[wasm_bindgen]
impl Query {
    /// Creates a query. Certificates of another model are refused.
    #[wasm_bindgen(constructor)]
    pub fn new(model: &Model, certificates: &Certificates) -> Result<Query, JsError> {
        let query = sscc::Query::new(&model.model, &certificates.0)?;
        Ok(Self { query, q: vec![0.0; model.model.rank()], pairs: Vec::new() })
    }

    /// Returns all colliding pairs at q (r numbers), sorted, 2 triangle numbers for each. If there are none, the shape is proven free.
    pub fn discrete(&mut self, q: &[f64]) -> Result<Vec<u32>, JsError> {
        Ok(numbers(self.query.discrete(q)?))
    }

    /// Returns at most `limit` of the pairs, or all without a limit; which ones is not fixed. `statistics.complete` is
    /// false if the limit ended the search.
    #[wasm_bindgen(js_name = discreteAtMost)]
    pub fn discrete_at_most(&mut self, q: &[f64], limit: Option<f64>) -> Result<Vec<u32>, JsError> {
        Ok(numbers(self.query.discrete_at_most(q, arrays::limit(limit)?)?))
    }

    /// Whether any pair collides at q.
    #[wasm_bindgen(js_name = isColliding)]
    pub fn is_colliding(&mut self, q: &[f64]) -> Result<bool, JsError> {
        Ok(self.query.first(q)?.is_some())
    }

    /// Returns the number of colliding pairs at q.
    pub fn count(&mut self, q: &[f64]) -> Result<usize, JsError> {
        Ok(self.query.count(q)?)
    }

    /// Returns all colliding pairs at each of n configurations (an array of n r numbers, one q after the other). One
    /// call is faster than n calls. The statistics are then those of the last q. The error is that of the first q that
    /// has one.
    pub fn batch(&mut self, rows: &[f64]) -> Result<Batch, JsError> {
        Ok(Batch::answer(&mut self.query, self.q.len(), rows)?)
    }

    /// Returns the pairs that collide while all vertices move on straight lines from their positions at `q0` to those
    /// at `q1`.
    pub fn continuous(&mut self, q0: &[f64], q1: &[f64]) -> Result<Impacts, JsError> {
        Ok(self.query.continuous(q0, q1)?.into())
    }

    /// Returns a scale s such that the shape is proven free at `centre + t (q - centre)` for all t from 0 to s. It is 0
    /// if the shape collides at the centre, and infinite if no vertex moves.
    #[wasm_bindgen(js_name = safeScale)]
    pub fn safe_scale(&mut self, q: &[f64]) -> Result<f64, JsError> {
        Ok(self.query.safe_scale(q)?)
    }

    /// The cost of the last answer.
    #[wasm_bindgen(getter)]
    pub fn statistics(&self) -> Statistics {
        self.query.statistics().into()
    }

    // `queries.js` calls the following functions, to avoid copies.

    /// Returns the address at which [`Self::find`] reads q; null if q does not have this length.
    #[wasm_bindgen(js_name = addressOfQ, skip_typescript)]
    pub fn address_of_q(&mut self, length: usize) -> *mut f64 {
        if length == self.q.len() { self.q.as_mut_ptr() } else { std::ptr::null_mut() }
    }

    /// Returns the number of colliding pairs, at most `limit`, at the q that was written; -1 on an error.
    #[wasm_bindgen(skip_typescript)]
    pub fn find(&mut self, limit: usize) -> i32 {
        // An answer has fewer than 2^31 pairs, because the memory is used up before.
        self.query.discrete_at_most(&self.q, limit).map_or(-1, |pairs| pairs.len() as i32)
    }

    /// Returns the address of the pairs of the last answer (2 triangle numbers for each).
    #[wasm_bindgen(js_name = addressOfPairs, skip_typescript)]
    pub fn address_of_pairs(&mut self) -> *const u32 {
        self.pairs.clear();
        self.pairs.extend(self.query.pairs().iter().flat_map(|&(a, b)| [a, b]));
        self.pairs.as_ptr()
    }
}
