//! The C interface of sscc: `include/sscc/sscc.h`, which cbindgen writes from this crate. `tests/it/header.rs` compares
//! the header with the code.
//!
//! Modules of nouns (`model`, `query`, ...) have the exported functions, `sscc_<noun>_<verb>`. Each function borrows its handles
//! (`handle`), checks its arrays (`pointers`, `matrix`) and calls the core, within `guard` (`status`), which converts errors and
//! panics to a status. Pointers are used in `exclusive`, `handle`, `pointers` and `matrix`; the other modules rely on the
//! guarantee of the caller.
#![allow(non_camel_case_types, reason = "names of C")]
#![allow(clippy::missing_errors_doc, reason = "sscc_status has them")]

mod answer;
mod callbacks;
mod certificates;
mod detector;
mod exclusive;
mod handle;
mod kinetic;
mod live;
mod matrix;
mod model;
mod options;
mod pointers;
mod query;
mod shape;
mod status;
mod types;
mod version;

pub use certificates::*;
pub use detector::*;
pub use kinetic::*;
pub use matrix::{sscc_index_matrix, sscc_matrix};
pub use model::{
    sscc_model, sscc_model_faces, sscc_model_free, sscc_model_load, sscc_model_new, sscc_model_positions,
    sscc_model_rank, sscc_model_save, sscc_model_triangle_count, sscc_model_vertex_count,
};
pub use options::{sscc_certify_options, sscc_filter, sscc_metric, sscc_neighbours, sscc_scheme, sscc_weld};
pub use query::*;
pub use shape::*;
pub use status::{sscc_error_message, sscc_status};
pub use types::*;
pub use version::*;
