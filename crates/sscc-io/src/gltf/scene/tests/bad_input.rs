//! Bad files and requests: one line with the place and the cause.

use super::file::{JSON, binary, changed, glb, scene};
use crate::gltf::{SkinWeights, parse_scene};

/// Returns the error of reading a file, or else of evaluating its animation.
fn error(bytes: &[u8]) -> String {
    let evaluated = parse_scene(bytes).and_then(|scene| scene.pose(Some(0), 0.0).map(drop));
    evaluated.unwrap_err().to_string()
}

/// Returns the error for the valid file with one change.
fn with(from: &str, to: &str) -> String {
    error(&changed(&[(from, to)]))
}

/// Returns the error for the valid file with other bytes in the buffer.
fn with_bytes(at: usize, bytes: &[u8]) -> String {
    let mut binary = binary();
    binary[at..at + bytes.len()].copy_from_slice(bytes);
    error(&glb(JSON, &binary))
}

#[test]
fn bad_nodes_and_skins_are_rejected() {
    for (from, to, message) in [
        (r#""children":[2]"#, r#""children":[2,1]"#, "nodes[1]: it is a child of nodes[0] and of nodes[1]"),
        (r#""children":[2]"#, r#""children":[5]"#, "nodes[1]: its child nodes[5] does not exist"),
        (r#""translation":[0,0,2]"#, r#""children":[0]"#, "nodes[0]: its ancestors form a cycle"),
        (r#""rotation":[0,0,1,0]"#, r#""rotation":[0,0,0,0]"#, "nodes[1]: its rotation has length 0"),
        (r#""mesh":0,"skin":0"#, r#""mesh":1,"skin":0"#, "nodes[3]: meshes[1] does not exist"),
        (r#""mesh":0,"skin":0"#, r#""mesh":0,"skin":1"#, "nodes[3]: skins[1] does not exist"),
        (
            r#""joints":[1,2]"#,
            r#""joints":[1]"#,
            "nodes[3]: vertex 1 (counted from 0) of meshes[0] names joint 1, but skins[0] has 1",
        ),
        (r#""joints":[1,2]"#, r#""joints":[1,9]"#, "skins[0]: joint 1 is nodes[9], which does not exist"),
        (r#""joints":[1,2]"#, r#""joints":[]"#, "skins[0]: it has no joints"),
        (r#""joints":[1,2]"#, r#""joints":[1,2,0]"#, "skins[0]: 2 inverse bind matrices for 3 joints"),
        (
            r#""inverseBindMatrices":4"#,
            r#""inverseBindMatrices":3"#,
            "accessors[3]: inverse bind matrices must be MAT4 of float32",
        ),
        (
            r#""JOINTS_0":2,"#,
            "",
            "meshes[0].primitives[0]: a node shows it with a skin, but it has no JOINTS_0",
        ),
        (
            r#""WEIGHTS_0":3,"#,
            "",
            "meshes[0].primitives[0]: its attributes JOINTS_n and WEIGHTS_n do not have the same numbers n",
        ),
        (
            r#""JOINTS_0":2,"#,
            r#""JOINTS_0":3,"#,
            "accessors[3]: joints must be VEC4 of unsigned integers of 8 or 16 bits, not normalized",
        ),
        (
            r#""WEIGHTS_0":3,"#,
            r#""WEIGHTS_0":7,"#,
            "meshes[0].primitives[0]: WEIGHTS_0 has 3 items for 4 vertices",
        ),
    ] {
        assert_eq!(with(from, to), message);
    }
    let flat = with(r#""rotation":[0,0,1,0]"#, r#""matrix":[0,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]"#);
    assert!(flat.starts_with("nodes[1]: an animation moves it, but its matrix has an axis"), "{flat}");
    let matrix = with(r#""rotation":[0,0,1,0]"#, r#""matrix":[1,0]"#);
    assert!(matrix.starts_with("JSON: invalid length 2"), "{matrix}");
    assert!(with(r#""children":[2]"#, r#""children":[-1]"#).starts_with("JSON: "));
    // Numbers of the buffer.
    let negative = with_bytes(112, &(-0.5_f32).to_le_bytes());
    let message =
        "meshes[0].primitives[0]: joint 0 has the negative weight -0.5 at vertex 0 (counted from 0)";
    assert_eq!(negative, message);
    for (at, accessor, item) in
        [(112 + 20, 3, 1), (176 + 64, 4, 1), (304 + 4, 5, 1), (316, 6, 0), (400, 8, 0)]
    {
        for x in [f32::NAN, f32::INFINITY] {
            let message = with_bytes(at, &x.to_le_bytes());
            assert_eq!(message, format!("accessors[{accessor}]: item {item} (counted from 0) is not finite"));
        }
    }
    let message = with_bytes(4, &f32::NAN.to_le_bytes());
    assert_eq!(
        message,
        "meshes[0]: the position of vertex 0 (counted from 0) is not finite, or beyond 2^200"
    );
    let message = with_bytes(48 + 12, &f32::NAN.to_le_bytes());
    assert_eq!(message, "meshes[0]: target 0 of vertex 1 (counted from 0) is not finite, or beyond 2^200");
    // A joint that does not exist has no effect with weight 0.
    let mut unused = binary();
    unused[97] = 200;
    assert!(parse_scene(&glb(JSON, &unused)).is_ok());
}

#[test]
fn bad_animations_are_rejected() {
    let sampler = "animations[0].samplers";
    let channel = "animations[0].channels";
    let times = r#"{"bufferView":5,"componentType":5126,"count":3,"type":"SCALAR"},
  {"bufferView":6"#;
    for (from, to, message) in [
        (
            r#""interpolation":"STEP""#,
            r#""interpolation":"step""#,
            format!(
                "{sampler}[0]: the interpolation 'step' is unknown: STEP, LINEAR or CUBICSPLINE was expected"
            ),
        ),
        (
            r#""interpolation":"STEP""#,
            r#""interpolation":"CUBICSPLINE""#,
            format!("{sampler}[0]: its output has 3 items, but 3 key frames need 9"),
        ),
        (
            r#","interpolation":"CUBICSPLINE""#,
            "",
            format!("{sampler}[2]: its output has 9 items, but 3 key frames need 3"),
        ),
        (
            r#""output":9"#,
            r#""output":0"#,
            format!("{sampler}[3]: its output has 4 items, but 3 key frames need 3"),
        ),
        (r#""output":9"#, r#""output":99"#, "accessors[99]: there is no such accessor".into()),
        (
            r#""output":7"#,
            r#""output":6"#,
            "accessors[6]: rotations must be VEC4 of float32 (or of normalized integers of 8 or 16 bits)"
                .into(),
        ),
        (
            r#"{"input":5,"output":7}"#,
            r#"{"input":6,"output":7}"#,
            "accessors[6]: times of key frames must be SCALAR of float32".into(),
        ),
        (times, &times.replacen("3", "0", 1), format!("{sampler}[0]: it has no key frames")),
        (
            times,
            &times.replacen("3", "2", 1),
            format!("{sampler}[0]: its output has 3 items, but 2 key frames need 2"),
        ),
        (r#""sampler":1"#, r#""sampler":4"#, format!("{channel}[1]: samplers[4] does not exist")),
        (r#""node":1"#, r#""node":5"#, format!("{channel}[1]: nodes[5] does not exist")),
        (r#""node":3"#, r#""node":2"#, format!("{channel}[3]: nodes[2] has no morph targets")),
        (
            r#""path":"scale""#,
            r#""path":"visible""#,
            format!(
                "{channel}[2]: the path 'visible' is unknown: translation, rotation, scale or weights was expected"
            ),
        ),
        (
            r#"{"sampler":2,"target":{"node":2,"path":"scale"}}"#,
            r#"{"sampler":0,"target":{"node":0,"path":"translation"}}"#,
            "animations[0]: two channels move the same property of nodes[0]".into(),
        ),
    ] {
        assert_eq!(with(from, to), message);
    }
    assert!(with(r#","path":"scale""#, "").starts_with("JSON: missing field `path`"));
    let empty = glb(
        &(JSON[..JSON.find("\"channels\"").unwrap()].to_owned() + r#""channels":[],"samplers":[]}]}"#),
        &binary(),
    );
    let empty = parse_scene(&empty).unwrap();
    assert_eq!((empty.animations()[0].channels, empty.animations()[0].last_time), (0, 0.0));
    assert_eq!(empty.pose(Some(0), 0.0).err().unwrap().to_string(), "animations[0]: it has no key frames");
    assert!(empty.pose(None, 0.0).is_ok());
    let unsorted = with_bytes(304 + 8, &1.5_f32.to_le_bytes());
    assert_eq!(unsorted, format!("{sampler}[0]: the time of key frame 2 is before that of key frame 1"));
    assert_eq!(
        with_bytes(352 + 8, &[0; 4]),
        format!("{sampler}[1]: the rotation of key frame 0 has length 0")
    );
}

#[test]
fn bad_requests_are_rejected() {
    let scene = scene(&[]);
    let message = |node, animation, time| {
        let request = scene.positions(node, animation, time, SkinWeights::Normalized, &mut Vec::new());
        request.unwrap_err().to_string()
    };
    assert_eq!(message(2, None, 0.0), "nodes[2]: it shows no mesh with triangles, or does not exist");
    assert_eq!(message(99, None, 0.0), "nodes[99]: it shows no mesh with triangles, or does not exist");
    assert_eq!(message(3, Some(1), 0.0), "animations[1]: there is no such animation; the file has 1");
    assert_eq!(message(3, Some(0), f64::NAN), "animations[0]: the time is not a number");
    let wide = super::file::scene(&[(r#""scale":[1,2,1]"#, r#""scale":[1e300,2,1]"#)]);
    let mut found = Vec::new();
    let refused = wide.positions(3, None, 0.0, SkinWeights::Normalized, &mut found).unwrap_err().to_string();
    assert_eq!(refused, "nodes[3]: the position of vertex 2 (counted from 0) is not finite, or beyond 2^200");
}
