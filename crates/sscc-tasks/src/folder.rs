//! Folders for the files of long work.

use std::fs;
use std::path::Path;

use sscc_io::{Message, check_writable};

use crate::TaskError;

/// Makes a folder if it does not exist, and checks that it can be written to. Callers do this before long work.
///
/// # Errors
/// When the folder cannot be made or written to.
pub fn make_folder(folder: &Path) -> Result<(), TaskError> {
    let make = || {
        fs::create_dir_all(folder)?;
        check_writable(folder)
    };
    make().map_err(|cause| TaskError::System {
        place: Message::from(folder.display()) + ": cannot write to this folder",
        cause,
    })
}
