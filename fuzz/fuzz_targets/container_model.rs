//! Containers of models, with a corrected digest, so that a wrong digest does not end the reading.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line, sealed};

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    let bytes = &sealed(bytes);
    one_line(sscc_io::container::model_from_bytes(bytes));
}
