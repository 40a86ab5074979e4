//! Every reader and writer of sscc: meshes, modes, arrays and the sealed containers.
//!
//! All readers take hostile bytes: they answer with an error of one line that names the file, the place in
//! it and the cause. They never panic, and never allocate by a number that the file's size does not bear out.
//! Files are read whole (a mapped file that is replaced while in use kills the process), and written
//! whole or not at all.
//!
//! Each format can also be parsed from bytes ([`mesh::obj::parse`], [`npy::parse`], ...), without a file.

pub mod container;
mod error;
mod file;
mod load;
pub mod mesh;
pub mod modes;
pub mod npy;
mod numbers;
mod text;

pub use container::{ModelInfo, read_certificates, read_model, write_certificates, write_model};
pub use error::{FormatError, IoError, Place};
pub use file::{read_whole, write_whole};
pub use load::load_model;
pub use mesh::read_mesh;
pub use modes::read_modes;
pub use npy::write_npy;
pub use numbers::{Rows, read_rows, read_vector};
