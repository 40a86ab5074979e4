//! Models: a mesh and its modes.

use sscc::{Modes, ReducedModel, TriMesh};
use sscc_io::{ModelInfo, container, gltf};
use wasm_bindgen::prelude::*;

use crate::arrays::{coordinates, points, triangles};
use crate::certificates::Certificates;
use crate::options::{Options, json};

/// A triangle mesh and its deformation modes: at q the vertices are at `positions + modes q`.
#[wasm_bindgen]
pub struct Model {
    pub(crate) model: ReducedModel,
    info: ModelInfo,
    mode_names: Vec<String>,
    default_q: Option<Vec<f64>>,
}

#[wasm_bindgen]
impl Model {
    /// Creates a model of V vertices, F triangles and r modes. `positions`: 3 coordinates for each vertex. `faces`: 3 vertex numbers for
    /// each triangle. `modes`: the matrix of 3V rows and r columns, row by row.
    #[wasm_bindgen(constructor)]
    pub fn new(
        positions: &[f64],
        #[wasm_bindgen(unchecked_param_type = "Uint32Array | number[]")] faces: &[f64],
        modes: &[f64],
    ) -> Result<Model, JsError> {
        let mesh = TriMesh::new(points("positions", positions)?, triangles(faces)?)?;
        let (rows, vertices) = (positions.len(), mesh.rest_positions().len());
        let rank = modes.len().checked_div(rows).unwrap_or(0);
        if rank * rows != modes.len() {
            let found = modes.len();
            return Err(JsError::new(&format!(
                "modes has {found} numbers; their number must be a multiple of 3V = {rows}"
            )));
        }
        let modes = Modes::from_matrix(vertices, rank, |row, mode| modes[row * rank + mode])?;
        let info = ModelInfo::new("", "arrays of JavaScript");
        Ok(Self { model: ReducedModel::new(mesh, modes)?, info, mode_names: Vec::new(), default_q: None })
    }

    /// Reads a model from the bytes of a `.model.safetensors` file, or of a glTF file (`.glb`, `.gltf`, `.vrm`) with morph targets
    /// and all of its buffers. `meshName` names the mesh of a glTF file where several have morph targets.
    pub fn load(
        bytes: &[u8],
        #[wasm_bindgen(js_name = meshName)] mesh_name: Option<String>,
    ) -> Result<Model, JsError> {
        if !is_gltf(bytes) {
            if mesh_name.is_some() {
                return Err(JsError::new("meshName is for glTF files: leave it out"));
            }
            let (model, info) = container::model_from_bytes(bytes)?;
            return Ok(Self { model, info, mode_names: Vec::new(), default_q: None });
        }
        let read = gltf::parse(bytes, mesh_name.as_deref())?;
        let info = ModelInfo::new("", format!("mesh {:?} of a glTF file", read.mesh_name));
        let model = ReducedModel::new(read.mesh, read.modes)?;
        Ok(Self { model, info, mode_names: read.target_names, default_q: Some(read.default_weights) })
    }

    /// Returns the bytes of a `.model.safetensors` file, which `sscc` reads.
    #[wasm_bindgen(js_name = toBytes)]
    pub fn to_bytes(&self) -> Result<Vec<u8>, JsError> {
        Ok(container::model_to_bytes(&self.model, &self.info)?)
    }

    /// Computes certificates. This takes seconds for ten thousand triangles: in a page, call it in a worker.
    pub fn certify(
        &self,
        #[wasm_bindgen(unchecked_optional_param_type = "CertifyOptions")] options: JsValue,
    ) -> Result<Certificates, JsError> {
        let options = Options::parse(json(&options)?.as_deref())?.for_mesh(self.model.mesh())?;
        Ok(Certificates(sscc::Certificates::compute(&self.model, &options, &())?))
    }

    /// The number of triangles, F.
    #[wasm_bindgen(getter, js_name = triangleCount)]
    pub fn triangle_count(&self) -> usize {
        self.model.mesh().faces().len()
    }

    /// The number of vertices, V.
    #[wasm_bindgen(getter, js_name = vertexCount)]
    pub fn vertex_count(&self) -> usize {
        self.model.mesh().rest_positions().len()
    }

    /// The number of modes, r.
    #[wasm_bindgen(getter)]
    pub fn rank(&self) -> usize {
        self.model.rank()
    }

    /// The names of morph targets (r); an empty array if the model is not of a glTF file.
    #[wasm_bindgen(getter, js_name = modeNames)]
    pub fn mode_names(&self) -> Vec<String> {
        self.mode_names.clone()
    }

    /// The weights at which a glTF file shows the model (r numbers); `undefined` for other models.
    #[wasm_bindgen(getter, js_name = defaultQ)]
    pub fn default_q(&self) -> Option<Vec<f64>> {
        self.default_q.clone()
    }

    /// 3 vertex numbers for each triangle (3F).
    #[wasm_bindgen(getter)]
    pub fn faces(&self) -> Vec<u32> {
        self.model.mesh().faces().as_flattened().to_vec()
    }

    /// Returns the coordinates of all vertices at q (3V). The answers of queries refer to these numbers, bit for bit.
    pub fn positions(&self, q: &[f64]) -> Result<Vec<f64>, JsError> {
        Ok(coordinates(&self.model.positions(q)?))
    }
}

/// Whether bytes are a glTF file (binary, or JSON). Other files (`.safetensors`) begin with a number of 8 bytes.
fn is_gltf(bytes: &[u8]) -> bool {
    let is_container = bytes.get(8) == Some(&b'{');
    bytes.starts_with(b"glTF") || (!is_container && bytes.trim_ascii_start().starts_with(b"{"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two() -> Model {
        let positions =
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0];
        let modes: Vec<f64> = (0..18).map(|row| f64::from(u8::from(row >= 9 && row % 3 == 2))).collect();
        Model::new(&positions, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0], &modes).ok().unwrap()
    }

    #[test]
    fn containers_and_gltf_files_are_distinguished() {
        let bytes = two().to_bytes().ok().unwrap();
        assert!(!is_gltf(&bytes) && !is_gltf(b"") && !is_gltf(b"solid"));
        assert!(is_gltf(b"glTF\x02\0\0\0{") && is_gltf(b" \n{\"asset\":{}}"));
        assert_eq!(Model::load(&bytes, None).ok().unwrap().positions(&[0.5]).ok().unwrap()[11], 1.5);
    }

    #[test]
    fn modes_are_columns() {
        let model = two();
        assert_eq!((model.rank(), model.vertex_count(), model.triangle_count()), (1, 6, 2));
        assert_eq!(model.positions(&[-1.0]).ok().unwrap()[9..12], [0.0, 0.0, 0.0]);
    }
}
