//! Files that are written beside their target and then take its place.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process;

/// Other processes and threads have names of their own or are skipped, so a few tries are enough.
const TRIES: u32 = 10_000;

/// A new file that is removed when it is dropped, unless it has been renamed.
pub(crate) struct PartFile {
    path: PathBuf,
    file: Option<File>,
}

impl PartFile {
    /// Creates it in a folder, under a name that nothing there has.
    pub(crate) fn create_in(folder: &Path) -> io::Result<Self> {
        for number in 0..TRIES {
            let path = folder.join(format!(".sscc-{}-{number}.part", process::id()));
            match File::create_new(&path) {
                Ok(file) => return Ok(Self { path, file: Some(file) }),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(io::Error::new(
            ErrorKind::AlreadyExists,
            "there are too many files named .sscc-*.part; remove them",
        ))
    }

    /// Writes all bytes, to the disk.
    pub(crate) fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let Some(file) = &mut self.file else { return Ok(()) };
        file.write_all(bytes)?;
        file.sync_all()
    }

    /// Takes the place of `target`.
    pub(crate) fn rename(mut self, target: &Path) -> io::Result<()> {
        // Closed first: some systems do not rename open files.
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

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;

    #[test]
    fn many_at_once_have_names_of_their_own() {
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
    fn nothing_is_left_of_one_that_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let (first, second) =
            (PartFile::create_in(folder.path()).unwrap(), PartFile::create_in(folder.path()).unwrap());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        drop((first, second));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
