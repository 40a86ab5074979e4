//! The version of the library.
#![allow(unsafe_code, reason = "exported names")]

use std::ffi::c_char;

/// The ABI version of this header. If sscc_abi_version() returns another number, the program must be compiled again.
pub const SSCC_ABI_VERSION: u32 = 1;

/// Returns the version of the library, such as "0.1.0".
///
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn sscc_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// Returns the SSCC_ABI_VERSION of the library.
///
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn sscc_abi_version() -> u32 {
    SSCC_ABI_VERSION
}
