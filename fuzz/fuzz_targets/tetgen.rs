//! Both files of TetGen, with a zero byte between them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line};

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    let middle = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    let (first, second) = bytes.split_at(middle);
    if let Some(nodes) = one_line(sscc_io::solid::tetgen::parse_nodes(first)) {
        one_line(sscc_io::solid::tetgen::parse(&nodes, second.get(1..).unwrap_or_default()));
    }
}
