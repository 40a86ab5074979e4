//! Pairs of continuous queries, with their times.

use sscc::Impact;
use wasm_bindgen::prelude::*;

/// The pairs of triangles that collide during a motion.
#[wasm_bindgen]
pub struct Impacts(Vec<Impact>);

impl From<&[Impact]> for Impacts {
    fn from(impacts: &[Impact]) -> Self {
        Self(impacts.to_vec())
    }
}

#[wasm_bindgen]
impl Impacts {
    /// The number of pairs, n.
    #[wasm_bindgen(getter)]
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The pairs, sorted, the lower triangle number of each first (2n).
    #[wasm_bindgen(getter)]
    pub fn pairs(&self) -> Vec<u32> {
        self.0.iter().flat_map(|impact| [impact.pair.0, impact.pair.1]).collect()
    }

    /// The time of impact of each pair, from 0 to 1, never later than the true one (n).
    #[wasm_bindgen(getter)]
    pub fn times(&self) -> Vec<f64> {
        self.0.iter().map(|impact| impact.time).collect()
    }
}
