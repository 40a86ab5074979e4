//! Temporary files beside a target, which replace it by renaming.

use std::fs::{self, File, Metadata};
use std::io::{self, ErrorKind, Write};
#[cfg(unix)]
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process;

/// Maximum number of names to try. Names contain the process id, so collisions are rare.
const MAX_ATTEMPTS: u32 = 10_000;

/// New file that is removed on drop unless it was renamed.
pub(crate) struct PartFile {
    path: PathBuf,
    file: Option<File>,
}

impl PartFile {
    /// Creates the file in a folder, with an unused name.
    pub(crate) fn create_in(folder: &Path) -> io::Result<Self> {
        let (path, file) = create_unused(folder, |path| File::create_new(path))?;
        Ok(Self { path, file: Some(file) })
    }

    /// Appends bytes.
    pub(crate) fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.as_mut().map_or(Ok(()), |file| file.write_all(bytes))
    }

    /// Sets the permissions of another file, on Unix, if owner and group are the same: for others these permissions would have
    /// another meaning. Some file systems have none: there the file keeps those with which it was created.
    pub(crate) fn set_permissions_of(&self, old: &Metadata) {
        #[cfg(unix)]
        if let Some(file) = &self.file
            && file.metadata().is_ok_and(|new| (new.uid(), new.gid()) == (old.uid(), old.gid()))
        {
            let _ = file.set_permissions(old.permissions());
        }
        #[cfg(not(unix))]
        let _ = old;
    }

    /// Flushes the file to the disk and renames it to `target`, which is replaced if it exists.
    pub(crate) fn rename(mut self, target: &Path) -> io::Result<()> {
        if let Some(file) = &self.file {
            file.sync_all()?;
        }
        // Some systems cannot rename open files.
        self.file = None;
        fs::rename(&self.path, target)?;
        self.path.clear();
        Ok(())
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        self.file = None;
        if self.path != Path::new("") {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Creates a file or a folder by `create`, with an unused name.
pub(crate) fn create_unused<T>(
    folder: &Path,
    create: impl Fn(&Path) -> io::Result<T>,
) -> io::Result<(PathBuf, T)> {
    for number in 0..MAX_ATTEMPTS {
        let path = folder.join(format!(".sscc-{}-{number}.part", process::id()));
        match create(&path) {
            Ok(created) => return Ok((path, created)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::new(ErrorKind::AlreadyExists, "there are too many files named .sscc-*.part; remove them"))
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;

    #[test]
    fn concurrent_files_have_different_names() {
        let folder = tempfile::tempdir().unwrap();
        let write = |number: u8| {
            let mut part = PartFile::create_in(folder.path()).unwrap();
            part.write(&[number; 1000]).unwrap();
            part.rename(&folder.path().join("target")).unwrap();
        };
        thread::scope(|scope| (0..8).for_each(|number| drop(scope.spawn(move || write(number)))));
        let bytes = fs::read(folder.path().join("target")).unwrap();
        assert_eq!(bytes, [bytes[0]; 1000]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_dropped_file_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let (first, second) =
            (PartFile::create_in(folder.path()).unwrap(), PartFile::create_in(folder.path()).unwrap());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        drop((first, second));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
