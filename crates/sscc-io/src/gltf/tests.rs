use std::fs;

use glam::DVec3;

use super::*;

/// Returns the bytes of numbers in a buffer.
fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Returns a GLB of these two chunks, padded to multiples of 4.
fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let pad = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let (json, binary) = (pad(json.as_bytes(), b' '), pad(binary, 0));
    let size = |bytes: &[u8]| (bytes.len() as u32).to_le_bytes();
    let total = ((12 + 8 + json.len() + 8 + binary.len()) as u32).to_le_bytes();
    [
        b"glTF",
        &2u32.to_le_bytes()[..],
        &total,
        &size(&json),
        b"JSON",
        &json,
        &size(&binary),
        b"BIN\0",
        &binary,
    ]
    .concat()
}

/// Two primitives: a square as a strip with indices of 8 bits, a plain and an empty target; and a triangle without
/// indices, with normalized 16-bit positions and a sparse target.
const JSON: &str = r#"{
 "asset":{"version":"2.0"},
 "extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"],
 "buffers":[{"byteLength":152}],
 "bufferViews":[
  {"buffer":0,"byteOffset":0,"byteLength":48},
  {"buffer":0,"byteOffset":48,"byteLength":48},
  {"buffer":0,"byteOffset":96,"byteLength":4},
  {"buffer":0,"byteOffset":100,"byteLength":24,"byteStride":8},
  {"buffer":0,"byteOffset":124,"byteLength":4},
  {"buffer":0,"byteOffset":128,"byteLength":24}],
 "accessors":[
  {"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
  {"bufferView":1,"componentType":5126,"count":4,"type":"VEC3"},
  {"bufferView":2,"componentType":5121,"count":4,"type":"SCALAR"},
  {"bufferView":3,"componentType":5122,"normalized":true,"count":3,"type":"VEC3"},
  {"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":2,
    "indices":{"bufferView":4,"componentType":5123},"values":{"bufferView":5}}}],
 "meshes":[{"name":"face","extras":{"targetNames":["smile","frown"]},"weights":[0.25,0],"primitives":[
  {"attributes":{"POSITION":0,"NORMAL":77},"indices":2,"mode":5,"targets":[{"POSITION":1},{"NORMAL":9}]},
  {"attributes":{"POSITION":3},"targets":[{},{"POSITION":4}]}]}]
}"#;

fn binary() -> Vec<u8> {
    let mut bytes = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    bytes.extend(floats(&[0.1, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.3, 4.0, 5.0, 6.0]));
    bytes.extend([0, 1, 2, 3]);
    for position in [[0_i16, 0, i16::MAX], [i16::MAX, 0, i16::MIN], [0, 16384, 0]] {
        bytes.extend(position.iter().flat_map(|c| c.to_le_bytes()));
        bytes.extend([9, 9]); // padding of the stride
    }
    bytes.extend([0, 0, 2, 0]);
    bytes.extend(floats(&[7.0, 8.0, 9.0, -1.0, -2.0, -3.0]));
    bytes
}

fn message(json: &str) -> String {
    parse(&glb(json, &binary()), None).unwrap_err().to_string()
}

/// Returns the error message for the valid file with one change.
fn with(from: &str, to: &str) -> String {
    assert_eq!(JSON.matches(from).count(), 1, "{from}");
    message(&JSON.replace(from, to))
}

#[test]
fn primitives_are_joined() {
    let model = parse(&glb(JSON, &binary()), None).unwrap();
    let half = 16384.0 / 32767.0;
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    assert_eq!(model.mesh.rest_positions(), [DVec3::ZERO, x, y, x + y, z, x - z, y * half]);
    assert_eq!(model.mesh.faces(), [[0, 1, 2], [1, 3, 2], [4, 5, 6]]);
    let wide = |x: f32| f64::from(x);
    assert_eq!(model.modes.of_vertex(0), [x * wide(0.1), DVec3::ZERO]);
    assert_eq!(model.modes.of_vertex(3), [DVec3::new(4.0, 5.0, 6.0), DVec3::ZERO]);
    assert_eq!(model.modes.of_vertex(4), [DVec3::ZERO, DVec3::new(7.0, 8.0, 9.0)]);
    assert_eq!(model.modes.of_vertex(5), [DVec3::ZERO; 2]);
    assert_eq!(model.modes.of_vertex(6), [DVec3::ZERO, DVec3::new(-1.0, -2.0, -3.0)]);
    assert_eq!(model.default_weights, [0.25, 0.0]);
    assert_eq!(model.target_names, ["smile", "frown"]);
    assert_eq!(model.mesh_name, "face");
    assert_eq!(
        model.primitives,
        [
            PrimitiveRange { number: 0, vertices: 0..4, triangles: 0..2 },
            PrimitiveRange { number: 1, vertices: 4..7, triangles: 2..3 }
        ]
    );
    // Names in another number or form are ignored.
    for extras in [r#"{"targetNames":["smile"]}"#, "7", "null", r#"{"targetNames":{"a":1}}"#] {
        let json = JSON.replace(r#"{"targetNames":["smile","frown"]}"#, extras);
        let other = parse(&glb(&json, &binary()), None).unwrap();
        assert_eq!(other.target_names, ["target 0", "target 1"], "{extras}");
    }
    let unnamed = JSON.replace(r#""weights":[0.25,0],"#, "").replace(r#""name":"face","#, "");
    let unnamed = parse(&glb(&unnamed, &binary()), Some("#0")).unwrap();
    assert_eq!((unnamed.default_weights, unnamed.mesh_name.as_str()), (vec![0.0; 2], "#0"));
}

#[test]
fn external_and_embedded_buffers() {
    use base64::Engine;
    let whole = parse(&glb(JSON, &binary()), None).unwrap();
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path().join("in here");
    fs::create_dir_all(folder.join("sub dir")).unwrap();
    let path = folder.join("a.gltf");
    let with_uri = |uri: &str| {
        let json = JSON.replace(r#"{"byteLength""#, &format!(r#"{{"uri":"{uri}","byteLength""#));
        fs::write(&path, &json).unwrap();
        json
    };
    // An external buffer may be longer than needed.
    fs::write(folder.join("sub dir/b.bin"), [&binary()[..], b"more"].concat()).unwrap();
    let json = with_uri("./sub%20dir/b.bin");
    assert_eq!(read(&path, None).unwrap(), whole);
    assert_eq!(read_contents(&path).unwrap().meshes[0].targets.len(), 2);
    let alone = parse(json.as_bytes(), None).unwrap_err().to_string();
    assert!(
        alone.contains("buffers[0]: the file './sub%20dir/b.bin' is needed, but these data have no folder"),
        "{alone}"
    );
    let data = base64::engine::general_purpose::STANDARD.encode(binary());
    let json = with_uri(&format!("data:application/gltf-buffer;base64,{data}"));
    assert_eq!(parse(json.as_bytes(), None).unwrap(), whole);

    let refused = |uri: &str| {
        with_uri(uri);
        read(&path, None).unwrap_err().to_string()
    };
    fs::write(directory.path().join("b.bin"), binary()).unwrap();
    for uri in ["../b.bin", "sub%20dir/../../b.bin", "/b.bin", "%2e%2e/b.bin", "C:/b.bin"] {
        assert!(refused(uri).contains("leads out of the folder"), "{uri}");
    }
    assert!(refused("https://example.org/b.bin").contains("is a URL"));
    assert!(refused("c.bin").contains("c.bin: not found"));
    assert!(refused("sub dir").contains("is a directory"));
    fs::write(folder.join("short.bin"), &binary()[1..]).unwrap();
    assert!(refused("short.bin").ends_with("buffers[0]: it declares 152 bytes, but has 151"));
    assert!(refused("data:application/gltf-buffer;base64,AAAA").ends_with("but has 3"));
}

#[test]
fn other_versions_and_extensions_are_rejected() {
    for version in ["1.0", "1", "3.0", "20", ""] {
        let refused = with(r#""version":"2.0""#, &format!(r#""version":"{version}""#));
        assert!(refused.starts_with("asset: version ") && refused.ends_with("as glTF 2.0"), "{refused}");
    }
    assert!(with(r#""version":"2.0""#, r#""version":"2.1","minVersion":"2.1""#).contains("version '2.1'"));
    let newer = JSON.replace(r#""version":"2.0""#, r#""version":"2.1","minVersion":"2.0""#);
    assert!(parse(&glb(&newer, &binary()), None).is_ok());
    // Version 1.0 has objects in place of lists.
    let first = message(r#"{"asset":{"version":"1.0"},"accessors":{"a":{}},"meshes":{"b":{}}}"#);
    assert!(first.contains("version '1.0'"), "{first}");
    assert!(message(r#"{"meshes":[]}"#).starts_with("JSON: missing field `asset`"));

    let required = r#""extensionsRequired":["KHR_mesh_quantization"]"#;
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "X_unknown"] {
        let refused = with(required, &format!(r#""extensionsRequired":["KHR_texture_basisu","{name}"]"#));
        assert_eq!(
            refused,
            format!("extensionsRequired: the extension '{name}' is not supported: save the file without it")
        );
    }
}

#[test]
fn errors_name_the_part() {
    assert_eq!(with(r#""weights":[0.25,0]"#, r#""weights":[1e999,0]"#).split(':').next(), Some("JSON"));
    assert_eq!(with(r#"[{"POSITION":1}"#, r#"[{"POSITION":9}"#), "accessors[9]: there is no such accessor");
    assert_eq!(
        with(r#"[{"POSITION":1}"#, r#"[{"POSITION":4}"#),
        "meshes[0].primitives[0]: target 0 has 3 positions for 4 vertices"
    );
    assert!(with(r#"[{"POSITION":1}"#, r#"[{"POSITION":2}"#).contains("must be VEC3 of float32"));
    assert!(with(r#""indices":2"#, r#""indices":0"#).contains("must be SCALAR of unsigned integers"));
    assert!(with("5123", "5122").contains("sparse indices must be unsigned integers"));
    assert!(
        with(r#""byteStride":8"#, r#""byteStride":4"#)
            .contains("the stride of 4 bytes is shorter than an item of 6")
    );
    assert!(
        with(r#""byteOffset":96,"byteLength":4"#, r#""byteOffset":150,"byteLength":4"#)
            .contains("bufferViews[2]: 4 bytes from byte 150 on are not within buffers[0] of 152 bytes")
    );
    assert!(with(r#"[{"byteLength":152}]"#, r#"[{"byteLength":153}]"#).contains("it declares 153 bytes"));
    assert!(with(r#"[{"byteLength":152}]"#, "[]").contains("buffers[0]: there is no such buffer"));
    assert!(with(r#"[{"byteLength":152}]"#, r#"[{"byteLength":-1}]"#).starts_with("JSON: "));
    let mut bytes = binary();
    bytes[99] = 4;
    let refused = parse(&glb(JSON, &bytes), None).unwrap_err().to_string();
    assert!(
        refused.ends_with("primitives[0]: an index names vertex 4 (counted from 0), but there are 4"),
        "{refused}"
    );
    for indices in [[0, 0], [2, 1], [0, 3], [0, u8::MAX]] {
        let mut bytes = binary();
        (bytes[124], bytes[126]) = (indices[0], indices[1]);
        let refused = parse(&glb(JSON, &bytes), None).unwrap_err().to_string();
        assert!(refused.contains("accessors[4]: sparse indices must ascend"), "{refused}");
    }
    let mut bytes = binary();
    bytes[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(parse(&glb(JSON, &bytes), None).unwrap_err().to_string().starts_with("vertex 0 "));
    let mut bytes = binary();
    bytes[48..52].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert!(parse(&glb(JSON, &bytes), None).unwrap_err().to_string().starts_with("mode 0 of vertex 0 "));
}

/// Errors in data that no query needs do not refuse a file.
#[test]
fn needless_content_is_not_read() {
    let whole = parse(&glb(JSON, &binary()), None).unwrap();
    let view = r#""byteOffset":96,"byteLength":4}"#;
    for (from, to) in [
        // Extensions that are used, but not required, with the data that they compress.
        (r#""mode":5"#, r#""mode":5,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}}"#),
        (view, r#""byteOffset":96,"byteLength":4,"extensions":{"EXT_meshopt_compression":{"buffer":9}}}"#),
        (
            r#"{"byteLength":152}"#,
            r#"{"byteLength":152},{"byteLength":9,"extensions":{"EXT_meshopt_compression":{"fallback":true}}}"#,
        ),
        (r#""mode":5"#, r#""mode":5,"extensions":{"X_unknown":7}"#),
        (r#"["KHR_mesh_quantization"],"extensionsRequired""#, r#"["X_unknown","VRM"],"extensionsRequired""#),
        (r#""extensionsRequired":["#, r#""extensionsRequired":["VRMC_vrm","KHR_xmp_json_ld","#),
        // Accessors, views and buffers that no position needs.
        (
            r#""accessors":["#,
            r#""images":[{"uri":7}],"samplers":[{"magFilter":"x"}],"textures":7,"materials":[{"name":"m","pbrMetallicRoughness":7}],"accessors":["#,
        ),
        (
            r#"{"POSITION":0,"NORMAL":77}"#,
            r#"{"POSITION":0,"NORMAL":"x","TANGENT":-1,"_ANY":{},"JOINTS_0":"x","WEIGHTS_0":null}"#,
        ),
        (r#""sparse":{"count":2,"#, r#""min":["x"],"max":null,"sparse":{"extras":[],"count":2,"#),
        (r#""type":"VEC3","sparse""#, r#""type":"VEC3","name":7,"sparse""#),
        // Primitives without triangles, in any place.
        (
            r#""primitives":["#,
            r#""primitives":[{"attributes":{"POSITION":99},"mode":1},{"attributes":{"NORMAL":0}},{"attributes":{"POSITION":0},"mode":0},"#,
        ),
        // Empty values as null.
        (r#""name":"face","#, r#""name":"face","extensions":null,"#),
        (
            r#"{"POSITION":3},"targets""#,
            r#"{"POSITION":3},"extensions":null,"extras":null,"indices":null,"mode":null,"targets""#,
        ),
        (
            r#""buffer":0,"byteOffset":0,"#,
            r#""buffer":0,"byteOffset":null,"byteStride":0,"extensions":null,"#,
        ),
    ] {
        assert_eq!(JSON.matches(from).count(), 1, "{from}");
        let read = parse(&glb(&JSON.replace(from, to), &binary()), None);
        let mut read = read.unwrap_or_else(|error| panic!("{to}: {error}"));
        let first = read.primitives[0].number;
        assert_eq!(first, if from == r#""primitives":["# { 3 } else { 0 });
        read.primitives.iter_mut().for_each(|range| range.number -= first);
        assert_eq!(read, whole, "{to}");
    }
    let two = JSON.replace(r#""version":"2.0""#, r#""version":"2""#);
    assert_eq!(parse(&glb(&two, &binary()), None).unwrap(), whole);
}

#[test]
fn primitives_of_an_unknown_topology_are_refused() {
    for mode in [7_u32, u32::MAX] {
        let named = format!(
            "meshes[0].primitives[0]: a primitive of triangles was expected, this one has the unknown topology {mode}"
        );
        let json = JSON.replace(r#""mode":5"#, &format!(r#""mode":{mode}"#));
        assert_eq!(message(&json), named);
        assert_eq!(parse_placed_mesh(&glb(&json, &binary()), None).err().unwrap().to_string(), named);
    }
}

/// Data that exist only compressed are never read as zeros.
#[test]
fn data_that_exist_only_compressed_are_refused() {
    let draco = r#""mode":5,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}}"#;
    let json = JSON.replace(r#""mode":5"#, draco);
    for accessor in [
        r#"{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min""#,
        r#"{"bufferView":2,"componentType":5121"#,
    ] {
        let without = accessor.replace(r#""bufferView":0,"#, "").replace(r#""bufferView":2,"#, "");
        let refused = message(&json.replace(accessor, &without));
        assert_eq!(
            refused,
            "meshes[0].primitives[0]: its numbers exist only compressed by the extension KHR_draco_mesh_compression, which \
             is not supported: save the file without it"
        );
    }
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let buffer = format!(r#"{{"byteLength":152,"extensions":{{"{name}":{{"fallback":true}}}}}}"#);
        let refused = with(r#"{"byteLength":152}"#, &buffer);
        assert!(
            refused.starts_with("buffers[0]: its bytes exist only compressed by the extension"),
            "{refused}"
        );
    }
}

#[test]
fn missing_morph_targets_move_nothing() {
    let whole = parse(&glb(JSON, &binary()), None).unwrap();
    assert!(whole.notes.is_empty());
    let note = "meshes[0]: its primitives have 1 to 2 morph targets; the missing ones move nothing";
    // The second target of the first primitive moves nothing in the file, nor does the first of the second.
    let json = JSON.replace(r#"[{"POSITION":1},{"NORMAL":9}]"#, r#"[{"POSITION":1}]"#);
    let read = parse(&glb(&json, &binary()), None).unwrap();
    assert_eq!(read.notes, [note]);
    assert_eq!(MorphModel { notes: Vec::new(), ..read }, whole);
    let first = JSON.replace(r#"{"POSITION":3},"targets":[{},{"POSITION":4}]"#, r#"{"POSITION":3}"#);
    let first = parse(&glb(&first, &binary()), None).unwrap();
    assert_eq!(first.notes, [note.replace("1 to 2", "0 to 2")]);
    assert_eq!(first.modes.of_vertex(0), whole.modes.of_vertex(0));
    assert_eq!(first.modes.of_vertex(4), [DVec3::ZERO; 2]);
    // There is one weight for each target; missing weights are 0.
    for (weights, expected) in [("[0.25]", [0.25, 0.0]), ("[0.25,0.5,9]", [0.25, 0.5])] {
        let read = parse(&glb(&JSON.replace("[0.25,0]", weights), &binary()), None).unwrap();
        assert_eq!(read.default_weights, expected);
        assert_eq!(read.notes.len(), 1);
        assert!(read.notes[0].contains("default weights for 2 morph targets; missing ones are 0"));
    }
    // A mesh at rest needs no targets: they may have another number, and be damaged.
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("face.VRM");
    let json = JSON.replace(r#"{},{"POSITION":4}"#, r#"{"POSITION":99}"#);
    fs::write(&path, glb(&json, &binary())).unwrap();
    let mesh = crate::load_mesh(&path, None).unwrap();
    assert_eq!(mesh, whole.mesh);
    assert!(is_gltf(&path));
}

/// Counts that exceed the bytes of the file are errors, without large allocations.
#[test]
fn hostile_counts_are_rejected() {
    for count in ["5", "4294967296", "18446744073709551615", "6148914691236517206"] {
        let refused = with(r#""count":4,"type":"SCALAR""#, &format!(r#""count":{count},"type":"SCALAR""#));
        assert!(refused.contains("fit into it") || refused.contains("of memory"), "{refused}");
        let sparse = with(r#"{"count":2,"#, &format!(r#"{{"count":{count},"#));
        assert!(sparse.contains("more sparse items than items"), "{sparse}");
        // An accessor without a view is all zeros, so only the memory allowance limits its count.
        let zeros = format!(
            r#"{{"componentType":5126,"count":{count},"type":"VEC3"}},{{"componentType":5126,"count":3,"#
        );
        let json = JSON
            .replace(r#"{"componentType":5126,"count":3,"#, &zeros)
            .replace(r#":{"POSITION":3}"#, r#":{"POSITION":4}"#);
        let refused = message(&json.replace(r#"{},{"POSITION":4}"#, "{},{}"));
        assert!(count == "5" && refused.contains("5 corners") || refused.contains("of memory"), "{refused}");
    }
    for key in [r#""byteOffset":128"#, r#""byteStride":8"#, r#""byteOffset":48"#] {
        let name = key.split(':').next().unwrap();
        assert!(!with(key, &format!("{name}:18446744073709551615")).is_empty());
    }
    // Many targets refer to one accessor, so the decoded numbers exceed the memory allowance.
    let targets = vec![r#"{"POSITION":1}"#; 20_000].join(",");
    let vertices = 1_000;
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{0}}}],"bufferViews":[{{"buffer":0,"byteLength":{0}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3"}},
        {{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3"}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"targets":[{targets}]}}]}}]}}"#,
        12 * vertices
    );
    let refused = parse(&glb(&json, &vec![0; 12 * vertices]), None).unwrap_err().to_string();
    assert!(refused.contains("too much for a file of this size"), "{refused}");
}

#[test]
fn every_truncation_is_rejected() {
    let bytes = glb(JSON, &binary());
    assert!(parse(&bytes, None).is_ok());
    for len in 0..bytes.len() {
        assert!(parse(&bytes[..len], None).is_err(), "{len}");
        assert!(parse(&JSON.as_bytes()[..len.min(JSON.len() - 1)], None).is_err(), "{len}");
    }
    assert!(parse(&[&bytes[..], b"\0"].concat(), None).is_err());
    assert!(parse(&[JSON.as_bytes(), b"}"].concat(), None).is_err());
}

/// The same model as OBJ and `.npy`.
#[test]
fn agrees_with_obj_and_npy() {
    let directory = tempfile::tempdir().unwrap();
    let [glb_path, obj_path, npy_path] = ["a.glb", "a.obj", "a.npy"].map(|n| directory.path().join(n));
    fs::write(&glb_path, glb(JSON, &binary())).unwrap();
    let (x, y) = (0.1_f32, 16384.0 / 32767.0);
    fs::write(
        &obj_path,
        format!(
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 -1\nv 0 {y} 0\nf 1 2 3\nf 2 4 3\nf 5 6 7\n"
        ),
    )
    .unwrap();
    let mut values = [0.0; 42];
    for (vertex, mode, moved) in [
        (0, 0, [x, 0.0, 0.0]),
        (1, 0, [0.0, 0.2, 0.0]),
        (2, 0, [0.0, 0.0, 0.3]),
        (3, 0, [4.0, 5.0, 6.0]),
        (4, 1, [7.0, 8.0, 9.0]),
        (6, 1, [-1.0, -2.0, -3.0]),
    ] {
        for c in 0..3 {
            values[(3 * vertex + c) * 2 + mode] = f64::from(moved[c]);
        }
    }
    crate::write_npy(&npy_path, &[21, 2], &values).unwrap();
    let (ours, info) = crate::load_model(&glb_path, None).unwrap();
    let (theirs, _) = crate::load_model(&obj_path, Some(&npy_path)).unwrap();
    // glTF splits vertices along seams, OBJ does not.
    let split = theirs.mesh().clone().with_split_vertices();
    assert_eq!((ours.mesh(), ours.modes(), ours.metric()), (&split, theirs.modes(), theirs.metric()));
    assert_eq!(info.provenance, "mesh \"face\" of a.glb");
}

/// The square has two triangles, the other primitive one.
#[test]
fn groups_are_primitives_nodes_or_materials() {
    let groups = |json: &str, by| {
        let found = parse_groups(&glb(json, &binary()), None, by).unwrap();
        (found.names.join("|"), found.of_triangle)
    };
    assert_eq!(groups(JSON, GroupsBy::Group), ("#0|#1".into(), vec![0, 0, 1]));
    assert_eq!(groups(JSON, GroupsBy::Object), ("face".into(), vec![0; 3]));
    assert_eq!(groups(JSON, GroupsBy::Material), ("default".into(), vec![0; 3]));
    let named = JSON.replace(r#""mode":5"#, r#""mode":5,"material":1"#).replace(
        r#""buffers""#,
        r#""materials":[{},{"name":"skin"}],"nodes":[{"name":"x"},{"name":"head","mesh":0}],"buffers""#,
    );
    assert_eq!(groups(&named, GroupsBy::Object), ("head".into(), vec![0; 3]));
    assert_eq!(groups(&named, GroupsBy::Mesh), ("face".into(), vec![0; 3]));
    assert_eq!(groups(&named, GroupsBy::Material), ("skin|default".into(), vec![0, 0, 1]));
    // Materials do not change the shape: one that does not exist has a number.
    let missing = named.replace(r#""material":1"#, r#""material":7"#);
    assert_eq!(groups(&missing, GroupsBy::Material), ("#7|default".into(), vec![0, 0, 1]));
    let scene = parse_scene(&glb(&named, &binary())).unwrap();
    let found = scene.mesh_nodes()[0].groups(GroupsBy::Material).unwrap();
    assert_eq!((found.names.join("|"), found.of_triangle), ("skin|default".into(), vec![0, 0, 1]));
    assert_eq!(scene.mesh_nodes()[0].groups(GroupsBy::Object).unwrap().names, ["head"]);
    let malformed = named.replace(r#""material":1"#, r#""material":"red""#);
    let error = parse_groups(&glb(&malformed, &binary()), None, GroupsBy::Group).unwrap_err();
    assert!(error.to_string().starts_with("JSON: "), "{error}");
}

/// Only groups need materials and the names of parts.
#[test]
fn malformed_materials_refuse_groups_alone() {
    let with_nodes = JSON.replace(r#""buffers""#, r#""materials":[{}],"nodes":[{"mesh":0}],"buffers""#);
    for (from, to) in [
        (r#""materials":[{}]"#, r#""materials":[{"name":5}]"#),
        (r#""materials":[{}]"#, r#""materials":7"#),
        (r#""mode":5"#, r#""mode":5,"material":-1"#),
    ] {
        let bytes = glb(&with_nodes.replace(from, to), &binary());
        let scene = parse_scene(&bytes).unwrap();
        let placed = parse_placed_mesh(&bytes, None).unwrap();
        assert_eq!((scene.mesh_nodes().len(), placed.to_mesh(0).unwrap().faces().len()), (1, 3));
        for error in [
            scene.mesh_nodes()[0].groups(GroupsBy::Material).unwrap_err(),
            placed.groups(0, GroupsBy::Material).unwrap_err(),
        ] {
            assert!(error.to_string().starts_with("JSON: "), "{to}: {error}");
        }
    }
    let null = with_nodes.replace(r#""materials":[{}]"#, r#""materials":null"#);
    let placed = parse_placed_mesh(&glb(&null, &binary()), None).unwrap();
    assert_eq!(placed.groups(0, GroupsBy::Material).unwrap().names, ["default"]);
}
