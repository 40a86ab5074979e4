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

/// Returns an array of NumPy of this type and shape, whose bytes are 0.
fn zeros(descr: &str, shape: [usize; 2], size: usize) -> Vec<u8> {
    let [rows, columns] = shape;
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({rows}, {columns}), }}\n");
    let start = [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes()].concat();
    [start, vec![0; rows * columns * size]].concat()
}

/// Entries of one byte become numbers of eight. An archive whose numbers would take far more than its size is rejected before
/// they are decoded.
#[test]
fn narrow_integers_are_counted_as_numbers() {
    use std::io::Write;
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options =
        zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    let arrays = [
        ("mean", zeros("|i1", [10_000_000, 3], 1)),
        ("faces", zeros("<i8", [1, 3], 8)),
        ("components", zeros("<f8", [1, 3], 8)),
    ];
    for (name, array) in arrays {
        writer.start_file(format!("{name}.npy"), options).unwrap();
        writer.write_all(&array).unwrap();
    }
    let archive = writer.finish().unwrap().into_inner();
    assert!(archive.len() < 100_000, "{}", archive.len());
    let mut message = String::new();
    // The entry itself may be unpacked: 30 MB, while its vector grows. Its numbers would take 240 MB.
    let peak = peak(|| message = npz::parse_model(&archive).unwrap_err().to_string());
    assert!(peak < 150_000_000, "{peak}");
    assert!(message.starts_with("array 'mean': its numbers would take more than "), "{message}");
}

/// An array of bytes takes its numbers, and nothing else of that size.
#[test]
fn narrow_integers_are_decoded_without_a_copy() {
    let array = zeros("|u1", [1000, 1000], 1);
    let mut last = f64::NAN;
    let peak = peak(|| last = npy::parse(&array).unwrap().into_c_order()[999_999]);
    assert!(last == 0.0 && peak < 8_100_000, "{peak}");
}
