//! Loads a model from its files, in any supported format.

use std::path::Path;

use sscc::{Modes, ReducedModel, TriMesh};

use crate::file::{check_exists, ending};
use crate::{
    IoError, ModelInfo, NamedModes, NpzModel, gltf, read_mesh, read_model, read_modes_for, read_npz_model,
};

/// Cause of the error for a mesh without modes.
const NO_MODES: &str = "a mesh has no modes: add --modes FILE, or compute modes with sscc modes; sscc check without a \
                        q checks the mesh as it is";

/// Options for loading a model.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct LoadOptions<'a> {
    /// Modes of a mesh file: a file, or a folder of target meshes.
    pub modes: Option<&'a Path>,
    /// Name of the mesh in a glTF file with several meshes.
    pub mesh_name: Option<&'a str>,
}

impl<'a> LoadOptions<'a> {
    /// Creates options with these values.
    pub fn new(modes: Option<&'a Path>, mesh_name: Option<&'a str>) -> Self {
        Self { modes, mesh_name }
    }
}

/// A model with the additional data of its files.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LoadedModel {
    /// The model.
    pub model: ReducedModel,
    /// Units and provenance.
    pub info: ModelInfo,
    /// Default q of a glTF file (r numbers).
    pub default_q: Option<Vec<f64>>,
    /// Names of the modes (r), or empty.
    pub mode_names: Vec<String>,
    /// One number per mode from a `.npz` file (r), such as variances.
    pub mode_weights: Option<Vec<f64>>,
}

/// Loads a model with modes alone and returns the model with its units and provenance: see [`load_model_with`].
///
/// # Errors
/// As [`load_model_with`].
pub fn load_model(path: &Path, modes: Option<&Path>) -> Result<(ReducedModel, ModelInfo), IoError> {
    let loaded = load_model_with(path, &LoadOptions::new(modes, None))?;
    Ok((loaded.model, loaded.info))
}

/// Loads a model from a `*.model.safetensors` file, from a `.glb` or `.gltf` file with morph targets, from a complete
/// `.npz` file, or from a mesh file with its modes ([`read_modes_for`]). The metric is that of the file, else
/// displacement.
///
/// # Errors
/// When modes are missing for a mesh, or given for a model that contains modes; when a mesh is named for a file other
/// than glTF; when a file cannot be read or is malformed; when the modes belong to another mesh.
pub fn load_model_with(path: &Path, options: &LoadOptions<'_>) -> Result<LoadedModel, IoError> {
    let refused = |cause: &str| IoError::Request { path: path.to_owned(), cause: cause.into() };
    // A missing file is reported first.
    check_exists(path)?;
    let format = ending(path);
    let is_gltf = matches!(format.as_str(), "glb" | "gltf");
    if options.mesh_name.is_some() && !is_gltf {
        return Err(named_mesh_error(path));
    }
    match (format.as_str(), options.modes) {
        ("safetensors", None) => {
            let (model, info) = read_model(path)?;
            Ok(LoadedModel { model, info, default_q: None, mode_names: Vec::new(), mode_weights: None })
        }
        ("glb" | "gltf", None) => {
            let read = gltf::read(path, options.mesh_name)?;
            let provenance = format!("mesh {:?} of {}", read.mesh_name, name(path));
            let loaded = assemble(path, read.mesh, read.modes, provenance, read.target_names)?;
            Ok(LoadedModel { default_q: Some(read.default_weights), ..loaded })
        }
        ("npz", None) => {
            let NpzModel { mesh, modes, weights } = read_npz_model(path)?;
            let loaded = assemble(path, mesh, modes, format!("arrays of {}", name(path)), Vec::new())?;
            Ok(LoadedModel { mode_weights: weights, ..loaded })
        }
        ("safetensors" | "glb" | "gltf" | "npz", Some(_)) => {
            Err(refused("a model file has its own modes: leave out --modes"))
        }
        (_, None) => {
            // A missing or malformed mesh is reported before missing modes.
            read_mesh(path)?;
            Err(refused(NO_MODES))
        }
        (_, Some(modes_path)) => {
            let mesh = read_mesh(path)?;
            let NamedModes { modes, names } = read_modes_for(modes_path, &mesh, path)?;
            let provenance = format!("mesh {}, modes {}", name(path), name(modes_path));
            assemble(modes_path, mesh, modes, provenance, names)
        }
    }
}

/// Loads a mesh at rest from a file of any format: a mesh file, a `.glb` or `.gltf` file
/// ([`gltf::read_base_mesh`]), or a model without its modes.
///
/// # Errors
/// When a mesh is named for a file other than glTF, the file cannot be read or is malformed, or has no triangles.
pub fn load_mesh(path: &Path, mesh_name: Option<&str>) -> Result<TriMesh, IoError> {
    let format = ending(path);
    if mesh_name.is_some() && !matches!(format.as_str(), "glb" | "gltf") {
        check_exists(path)?;
        return Err(named_mesh_error(path));
    }
    match format.as_str() {
        "glb" | "gltf" => gltf::read_base_mesh(path, mesh_name),
        "safetensors" => Ok(read_model(path)?.0.mesh().clone()),
        "npz" => Ok(read_npz_model(path)?.mesh),
        _ => read_mesh(path),
    }
}

/// Returns the error for a named mesh of a file that has only one.
fn named_mesh_error(path: &Path) -> IoError {
    let cause = "only a glTF file can have several meshes: leave out --mesh-name".into();
    IoError::Request { path: path.to_owned(), cause }
}

/// Whether the format splits vertices along seams, so that adjacent triangles share no vertex: STL and glTF. For
/// adjacency in such files, vertices of equal position and equal modes should be welded.
pub fn splits_vertices(path: &Path) -> bool {
    matches!(ending(path).as_str(), "stl" | "glb" | "gltf")
}

/// Builds the model. `at` is the file to name in the error if mesh and modes do not fit.
fn assemble(
    at: &Path,
    mesh: TriMesh,
    modes: Modes,
    provenance: String,
    mode_names: Vec<String>,
) -> Result<LoadedModel, IoError> {
    let model = ReducedModel::new(mesh, modes)
        .map_err(|error| IoError::Request { path: at.to_owned(), cause: error.to_string() })?;
    let info = ModelInfo::new("", provenance);
    Ok(LoadedModel { model, info, default_q: None, mode_names, mode_weights: None })
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
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
        assert!(
            message(&mesh, None)
                .contains("a.obj: a mesh has no modes: add --modes FILE, or compute modes with sscc modes")
        );
        assert!(message(&model, Some(&modes)).ends_with("has its own modes: leave out --modes"));
        assert!(message(&directory.path().join("b.obj"), None).ends_with("b.obj: not found"));
        write_npy(&modes, &[9, 2], &[1e-70; 18]).unwrap();
        assert!(load_model(&mesh, Some(&modes)).is_ok());
        write_npy(&modes, &[12, 1], &[0.0; 12]).unwrap();
        assert!(message(&mesh, Some(&modes)).contains("a.npy: the modes are for 4 vertices, the mesh has 3"));
    }

    #[test]
    fn each_kind_of_model_is_loaded() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        std::fs::write(path("a.obj"), obj).unwrap();
        let stl =
            "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid";
        std::fs::write(path("a.STL"), stl).unwrap();
        std::fs::create_dir(path("targets")).unwrap();
        std::fs::write(path("targets/smile.obj"), obj.replace("v 1 0 0", "v 1 0 2")).unwrap();
        let mut moved = [0.0; 9];
        moved[5] = 2.0;
        write_npy(&path("a.npy"), &[9, 1], &moved).unwrap();
        let mut npz = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        npz.start_file("components.npy", zip::write::SimpleFileOptions::default()).unwrap();
        std::io::Write::write_all(&mut npz, &crate::npy::to_bytes(&[1, 9], &moved).unwrap()).unwrap();
        std::fs::write(path("a.npz"), npz.finish().unwrap().into_inner()).unwrap();

        let load = |mesh: &str, modes: &str| {
            load_model_with(&path(mesh), &LoadOptions::new(Some(&path(modes)), None)).unwrap()
        };
        let first = load("a.obj", "a.npy");
        for (mesh, modes) in
            [("a.obj", "a.npz"), ("a.obj", "targets"), ("a.STL", "a.npy"), ("a.STL", "targets")]
        {
            let other = load(mesh, modes);
            assert_eq!((other.model.mesh(), other.model.modes()), (first.model.mesh(), first.model.modes()));
            assert_eq!(other.info.provenance, format!("mesh {mesh}, modes {modes}"));
            let names: &[&str] = if modes == "targets" { &["smile"] } else { &[] };
            assert_eq!(other.mode_names, names);
        }
        let message = |name: &str, options: LoadOptions<'_>| {
            load_model_with(&path(name), &options).unwrap_err().to_string()
        };
        let npz = message("a.npz", LoadOptions::default());
        assert!(npz.contains("a.npz: the archive has no array named mean"), "{npz}");
        let named = message("a.obj", LoadOptions::new(None, Some("x")));
        assert!(named.ends_with("leave out --mesh-name"), "{named}");
        for own in ["a.npz", "b.glb", "b.gltf"] {
            let modes = path("a.npy");
            let refused = || message(own, LoadOptions::new(Some(&modes), None));
            assert!(path(own).exists() || refused().ends_with(&format!("{own}: not found")));
            std::fs::write(path(own), "x").unwrap();
            assert!(refused().ends_with("leave out --modes"));
        }
        for mesh in ["a.obj", "a.STL"] {
            assert_eq!(load_mesh(&path(mesh), None).unwrap(), *first.model.mesh());
        }
        let named = load_mesh(&path("a.obj"), Some("x")).unwrap_err().to_string();
        assert!(named.ends_with("leave out --mesh-name"), "{named}");
        assert!(splits_vertices(Path::new("a.STL")) && splits_vertices(Path::new("a.glb")));
        assert!(!splits_vertices(Path::new("a.obj")));
    }
}
