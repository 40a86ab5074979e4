//! Reads models from files: a mesh of triangles (.obj) with a matrix of modes (.npy), or one `*.model.safetensors`.

use std::fs;
use std::path::Path;

use crate::container::reals;
use crate::model::Model;
use crate::refusal::{Refusal, Result, input};

/// Reads all bytes of a file.
///
/// # Errors
/// When the system reports an error.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).or_else(|cause| input(format!("{}: {cause}", shown(path))))
}

/// Returns a path on one line, with control characters escaped.
fn shown(path: &Path) -> String {
    let path = path.to_string_lossy();
    if path.chars().any(char::is_control) { path.escape_debug().to_string() } else { path.into_owned() }
}

impl Model {
    /// Reads a model: from a mesh and its modes, or, without `modes`, from one file with both.
    ///
    /// # Errors
    /// When a file cannot be read, or its content is invalid.
    pub fn read(mesh: &Path, modes: Option<&Path>) -> Result<Self> {
        let bytes = read(mesh)?;
        let of_mesh = |refusal: Refusal| refusal.of(&shown(mesh));
        let Some(path) = modes else { return Self::from_container(&bytes).map_err(of_mesh) };
        let of_modes = |refusal: Refusal| refusal.of(&shown(path));
        let (positions, faces) = parse_obj(&String::from_utf8_lossy(&bytes)).map_err(of_mesh)?;
        let (modes, rank) = parse_npy(&read(path)?, positions.len()).map_err(of_modes)?;
        Self::new(positions, faces, modes, rank).map_err(of_modes)
    }
}

/// Positions and faces of a mesh of triangles.
type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

fn parse_obj(text: &str) -> Result<Mesh> {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (number, line) in text.replace("\r\n", "\n").split(['\n', '\r']).enumerate() {
        let mut words = line.split('#').next().unwrap_or_default().split_whitespace();
        let parsed = match words.next() {
            Some("v") => {
                let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
                numbers.first_chunk().map(|position| positions.push(*position))
            }
            Some("f" | "fo") => {
                let count = positions.len() as i64;
                let vertex = |word: &str| {
                    let number: i64 = word.split('/').next()?.parse().ok()?;
                    u32::try_from(if number < 0 { count + number } else { number - 1 }).ok()
                };
                let corners: Option<Vec<u32>> = words.map(vertex).collect();
                corners.and_then(|corners| corners.try_into().ok()).map(|face| faces.push(face))
            }
            _ => Some(()),
        };
        if parsed.is_none() {
            let wanted = "a vertex of three numbers or a triangle was expected (other polygons are not read)";
            return input(format!("line {}: {wanted}", number + 1));
        }
    }
    Ok((positions, faces))
}

/// Returns the modes (3V x r by rows) of an array of f64 of the shape (3V, r) or (V, 3, r), and r.
fn parse_npy(bytes: &[u8], vertices: usize) -> Result<(Vec<f64>, usize)> {
    let parsed = || {
        let length = match (bytes.strip_prefix(b"\x93NUMPY")?, bytes.get(6)?) {
            (_, 1) => 10 + usize::from(u16::from_le_bytes(*bytes.get(8..10)?.first_chunk()?)),
            _ => 12 + u32::from_le_bytes(*bytes.get(8..12)?.first_chunk()?) as usize,
        };
        let header = String::from_utf8_lossy(bytes.get(10..length)?);
        let is_known = header.contains("'<f8'") && header.contains("'fortran_order': False");
        let shape = header.split_once('(')?.1.split_once(')')?.0;
        let axes = shape.split(',').map(|axis| axis.trim().parse::<usize>().ok());
        let axes = axes.collect::<Option<Vec<_>>>()?;
        let data = &bytes[length..];
        let rank = (data.len() / 8).checked_div(3 * vertices)?;
        let fits = axes == [3 * vertices, rank] || axes == [vertices, 3, rank];
        (is_known && fits && data.len() == 24 * vertices * rank).then(|| (reals(data), rank))
    };
    parsed().ok_or_else(|| {
        let rows = 3 * vertices;
        Refusal::Input(format!("not an .npy file of float64 in C order, ({rows}, r) or ({vertices}, 3, r)"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_and_modes_are_read_and_others_refused() {
        let mesh =
            parse_obj("# two\nv 0 0 0\nv 1 0 0 # x\nv 0 1e0 0\nvn 0 0 1\nf 1/2/3 2 3\nf -3 -2 -1\n").unwrap();
        assert_eq!(mesh, (vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]; 2]));
        assert_eq!(parse_obj("v 0 0 0\rv 1 0 0\r\nv 0 1 0\nfo 1 2 3 # 4\rf 1 2 3#\n").unwrap(), mesh);
        for wrong in ["v 1 2", "v 0 0 0\nf 1 1 1 1", "f 0 1 2", "f 1 2 x"] {
            assert!(parse_obj(wrong).unwrap_err().to_string().contains("line"), "{wrong}");
        }
        let npy = |header: &str, count: usize| {
            let mut bytes = b"\x93NUMPY\x01\0".to_vec();
            bytes.extend((header.len() as u16).to_le_bytes());
            bytes.extend(header.as_bytes());
            bytes.extend((0..count).flat_map(|i| (i as f64).to_le_bytes()));
            bytes
        };
        let header =
            |shape: &str| format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}");
        for shape in ["6, 3", "2, 3, 3"] {
            let (modes, rank) = parse_npy(&npy(&header(shape), 18), 2).unwrap();
            assert_eq!((modes[17], rank), (17.0, 3));
            assert!(parse_npy(&npy(&header(shape), 17), 2).is_err());
        }
        for wrong in ["5, 3", "18", "3, 2, 3", "x, 3"] {
            assert!(parse_npy(&npy(&header(wrong), 18), 2).is_err(), "{wrong}");
        }
        let fortran = header("6, 3").replace("False", "True");
        assert!(parse_npy(&npy(&fortran, 18), 2).is_err() && parse_npy(b"\x93NUMPY", 2).is_err());
    }
}
