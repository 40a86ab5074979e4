//! glTF: morph targets, and meshes at the positions of their nodes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line};

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    one_line(sscc_io::gltf::parse(bytes, None));
    one_line(sscc_io::gltf::parse(bytes, Some("#0")));
    one_line(sscc_io::gltf::parse_placed_mesh(bytes, None));
}
