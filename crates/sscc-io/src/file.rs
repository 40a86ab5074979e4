//! Files read whole and written whole.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use crate::part_file::PartFile;
use crate::{FormatError, IoError};

/// Reads a whole file.
///
/// Pipes and devices are refused: they have no size that could bound what is read from them.
///
/// # Errors
/// When there is no such file, it is no regular file, it is empty, does not fit into memory, or the system
/// refuses.
pub fn read_whole(path: &Path) -> Result<Vec<u8>, IoError> {
    let refused = |cause: io::Error| match cause.kind() {
        ErrorKind::NotFound => IoError::NotFound { path: path.to_owned() },
        _ => IoError::System { path: path.to_owned(), action: "read", cause },
    };
    // Looked at before it is opened: opening a pipe would wait for a writer.
    let metadata = fs::metadata(path).map_err(refused)?;
    check_regular(path, &metadata)?;
    let mut bytes = Vec::new();
    usize::try_from(metadata.len())
        .ok()
        .and_then(|len| bytes.try_reserve_exact(len).ok())
        .ok_or_else(|| refused(io::Error::from(ErrorKind::OutOfMemory)))?;
    // No more than the size seen: a file that grows meanwhile is cut there, and its reader refuses the cut.
    File::open(path).map_err(refused)?.take(metadata.len()).read_to_end(&mut bytes).map_err(refused)?;
    if bytes.is_empty() {
        return Err(FormatError::whole("the file is empty").of(path));
    }
    Ok(bytes)
}

/// Writes a whole file: beside the target first, then renamed over it, so that nothing half-written ever
/// appears under its name, and an old file stays as it is until the new one is complete.
///
/// # Errors
/// When the directory cannot be written to, the target is no regular file, or the system refuses. The
/// target is then as it was, and nothing is left beside it.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    let refused = |cause| IoError::System { path: path.to_owned(), action: "written", cause };
    // A rename over /dev/null would replace the device.
    match fs::metadata(path) {
        Ok(metadata) => check_regular(path, &metadata)?,
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(refused(error)),
    }
    let directory = folder(path);
    // Removed when dropped before the rename, on every way out.
    let mut beside = PartFile::create_in(directory).map_err(refused)?;
    beside.write(bytes).map_err(refused)?;
    beside.rename(path).map_err(refused)?;
    // The rename itself should outlive a power cut too; not every system lets a directory be opened.
    if let Ok(directory) = File::open(directory) {
        let _ = directory.sync_all();
    }
    Ok(())
}

/// Refuses a path at which there is nothing.
pub(crate) fn check_exists(path: &Path) -> Result<(), IoError> {
    match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Err(IoError::NotFound { path: path.to_owned() }),
        _ => Ok(()),
    }
}

/// The refusal of a file whose ending no reader of `what` knows. A file that does not exist is refused as missing.
pub(crate) fn unsupported(path: &Path, what: &'static str, supported: &'static str) -> IoError {
    match check_exists(path) {
        Err(missing) => missing,
        Ok(()) => IoError::Unsupported { path: path.to_owned(), what, supported },
    }
}

/// The ending of a file name, in lower case, without its dot.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// The folder of a file.
pub fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

/// Whether files can be written to a folder: before long work whose result is for it.
///
/// # Errors
/// What the system says.
pub fn check_writable(folder: &Path) -> io::Result<()> {
    PartFile::create_in(folder).map(drop)
}

fn check_regular(path: &Path, metadata: &fs::Metadata) -> Result<(), IoError> {
    let found = match metadata {
        m if m.is_file() => return Ok(()),
        m if m.is_dir() => "a directory",
        _ => "a device or pipe",
    };
    Err(IoError::NotAFile { path: path.to_owned(), found })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn written_files_are_whole_and_alone() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.bin");
        write_whole(&path, b"first").unwrap();
        write_whole(&path, b"second").unwrap();
        assert_eq!(read_whole(&path).unwrap(), b"second");
        assert_eq!(names(directory.path()), ["x.bin"]);
    }

    #[test]
    fn a_failed_write_leaves_nothing() {
        let directory = tempfile::tempdir().unwrap();
        let taken = directory.path().join("taken");
        fs::create_dir(&taken).unwrap();
        assert!(write_whole(&taken, b"x").unwrap_err().to_string().contains("is a directory"));
        assert!(write_whole(&directory.path().join("missing/x"), b"x").is_err());
        assert_eq!(names(directory.path()), ["taken"]);
    }

    #[test]
    fn what_is_no_file_is_named() {
        let directory = tempfile::tempdir().unwrap();
        let message = |path: &Path| read_whole(path).unwrap_err().to_string();
        assert!(message(directory.path()).ends_with("is a directory, a file was expected"));
        assert!(message(&directory.path().join("no.obj")).ends_with("no.obj: not found"));
        let empty = directory.path().join("empty.obj");
        fs::write(&empty, b"").unwrap();
        assert!(message(&empty).ends_with("empty.obj: the file is empty"));
        #[cfg(unix)]
        assert!(message(Path::new("/dev/zero")).ends_with("is a device or pipe, a file was expected"));
    }

    #[test]
    #[cfg(unix)]
    fn devices_are_not_replaced() {
        assert!(write_whole(Path::new("/dev/null"), b"x").is_err());
    }
}
