//! Arrays of NumPy, and modes in them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line};

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    one_line(sscc_io::npy::parse_integers(bytes));
    if let Some(array) = one_line(sscc_io::npy::parse(bytes)) {
        for vertices in [1, 2, 3, 4] {
            one_line(sscc_io::modes::array::from_array(&array, vertices));
        }
    }
}
