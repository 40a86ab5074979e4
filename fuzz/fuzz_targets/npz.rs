//! Archives of NumPy: models, and modes for a mesh.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line, two_triangles};

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    one_line(sscc_io::npz::parse_model(bytes));
    one_line(sscc_io::npz::parse_modes(bytes, &two_triangles()));
}
