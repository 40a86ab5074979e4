//! Containers of certificates, with a corrected digest.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line, sealed};

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    let bytes = &sealed(bytes);
    one_line(sscc_io::container::certificates_from_bytes(bytes));
}
