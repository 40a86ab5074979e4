//! A hash of the source, `SSCC_SOURCE`: results that processes exchange are taken from the same build only.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=src");
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let mut files = Vec::new();
    collect(&root.join("src"), &mut files)?;
    files.sort();
    let mut hash = OFFSET;
    for file in files {
        let name = file.strip_prefix(&root).unwrap_or(&file).to_string_lossy().replace('\\', "/");
        let text = fs::read(&file)?;
        let length = (text.len() as u64).to_le_bytes();
        name.bytes()
            .chain(length)
            .chain(text)
            .for_each(|byte| hash = (hash ^ u64::from(byte)).wrapping_mul(PRIME));
    }
    println!("cargo::rustc-env=SSCC_SOURCE={hash:016x}");
    Ok(())
}

/// FNV-1a: builds are told apart, not defended.
const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0100_0000_01b3;

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}
