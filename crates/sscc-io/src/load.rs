//! Loads a model from its files, in any supported format.

use std::path::{Path, PathBuf};

use sscc::{ReducedModel, TriMesh};

use crate::file::{check_exists, ending, unsupported};
use crate::mesh::{is_mesh_name, read_mesh_with_warnings};
use crate::mesh_path::named_file;
use crate::modes::{is_collection, read_collection};
use crate::solid::vtk::{Displacement, is_vtk_name, read_surface};
use crate::solid::{is_solid_name, read_volume_or_surface};
use crate::{
    IoError, ModelInfo, NamedModes, NpzModel, Setting, gltf, read_model, read_modes_for, read_npz_model,
};

/// Endings of the files that have a mesh.
const SUPPORTED: &str = ".obj, .off, .ply, .stl; solids: .mesh, .veg, .msh, .node, .ele, .vtu, .vtk, .pvd; \
                         glTF: .glb, .gltf, .vrm; models: .npz, .model.safetensors";

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
    /// Units and provenance; also forces, mass and standard deviations, if the files have them.
    pub info: ModelInfo,
    /// Default q of a glTF file (r numbers).
    pub default_q: Option<Vec<f64>>,
    /// Names of the modes (r), or empty.
    pub mode_names: Vec<String>,
    /// One number per mode from a `.npz` file (r), such as variances.
    pub mode_weights: Option<Vec<f64>>,
    /// Lines about content of the file whose meaning is not clear ([`read_mesh_with_warnings`]), or that its standard
    /// requires but the file lacks.
    pub warnings: Vec<String>,
    /// The glTF file, and the name of the mesh.
    scene: Option<(PathBuf, Option<String>)>,
}

impl LoadedModel {
    /// Reads the places that the nodes of a glTF file give the model: [`gltf::PlacedMesh::place`] moves its positions, which
    /// are in the coordinates of the mesh, to the world. None for other files, which have no nodes.
    ///
    /// # Errors
    /// When the file cannot be read, or its nodes or skins are malformed.
    pub fn placement(&self) -> Result<Option<gltf::PlacedMesh>, IoError> {
        let read =
            |(path, name): &(PathBuf, Option<String>)| gltf::read_model_placement(path, name.as_deref());
        self.scene.as_ref().map(read).transpose()
    }
}

/// A mesh with lines about its file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LoadedMesh {
    /// The mesh.
    pub mesh: TriMesh,
    /// Lines about content whose meaning is not clear ([`read_mesh_with_warnings`]), or that was not evaluated
    /// ([`gltf::PlacedMesh::notes`]).
    pub warnings: Vec<String>,
}

/// Loads a model as [`load_model_with`] does, without a mesh name, and returns it with its units and provenance.
///
/// # Errors
/// As [`load_model_with`].
pub fn load_model(path: &Path, modes: Option<&Path>) -> Result<(ReducedModel, ModelInfo), IoError> {
    let loaded = load_model_with(path, &LoadOptions::new(modes, None))?;
    Ok((loaded.model, loaded.info))
}

/// Loads a model from a `*.model.safetensors` file, from a glTF file ([`gltf::is_gltf`]) with morph targets, from a complete
/// `.npz` file, or from a mesh file or a solid with its modes ([`read_modes_for`]). The metric is that of the file, else
/// displacement. `FILE#NAME` ([`split_mesh_name`](crate::split_mesh_name)) names the mesh as [`LoadOptions::mesh_name`] does.
///
/// A model of a glTF file is in the coordinates of its mesh: see [`LoadedModel::placement`].
///
/// # Errors
/// When modes are missing for a mesh, or given for a model that contains modes; when a mesh is named for a file other
/// than glTF, or twice; when a file cannot be read or is malformed; when the modes belong to another mesh.
pub fn load_model_with(path: &Path, options: &LoadOptions<'_>) -> Result<LoadedModel, IoError> {
    let (file, mesh_name) = named_file(path, options.mesh_name)?;
    let (path, mesh_name) = (file.as_path(), mesh_name.as_deref());
    // A missing file is reported first.
    check_exists(path)?;
    let format = ending(path);
    let is_gltf = gltf::is_gltf(path);
    if mesh_name.is_some() && !is_gltf {
        return Err(named_mesh_error(path));
    }
    match (format.as_str(), options.modes) {
        ("safetensors", None) => {
            let (model, info) = read_model(path)?;
            Ok(loaded(model, info, Vec::new()))
        }
        (_, None) if is_gltf => {
            let read = gltf::read(path, mesh_name)?;
            let provenance = format!("mesh {:?} of {}", read.mesh_name, name(path));
            let modes = NamedModes { modes: read.modes, names: read.target_names, deviations: None };
            let loaded = assemble(path, read.mesh, modes, provenance)?;
            let scene = Some((path.to_owned(), mesh_name.map(str::to_owned)));
            Ok(LoadedModel { default_q: Some(read.default_weights), warnings: read.notes, scene, ..loaded })
        }
        ("npz", None) => {
            let NpzModel { mesh, modes, weights, deviations } = read_npz_model(path)?;
            let modes = NamedModes { modes, names: Vec::new(), deviations };
            let loaded = assemble(path, mesh, modes, format!("arrays of {}", name(path)))?;
            Ok(LoadedModel { mode_weights: weights, ..loaded })
        }
        (format, Some(_)) if is_gltf || matches!(format, "safetensors" | "npz") => {
            Err(IoError::request(path, "a model file has its own modes: leave out " + Setting::Modes))
        }
        (_, None) => {
            // A missing or malformed mesh is reported before missing modes.
            load_mesh(path, None)?;
            let advice =
                " FILE, or compute modes with sscc modes; sscc check without a q checks the mesh as it is";
            Err(IoError::request(path, "a mesh has no modes: add " + Setting::Modes + advice))
        }
        (_, Some(modes_path)) => {
            let LoadedMesh { mesh, warnings } = load_rest_mesh(path)?;
            let modes = read_modes_for(modes_path, &mesh, path)?;
            let provenance = format!("mesh {}, modes {}", name(path), name(modes_path));
            Ok(LoadedModel { warnings, ..assemble(modes_path, mesh, modes, provenance)? })
        }
    }
}

/// Loads a mesh at rest from a file of any format: a mesh file, a glTF file at the first place of its mesh
/// ([`gltf::read_placed_mesh`]), a model without its modes, or a solid. The mesh of a solid is the surface of its elements,
/// or of the faces in a Medit, gmsh or VTK file without elements, with all vertices of the file. `FILE#NAME`
/// ([`split_mesh_name`](crate::split_mesh_name)) names the mesh as `mesh_name` does.
///
/// A grid of VTK is deformed by its displacements ([`Displacement::ByName`]), or by the point data that `mesh_name` names; an
/// empty name leaves it undeformed. The grid of a `.pvd` collection is its first file.
///
/// # Errors
/// When a mesh is named for a file other than glTF and VTK, or twice; when the file cannot be read or is malformed, or has no
/// triangles.
pub fn load_mesh(path: &Path, mesh_name: Option<&str>) -> Result<TriMesh, IoError> {
    load_mesh_with_warnings(path, mesh_name).map(|loaded| loaded.mesh)
}

/// As [`load_mesh`], with lines about content of the file whose meaning is not clear or that was not evaluated.
///
/// # Errors
/// As [`load_mesh`].
pub fn load_mesh_with_warnings(path: &Path, mesh_name: Option<&str>) -> Result<LoadedMesh, IoError> {
    let (file, mesh_name) = named_file(path, mesh_name)?;
    let path = file.as_path();
    let format = ending(path);
    if is_grid_name(path) {
        return load_grid(path, &Displacement::of_name(mesh_name.as_deref()));
    }
    if mesh_name.is_some() && !gltf::is_gltf(path) {
        check_exists(path)?;
        return Err(named_mesh_error(path));
    }
    let (mesh, warnings) = match format.as_str() {
        _ if gltf::is_gltf(path) => {
            let placed = gltf::read_placed_mesh(path, mesh_name.as_deref())?;
            (placed.to_mesh(0).map_err(|error| error.of(path))?, placed.notes().to_vec())
        }
        "safetensors" => (read_model(path)?.0.mesh().clone(), Vec::new()),
        "npz" => (read_npz_model(path)?.mesh, Vec::new()),
        _ if is_mesh_name(path) => read_mesh_with_warnings(path)?,
        _ if is_solid_name(path) => {
            read_volume_or_surface(path)?.into_surface().map_err(|error| error.of(path))?
        }
        _ => return Err(unsupported(path, "mesh", SUPPORTED)),
    };
    Ok(LoadedMesh { mesh, warnings })
}

/// Loads the surface of a grid of VTK, or of the first one of a collection.
fn load_grid(path: &Path, displacement: &Displacement) -> Result<LoadedMesh, IoError> {
    let first = match is_collection(path) {
        true => Some(read_collection(path)?.swap_remove(0).file),
        false => None,
    };
    let path = first.as_deref().unwrap_or(path);
    let (mesh, warnings) = read_surface(path, displacement)?;
    Ok(LoadedMesh { mesh, warnings })
}

/// As [`load_mesh_with_warnings`], but a grid of VTK, or the first one of a collection, is at rest, without its displacements.
fn load_rest_mesh(path: &Path) -> Result<LoadedMesh, IoError> {
    match is_grid_name(path) {
        true => load_grid(path, &Displacement::None),
        false => load_mesh_with_warnings(path, None),
    }
}

/// Whether the ending is that of a grid of VTK or of a collection of grids.
fn is_grid_name(path: &Path) -> bool {
    is_vtk_name(path) || is_collection(path)
}

/// Returns the error for a named mesh of a file that has only one.
fn named_mesh_error(path: &Path) -> IoError {
    IoError::request(path, "only a glTF file can have several meshes: leave out " + Setting::MeshName)
}

/// Builds the model. `at` is the file to name in the error if mesh and modes do not fit.
fn assemble(at: &Path, mesh: TriMesh, modes: NamedModes, provenance: String) -> Result<LoadedModel, IoError> {
    let NamedModes { modes, names: mode_names, deviations } = modes;
    let model = ReducedModel::new(mesh, modes).map_err(|error| IoError::request(at, error.to_string()))?;
    let info = ModelInfo { deviations, ..ModelInfo::new("", provenance) };
    Ok(loaded(model, info, mode_names))
}

/// Returns a model without further data.
fn loaded(model: ReducedModel, info: ModelInfo, mode_names: Vec<String>) -> LoadedModel {
    LoadedModel {
        model,
        info,
        default_q: None,
        mode_names,
        mode_weights: None,
        warnings: Vec::new(),
        scene: None,
    }
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use sscc::ContactFilter;

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
                .contains("a.obj: a mesh has no modes: add modes FILE, or compute modes with sscc modes")
        );
        assert!(message(&model, Some(&modes)).ends_with("has its own modes: leave out modes"));
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
        for (mesh_name, modes) in
            [("a.obj", "a.npz"), ("a.obj", "targets"), ("a.STL", "a.npy"), ("a.STL", "targets")]
        {
            let other = load(mesh_name, modes);
            let (mesh, of_first) = (other.model.mesh(), first.model.mesh());
            assert_eq!((mesh.faces(), mesh.rest_positions()), (of_first.faces(), of_first.rest_positions()));
            assert_eq!(other.model.modes(), first.model.modes());
            assert_eq!(mesh.has_split_vertices(), mesh_name.ends_with("STL"));
            assert_eq!(other.info.provenance, format!("mesh {mesh_name}, modes {modes}"));
            let names: &[&str] = if modes == "targets" { &["smile"] } else { &[] };
            assert_eq!(other.mode_names, names);
        }
        let message = |name: &str, options: LoadOptions<'_>| {
            load_model_with(&path(name), &options).unwrap_err().to_string()
        };
        let npz = message("a.npz", LoadOptions::default());
        assert!(npz.contains("a.npz: the archive has no array named mean"), "{npz}");
        let named = message("a.obj", LoadOptions::new(None, Some("x")));
        assert!(named.ends_with("leave out mesh_name"), "{named}");
        for own in ["a.npz", "b.glb", "b.gltf"] {
            let modes = path("a.npy");
            let refused = || message(own, LoadOptions::new(Some(&modes), None));
            assert!(path(own).exists() || refused().ends_with(&format!("{own}: not found")));
            std::fs::write(path(own), "x").unwrap();
            assert!(refused().ends_with("leave out modes"));
        }
        // The surface of a solid has all vertices of its file, so its modes fit.
        let solid = "MeshVersionFormatted 1\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra 1\n1 2 3 4 0\n";
        std::fs::write(path("s.mesh"), solid).unwrap();
        write_npy(&path("s.npy"), &[4, 3], &[0.5; 12]).unwrap();
        assert_eq!(load("s.mesh", "s.npy").model.mesh(), &load_mesh(&path("s.mesh"), None).unwrap());
        assert_eq!(load("s.mesh", "s.npy").model.mesh().faces().len(), 4);
        let no_modes = message("s.mesh", LoadOptions::default());
        assert!(no_modes.contains("s.mesh: a mesh has no modes: add modes FILE"), "{no_modes}");
        std::fs::write(path("a.fbx"), "x").unwrap();
        for refused in [
            message("a.fbx", LoadOptions::default()),
            load_mesh(&path("a.fbx"), None).unwrap_err().to_string(),
        ] {
            assert!(
                [".stl", ".msh", ".gltf", ".npz"].iter().all(|ending| refused.contains(ending)),
                "{refused}"
            );
        }
        let bent = "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nf 1 2 3 4\n";
        std::fs::write(path("bent.obj"), bent).unwrap();
        write_npy(&path("bent.npy"), &[4, 3], &[0.5; 12]).unwrap();
        let warned = load("bent.obj", "bent.npy").warnings;
        assert_eq!(load_mesh_with_warnings(&path("bent.obj"), None).unwrap().warnings, warned);
        assert!(warned[0].contains("are not plane") && warned[0].ends_with("(faces, counted from 0: 0)"));
        for mesh in ["a.obj", "a.STL"] {
            let read = load_mesh(&path(mesh), None).unwrap();
            assert_eq!(read.rest_positions(), first.model.mesh().rest_positions());
            // The mesh of a format that splits vertices is welded by default.
            assert_eq!(ContactFilter::of(&read).weld, mesh == "a.STL");
        }
        let named = load_mesh(&path("a.obj"), Some("x")).unwrap_err().to_string();
        assert!(named.ends_with("leave out mesh_name"), "{named}");
    }

    #[test]
    fn grids_and_collections_of_grids_are_at_rest_in_a_model() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        let grid = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n\
                    0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\n\
                    VECTORS u double\n0 0 0 0 0 0 0 0 0 0 0 2\n";
        std::fs::write(path("a.vtk"), grid).unwrap();
        let collection = "<VTKFile type='Collection'><Collection>\n<DataSet timestep='1' file='a.vtk'/>\n\
                          </Collection></VTKFile>";
        std::fs::write(path("a.pvd"), collection).unwrap();
        write_npy(&path("a.npy"), &[12, 1], &[0.5; 12]).unwrap();
        for name in ["a.vtk", "a.pvd"] {
            let mesh = load_mesh(&path(name), None).unwrap();
            assert_eq!(mesh.rest_positions()[3].z, 3.0, "{name}");
            let (model, _) = load_model(&path(name), Some(&path("a.npy"))).unwrap();
            assert_eq!(model.mesh().rest_positions()[3].z, 1.0, "{name}");
        }
    }

    #[test]
    fn the_mesh_of_a_gltf_file_has_the_notes_of_its_nodes() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.gltf");
        let bytes: Vec<u8> =
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0_f32].iter().flat_map(|x| x.to_le_bytes()).collect();
        std::fs::write(directory.path().join("a.bin"), bytes).unwrap();
        let json = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"a.bin","byteLength":36}],
            "bufferViews":[{"buffer":0,"byteLength":36}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "nodes":[{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{}}}]}"#;
        std::fs::write(&path, json).unwrap();
        let warnings = load_mesh_with_warnings(&path, None).unwrap().warnings;
        assert_eq!(warnings, gltf::read_placed_mesh(&path, None).unwrap().notes());
        assert!(warnings.len() == 1 && warnings[0].starts_with("nodes[0]: the extension EXT_mesh_gpu"));
    }

    #[test]
    fn git_lfs_pointers_are_named() {
        let directory = tempfile::tempdir().unwrap();
        let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12345\n";
        for name in [
            "a.obj",
            "a.off",
            "a.ply",
            "a.stl",
            "a.npy",
            "a.npz",
            "a.glb",
            "a.msh",
            "a.veg",
            "a.model.safetensors",
        ] {
            let path = directory.path().join(name);
            std::fs::write(&path, pointer).unwrap();
            let message = load_mesh(&path, None).unwrap_err().to_string();
            let is_named = message
                .ends_with("a Git LFS pointer, not the file itself: run 'git lfs pull' in its repository");
            assert!(is_named || name == "a.npy", "{message}");
        }
        let mesh = crate::mesh::obj::parse(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let frames = crate::FrameReader::open(&directory.path().join("a.npy"), &mesh, "m.obj".as_ref());
        assert!(frames.err().unwrap().to_string().contains("a.npy: a Git LFS pointer"));
        let modes = crate::read_modes(&directory.path().join("a.npy"), 3).unwrap_err().to_string();
        assert!(modes.contains("a.npy: a Git LFS pointer"), "{modes}");
    }
}
