//! Collisions of any mesh at given positions.

use sscc::TriMesh;
use wasm_bindgen::prelude::*;

use crate::arrays::{self, numbers, points, triangles};
use crate::impacts::Impacts;
use crate::options::{Options, json};
use crate::statistics::Statistics;

/// Answers which triangles of a deforming mesh collide, without modes.
#[wasm_bindgen]
pub struct Detector(sscc::Detector);

#[wasm_bindgen]
impl Detector {
    /// Creates a detector. `positions`: 3 coordinates for each vertex, in any pose; they determine the hierarchy and,
    /// with the option `weld`, which vertices are welded. `faces`: 3 vertex numbers for each triangle.
    #[wasm_bindgen(constructor)]
    pub fn new(
        positions: &[f64],
        #[wasm_bindgen(unchecked_param_type = "Uint32Array | number[]")] faces: &[f64],
        #[wasm_bindgen(unchecked_optional_param_type = "FilterOptions")] options: JsValue,
    ) -> Result<Detector, JsError> {
        let mesh = TriMesh::new(points("positions", positions)?, triangles(faces)?)?;
        let filter = Options::parse(json(&options)?.as_deref())?.filter_alone(&mesh)?;
        Ok(Self(sscc::Detector::with_filter(&mesh, &filter)?))
    }

    /// Returns all colliding pairs at these positions (3V numbers), sorted, 2 triangle numbers for each. If there are none, the mesh is
    /// proven free.
    pub fn discrete(&mut self, positions: &[f64]) -> Result<Vec<u32>, JsError> {
        Ok(numbers(self.0.discrete(&points("positions", positions)?)?))
    }

    /// Returns at most `limit` of the pairs, or all without a limit; which ones is not fixed. `statistics.complete` is
    /// false if the limit ended the search.
    #[wasm_bindgen(js_name = discreteAtMost)]
    pub fn discrete_at_most(&mut self, positions: &[f64], limit: Option<f64>) -> Result<Vec<u32>, JsError> {
        Ok(numbers(self.0.discrete_at_most(&points("positions", positions)?, arrays::limit(limit)?)?))
    }

    /// Returns the pairs that collide while all vertices move on straight lines from `x0` to `x1`.
    pub fn continuous(&mut self, x0: &[f64], x1: &[f64]) -> Result<Impacts, JsError> {
        Ok(self.0.continuous(&points("x0", x0)?, &points("x1", x1)?)?.into())
    }

    /// The cost of the last answer.
    #[wasm_bindgen(getter)]
    pub fn statistics(&self) -> Statistics {
        self.0.statistics().into()
    }
}
