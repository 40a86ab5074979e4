//! Arguments of bindings for all other questions: detectors, sweeps, resolves, samples, shapes in the world, curves.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, questions};

fuzz_target!(|bytes: &[u8]| bounded(bytes, questions::attack));
