//! What hostile files may take in memory: a multiple of their size, never what they claim.

#![allow(clippy::unwrap_used)]

use allocation_counter::measure;
use sscc_io::mesh::stl;
use sscc_io::{gltf, npy, npz};

/// The most memory in use at once while this runs, in bytes.
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
fn claimed_counts_take_nothing() {
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
fn json_grows_little() {
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
    }
}

/// A deflated entry that grows a thousandfold is refused by the size it states, before it is unpacked.
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
    // With a small size in its place it is cut there.
    let size = 100_000_000_u32.to_le_bytes();
    let at = bomb.windows(4).rposition(|w| w == size).unwrap();
    let mut lie = bomb;
    lie[at..at + 4].copy_from_slice(&1000_u32.to_le_bytes());
    assert!(peak(|| assert!(npz::parse_model(&lie).is_err())) < 300_000);
}
