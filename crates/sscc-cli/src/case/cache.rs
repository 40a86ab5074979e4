//! What takes long to make is kept in a folder from one run to the next, under a hash of all that it is made from.

use std::env;
use std::fmt::{self, Display};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use anyhow::{Context, Result};
use sscc::{ReducedModel, TriMesh};

use crate::interrupt;
use crate::output::{note, one_line};

/// A folder of files that can be made again.
pub struct Cache {
    folder: PathBuf,
}

impl Cache {
    /// The folder that is wanted, else `sscc` in the system's cache folder.
    pub fn open(wanted: Option<&Path>) -> Result<Self> {
        let folder = wanted.map_or_else(|| system_folder().join("sscc"), Path::to_owned);
        let refused =
            || format!("{}: no folder that can be written to; choose one by --cache", folder.display());
        fs::create_dir_all(&folder).with_context(refused)?;
        tempfile::tempfile_in(&folder).with_context(refused)?;
        Ok(Self { folder })
    }

    /// Where the files are.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Reads a file, or makes and writes it where it is missing or damaged.
    pub fn get<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Path) -> Result<T>,
        make: impl FnOnce() -> Result<T>,
        write: impl FnOnce(&Path, &T) -> Result<()>,
    ) -> Result<T> {
        let path = self.folder.join(name);
        if path.exists() {
            match read(&path) {
                Ok(found) => return Ok(found),
                Err(error) => note(format_args!("made anew: {}", one_line(&format!("{error:#}")))),
            }
        }
        let made = make()?;
        interrupt::check()?;
        write(&path, &made)?;
        Ok(made)
    }
}

/// The folder in which programs of this system keep what they can make again.
fn system_folder() -> PathBuf {
    let named = |name: &str| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let at_home = |folder: &str| env::home_dir().map(|home| home.join(folder));
    let folder = if cfg!(windows) {
        named("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        at_home("Library/Caches")
    } else {
        named("XDG_CACHE_HOME").or_else(|| at_home(".cache"))
    };
    folder.unwrap_or_else(env::temp_dir)
}

/// The hash of what something is made from, the version of this program included.
pub struct Key(blake3::Hasher);

impl Key {
    /// Of something of this kind.
    pub fn new(kind: &str) -> Self {
        Self(blake3::Hasher::new()).text(kind).text(env!("CARGO_PKG_VERSION"))
    }

    pub fn text(mut self, text: &str) -> Self {
        self.0.update(&(text.len() as u64).to_le_bytes()).update(text.as_bytes());
        self
    }

    pub fn mesh(mut self, mesh: &TriMesh) -> Self {
        self.0.update(&(mesh.faces().len() as u64).to_le_bytes());
        for v in mesh.faces().as_flattened() {
            self.0.update(&v.to_le_bytes());
        }
        for x in mesh.rest_positions().iter().flat_map(|p| p.to_array()) {
            self.0.update(&x.to_le_bytes());
        }
        self
    }

    /// The model with all that its certificates speak of.
    pub fn model(self, model: &ReducedModel) -> Self {
        let digest = sscc::Digest::of(model, &sscc::Scope::of(model));
        self.text(&format!("{digest:?}"))
    }
}

impl Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.finalize().to_hex()[..16])
    }
}

/// The hash of this very program: certificates, and the time they took, are those of one build.
pub fn program() -> Result<&'static str> {
    static HASH: OnceLock<String> = OnceLock::new();
    if HASH.get().is_none() {
        let path = env::current_exe().context("this program's own file")?;
        let mut hasher = blake3::Hasher::new();
        let file = fs::File::open(&path).with_context(|| path.display().to_string())?;
        hasher.update_reader(file).with_context(|| path.display().to_string())?;
        let _ = HASH.set(hasher.finalize().to_hex().to_string());
    }
    Ok(HASH.get().map_or("", String::as_str))
}
