//! Certificates of a model.

use sscc_io::container;
use wasm_bindgen::prelude::*;

use crate::arrays::numbers;

/// Radii in q-space within which parts of a shape cannot collide with each other. They hold for exactly one model.
#[wasm_bindgen]
pub struct Certificates(pub(crate) sscc::Certificates);

#[wasm_bindgen]
impl Certificates {
    /// Reads certificates from the bytes of a `.sscc.safetensors` file.
    pub fn load(bytes: &[u8]) -> Result<Certificates, JsError> {
        Ok(Self(container::certificates_from_bytes(bytes)?))
    }

    /// Returns the bytes of a `.sscc.safetensors` file, the same as those of `sscc certify`.
    #[wasm_bindgen(js_name = toBytes)]
    pub fn to_bytes(&self) -> Result<Vec<u8>, JsError> {
        Ok(container::certificates_to_bytes(&self.0)?)
    }

    /// The norm |z| below which the whole shape is proven free, apart from the exceptions. If the certificates have a
    /// clearance, the shape keeps it below this norm, but triangles within the rings may collide.
    #[wasm_bindgen(getter, js_name = rootRadius)]
    pub fn root_radius(&self) -> f64 {
        self.0.root_radius()
    }

    /// The norm |z| at which radii are capped.
    #[wasm_bindgen(getter, js_name = globalRadius)]
    pub fn global_radius(&self) -> f64 {
        self.0.global_radius()
    }

    /// The pairs that collide at the centre, or are nearer than the clearance there; no radius covers them, and every
    /// query tests them (2 triangle numbers for each).
    #[wasm_bindgen(getter)]
    pub fn exceptions(&self) -> Vec<u32> {
        numbers(self.0.exceptions())
    }

    /// Returns the norm |z| of q in the metric of the certificates, rounded up.
    pub fn norm(&self, q: &[f64]) -> Result<f64, JsError> {
        Ok(self.0.norm(q)?)
    }
}
