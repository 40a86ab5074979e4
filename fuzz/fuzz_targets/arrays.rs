//! Arguments of bindings: positions, faces, modes, metrics and q of any numbers. Queries with certificates must equal brute
//! force.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::bounded;

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    sscc_fuzz::arrays::attack(bytes);
}
