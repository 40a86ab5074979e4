//! Programs of Debian packages that tests need.

use std::env;
use std::io;
use std::path::Path;
use std::process::Command;
use std::sync::{Mutex, PoisonError};

/// Lock for installations, since apt-get locks its lists: tests that run at the same time install one after the other.
static TURN: Mutex<()> = Mutex::new(());

/// Whether a program is on the path.
pub fn has(program: &str) -> bool {
    env::var_os("PATH")
        .is_some_and(|path| env::split_paths(&path).any(|folder| folder.join(program).is_file()))
}

/// Installs packages. Returns whether this succeeded.
pub fn install(packages: &[&str]) -> bool {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let apt = |arguments: &[&str]| -> io::Result<bool> {
        let mut apt = Command::new("apt-get");
        Ok(apt.args(arguments).env("DEBIAN_FRONTEND", "noninteractive").status()?.success())
    };
    let packages = [&["-qq", "install", "-y", "--no-install-recommends"], packages].concat();
    Path::new("/usr/bin/apt-get").exists()
        && apt(&["-qq", "update"]).and_then(|_| apt(&packages)).is_ok_and(|ok| ok)
}
