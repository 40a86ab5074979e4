//! The default filter depends on the format of the mesh: detectors and certificates weld vertices of formats that split them.

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;
use sscc::parts::Scope;
use sscc::{
    Certificates, CertifyOptions, ContactFilter, Detector, Method, Neighbours, Pair, Query, ReducedModel,
    TriMesh,
};
use sscc_io::{LoadOptions, load_mesh, load_model_with, write_npy};

/// A square of two triangles, each with vertices of its own, and a triangle that crosses the first of them.
const CORNERS: [[f32; 3]; 9] = [
    [0.0, 0.0, 0.0],
    [4.0, 0.0, 0.0],
    [0.0, 4.0, 0.0],
    [4.0, 0.0, 0.0],
    [4.0, 4.0, 0.0],
    [0.0, 4.0, 0.0],
    [1.0, 1.0, -1.0],
    [1.5, 1.0, -1.0],
    [1.0, 1.0, 1.0],
];

/// The colliding pairs without welding: that of the seam, and the true one.
const UNWELDED: [Pair; 2] = [(0, 1), (0, 2)];

/// The colliding pair with welding.
const WELDED: [Pair; 1] = [(0, 2)];

fn text_stl() -> String {
    let facet = |corners: &[[f32; 3]]| {
        let vertices: String = corners.iter().map(|[x, y, z]| format!("vertex {x} {y} {z}\n")).collect();
        format!("facet normal 0 0 1\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    format!("solid\n{}endsolid\n", CORNERS.chunks(3).map(facet).collect::<String>())
}

fn obj() -> String {
    let vertices: String = CORNERS.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    format!("{vertices}f 1 2 3\nf 4 5 6\nf 7 8 9\n")
}

/// Returns a glTF file with one morph target, which lifts the last triangle by 1.
fn gltf() -> String {
    let lifted = (0..9).flat_map(|v| [0.0, 0.0, if v < 6 { 0.0 } else { 4.0 }]);
    let floats = CORNERS.iter().flatten().copied().chain(lifted);
    let bytes: Vec<u8> = floats.flat_map(f32::to_le_bytes).collect();
    let accessor = |view: usize| json!({"bufferView": view, "componentType": 5126, "count": 9, "type": "VEC3", "min": [0, 0, -1], "max": [4, 4, 4]});
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"name": "Square", "primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}]}]}],
        "accessors": [accessor(0), accessor(1)],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 108},
            {"buffer": 0, "byteOffset": 108, "byteLength": 108}
        ],
        "buffers": [{"byteLength": 216, "uri": format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes))}]
    })
    .to_string()
}

fn detected(mesh: &TriMesh) -> Vec<Pair> {
    Detector::new(mesh).discrete(mesh.rest_positions()).unwrap().to_vec()
}

/// Returns the exceptions of default certificates, which are the pairs that collide at rest, and the pairs that a search
/// without certificates finds there.
fn of_model(model: &ReducedModel) -> [Vec<Pair>; 2] {
    let certificates = Certificates::compute(model, &CertifyOptions::default(), &()).unwrap();
    let mut query = Query::without_certificates(model, Scope::of(model), Method::BruteForce).unwrap();
    [certificates.exceptions().to_vec(), query.discrete(&vec![0.0; model.rank()]).unwrap().to_vec()]
}

fn model(folder: &Path, mesh: &str) -> ReducedModel {
    let modes = folder.join("modes.npy");
    let own = mesh.ends_with("gltf");
    let options = LoadOptions::new((!own).then_some(modes.as_path()), None);
    load_model_with(&folder.join(mesh), &options).unwrap().model
}

#[test]
fn detectors_and_certificates_weld_vertices_that_a_format_splits() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("a.stl"), text_stl()).unwrap();
    fs::write(folder.join("a.gltf"), gltf()).unwrap();
    fs::write(folder.join("a.obj"), obj()).unwrap();
    let lift: Vec<f64> = (0..27).map(|row| if row >= 18 && row % 3 == 2 { 4.0 } else { 0.0 }).collect();
    write_npy(&folder.join("modes.npy"), &[27, 1], &lift).unwrap();
    for (file, expected) in [("a.stl", &WELDED[..]), ("a.gltf", &WELDED), ("a.obj", &UNWELDED)] {
        let mesh = load_mesh(&folder.join(file), None).unwrap();
        let default = ContactFilter::of(&mesh);
        assert_eq!((default.weld, default.neighbours), (file != "a.obj", Neighbours::Exclude), "{file}");
        assert_eq!(detected(&mesh), expected, "{file}");
        // The default is the same for the mesh at other positions, and in a model.
        let moved = mesh.rest_positions().iter().map(|p| *p * 2.0).collect();
        assert_eq!(detected(&mesh.with_rest_positions(moved).unwrap()), expected, "{file}");
        let model = model(folder, file);
        assert_eq!(of_model(&model), [expected, expected], "{file}");
        // Options override the default.
        for (weld, expected) in [(false, &UNWELDED[..]), (true, &WELDED)] {
            let filter = ContactFilter::new(Neighbours::Exclude).weld(weld);
            let mut detector = Detector::with_filter(&mesh, &filter).unwrap();
            assert_eq!(detector.discrete(mesh.rest_positions()).unwrap(), expected, "{file} {weld}");
            let options = CertifyOptions::default().filter(filter);
            let certificates = Certificates::compute(&model, &options, &()).unwrap();
            assert_eq!((certificates.exceptions(), certificates.filter().weld), (expected, weld), "{file}");
        }
    }
}
