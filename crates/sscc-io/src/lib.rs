//! Every reader and writer of sscc: meshes, solids, modes, glTF, arrays and the sealed containers.
//!
//! All readers take hostile bytes: they answer with an error of one line that names the file, the place in
//! it and the cause. They never panic, and never allocate by a number that the file's size does not bear out.
//! Files are read whole (a mapped file that is replaced while in use kills the process), and written
//! whole or not at all.
//!
//! Each format can also be parsed from bytes ([`mesh::obj::parse`], [`npy::parse`], ...), without a file.

mod allowance;
pub mod container;
mod cubic;
mod error;
mod file;
pub mod gltf;
mod load;
pub mod mesh;
pub mod modes;
pub mod npy;
pub mod npz;
mod numbers;
mod pose;
pub mod solid;
mod text;

pub use container::{ModelInfo, read_certificates, read_model, write_certificates, write_model};
pub use cubic::{Cubic, parse_cubic, read_cubic};
pub use error::{FormatError, IoError, Place};
pub use file::{read_whole, write_whole};
pub use load::{LoadOptions, LoadedModel, load_model, load_model_with, splits_vertices};
pub use mesh::read_mesh;
pub use modes::{read_modes, read_modes_for};
pub use npy::write_npy;
pub use npz::read_npz_model;
pub use numbers::{Rows, read_matrix, read_rows, read_vector};
pub use pose::{write_obj_pose, write_ply_pose};
pub use solid::{Material, Solid, read_solid};
