//! Readers for deformation modes (NumPy arrays and archives, VegaFEM modal matrices, folders of target meshes), and for
//! animations from which modes can be computed.

pub mod array;
mod collection;
pub mod folder;
mod frame_reader;
mod frames;
mod mesh_mismatch;
mod named_modes;
mod point_cache;
pub mod vega;
mod vtk_frames;

use std::path::Path;

use sscc::Modes;

use crate::IoError;
use crate::file::{ending, read_whole, unsupported};

pub use collection::is_collection;
pub(crate) use collection::{MAX_COLLECTION_FILES, read_collection};
pub(crate) use folder::has_mesh;
pub use frame_reader::FrameReader;
pub use frames::{Frames, read_frames};
pub use named_modes::NamedModes;

/// Formats of [`read_modes_for`](crate::read_modes_for); [`read_modes`] supports those that need no mesh.
const SUPPORTED: &str = ".npy, .U, .Ulinear, .Unonlinear, .URendering (float64), .float (float32); \
                         with their mesh also .npz and a folder of target meshes";

/// Reads the modes of a mesh with this number of vertices (unused ones included). The ending of the file name, in any
/// case, selects the format: `.npy` ([`mod@array`]), or a VegaFEM modal matrix ([`vega`]).
///
/// # Errors
/// When the ending is unknown, the file cannot be read or is malformed, the modes belong to a mesh with another number of
/// vertices, or there are none.
pub fn read_modes(path: &Path, vertices: usize) -> Result<Modes, IoError> {
    let parse = match ending(path).as_str() {
        "npy" => |bytes: &[u8], vertices| array::from_array(&crate::npy::parse(bytes)?, vertices),
        "float" => |bytes: &[u8], vertices| vega::parse(bytes, vega::Precision::Single, vertices),
        "u" | "ulinear" | "unonlinear" | "urendering" => {
            |bytes: &[u8], vertices| vega::parse(bytes, vega::Precision::Double, vertices)
        }
        _ => return Err(unsupported(path, "modes", SUPPORTED)),
    };
    parse(&read_whole(path)?, vertices).map_err(|error| error.of(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_selects_the_format() {
        let directory = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: &[u8]| {
            let path = directory.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            path
        };
        let vega = [&3i32.to_le_bytes()[..], &1i32.to_le_bytes(), &[0; 12]].concat();
        assert_eq!(read_modes(&write("a.U.FLOAT", &vega), 1).unwrap().rank(), 1);
        let npy = crate::npy::to_bytes(&[3, 2], &[0.0; 6]).unwrap();
        assert_eq!(read_modes(&write("a.npy", &npy), 1).unwrap().rank(), 2);
        let message = |name, bytes| read_modes(&write(name, bytes), 1).unwrap_err().to_string();
        assert!(message("a.U", &vega).contains("rename it to end in .float"));
        let missing = read_modes(&directory.path().join("b.csv"), 1).unwrap_err().to_string();
        assert!(missing.ends_with("b.csv: not found"));
        assert!(message("a.npz", &npy).contains("unknown kind of modes file; supported: .npy, .U"));
    }
}
