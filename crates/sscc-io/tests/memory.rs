//! Memory for hostile files: a multiple of their size, independent of declared counts.

#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use allocation_counter::measure;
use sscc_io::mesh::stl;
use sscc_io::{gltf, npy, npz};

/// Returns the peak memory of a function in bytes.
fn peak(run: impl FnOnce()) -> u64 {
    measure(run).bytes_max
}

fn gltf_text(accessors: &str, meshes: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":36,"uri":"data:;base64,{}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],"accessors":[{accessors}],"meshes":[{meshes}]}}"#,
        "A".repeat(48)
    )
}

#[test]
fn declared_counts_allocate_nothing() {
    let accessor = r#"{"bufferView":0,"componentType":5126,"count":4000000000,"type":"VEC3"}"#;
    let zeros = r#"{"componentType":5126,"count":4000000000,"type":"VEC3"}"#;
    let mesh = r#"{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":0}]}]}"#;
    for accessor in [accessor, zeros] {
        let text = gltf_text(accessor, mesh);
        assert!(peak(|| assert!(gltf::parse(text.as_bytes(), None).is_err())) < 50_000);
    }
    let mut binary = vec![0; 134];
    binary[80..84].fill(0xff);
    assert!(peak(|| assert!(stl::parse(&binary).is_err())) < 10_000);
    let header = "{'descr': '<i8', 'fortran_order': False, 'shape': (1000000000, 3), }";
    let array = [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes()].concat();
    assert!(peak(|| assert!(npy::parse_integers(&array).is_err())) < 10_000);
}

#[test]
fn json_uses_little_memory() {
    let base = r#"{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}"#;
    let many = |item: &str| vec![item; 100_000].join(",");
    let primitive = r#"{"attributes":{"POSITION":0}}"#;
    for (accessors, meshes) in [
        (base.into(), format!(r#"{{"primitives":[{{"attributes":{{}},"targets":[{}]}}]}}"#, many("{}"))),
        (base.into(), format!(r#"{{"primitives":[{}]}}"#, many(primitive))),
        (base.into(), format!(r#"{{"primitives":[],"extras":[{}]}}"#, many("0"))),
        (base.into(), format!(r#"{{"primitives":[],"extras":{{"a":[{}]}}}}"#, many("[]"))),
        (base.into(), format!(r#"{{"primitives":[],"weights":[{}]}}"#, many("0"))),
        (base.into(), many(r#"{"primitives":[]}"#)),
        (many(base), String::new()),
    ] {
        let text = gltf_text(&accessors, &meshes);
        let peak = peak(|| assert!(gltf::parse(text.as_bytes(), None).is_err()));
        assert!(peak < 50 * text.len() as u64, "{peak} for {}", text.len());
        let contents = self::peak(|| assert!(gltf::parse_contents(text.as_bytes()).is_ok()));
        assert!(contents < 50 * text.len() as u64, "{contents} for {}", text.len());
    }
}

#[test]
fn scenes_use_little_memory() {
    let many = |item: &str| vec![item; 100_000].join(",");
    let accessor = r#"{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}"#;
    let zeros = r#"{"componentType":5126,"count":4000000000,"type":"SCALAR"}"#;
    let mesh = r#"{"primitives":[{"attributes":{"POSITION":0}}]}"#;
    let sampler = r#"{"input":1,"output":1}"#;
    let channel = r#"{"sampler":0,"target":{"node":0,"path":"scale"}}"#;
    for (parts, is_valid) in [
        (format!(r#""nodes":[{}]"#, many("{}")), true),
        (format!(r#""nodes":[{}]"#, many(r#"{"mesh":0}"#)), true),
        (format!(r#""nodes":[{{}}],"scenes":[{}]"#, many("{}")), true),
        (format!(r#""nodes":[{{}}],"scenes":[{{"nodes":[{}]}}]"#, many("0")), true),
        (format!(r#""nodes":[{}]"#, many(r#"{"children":[0]}"#)), false),
        (format!(r#""nodes":[{{"weights":[{}]}}]"#, many("0")), true),
        (format!(r#""nodes":[{{}}],"skins":[{}]"#, many(r#"{"joints":[0]}"#)), true),
        (format!(r#""nodes":[{{}}],"skins":[{{"joints":[{}]}}]"#, many("0")), true),
        (format!(r#""animations":[{}]"#, many(r#"{"channels":[],"samplers":[]}"#)), true),
        (format!(r#""animations":[{{"channels":[],"samplers":[{}]}}]"#, many(sampler)), true),
        (
            format!(
                r#""nodes":[{{}}],"animations":[{{"channels":[{}],"samplers":[{sampler}]}}]"#,
                many(channel)
            ),
            true,
        ),
    ] {
        let text = gltf_text(&format!("{accessor},{zeros}"), mesh);
        let text = format!("{},{parts}}}", text.strip_suffix('}').unwrap());
        let peak = peak(|| assert_eq!(gltf::parse_scene(text.as_bytes()).is_ok(), is_valid));
        assert!(peak < 100 * text.len() as u64, "{peak} for {}: {}", text.len(), &parts[..80]);
        let placed = self::peak(|| drop(gltf::parse_placed_mesh(text.as_bytes(), None)));
        assert!(placed < 100 * text.len() as u64, "{placed} for {}: {}", text.len(), &parts[..80]);
        let contents = self::peak(|| assert_eq!(gltf::parse_contents(text.as_bytes()).is_ok(), is_valid));
        assert!(contents < 100 * text.len() as u64, "{contents} for {}: {}", text.len(), &parts[..80]);
    }
}

/// A deflated entry that grows a thousandfold is rejected by its declared size, before it is unpacked.
#[test]
fn bombs_are_not_unpacked() {
    use std::io::Write;
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options =
        zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    writer.start_file("modes.npy", options).unwrap();
    writer.write_all(&vec![0; 100_000_000]).unwrap();
    let bomb = writer.finish().unwrap().into_inner();
    assert!(peak(|| assert!(npz::parse_model(&bomb).is_err())) < 100_000);
    // With a small declared size, unpacking stops at that size.
    let size = 100_000_000_u32.to_le_bytes();
    let at = bomb.windows(4).rposition(|w| w == size).unwrap();
    let mut false_size = bomb;
    false_size[at..at + 4].copy_from_slice(&1000_u32.to_le_bytes());
    assert!(peak(|| assert!(npz::parse_model(&false_size).is_err())) < 300_000);
}
