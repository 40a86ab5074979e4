//! Containers: safetensors files sealed with a digest of themselves.
//!
//! A container is an ordinary safetensors file (NumPy and others read it): a JSON header with named tensors
//! and text, then the data. Its first text entry, `blake3`, is the BLAKE3 of the whole file with this
//! entry's own 64 digits taken as zeros, so that any flipped byte is refused: of the data, the header or
//! the seal. The bytes are a function of the content: the same content gives the same file.

mod certificates;
mod elasticity;
mod header;
mod kind;
mod metric;
mod model;
mod sealed;
mod tensor;
mod writer;

pub use certificates::{
    certificates_from_bytes, certificates_to_bytes, read_certificates, write_certificates,
};
pub use kind::{CERTIFICATES, Kind, MODEL};
pub use model::{ModelInfo, model_from_bytes, model_to_bytes, read_model, write_model};
pub use sealed::Sealed;
pub use tensor::{ANY, Tensor};
pub use writer::SealedWriter;
