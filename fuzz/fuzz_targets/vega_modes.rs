//! Matrices of modes of VegaFEM.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line};
use sscc_io::modes::vega::Precision;

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    for precision in [Precision::Single, Precision::Double] {
        for vertices in [1, 2, 6] {
            one_line(sscc_io::modes::vega::parse(bytes, precision, vertices));
        }
    }
}
