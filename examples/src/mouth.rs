//! A model of a mouth with four modes, written in each of the formats that the examples read.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use glam::DVec3;
use serde_json::{Value, json};
use sscc_io::npy;
use zip::{ZipWriter, write::SimpleFileOptions};

/// Number of vertices of each ring. The mouth is a sheet of skin around an opening, with 2 x 64 x 6 triangles.
const AROUND: usize = 64;

/// Number of rings of triangles.
const RINGS: usize = 6;

/// The names of the modes.
const NAMES: [&str; 4] = ["close", "bite", "smile", "purse"];

/// The variance of a population of mouths along each mode.
const VARIANCES: [f64; 4] = [0.09, 0.04, 0.25, 0.25];

struct Mouth {
    positions: Vec<DVec3>,
    /// `modes[k][vertex]`
    modes: [Vec<DVec3>; NAMES.len()],
    faces: Vec<[u32; 3]>,
}

/// Returns the mouth. At rest it is open, with a gap of 0.6 between the lips in the middle. A unit of the mode `close`
/// reduces the gap by 0.8, a unit of `bite` by 0.9.
fn mouth() -> Mouth {
    let mut mouth = Mouth { positions: Vec::new(), modes: Default::default(), faces: Vec::new() };
    for ring in 0..=RINGS {
        for spoke in 0..AROUND {
            let (sin, cos) = libm::sincos(TAU * spoke as f64 / AROUND as f64);
            let out = ring as f64 / RINGS as f64; // from the lips to the cheeks
            mouth.positions.push(DVec3::new((1.0 + out) * cos, (0.3 + out) * sin, 0.5 * out * (1.0 - out)));
            let fields = [
                DVec3::new(0.0, -0.4 * sin * sin.abs(), 0.0),
                DVec3::new(0.0, 0.9 * sin.min(0.0) * sin.min(0.0), 0.0),
                DVec3::new(0.2 * cos, 0.3 * cos * cos, 0.0),
                DVec3::new(-0.3 * cos, 0.0, 0.3),
            ];
            for (mode, field) in mouth.modes.iter_mut().zip(fields) {
                mode.push(field * (1.0 - out) * (1.0 - out));
            }
            if ring < RINGS {
                let next = (spoke + 1) % AROUND;
                let [a, b] = [spoke, next].map(|spoke| (ring * AROUND + spoke) as u32);
                let [c, d] = [a, b].map(|vertex| vertex + AROUND as u32);
                mouth.faces.extend([[a, c, b], [b, c, d]]);
            }
        }
    }
    mouth
}

/// Writes `mouth.glb` with four morph targets. Each triangle has its own three vertices, as modelling programs write sharp
/// edges, so the model needs welding.
///
/// # Errors
/// When the file cannot be written.
pub fn mouth_glb(folder: &Path) -> io::Result<PathBuf> {
    let Mouth { positions, modes, faces } = mouth();
    let mut binary: Vec<u8> = Vec::new();
    for vectors in [&positions].into_iter().chain(&modes) {
        for &vertex in faces.iter().flatten() {
            binary.extend(vectors[vertex as usize].as_vec3().to_array().iter().flat_map(|x| x.to_le_bytes()));
        }
    }
    let length = binary.len() / (1 + NAMES.len());
    let list = |of: &dyn Fn(usize) -> Value| -> Vec<Value> { (0..=NAMES.len()).map(of).collect() };
    let json = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": binary.len()}],
        "bufferViews": list(&|i| json!({"buffer": 0, "byteOffset": i * length, "byteLength": length})),
        "accessors":
            list(&|i| json!({"bufferView": i, "componentType": 5126, "type": "VEC3", "count": length / 12})),
        "meshes": [{
            "name": "Mouth",
            "primitives": [{
                "attributes": {"POSITION": 0},
                "targets": list(&|i| json!({"POSITION": i}))[1..],
            }],
            "extras": {"targetNames": NAMES},
        }],
    });
    let mut json = json.to_string();
    while !json.len().is_multiple_of(4) {
        json.push(' ');
    }
    let size = |bytes: usize| (bytes as u32).to_le_bytes();
    let [whole, json_size, binary_size] =
        [28 + json.len() + binary.len(), json.len(), binary.len()].map(size);
    let path = folder.join("mouth.glb");
    let chunks: [&[u8]; 8] =
        [b"glTF\x02\0\0\0", &whole, &json_size, b"JSON", json.as_bytes(), &binary_size, b"BIN\0", &binary];
    fs::write(&path, chunks.concat())?;
    Ok(path)
}

/// Writes `mouths.npz`, a population of mouths with the array names of a PCA: `mean`, `components`,
/// `explained_variance`, `faces`.
///
/// # Errors
/// When the file cannot be written.
pub fn mouths_npz(folder: &Path) -> io::Result<PathBuf> {
    let Mouth { positions, modes, faces } = mouth();
    let numbers = |vectors: &[DVec3]| vectors.iter().flat_map(|v| v.to_array()).collect::<Vec<f64>>();
    let header = format!("{{'descr': '<u4', 'fortran_order': False, 'shape': ({}, 3), }}\n", faces.len());
    let mut integers = [b"\x93NUMPY\x01\0", &(header.len() as u16).to_le_bytes()[..]].concat();
    integers.extend(header.bytes());
    integers.extend(faces.iter().flatten().flat_map(|vertex| vertex.to_le_bytes()));
    let path = folder.join("mouths.npz");
    let mut archive = ZipWriter::new(File::create(&path)?);
    for (name, bytes) in [
        ("mean.npy", npy::to_bytes(&[positions.len(), 3], &numbers(&positions))),
        ("components.npy", npy::to_bytes(&[modes.len(), 3 * positions.len()], &numbers(&modes.concat()))),
        ("explained_variance.npy", npy::to_bytes(&[VARIANCES.len()], &VARIANCES)),
        ("faces.npy", Some(integers)),
    ] {
        archive.start_file(name, SimpleFileOptions::default())?;
        archive.write_all(&bytes.ok_or(io::ErrorKind::InvalidInput)?)?;
    }
    archive.finish()?;
    Ok(path)
}

/// Writes `mouth.obj`, and `mouth.U` in the format of VegaFEM for modes: rows and columns (int32), then the matrix column by
/// column (float64).
///
/// # Errors
/// When a file cannot be written.
pub fn mouth_vegafem(folder: &Path) -> io::Result<[PathBuf; 2]> {
    let Mouth { positions, modes, faces } = mouth();
    let mut obj = String::new();
    for p in &positions {
        let _ = writeln!(obj, "v {:?} {:?} {:?}", p.x, p.y, p.z);
    }
    for [a, b, c] in faces {
        let _ = writeln!(obj, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    let mut matrix = [3 * positions.len(), modes.len()].map(|size| (size as i32).to_le_bytes()).concat();
    matrix.extend(modes.iter().flatten().flat_map(|u| u.to_array()).flat_map(f64::to_le_bytes));
    let paths = ["mouth.obj", "mouth.U"].map(|name| folder.join(name));
    fs::write(&paths[0], obj)?;
    fs::write(&paths[1], matrix)?;
    Ok(paths)
}
