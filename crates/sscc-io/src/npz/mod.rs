//! Reads models from NumPy archives (`.npz`): PCA models, body models.
//!
//! The name of an array decides its use; other arrays are skipped. V vertices, r modes, N triangles:
//!
//! | array | names | shape |
//! | --- | --- | --- |
//! | rest positions | `mean`, `mean_`, `vertices`, `v_template`, `rest_positions` | (V, 3) or (3V) |
//! | modes | `modes`, `shapedirs`, `U`, `basis` | (3V, r), (V, 3, r), (r, V, 3), (V, 3) or (3V) |
//! | modes, first axis first | `components`, `components_` (scikit-learn) | (r, 3V), (r, V, 3), (3V, r), (V, 3, r), (V, 3) or (3V) |
//! | triangles | `faces`, `f`, `triangles` | (N, 3), integers from 0 |
//! | one number for each mode | `weights`, `explained_variance`, `explained_variance_`, `eigenvalues` | (r) |
//!
//! Variances (`explained_variance`, and `eigenvalues` of `components`) state how far each entry of q goes in the samples
//! of the model: [`NpzModel::deviations`].
//!
//! If a shape fits two forms, the first one in the table applies. Two names for one part are an error. Arrays are floats or
//! integers, faces integers. An archive may be stored or deflated (`numpy.savez`, `numpy.savez_compressed`). Its
//! recognised arrays may take up to 100 times the file's size plus 64 MiB, at most 4 GiB, and their numbers, 8 bytes each,
//! up to 400 times the file's size plus 64 MiB, at most 8 GiB.
//!
//! [`write_npz`] writes arrays of any names.

mod archive;
mod deviations;
mod names;
mod number_limit;
mod parts;
mod write;

use std::path::Path;

use sscc::{Modes, TriMesh};

use self::names::Part;
use self::parts::Parts;
use crate::modes::NamedModes;
use crate::{FormatError, IoError, read_whole};

pub use write::{NamedArray, write_npz};

/// A model from an archive.
#[derive(Clone, Debug, PartialEq)]
pub struct NpzModel {
    /// The mesh.
    pub mesh: TriMesh,
    /// Its modes.
    pub modes: Modes,
    /// The numbers that the file has for each mode (r), such as variances. Their meaning depends on the array's name.
    pub weights: Option<Vec<f64>>,
    /// The standard deviation of each entry of q (r), if the file has the variances of principal components.
    pub deviations: Option<Vec<f64>>,
}

/// Reads a complete model.
///
/// # Errors
/// When the file cannot be read, is not an archive, is damaged or too large when unpacked; when the mean, the modes or
/// the faces are missing, or their type or shape is not in the table; when two arrays are for one part; when there is
/// another number of weights than of modes; when a face names no vertex, or a number is out of range.
pub fn read_npz_model(path: &Path) -> Result<NpzModel, IoError> {
    parse_model(&read_whole(path)?).map_err(|error| error.of(path))
}

/// As [`read_npz_model`], from bytes.
///
/// # Errors
/// As [`read_npz_model`], without the file's name.
pub fn parse_model(bytes: &[u8]) -> Result<NpzModel, FormatError> {
    let all = [Part::Mean, Part::Modes, Part::Components, Part::Faces, Part::Weights];
    let parts = Parts::read(bytes, &all, None)?;
    let mesh = parts.mesh()?;
    let modes = parts.modes(mesh.rest_positions().len())?;
    let weights = parts.weights(modes.rank())?;
    let deviations = parts.deviations(&modes);
    Ok(NpzModel { mesh, modes, weights, deviations })
}

/// Parses the modes of a mesh, with the standard deviations of q if the file has their variances (and only one array
/// with a number for each mode); faces and other arrays are skipped. If the archive has a mean, it must equal the rest positions
/// of the mesh up to 2^-20 of their largest coordinate (the precision of float32 and of text with 6 digits).
///
/// # Errors
/// As [`parse_model`] for the modes and for the mean, which may be missing; when the modes or the mean belong to
/// another mesh.
pub fn parse_modes(bytes: &[u8], mesh: &TriMesh) -> Result<NamedModes, FormatError> {
    let parts = Parts::read(bytes, &[Part::Mean, Part::Modes, Part::Components], Some(Part::Weights))?;
    let positions = mesh.rest_positions();
    let modes = parts.modes(positions.len())?;
    let deviations = parts.deviations(&modes);
    let modes = NamedModes { modes, names: Vec::new(), deviations };
    let Some(mean) = parts.mean()? else {
        return Ok(modes);
    };
    if mean.len() != positions.len() {
        let cause = format!("the mean has {} vertices, the mesh has {}", mean.len(), positions.len());
        return Err(FormatError::whole(cause));
    }
    let largest = positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let tolerance = largest * 2.0_f64.powi(-20);
    // NaN must fail this test, too. The largest entry of a vector would ignore it.
    let is_close = |vertex: &usize| {
        (mean[*vertex] - positions[*vertex]).to_array().iter().all(|entry| entry.abs() <= tolerance)
    };
    match (0..mean.len()).find(|vertex| !is_close(vertex)) {
        Some(vertex) => {
            let [x, y, z] = (mean[vertex] - positions[vertex]).to_array();
            let cause = format!(
                "the mean differs from the mesh: vertex {vertex} (counted from 0) differs by ({x:.3e}, {y:.3e}, {z:.3e}); \
                 use the mesh of the mean, or an archive with modes only"
            );
            Err(FormatError::whole(cause))
        }
        None => Ok(modes),
    }
}

#[cfg(test)]
mod tests;
