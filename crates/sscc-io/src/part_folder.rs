//! Temporary folders beside a target, whose content replaces it by renaming.

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::part_file::create_unused;

/// New folder that is removed on drop with all that it contains.
pub(crate) struct PartFolder {
    path: PathBuf,
    is_kept: bool,
}

impl PartFolder {
    /// Creates the folder in another one, with an unused name.
    pub(crate) fn create_in(folder: &Path) -> io::Result<Self> {
        let (path, ()) = create_unused(folder, |path| fs::create_dir(path))?;
        Ok(Self { path, is_kept: false })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Renames each first path to the second one. If one cannot be renamed, the paths before it get their old names again; if
    /// this fails, this folder is kept, since it may contain the old files.
    pub(crate) fn rename_all(&mut self, moves: &[(PathBuf, PathBuf)]) -> io::Result<()> {
        for (number, (from, to)) in moves.iter().enumerate() {
            if let Err(error) = fs::rename(from, to) {
                let back = |(from, to): &(PathBuf, PathBuf)| fs::rename(to, from).is_ok();
                self.is_kept = !moves[..number].iter().rev().all(back);
                return Err(error);
            }
        }
        Ok(())
    }
}

impl Drop for PartFolder {
    fn drop(&mut self) {
        if !self.is_kept {
            let _ = fs::remove_dir_all(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_paths_are_renamed_or_none() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let mut part = PartFolder::create_in(directory.path()).unwrap();
        let new = part.path().join("new");
        fs::write(at("x"), "old").unwrap();
        fs::write(&new, "new").unwrap();
        let set_aside = (at("x"), part.path().join("old"));
        let mut moves = vec![set_aside, (new, at("x")), (at("missing"), at("y"))];
        assert!(part.rename_all(&moves).is_err());
        assert_eq!(fs::read(at("x")).unwrap(), b"old");
        moves.pop();
        part.rename_all(&moves).unwrap();
        drop(part);
        assert_eq!(fs::read(at("x")).unwrap(), b"new");
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    }
}
