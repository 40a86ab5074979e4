//! The cost of an answer.

use wasm_bindgen::prelude::*;

/// The cost of the last answer of a query or a detector.
#[wasm_bindgen]
pub struct Statistics(sscc::Statistics);

impl From<sscc::Statistics> for Statistics {
    fn from(statistics: sscc::Statistics) -> Self {
        Self(statistics)
    }
}

#[wasm_bindgen]
impl Statistics {
    /// |z|, rounded up, in the metric and about the centre of the certificates; for a continuous query the larger one
    /// of start and end; 0 for a detector.
    #[wasm_bindgen(getter)]
    pub fn norm(&self) -> f64 {
        self.0.norm
    }

    /// Whether the root's certificate alone proved the shape free, apart from exceptions.
    #[wasm_bindgen(getter, js_name = rootCertified)]
    pub fn root_certified(&self) -> bool {
        self.0.root_certified
    }

    /// The kind of proof of the answer, apart from exceptions.
    #[wasm_bindgen(getter, unchecked_return_type = "\"radius\" | \"local\" | \"search\"")]
    pub fn proof(&self) -> String {
        let name: &'static str = self.0.proof.into();
        name.to_owned()
    }

    /// Whether all pairs are listed; false if a limit or an error ended the search.
    #[wasm_bindgen(getter)]
    pub fn complete(&self) -> bool {
        self.0.complete
    }

    /// Nodes and node pairs that were opened.
    #[wasm_bindgen(getter)]
    pub fn opened(&self) -> f64 {
        self.0.opened as f64
    }

    /// Pairs of boxes compared.
    #[wasm_bindgen(getter, js_name = boxTests)]
    pub fn box_tests(&self) -> f64 {
        self.0.box_tests as f64
    }

    /// Pairs of triangles tested exactly.
    #[wasm_bindgen(getter, js_name = triangleTests)]
    pub fn triangle_tests(&self) -> f64 {
        self.0.triangle_tests as f64
    }
}
