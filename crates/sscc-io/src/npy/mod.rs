//! Reader and writer for NumPy arrays (`.npy`) of numbers.
//!
//! The module has its own parser: in the crate `npyz`, parsing takes time exponential in the number of open brackets.
//! Here the header must have the form that NumPy writes for an array of numbers. The tests compare both on valid files.
//! See `docs/notes/files-and-page.md#readers-of-files`.

mod array;
mod blocks;
mod header;
mod write;

pub(crate) use array::entry_count;
pub use array::{Array, parse, parse_integers};
pub(crate) use blocks::Blocks;
pub use write::{NpyWriter, to_bytes, write_npy};

#[cfg(test)]
mod tests;
