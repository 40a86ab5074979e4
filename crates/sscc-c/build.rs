//! Names the shared library by its ABI version (`sscc_abi_version`), so that programs find the library with which they were linked.
#![allow(clippy::print_stdout, reason = "how build scripts talk to cargo")]

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let system = std::env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    match system.as_str() {
        "linux" => println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libsscc.so.1"),
        "macos" => println!("cargo::rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libsscc.1.dylib"),
        _ => {}
    }
}
