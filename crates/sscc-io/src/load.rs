//! A model by the names of its files.

use std::path::Path;

use sscc::ReducedModel;

use crate::file::ending;
use crate::{IoError, ModelInfo, read_mesh, read_model, read_modes};

/// Loads a model: a `*.model.safetensors` alone, or a mesh file with a file of its modes (default metric:
/// displacement).
///
/// # Errors
/// When modes are missing for a mesh, or given for a model that has its own; when a file cannot be read or
/// is malformed; when the modes are of another mesh.
pub fn load_model(path: &Path, modes: Option<&Path>) -> Result<(ReducedModel, ModelInfo), IoError> {
    let refused = |at: &Path, cause: &str| IoError::Request { path: at.to_owned(), cause: cause.into() };
    match (ending(path).as_str(), modes) {
        ("safetensors", None) => read_model(path),
        ("safetensors", Some(_)) => Err(refused(path, "a model file has its own modes: leave out --modes")),
        (_, None) => {
            // A file that is missing or no mesh at all is told first: modes would not help.
            read_mesh(path)?;
            Err(refused(path, "a mesh has no modes: add --modes FILE"))
        }
        (_, Some(modes_path)) => {
            let mesh = read_mesh(path)?;
            let modes = read_modes(modes_path, mesh.rest_positions().len())?;
            let model =
                ReducedModel::new(mesh, modes).map_err(|error| refused(modes_path, &error.to_string()))?;
            let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let provenance = format!("mesh {}, modes {}", name(path), name(modes_path));
            Ok((model, ModelInfo::new("", provenance)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{write_model, write_npy};

    #[test]
    fn a_mesh_with_modes_becomes_a_model() {
        let directory = tempfile::tempdir().unwrap();
        let [mesh, modes, model] =
            ["a.obj", "a.npy", "a.model.safetensors"].map(|n| directory.path().join(n));
        std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        write_npy(&modes, &[9, 2], &std::array::from_fn::<f64, 18, _>(|i| i as f64)).unwrap();
        let (loaded, info) = load_model(&mesh, Some(&modes)).unwrap();
        assert_eq!(info.provenance, "mesh a.obj, modes a.npy");
        write_model(&model, &loaded, &info).unwrap();
        let (again, same_info) = load_model(&model, None).unwrap();
        assert_eq!(
            (again.mesh(), again.modes(), again.metric()),
            (loaded.mesh(), loaded.modes(), loaded.metric())
        );
        assert_eq!(same_info, info);

        let message = |path: &Path, modes: Option<&Path>| load_model(path, modes).unwrap_err().to_string();
        assert!(message(&mesh, None).ends_with("a.obj: a mesh has no modes: add --modes FILE"));
        assert!(message(&model, Some(&modes)).ends_with("has its own modes: leave out --modes"));
        assert!(message(&directory.path().join("b.obj"), None).ends_with("b.obj: not found"));
        write_npy(&modes, &[9, 2], &[1e-70; 18]).unwrap();
        assert!(load_model(&mesh, Some(&modes)).is_ok());
        write_npy(&modes, &[12, 1], &[0.0; 12]).unwrap();
        assert!(message(&mesh, Some(&modes)).contains("a.npy: the modes are for 4 vertices, the mesh has 3"));
    }
}
