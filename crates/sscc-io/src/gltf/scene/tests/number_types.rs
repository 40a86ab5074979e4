//! Integers of all types that the standard allows, in place of float32.

use glam::{DQuat, DVec3};

use super::file::{JOINTS, JSON, WEIGHTS, assert_close, binary, glb, positions, scene, skinned};
use crate::gltf::parse_scene;

#[test]
fn integers_are_decoded() {
    let plain = scene(&[]);
    let replaced = |accessor: &str, at: usize, bytes: &[u8], to: &str| {
        let mut binary = binary();
        binary[at..at + bytes.len()].copy_from_slice(bytes);
        let json = JSON.replace(accessor, to);
        assert_ne!(json, JSON);
        parse_scene(&glb(&json, &binary)).unwrap()
    };
    // 1, 0.25 and 0.75 are multiples of 1/255 and 1/65535 up to 0.002.
    let joints = JOINTS.concat().iter().flat_map(|j| u16::from(*j).to_le_bytes()).collect::<Vec<u8>>();
    let weights = WEIGHTS.concat();
    let bytes: Vec<u8> = weights.iter().map(|w| (w * 255.0).round() as u8).collect();
    let shorts: Vec<u8> = weights.iter().flat_map(|w| ((w * 65535.0).round() as u16).to_le_bytes()).collect();
    let of_weights = r#"{"bufferView":3,"componentType":5126,"#;
    let of_joints = r#""byteLength":16}"#;
    for (scene, tolerance) in [
        (
            replaced(of_weights, 112, &bytes, r#"{"bufferView":3,"componentType":5121,"normalized":true,"#),
            0.1,
        ),
        (
            replaced(of_weights, 112, &shorts, r#"{"bufferView":3,"componentType":5123,"normalized":true,"#),
            1e-3,
        ),
        {
            let mut binary = binary();
            binary.extend(&joints);
            let json = JSON
                .replace(r#""byteLength":512"#, r#""byteLength":544"#)
                .replace(&format!(r#""byteOffset":96,{of_joints}"#), r#""byteOffset":512,"byteLength":32}"#)
                .replace(
                    r#"{"bufferView":2,"componentType":5121"#,
                    r#"{"bufferView":2,"componentType":5123"#,
                );
            (parse_scene(&glb(&json, &binary)).unwrap(), 1e-12)
        },
    ] {
        let (found, expected) = (positions(&scene, 3, Some(1.5)), positions(&plain, 3, Some(1.5)));
        let error = found.iter().zip(&expected).map(|(x, y)| x.distance(*y)).fold(0.0, f64::max);
        assert!(error < tolerance, "{error}");
        assert_eq!(scene.mesh_nodes()[0].weld_classes(), [0, 1, 2, 2]);
    }
    let of_rotations = r#"{"bufferView":7,"componentType":5126,"#;
    let i16s = [0, 0, i16::MAX, 0, 0, 0, 0, i16::MAX, 0, 0, 0, i16::MIN].map(i16::to_le_bytes).concat();
    let i8s = [0, 0, 127, 0, 0, 0, 0, 127, 0, 0, 0, 0x80];
    let u8s = [0, 0, 255, 0, 0, 0, 0, 255, 0, 0, 0, 255];
    for (code, bytes) in [(5120, &i8s[..]), (5121, &u8s), (5122, &i16s)] {
        let to = format!(r#"{{"bufferView":7,"componentType":{code},"normalized":true,"#);
        let scene = replaced(of_rotations, 352, bytes, &to);
        assert_eq!(positions(&scene, 3, Some(1.25)), positions(&plain, 3, Some(1.25)), "{code}");
    }
    // Weights of morph targets 1, 0.5 and 0.
    let of_morphs = r#"{"bufferView":5,"componentType":5126,"count":3,"type":"SCALAR"}],"#;
    let to = r#"{"bufferView":8,"byteOffset":108,"componentType":5123,"normalized":true,"count":3,"type":"SCALAR"}],"#;
    let mut binary = binary();
    binary.extend([0xff, 0xff, 0, 0x80, 0, 0].map(|b: u8| b));
    binary.resize(520, 0);
    binary.copy_within(512..518, 508);
    let json = JSON
        .replace(of_morphs, to)
        .replace(r#""byteLength":512"#, r#""byteLength":520"#)
        .replace(r#""byteLength":108"#, r#""byteLength":114"#);
    let scene = parse_scene(&glb(&json, &binary)).unwrap();
    let expected = skinned(20.0, DQuat::IDENTITY, DVec3::new(3.0, 2.0, 1.0), 32768.0 / 65535.0);
    assert_close(&positions(&scene, 3, Some(2.0)), &expected);
}
