use std::io::{Cursor, Write};

use glam::DVec3;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::*;
use crate::npy::to_bytes;

/// Returns an archive in the form of NumPy.
fn archive(entries: &[(&str, Vec<u8>)], method: CompressionMethod) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(method).large_file(true);
    for (name, content) in entries {
        writer.start_file(format!("{name}.npy"), options).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn stored(entries: &[(&str, Vec<u8>)]) -> Vec<u8> {
    archive(entries, CompressionMethod::Stored)
}

fn numbers(shape: &[usize]) -> Vec<u8> {
    let values: Vec<f64> = (0..shape.iter().product()).map(|i| i as f64).collect();
    to_bytes(shape, &values).unwrap()
}

fn faces(descr: &str, corners: &[u8]) -> Vec<u8> {
    let header =
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}, 3), }}", corners.len() / 3);
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    let size = usize::from(descr.as_bytes()[2] - b'0');
    for corner in corners {
        bytes.push(*corner);
        bytes.resize(bytes.len() + size - 1, if *corner == 255 { 255 } else { 0 });
    }
    bytes
}

/// Four vertices, two modes.
fn good() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("mean", numbers(&[4, 3])),
        ("modes", numbers(&[12, 2])),
        ("faces", faces("<i4", &[0, 1, 2, 3, 2, 1])),
        ("kintree_table", b"a pickle".to_vec()),
    ]
}

/// The valid archive with one array replaced or added.
fn with(name: &'static str, content: Vec<u8>) -> Vec<(&'static str, Vec<u8>)> {
    let mut entries = good();
    entries.retain(|(other, _)| *other != name);
    entries.push((name, content));
    entries
}

fn message(entries: &[(&str, Vec<u8>)]) -> String {
    parse_model(&stored(entries)).unwrap_err().to_string()
}

#[test]
fn stored_and_deflated() {
    let model = parse_model(&stored(&good())).unwrap();
    let NpzModel { mesh, modes, weights, deviations } = &model;
    assert_eq!(mesh.faces(), [[0, 1, 2], [3, 2, 1]]);
    assert_eq!(mesh.rest_positions()[1], DVec3::new(3.0, 4.0, 5.0));
    assert_eq!(modes.of_vertex(1)[1], DVec3::new(7.0, 9.0, 11.0));
    assert_eq!((weights, deviations), (&None, &None));
    let deflated = archive(&good(), CompressionMethod::Deflated);
    assert_eq!(parse_model(&deflated).unwrap(), model);
    assert_eq!(parse_modes(&deflated, mesh).unwrap().modes, *modes);
}

#[test]
fn all_names_and_shapes() {
    let model = parse_model(&stored(&good())).unwrap();
    for mean in ["mean", "mean_", "vertices", "v_template", "rest_positions"] {
        for (basis, shape) in [("shapedirs", &[4, 3, 2][..]), ("U", &[12, 2]), ("basis", &[12, 2])] {
            for (f, descr) in
                [("faces", "<i8"), ("f", "<u4"), ("triangles", "<u8"), ("f", "|u1"), ("f", "<i2")]
            {
                let entries = [
                    (mean, numbers(&[12])),
                    (basis, numbers(shape)),
                    (f, faces(descr, &[0, 1, 2, 3, 2, 1])),
                    ("weights", numbers(&[4, 24])),
                ];
                assert_eq!(parse_model(&stored(&entries)).unwrap(), model);
            }
        }
    }
    for name in ["components", "components_"] {
        for shape in [&[2, 12][..], &[2, 4, 3]] {
            let entries =
                [("mean", numbers(&[4, 3])), (name, numbers(shape)), ("f", faces("<i4", &[0, 1, 2]))];
            let modes = parse_model(&stored(&entries)).unwrap().modes;
            assert_eq!((modes.rank(), modes.of_vertex(1)[1]), (2, DVec3::new(15.0, 16.0, 17.0)));
        }
    }
    for name in ["weights", "explained_variance", "explained_variance_", "eigenvalues"] {
        let weights = parse_model(&stored(&with(name, numbers(&[2])))).unwrap().weights;
        assert_eq!(weights, Some(vec![0.0, 1.0]));
    }
}

#[test]
fn variances_state_the_standard_deviations_of_q() {
    // Two components of unit length that move one coordinate each, and the same times their standard deviations.
    let components = |scales: [f64; 2]| {
        let mut rows = [0.0; 24];
        (rows[4], rows[12 + 8]) = (scales[0], scales[1]);
        to_bytes(&[2, 12], &rows).unwrap()
    };
    let array = |values: &[f64]| to_bytes(&[values.len()], values).unwrap();
    let read = |components: Vec<u8>, name: &'static str, variances: Vec<u8>| {
        let entries = [
            ("mean", numbers(&[4, 3])),
            ("components", components),
            ("faces", faces("<i4", &[0, 1, 2, 3, 2, 1])),
            (name, variances),
        ];
        let model = parse_model(&stored(&entries)).unwrap();
        let as_modes = parse_modes(&stored(&entries), &model.mesh).unwrap();
        assert_eq!(as_modes.deviations, model.deviations, "{name}");
        model.deviations
    };
    for name in ["explained_variance", "explained_variance_", "eigenvalues"] {
        assert_eq!(read(components([1.0, 1.0]), name, array(&[4.0, 0.25])), Some(vec![2.0, 0.5]));
        assert_eq!(read(components([2.0, 0.5]), name, array(&[4.0, 0.25])), Some(vec![1.0, 1.0]));
        assert_eq!(read(components([1.0, 1.0]), name, array(&[4.0, -1e-18])), Some(vec![2.0, 0.0]));
        assert_eq!(read(components([1.0, 1.0]), name, array(&[4.0, f64::NAN])), None);
    }
    assert_eq!(read(components([1.0, 1.0]), "weights", array(&[4.0, 0.25])), None);
    // Eigenvalues beside other modes may be those of vibrations.
    let vibrations = parse_model(&stored(&with("eigenvalues", numbers(&[2])))).unwrap();
    assert_eq!(vibrations.deviations, None);
    // Variances of another number of components state nothing about these.
    let mesh = parse_model(&stored(&good())).unwrap().mesh;
    let more = parse_modes(&stored(&with("explained_variance", numbers(&[5]))), &mesh).unwrap();
    assert_eq!(more.deviations, None);
    // Which of two arrays has the variances is unknown. Modes alone do not need them; a model shows them.
    let mut two = with("explained_variance", numbers(&[2]));
    two.push(("weights", numbers(&[2])));
    assert_eq!(parse_modes(&stored(&two), &mesh).unwrap().deviations, None);
    assert!(message(&two).contains("'explained_variance' and 'weights' are the same part"));
}

#[test]
fn errors_name_the_array() {
    let without = |name: &str| {
        let mut entries = good();
        entries.retain(|(other, _)| *other != name);
        message(&entries)
    };
    assert!(without("mean").starts_with("the archive has no array named mean, mean_, vertices"));
    assert!(
        without("modes").starts_with("the archive has no array named modes, shapedirs, U, basis, components")
    );
    assert!(without("faces").ends_with("triangles: pass it as modes of a mesh file"));
    let twice = "'mean' and 'v_template' are the same part of the model: remove one of them";
    assert_eq!(message(&with("v_template", numbers(&[4, 3]))), twice);
    assert!(
        message(&with("components", numbers(&[2, 12])))
            .contains("'modes' and 'components' are the same part")
    );
    assert_eq!(
        message(&with("mean", numbers(&[3, 4]))),
        "array 'mean': shape [3, 4]: (V, 3) or (3V) was expected"
    );
    assert!(message(&with("mean", b"x".to_vec())).starts_with("array 'mean': byte 0: not a NumPy array"));
    assert!(
        message(&with("modes", numbers(&[2, 12])))
            .contains("array 'modes': shape [2, 12] has the modes in rows")
    );
    assert!(
        message(&with("modes", numbers(&[15, 2]))).contains("the modes are for 5 vertices, the mesh has 4")
    );
    assert!(message(&with("modes", faces("<c8", &[0; 12]))).contains("save the array as float64"));
    assert!(
        message(&with("faces", numbers(&[2, 3])))
            .contains("array 'faces': byte 10: header: the array has numbers of type '<f8'")
    );
    assert_eq!(
        message(&with("faces", faces("<i4", &[0, 1, 2, 0, 4, 1]))),
        "array 'faces': face 1 names vertex 4 (counted from 0), but there are 4"
    );
    assert!(message(&with("faces", faces("<i4", &[0, 1, 255]))).contains("face 0 names vertex -1 "));
    assert!(message(&with("faces", faces("<i4", &[]))).contains("no triangles"));
    assert!(
        message(&with("eigenvalues", numbers(&[3])))
            .contains("array 'eigenvalues': there are 3 numbers for 2 modes")
    );
}

#[test]
fn modes_of_another_mesh_are_rejected() {
    let NpzModel { mesh, modes, .. } = parse_model(&stored(&good())).unwrap();
    let alone = stored(&good()[1..2]);
    assert_eq!(parse_modes(&alone, &mesh).unwrap().modes, modes);
    let moved = |by: f64| {
        let positions = mesh.rest_positions().iter().map(|p| p + DVec3::Z * by).collect();
        TriMesh::new(positions, mesh.faces().to_vec()).unwrap()
    };
    assert!(parse_modes(&stored(&good()), &moved(1e-6)).is_ok());
    let refused = parse_modes(&stored(&good()), &moved(1e-4)).unwrap_err().to_string();
    assert!(
        refused.starts_with("the mean differs from the mesh: vertex 0 (counted from 0) differs by ("),
        "{refused}"
    );
    let fewer = TriMesh::new(vec![DVec3::ZERO; 3], vec![[0, 1, 2]]).unwrap();
    let refused = parse_modes(&stored(&good()), &fewer).unwrap_err().to_string();
    assert!(refused.contains("the modes are for 4 vertices, the mesh has 3"), "{refused}");
    for axis in 0..3 {
        let mut mean = mesh.rest_positions().to_vec();
        mean[2][axis] = f64::NAN;
        let values: Vec<f64> = mean.iter().flat_map(|p| p.to_array()).collect();
        let nan = with("mean", to_bytes(&[4, 3], &values).unwrap());
        let refused = parse_modes(&stored(&nan), &mesh).unwrap_err().to_string();
        assert!(
            refused.starts_with("the mean differs from the mesh: vertex 2 (counted from 0)"),
            "{refused}"
        );
    }
    let other_mean = with("mean", numbers(&[3, 3]));
    assert!(
        parse_modes(&stored(&other_mean), &mesh).unwrap_err().to_string().contains("the mean has 3 vertices")
    );
}

#[test]
fn damaged_archives_are_rejected() {
    for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
        let bytes = archive(&good(), method);
        for len in 0..bytes.len() {
            assert!(parse_model(&bytes[..len]).is_err(), "{len}");
        }
        for extra in [[&bytes[..], b"\0"].concat(), [b"x", &bytes[..]].concat()] {
            assert!(parse_model(&extra).is_err());
        }
        // A flipped bit is an error or does not change the model, because every array has a checksum.
        let model = parse_model(&bytes).unwrap();
        for at in 0..bytes.len() {
            for bit in [0, 3, 7] {
                let mut bytes = bytes.clone();
                bytes[at] ^= 1 << bit;
                if let Ok(read) = parse_model(&bytes) {
                    assert_eq!(read, model, "{at}");
                }
            }
        }
    }
}

#[test]
fn decompression_bombs_are_rejected() {
    // 80 MB of zeros in 80 kB.
    let bomb = archive(&with("modes", vec![0; 80_000_000]), CompressionMethod::Deflated);
    assert!(bomb.len() < 100_000);
    let refused = parse_model(&bomb).unwrap_err().to_string();
    assert!(refused.starts_with("array 'modes': its numbers would take more than"), "{refused}");
    // A false size in the directory, which follows the data, as a number of 4 bytes.
    let honest = archive(&with("modes", vec![0; 1_000_000]), CompressionMethod::Deflated);
    let size = 1_000_000_u32.to_le_bytes();
    let at = honest.windows(4).rposition(|w| w == size).unwrap();
    for false_size in [0_u32, 1000, 999_999, 1_000_001, 1 << 30, u32::MAX] {
        let mut bytes = honest.clone();
        bytes[at..at + 4].copy_from_slice(&false_size.to_le_bytes());
        let refused = parse_model(&bytes).unwrap_err().to_string();
        assert!(!refused.contains("array 'modes': byte 0"), "{false_size}: {refused}");
    }
}

#[test]
fn repeated_names_are_rejected() {
    let mut bytes = stored(&with("meaN", numbers(&[4, 3])));
    while let Some(at) = bytes.windows(8).position(|w| w == b"meaN.npy") {
        bytes[at..at + 4].copy_from_slice(b"mean");
    }
    assert!(parse_model(&bytes).is_err());
    // An archive of zip64 states its number of entries elsewhere.
    assert_eq!(parse_model(&zip64(stored(&good()))), parse_model(&stored(&good())));
    let message = parse_model(&zip64(bytes)).unwrap_err().to_string();
    assert!(message.ends_with("the archive has 4 names for 5 entries: is a name repeated?"), "{message}");
}

/// Returns an archive with the records of zip64 at its end.
fn zip64(mut archive: Vec<u8>) -> Vec<u8> {
    let mut end = archive.split_off(archive.len() - 22);
    let number = |at: usize, size: usize| {
        let mut bytes = [0; 8];
        bytes[..size].copy_from_slice(&end[at..at + size]);
        bytes
    };
    let (entries, size, offset) = (number(10, 2), number(12, 4), number(16, 4));
    let at = archive.len() as u64;
    archive.extend(b"PK\x06\x06");
    archive.extend(44_u64.to_le_bytes());
    archive.extend([45, 0, 45, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    archive.extend([entries, entries, size, offset].concat());
    archive.extend(b"PK\x06\x07\0\0\0\0");
    archive.extend(at.to_le_bytes());
    archive.extend(1_u32.to_le_bytes());
    end[8..20].fill(0xff);
    archive.extend(end);
    archive
}
