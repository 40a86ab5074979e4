//! Arguments of bindings for all other questions: detectors, sweeps, resolves, samples, shapes in the world, curves.
#![no_main]

use std::ffi::c_char;

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, questions};

fuzz_target!(|bytes: &[u8]| bounded(bytes, questions::attack));

/// Returns what the leak checker does not report: the list of destructors that the C library keeps for each thread. It is freed only
/// when a thread ends, and the threads of a pool end some time after the question for which the pool was made.
#[unsafe(no_mangle)]
pub extern "C" fn __lsan_default_suppressions() -> *const c_char {
    c"leak:__cxa_thread_atexit_impl".as_ptr()
}
