//! The files of a data set: files of folders are in the folder's place, and files that cannot be checked are counted.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};
use serde::Serialize;
use sscc_io::list_mesh_files;
use sscc_tasks::TaskError;

use crate::args::Check;
use crate::flags;
use crate::output::{counted, one_line};

/// The meshes of a run, and the first error among them.
pub struct DataSet {
    pub files: Vec<PathBuf>,
    /// Whether some of the files are those of a folder.
    pub has_folder: bool,
    failures: usize,
    first: Option<FileError>,
}

/// The JSON line of a file that could not be checked.
#[derive(Serialize)]
pub struct FileError {
    /// The file as in answers: its name may have line breaks.
    pub file: String,
    /// Place and cause on one line, without the file.
    pub error: String,
}

impl DataSet {
    /// Lists the files of each folder in its place.
    pub fn of(args: &Check) -> Result<Self> {
        let mut data_set = Self { files: Vec::new(), has_folder: false, failures: 0, first: None };
        for path in [&args.model.path].into_iter().chain(&args.meshes) {
            if !path.is_dir() {
                data_set.files.push(path.clone());
                continue;
            }
            for (flag, is_given) in [
                ("frames", args.motion.frames.is_some()),
                ("against", args.motion.against.is_some()),
                ("pose", args.pose.is_some()),
                ("report", args.report.is_some()),
                ("frames-out", args.frames_out.is_some()),
            ] {
                ensure!(!is_given, "{}: --{flag} is for one mesh: name a file of the folder", path.display());
            }
            data_set.has_folder = true;
            data_set.files.extend(list_mesh_files(path)?);
        }
        Ok(data_set)
    }

    /// Whether answers name their file, and the error of a file does not end the run.
    pub fn has_several(&self) -> bool {
        self.has_folder || self.files.len() > 1
    }

    /// Counts a file that could not be checked. Returns its line.
    pub fn fail(&mut self, file: &Path, error: &TaskError) -> FileError {
        self.failures += 1;
        let line = || FileError::new(file, error);
        self.first.get_or_insert_with(line);
        line()
    }

    /// Returns an error if some files could not be checked: that of the first one, with the number of all others.
    pub fn finish(self) -> Result<()> {
        match (self.first, self.failures) {
            (None, _) => Ok(()),
            (Some(FileError { file, error }), 1) => bail!("{file}: {error}"),
            (Some(FileError { file, error }), failures) => {
                let others = counted(failures as u64 - 1, "more file");
                bail!("{file}: {error}; {others} could not be checked")
            }
        }
    }
}

impl FileError {
    fn new(file: &Path, error: &TaskError) -> Self {
        let file = file.display().to_string();
        let message = one_line(&flags::message(error));
        let cause = message.strip_prefix(&one_line(&file)).and_then(|cause| cause.strip_prefix(": "));
        Self { error: cause.unwrap_or(&message).to_owned(), file }
    }
}
