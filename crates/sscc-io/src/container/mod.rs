//! Containers: safetensors files that store a digest of themselves.
//!
//! A container is an ordinary safetensors file, which NumPy and other tools read: a JSON header with named tensors and
//! text, then the data. Its first text entry, `blake3`, is the BLAKE3 digest of the whole file with the 64 digits of
//! this entry replaced by zeros. A changed byte of data, header or digest is therefore an error. The bytes are a
//! function of the content.

mod certificate_clearance;
mod certificate_groups;
mod certificates;
mod elasticity;
mod header;
mod kind;
mod local_certificates;
mod mass_data;
mod metric;
mod model;
mod proof;
mod reader;
mod tensor;
mod writer;

pub use certificates::{
    certificates_from_bytes, certificates_to_bytes, read_certificates, write_certificates,
};
pub use kind::{CERTIFICATES, Kind, MODEL};
pub use model::{ModelInfo, model_from_bytes, model_to_bytes, read_model, write_model};
pub use proof::{ProofFile, write_proof};
pub use reader::Container;
pub use tensor::{ANY, Tensor};
pub use writer::ContainerWriter;
