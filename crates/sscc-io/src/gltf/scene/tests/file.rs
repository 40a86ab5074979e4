//! A small valid file, and copies with changes.

use glam::{DMat4, DQuat, DVec3};

use crate::gltf::{AnimatedScene, SkinWeights, parse_scene};

/// Two triangles with a morph target and two joints. Node 3 shows them with the skin, node 4 without.
pub const JSON: &str = r#"{
 "asset":{"version":"2.0"},
 "buffers":[{"byteLength":512}],
 "bufferViews":[
  {"buffer":0,"byteOffset":0,"byteLength":48},
  {"buffer":0,"byteOffset":48,"byteLength":48},
  {"buffer":0,"byteOffset":96,"byteLength":16},
  {"buffer":0,"byteOffset":112,"byteLength":64},
  {"buffer":0,"byteOffset":176,"byteLength":128},
  {"buffer":0,"byteOffset":304,"byteLength":12},
  {"buffer":0,"byteOffset":316,"byteLength":36},
  {"buffer":0,"byteOffset":352,"byteLength":48},
  {"buffer":0,"byteOffset":400,"byteLength":108}],
 "accessors":[
  {"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
  {"bufferView":1,"componentType":5126,"count":4,"type":"VEC3"},
  {"bufferView":2,"componentType":5121,"count":4,"type":"VEC4"},
  {"bufferView":3,"componentType":5126,"count":4,"type":"VEC4"},
  {"bufferView":4,"componentType":5126,"count":2,"type":"MAT4"},
  {"bufferView":5,"componentType":5126,"count":3,"type":"SCALAR"},
  {"bufferView":6,"componentType":5126,"count":3,"type":"VEC3"},
  {"bufferView":7,"componentType":5126,"count":3,"type":"VEC4"},
  {"bufferView":8,"componentType":5126,"count":9,"type":"VEC3"},
  {"bufferView":5,"componentType":5126,"count":3,"type":"SCALAR"}],
 "meshes":[{"name":"flag","primitives":[
  {"attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3,"NORMAL":"x"},"mode":5,"targets":[{"POSITION":1}]},
  {"attributes":{},"mode":1}]}],
 "skins":[{"joints":[1,2],"inverseBindMatrices":4,"skeleton":77}],
 "nodes":[
  {"name":"root","children":[1],"translation":[0,0,10]},
  {"children":[2],"rotation":[0,0,1,0]},
  {"translation":[0,0,2],"scale":[1,2,1]},
  {"name":"skinned","mesh":0,"skin":0,"translation":[100,0,0]},
  {"mesh":0,"scale":[-1,1,1],"translation":[0,0,5],"weights":[0.5]}],
 "animations":[{"name":"wave","channels":[
  {"sampler":0,"target":{"node":0,"path":"translation"}},
  {"sampler":1,"target":{"node":1,"path":"rotation"}},
  {"sampler":2,"target":{"node":2,"path":"scale"}},
  {"sampler":3,"target":{"node":3,"path":"weights"}},
  {"sampler":0,"target":{"path":"pointer","extensions":{}}}],
 "samplers":[
  {"input":5,"output":6,"interpolation":"STEP"},
  {"input":5,"output":7},
  {"input":5,"output":8,"interpolation":"CUBICSPLINE"},
  {"input":5,"output":9,"interpolation":"LINEAR"}]}]
}"#;

pub const REST: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, -0.0]];
pub const TARGET: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
pub const JOINTS: [[u8; 4]; 4] = [[0, 0, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0], [1, 0, 1, 0]];
pub const WEIGHTS: [[f32; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.25, 0.75, 0.0, 0.0], [0.75, 0.25, 0.0, 0.0]];
pub const TIMES: [f32; 3] = [1.0, 2.0, 4.0];

pub fn binary() -> Vec<u8> {
    let floats = |values: &[f32]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let translate =
        |x: f64| DMat4::from_translation(DVec3::new(x, 0.0, 0.0)).to_cols_array().map(|x| x as f32);
    let tangent = [0.0; 3];
    let keys = [[1.0, 2.0, 1.0], [3.0, 2.0, 1.0], [1.0, 0.0, 1.0]].map(|scale| [tangent, scale, tangent]);
    let mut bytes = [
        floats(REST.as_flattened()),
        floats(TARGET.as_flattened()),
        JOINTS.concat(),
        floats(WEIGHTS.as_flattened()),
        floats(&[translate(0.0), translate(-1.0)].concat()),
        floats(&TIMES),
        floats(&[0.0, 0.0, 10.0, 0.0, 0.0, 20.0, 0.0, 0.0, 40.0]),
        floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0]),
        floats(keys.as_flattened().as_flattened()),
    ]
    .concat();
    bytes.resize(512, 0);
    bytes
}

pub fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let size = |n: usize| (n as u32).to_le_bytes();
    let total = size(12 + 8 + json.len() + 8 + binary.len());
    let (first, second) = (size(json.len()), size(binary.len()));
    [b"glTF", &size(2)[..], &total, &first, b"JSON", &json, &second, b"BIN\0", binary].concat()
}

/// The valid file with changes.
pub fn changed(changes: &[(&str, &str)]) -> Vec<u8> {
    let mut json = JSON.to_owned();
    for (from, to) in changes {
        assert_eq!(json.matches(from).count(), 1, "{from}");
        json = json.replace(from, to);
    }
    glb(&json, &binary())
}

pub fn scene(changes: &[(&str, &str)]) -> AnimatedScene {
    parse_scene(&changed(changes)).unwrap()
}

pub fn positions(scene: &AnimatedScene, node: usize, time: Option<f64>) -> Vec<DVec3> {
    let mut positions = vec![DVec3::NAN; 9];
    let animation = time.map(|_| 0);
    scene.positions(node, animation, time.unwrap_or(0.0), SkinWeights::AsStored, &mut positions).unwrap();
    positions
}

pub fn assert_close(found: &[DVec3], expected: &[DVec3]) {
    assert_eq!(found.len(), expected.len());
    for (v, (x, y)) in found.iter().zip(expected).enumerate() {
        assert!(x.distance(*y) < 1e-6, "vertex {v}: {x} instead of {y}");
    }
}

/// Positions of the skinned node for the state of its nodes, by the definition.
pub fn skinned(height: f64, rotation: DQuat, scale: DVec3, weight: f64) -> Vec<DVec3> {
    let wide = |x: [f32; 3]| DVec3::from_array(x.map(f64::from));
    let first = DMat4::from_translation(DVec3::Z * height) * DMat4::from_quat(rotation);
    let second = first * DMat4::from_translation(DVec3::Z * 2.0) * DMat4::from_scale(scale);
    let joints = [first, second * DMat4::from_translation(-DVec3::X)];
    (0..4)
        .map(|v| {
            let x = wide(REST[v]) + wide(TARGET[v]) * weight;
            (0..4)
                .map(|i| joints[usize::from(JOINTS[v][i])].transform_point3(x) * f64::from(WEIGHTS[v][i]))
                .sum()
        })
        .collect()
}
