//! Readers and writers of sscc: meshes, solids, modes, glTF, arrays and containers.
//!
//! [`load_model`] loads a model from files of any supported format. [`load_model_with`] also returns the names of the
//! modes, the numbers that a `.npz` file has for each mode, and the default q of a glTF file. Containers
//! ([`container`]) store models and certificates; NumPy reads them, and a digest detects any changed byte.
//!
//! ```
//! use sscc::{Certificates, CertifyOptions, Query};
//! use sscc_io::{load_model, read_certificates, read_model, write_certificates, write_model, write_npy};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let in_folder = |name: &str| folder.path().join(name);
//! // A mesh, and one mode for it (3V x 1) that moves the second triangle along z.
//! let (mesh, modes) = (in_folder("two.obj"), in_folder("two.npy"));
//! std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\nf 4 5 6\n")?;
//! let mode: Vec<f64> = (0..18).map(|row| if row >= 9 && row % 3 == 2 { 1.0 } else { 0.0 }).collect();
//! write_npy(&modes, &[18, 1], &mode)?;
//!
//! // Once:
//! let (model, info) = load_model(&mesh, Some(&modes))?;
//! let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
//! write_model(&in_folder("two.model.safetensors"), &model, &info)?;
//! write_certificates(&in_folder("two.sscc.safetensors"), &certificates)?;
//!
//! // In every later run:
//! let (model, _info) = read_model(&in_folder("two.model.safetensors"))?;
//! let certificates = read_certificates(&in_folder("two.sscc.safetensors"))?;
//! let mut query = Query::new(&model, &certificates)?;
//! assert_eq!(query.discrete(&[-1.0])?, [(0, 1)]);
//! # Ok(())
//! # }
//! ```
//!
//! | content | item |
//! | --- | --- |
//! | meshes: OBJ, PLY, OFF, STL | [`read_mesh`], [`mesh`] |
//! | groups of triangles: OBJ groups, objects and materials, glTF primitives, nodes and materials | [`read_groups`] |
//! | modes: `.npy`, VegaFEM's matrices, a folder of target meshes | [`read_modes_for`], [`modes`] |
//! | frames of an animation: a folder of meshes | [`read_frames`] |
//! | frames of a given mesh, one by one: `.npy` of positions, a `.pc2` point cache, VTK's `.vtu`, `.vtk` and `.pvd`, a folder of meshes | [`FrameReader`] |
//! | the mesh of any file, without modes, at the place that nodes give it; the surface of a solid | [`load_mesh`], [`gltf::read_placed_mesh`] |
//! | the files of a folder that have a mesh; whether an input has a file | [`list_mesh_files`], [`has_file`], [`is_folder_of_mesh`] |
//! | mesh and modes: glTF morph targets, `.npz` | [`gltf`], [`npz`] |
//! | animated characters: glTF nodes, skins, animations | [`gltf::read_scene`] |
//! | the contents of a glTF file | [`gltf::read_contents`] |
//! | q, trajectories, weights, matrices | [`read_rows`], [`read_vector`], [`read_matrix`], [`write_npy`] |
//! | models and certificates | [`container`] |
//! | arrays with names, sounds | [`write_npz`], [`write_wav`] |
//! | animation: mesh, modes and q(t) as glTF | [`gltf::write_animation`] |
//! | a pose with its colliding triangles marked; frames of such poses for ParaView | [`write_ply_pose`], [`write_obj_pose`], [`write_vtu_pose`]; [`VtkFramesWriter`] |
//! | contact curves as polylines | [`write_ply_curves`], [`write_obj_curves`] |
//!
//! STL and glTF split vertices along seams. Their readers report this ([`sscc::TriMesh::has_split_vertices`]), and detectors and
//! certificates weld them by default.
//!
//! All readers accept untrusted bytes. They report an error of one line with the file, the place and the cause. They
//! never panic, and never allocate by a number that the size of the file does not confirm. Files are read, as a whole
//! or block by block, and never mapped, because a mapped file that is truncated while in use ends the process. A file is
//! replaced atomically; the files of a `.pvd` collection are replaced as [`VtkFramesWriter::finish`] states.
//!
//! Each format can also be parsed from bytes ([`mesh::obj::parse`], [`npy::parse`], ...), without a file.

mod allowance;
mod collection_target;
pub mod container;
mod curves;
mod error;
mod file;
mod folder_files;
mod forces;
pub mod gltf;
mod groups;
mod load;
pub mod mesh;
mod mesh_files;
mod mesh_modes;
mod mesh_path;
mod message;
pub mod modes;
mod named_groups;
mod natural_order;
pub mod npy;
pub mod npz;
mod numbers;
mod part_file;
mod part_folder;
mod polygons;
mod pose;
pub mod solid;
mod text;
mod triangulate;
mod vertex_numbers;
mod vtk_frames_writer;
mod vtk_writer;
mod wav;

pub use container::{
    ModelInfo, ProofFile, read_certificates, read_model, write_certificates, write_model, write_proof,
};
pub use curves::{write_obj_curves, write_ply_curves};
pub use error::{FormatError, IoError, Place};
pub use file::{check_replaceable, check_writable, folder, linked_file, read_whole, write_whole};
pub use forces::{parse_reduced_forces, read_reduced_forces};
pub use groups::{read_base_groups, read_group_numbers, read_groups};
pub use load::{
    LoadOptions, LoadedMesh, LoadedModel, load_mesh, load_mesh_with_warnings, load_model, load_model_with,
};
pub use mesh::{read_mesh, read_mesh_with_warnings};
pub use mesh_files::{has_file, is_folder_of_mesh, list_mesh_files};
pub use mesh_modes::read_modes_for;
pub use mesh_path::split_mesh_name;
pub use message::{Message, Setting};
pub use modes::{FrameReader, Frames, NamedModes, is_collection, read_frames, read_modes};
pub use named_groups::{GroupsBy, NamedGroups};
pub use npy::{NpyWriter, write_npy};
pub use npz::{NamedArray, NpzModel, read_npz_model, write_npz};
pub use numbers::{Rows, read_matrix, read_rows, read_vector};
pub use pose::{write_obj_pose, write_ply_pose};
pub use solid::{VolumeOrSurface, read_volume_mesh, read_volume_mesh_with_warnings, read_volume_or_surface};
pub use triangulate::triangulate;
pub use vertex_numbers::read_vertex_numbers;
pub use vtk_frames_writer::VtkFramesWriter;
pub use vtk_writer::write_vtu_pose;
pub use wav::{WavFormat, wav_to_bytes, write_wav};
