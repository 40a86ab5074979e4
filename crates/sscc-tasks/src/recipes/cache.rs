//! Cache folder of models and certificates, each under a hash of its inputs.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use sscc_io::{Message, Setting, check_writable};

use crate::text::one_line;
use crate::watch::check_cancelled;
use crate::{TaskError, Watch};

/// Folder of files that can be computed again.
pub struct Cache {
    folder: PathBuf,
    /// Hash of this program, after its first use.
    program: OnceLock<String>,
}

impl Cache {
    /// Opens the folder `wanted`, or by default `sscc` in the system's cache folder.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn open(wanted: Option<&Path>) -> Result<Self, TaskError> {
        let folder = wanted.map_or_else(|| system_folder().join("sscc"), Path::to_owned);
        let open = || {
            fs::create_dir_all(&folder)?;
            check_writable(&folder)
        };
        open().map_err(|cause| TaskError::System {
            place: Message::from(folder.display())
                + ": cannot write to this folder; choose one with "
                + Setting::Cache,
            cause,
        })?;
        Ok(Self { folder, program: OnceLock::new() })
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the hash of this program's file. Cached certificates and their cost belong to one build.
    ///
    /// # Errors
    /// When the program cannot read its own file.
    pub fn program(&self) -> Result<&str, TaskError> {
        if let Some(hash) = self.program.get() {
            return Ok(hash);
        }
        let own = Path::new("this program's own file");
        let path = env::current_exe().map_err(|cause| TaskError::system(own, cause))?;
        let mut hasher = blake3::Hasher::new();
        let read = fs::File::open(&path).and_then(|file| hasher.update_reader(file).map(|_| ()));
        read.map_err(|cause| TaskError::system(&path, cause))?;
        Ok(self.program.get_or_init(|| hasher.finalize().to_hex().to_string()))
    }

    /// Reads a file. Creates it if it is missing or damaged.
    pub(crate) fn get<T>(
        &self,
        name: &str,
        watch: &dyn Watch,
        read: impl FnOnce(&Path) -> Result<T, TaskError>,
        make: impl FnOnce() -> Result<T, TaskError>,
        write: impl FnOnce(&Path, &T) -> Result<(), TaskError>,
    ) -> Result<T, TaskError> {
        let path = self.folder.join(name);
        if path.exists() {
            match read(&path) {
                Ok(found) => return Ok(found),
                Err(error) => watch.note(&format!("made anew: {}", one_line(&error.to_string()))),
            }
        }
        let made = make()?;
        check_cancelled(watch)?;
        write(&path, &made)?;
        Ok(made)
    }
}

/// Returns the user's cache folder by the convention of this system, else the folder of temporary files.
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
