//! Frames of a mesh: `.npy`, point caches, VTK. The first byte chooses the file extension.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line, two_triangles};
use sscc_io::FrameReader;

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    let Some((first, rest)) = bytes.split_first() else { return };
    let mut folder = tempfile::Builder::new();
    let ending = [".npy", ".pc2", ".vtk", ".vtu", ".pvd"][usize::from(*first) % 5];
    let Ok(file) = folder.suffix(ending).tempfile() else { return };
    if std::fs::write(file.path(), rest).is_err() {
        return;
    }
    let mesh = two_triangles();
    let Some(mut frames) = one_line(FrameReader::open(file.path(), &mesh, Path::new("mesh.obj"))) else {
        return;
    };
    let mut positions = Vec::new();
    for frame in 0..frames.len().min(3) {
        one_line(frames.check(frame, &mut positions));
    }
}
