//! A compiler that has a standard library for WebAssembly.
//!
//! rustup installs one (`rustup target add wasm32-unknown-unknown`). Where only Debian's packages are available, the library
//! is compiled once from the sources in `rust-web-src` by the compiler in `rustc-web`, and kept in [`cache`].

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::debian;
use crate::program::{cargo, output, succeed};

/// The target.
pub const TARGET: &str = "wasm32-unknown-unknown";

/// Compiler flag for 128-bit SIMD, which all engines have: Chromium 91, Firefox 89, Safari 16.4, Node 16.
const FEATURES: &str = "-Ctarget-feature=+simd128";

/// Debian's compiler.
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";

/// The sources of the standard library for Debian's compiler.
const DEBIAN_SOURCES: &str = "/usr/lib/rustlib/src/rust/library/std/Cargo.toml";

/// The Debian packages of the compiler and of these sources.
const DEBIAN_PACKAGES: [&str; 2] = ["rustc-web", "rust-web-src"];

/// The oldest version of Debian's compiler that compiles the crates.
const MIN_MINOR: u32 = 89;

/// The compiler, and how to call it.
pub struct Toolchain {
    /// Debian's compiler; None if the compiler of the project has the library.
    debian: Option<Debian>,
}

/// Debian's compiler, and the parts that it lacks.
struct Debian {
    /// The folder of its library, once this is compiled.
    sysroot: PathBuf,
    linker: PathBuf,
}

impl Toolchain {
    /// Finds a compiler. With `install`, tries to install Debian's. The error states why there is none.
    pub fn find(install: bool) -> Result<Self, String> {
        if library()?.is_dir() {
            return Ok(Self { debian: None });
        }
        let has_debian = || Path::new(DEBIAN_RUSTC).exists() && Path::new(DEBIAN_SOURCES).exists();
        if install && !has_debian() {
            debian::install(&DEBIAN_PACKAGES);
        }
        if !has_debian() {
            return Err(format!(
                "there is no standard library of {TARGET}: rustup target add {TARGET}, or Debian's {}",
                DEBIAN_PACKAGES.join(" and ")
            ));
        }
        let Some(linker) = linker()? else {
            return Err("there is no linker: the toolchain of the project has no rust-lld".to_owned());
        };
        Ok(Self { debian: Some(Debian { sysroot: sysroot(DEBIAN_RUSTC)?, linker }) })
    }

    /// Returns a cargo that compiles for the target with this compiler, and with more flags. Compiles the standard library if
    /// this was not done before; an error is an error of this compilation.
    pub fn cargo(&self, flags: &[String]) -> Result<Command, String> {
        let mut cargo = cargo();
        let mut all = vec![FEATURES.to_owned()];
        if let Some(Debian { sysroot, linker }) = &self.debian {
            if !sysroot.is_dir() {
                compile_library(DEBIAN_RUSTC, sysroot)?;
            }
            all.push(format!("--sysroot={}", sysroot.display()));
            cargo
                .env("RUSTC", DEBIAN_RUSTC)
                .env_remove("RUSTUP_TOOLCHAIN")
                .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker);
        }
        all.extend_from_slice(flags);
        cargo.env(FLAGS, encoded(&all));
        Ok(cargo)
    }
}

/// The variable of cargo for flags that may contain spaces. It has precedence over all other variables for flags.
const FLAGS: &str = "CARGO_ENCODED_RUSTFLAGS";

fn encoded(flags: &[String]) -> String {
    flags.join("\u{1f}")
}

/// Returns the flag that replaces a folder of this machine by a name, in all paths that a module contains.
pub fn renamed(folder: &Path, name: &str) -> String {
    format!("--remap-path-prefix={}={name}", folder.display())
}

/// Returns cargo's folder with the sources of dependencies.
pub fn cargo_home() -> PathBuf {
    let home = || PathBuf::from(env::var_os("HOME").unwrap_or_default()).join(".cargo");
    env::var_os("CARGO_HOME").map_or_else(home, PathBuf::from)
}

/// Returns the folder of the library for the target in the toolchain of the project. It need not exist.
fn library() -> Result<PathBuf, String> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let mut rustc = Command::new(rustc);
    rustc.args(["--print", "target-libdir", "--target", TARGET]);
    Ok(PathBuf::from(output(&mut rustc, "rustc cannot be run")?.trim()))
}

/// Returns the linker in the toolchain of the project: `lib/rustlib/HOST/bin/rust-lld`.
fn linker() -> Result<Option<PathBuf>, String> {
    let library = library()?;
    let hosts = library.ancestors().nth(2).map(fs::read_dir).into_iter().flatten().flatten().flatten();
    Ok(hosts.map(|host| host.path().join("bin/rust-lld")).find(|linker| linker.exists()))
}

/// Returns a folder for the library outside of the project, so that a fresh copy of the project need not compile it again.
fn cache() -> PathBuf {
    let home = || env::var_os("HOME").map(|home| Path::new(&home).join(".cache"));
    let base = env::var_os("XDG_CACHE_HOME").map(PathBuf::from).or_else(home);
    base.unwrap_or_else(env::temp_dir).join("sscc-wasm")
}

/// Returns the folder of the library of a compiler, which may not exist. Returns an error if the compiler is too old.
fn sysroot(rustc: &str) -> Result<PathBuf, String> {
    let version = output(Command::new(rustc).arg("--version"), "rustc cannot be run")?;
    let number = version.split(' ').nth(1).unwrap_or("").to_owned();
    let minor = number.split('.').nth(1).and_then(|minor| minor.parse::<u32>().ok());
    if minor.is_none_or(|minor| minor < MIN_MINOR) {
        return Err(format!("{rustc} is {number}; 1.{MIN_MINOR} or later is needed"));
    }
    Ok(cache().join(format!("library-{number}")))
}

/// Compiles the library of a compiler from its sources.
fn compile_library(rustc: &str, sysroot: &Path) -> Result<(), String> {
    println!("compiling the standard library of {TARGET}, once for {}", sysroot.display());
    let folder = sysroot.with_file_name(format!("library-of-{}", std::process::id()));
    let made = collect_library(rustc, &folder).and_then(|()| {
        // Another run may have created the folder meanwhile.
        match fs::rename(folder.join("sysroot"), sysroot) {
            Err(error) if !sysroot.is_dir() => Err(format!("{}: {error}", sysroot.display())),
            _ => Ok(()),
        }
    });
    let _ = fs::remove_dir_all(&folder);
    made
}

/// Compiles the library for a crate without content, and collects it as a sysroot.
fn collect_library(rustc: &str, folder: &Path) -> Result<(), String> {
    let libraries = folder.join("sysroot/lib/rustlib").join(TARGET).join("lib");
    let manifest = "[package]\nname = \"empty\"\nversion = \"0.0.0\"\nedition = \"2024\"\n[workspace]\n";
    let io = |error: std::io::Error| format!("{}: {error}", folder.display());
    fs::create_dir_all(folder.join("src")).map_err(io)?;
    fs::create_dir_all(&libraries).map_err(io)?;
    fs::write(folder.join("Cargo.toml"), manifest).map_err(io)?;
    fs::write(folder.join("src/lib.rs"), "#![no_std]\n").map_err(io)?;
    let mut build = cargo();
    build
        .args(["build", "--quiet", "--release", "--target", TARGET])
        // The library has no traces of panics, which the module cannot produce.
        .args(["-Z", "build-std=std,panic_abort", "-Z", "build-std-features="])
        .current_dir(folder)
        // Only nightly versions allow the option. It is safe here: the library is part of the compiler that compiles it.
        .env("RUSTC_BOOTSTRAP", "1")
        .env("RUSTC", rustc)
        .env(FLAGS, encoded(&[FEATURES.to_owned(), renamed(&cargo_home(), "cargo")]))
        .env("CARGO_PROFILE_RELEASE_PANIC", "abort")
        .env("CARGO_TARGET_DIR", folder.join("target"));
    succeed(&mut build, "the standard library cannot be compiled")?;
    let made = folder.join("target").join(TARGET).join("release/deps");
    for entry in fs::read_dir(&made).map_err(io)?.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.ends_with(".rlib") && !name.starts_with("libempty-") {
            fs::copy(entry.path(), libraries.join(name)).map_err(io)?;
        }
    }
    Ok(())
}
