//! Error for modes that belong to another mesh.

use crate::FormatError;

/// Returns the error for modes with `rows` rows (3 per vertex).
pub(super) fn mesh_mismatch(rows: usize, vertices: usize) -> FormatError {
    let of = match rows % 3 {
        0 => format!("{} vertices", rows / 3),
        _ => format!("{rows} rows (no multiple of 3)"),
    };
    FormatError::whole(format!("the modes are for {of}, the mesh has {vertices}: are they of another mesh?"))
}
