//! Reading and atomic writing of whole files.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use crate::error::cut;
use crate::part_file::PartFile;
use crate::{FormatError, IoError};

/// Beginning of the text that Git LFS stores in place of a file.
const LFS_POINTER: &[u8] = b"version https://git-lfs.github.com/spec/";

/// Maximum number of links from a path to its file, as on Linux.
const MAX_LINKS: usize = 40;

/// Maximum number of characters of a path in the cause of an error.
const MAX_SHOWN: usize = 200;

/// Reads a whole file.
///
/// Pipes and devices are rejected, because they have no size that bounds the bytes read.
///
/// # Errors
/// When the file does not exist, is not a regular file, is empty, is a Git LFS pointer, does not fit into memory, or the
/// system reports an error.
pub fn read_whole(path: &Path) -> Result<Vec<u8>, IoError> {
    let refused = |cause| read_error(path, cause);
    let (file, size) = open_regular(path)?;
    let mut bytes = Vec::new();
    usize::try_from(size)
        .ok()
        .and_then(|len| bytes.try_reserve_exact(len).ok())
        .ok_or_else(|| refused(io::Error::from(ErrorKind::OutOfMemory)))?;
    // At most the size from above is read. If the file grows meanwhile, its bytes beyond that size are not read.
    file.take(size).read_to_end(&mut bytes).map_err(refused)?;
    if bytes.is_empty() {
        return Err(FormatError::whole("the file is empty").of(path));
    }
    check_content(&bytes).map_err(|error| error.of(path))?;
    Ok(bytes)
}

/// Returns an error if these first bytes of a file are those of a Git LFS pointer, which stands for the file.
pub(crate) fn check_content(start: &[u8]) -> Result<(), FormatError> {
    if start.starts_with(LFS_POINTER) {
        let cause = "a Git LFS pointer, not the file itself: run 'git lfs pull' in its repository";
        return Err(FormatError::whole(cause));
    }
    Ok(())
}

/// Opens a regular file, and returns its size in bytes.
///
/// # Errors
/// As [`read_whole`], but the file may be empty, a Git LFS pointer or too large for memory.
pub(crate) fn open_regular(path: &Path) -> Result<(File, u64), IoError> {
    // The check comes before opening: opening a pipe waits for a writer.
    let metadata = fs::metadata(path).map_err(|cause| read_error(path, cause))?;
    check_regular(path, &metadata)?;
    let file = File::open(path).map_err(|cause| read_error(path, cause))?;
    Ok((file, metadata.len()))
}

/// Returns the error for a file that cannot be read.
pub(crate) fn read_error(path: &Path, cause: io::Error) -> IoError {
    match cause.kind() {
        ErrorKind::NotFound => IoError::NotFound { path: path.to_owned() },
        _ => IoError::System { path: path.to_owned(), action: "read", cause },
    }
}

/// Writes a whole file atomically: to a temporary file in the same folder, which is then renamed. An old file stays
/// unchanged until the new one is complete. A link is followed: it stays, and the file to which it leads is replaced. On Unix the
/// new file has the permissions of the old one if owner and group are the same.
///
/// # Errors
/// When the folder is not writable, the target is not a regular file or is read-only, a link leads to a folder that does not exist,
/// or the system reports an error. The target is then unchanged, and no temporary file remains.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    let mut file = WholeFile::create(path)?;
    file.write(bytes)?;
    file.finish()
}

/// Checks that a file can be written by [`write_whole`], before long work whose result it holds.
///
/// # Errors
/// As [`write_whole`].
pub fn check_replaceable(path: &Path) -> Result<(), IoError> {
    WholeFile::create(path).map(drop)
}

/// A file that is written in parts, and replaces its target when it is complete: see [`write_whole`].
pub(crate) struct WholeFile {
    /// The path in messages.
    path: PathBuf,
    /// The file of the path, after all links.
    target: PathBuf,
    /// Dropping it before the rename removes it.
    part: PartFile,
}

impl WholeFile {
    /// Creates the temporary file.
    ///
    /// # Errors
    /// As [`write_whole`].
    pub(crate) fn create(path: &Path) -> Result<Self, IoError> {
        check_target(path)?;
        let target = linked_file(path)?;
        let part = PartFile::create_in(folder(&target)).map_err(|cause| not_written(path, cause))?;
        // Before the first byte is written.
        if let Ok(old) = fs::metadata(&target) {
            part.set_permissions_of(&old);
        }
        Ok(Self { path: path.to_owned(), target, part })
    }

    /// Appends bytes.
    pub(crate) fn write(&mut self, bytes: &[u8]) -> Result<(), IoError> {
        self.part.write(bytes).map_err(|cause| not_written(&self.path, cause))
    }

    /// Replaces the target.
    pub(crate) fn finish(self) -> Result<(), IoError> {
        let Self { path, target, part } = self;
        part.rename(&target).map_err(|cause| not_written(&path, cause))?;
        sync_folder(&target);
        Ok(())
    }
}

/// Returns an error if a file cannot be replaced. A rename over /dev/null would replace the device, and one over a read-only file
/// would succeed.
pub(crate) fn check_target(path: &Path) -> Result<(), IoError> {
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_file() && metadata.permissions().readonly() => {
            let cause = "it is read-only: make it writable, or choose another name";
            Err(not_written(path, io::Error::new(ErrorKind::PermissionDenied, cause)))
        }
        Ok(metadata) => check_regular(path, &metadata),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => Err(not_written(path, error)),
    }
}

/// Returns the file to which a path leads after all links, which need not exist; the path itself if it is no link.
///
/// # Errors
/// When a link cannot be read, or leads to a folder that does not exist or to itself.
pub fn linked_file(path: &Path) -> Result<PathBuf, IoError> {
    let mut file = path.to_owned();
    for links in 0..MAX_LINKS {
        if !fs::symlink_metadata(&file).is_ok_and(|found| found.is_symlink()) {
            if links > 0 && !folder(&file).is_dir() {
                let shown = cut(&file.to_string_lossy(), MAX_SHOWN);
                let cause = format!(
                    "it is a link to {shown}, whose folder does not exist: make that folder, or remove the link"
                );
                return Err(not_written(path, io::Error::new(ErrorKind::NotFound, cause)));
            }
            return Ok(file);
        }
        let to = fs::read_link(&file).map_err(|cause| not_written(path, cause))?;
        file = folder(&file).join(to);
    }
    let cause = "it is a link that leads to itself: remove it, or choose another name";
    Err(not_written(path, io::Error::other(cause)))
}

/// Makes the rename of a file durable. Some systems cannot open directories.
pub(crate) fn sync_folder(path: &Path) {
    if let Ok(directory) = File::open(folder(path)) {
        let _ = directory.sync_all();
    }
}

/// Returns the error for a file that cannot be written.
pub(crate) fn not_written(path: &Path, cause: io::Error) -> IoError {
    IoError::System { path: path.to_owned(), action: "written", cause }
}

/// Returns an error if the path does not exist.
pub(crate) fn check_exists(path: &Path) -> Result<(), IoError> {
    match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Err(IoError::NotFound { path: path.to_owned() }),
        _ => Ok(()),
    }
}

/// Returns the error for a file whose ending no reader of `what` supports, or for a missing file.
pub(crate) fn unsupported(path: &Path, what: &'static str, supported: &'static str) -> IoError {
    match check_exists(path) {
        Err(missing) => missing,
        Ok(()) => IoError::Unsupported { path: path.to_owned(), what, supported },
    }
}

/// Returns the ending of a file name, in lower case, without its dot.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Returns the folder of a file, `.` if the path has none.
pub fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

/// Checks that files can be written to a folder, before long work whose result goes there.
///
/// # Errors
/// The error of the system when a file cannot be created.
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
    fn writing_leaves_only_the_target() {
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
    fn errors_name_missing_empty_and_irregular_files() {
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
    fn links_stay_and_their_files_are_replaced() {
        use std::os::unix::fs::symlink;
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        fs::create_dir(at("big")).unwrap();
        fs::write(at("big/x.npy"), b"old").unwrap();
        // A link to a file, a link to that link through a relative path, and a link to a file that does not exist yet.
        symlink(at("big/x.npy"), at("x.npy")).unwrap();
        symlink("../x.npy", at("big/again.npy")).unwrap();
        symlink("big/new.npy", at("new.npy")).unwrap();
        for (link, file, bytes) in [
            ("x.npy", "big/x.npy", b"first"),
            ("big/again.npy", "big/x.npy", b"later"),
            ("new.npy", "big/new.npy", b"begun"),
        ] {
            write_whole(&at(link), bytes).unwrap();
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
            assert!(fs::symlink_metadata(at(file)).unwrap().is_file(), "{file}");
            assert_eq!(fs::read(at(file)).unwrap(), bytes, "{link}");
        }
        symlink("none/x.npy", at("lost.npy")).unwrap();
        symlink("circle.npy", at("circle.npy")).unwrap();
        let message = |name: &str| write_whole(&at(name), b"x").unwrap_err().to_string();
        let lost = message("lost.npy");
        let end = "none/x.npy, whose folder does not exist: make that folder, or remove the link";
        assert!(
            lost.contains("lost.npy: cannot be written: it is a link to ") && lost.ends_with(end),
            "{lost}"
        );
        assert!(message("circle.npy").contains("circle.npy: cannot be written: "), "a circle");
        let mut left = [names(directory.path()), names(&at("big"))].concat();
        left.sort();
        let expected = ["again.npy", "big", "circle.npy", "lost.npy", "new.npy", "new.npy", "x.npy", "x.npy"];
        assert_eq!(left, expected);
    }

    #[test]
    #[cfg(unix)]
    fn read_only_files_are_kept_and_permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.npy");
        let mode = || fs::metadata(&path).unwrap().permissions().mode() & 0o777;
        let set_mode = |mode| fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
        fs::write(&path, b"old").unwrap();
        set_mode(0o444);
        let refused = write_whole(&path, b"new").unwrap_err().to_string();
        assert_eq!(check_replaceable(&path).unwrap_err().to_string(), refused);
        let end = "x.npy: cannot be written: it is read-only: make it writable, or choose another name";
        assert!(refused.ends_with(end), "{refused}");
        assert_eq!((fs::read(&path).unwrap(), mode()), (b"old".to_vec(), 0o444));
        assert_eq!(names(directory.path()), ["x.npy"]);
        for kept in [0o600, 0o664, 0o755] {
            set_mode(kept);
            write_whole(&path, b"new").unwrap();
            assert_eq!((fs::read(&path).unwrap(), mode()), (b"new".to_vec(), kept));
        }
        // A new file has the permissions that any new file has here.
        let [plain, other] = ["plain", "other"].map(|name| directory.path().join(name));
        fs::write(&plain, b"x").unwrap();
        write_whole(&other, b"x").unwrap();
        assert_eq!(fs::metadata(plain).unwrap().permissions(), fs::metadata(other).unwrap().permissions());
    }

    #[test]
    #[cfg(unix)]
    fn devices_are_not_replaced() {
        assert!(write_whole(Path::new("/dev/null"), b"x").is_err());
    }
}
