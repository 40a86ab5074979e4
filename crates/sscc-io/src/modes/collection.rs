//! Reads `.pvd` collections: the files of VTK of an animation, each with its time.

use std::path::{Component, Path, PathBuf};

use crate::error::quoted;
use crate::file::{ending, folder, read_whole};
use crate::solid::vtk::{elements, is_vtk_name};
use crate::{FormatError, IoError};

/// Maximum number of files in a collection.
pub(crate) const MAX_COLLECTION_FILES: usize = 10_000;

/// A file of a collection.
pub(crate) struct TimedFile {
    pub file: PathBuf,
    /// Its time (s).
    pub time: f64,
}

/// Whether the ending is that of a collection: `.pvd`.
pub fn is_collection(path: &Path) -> bool {
    ending(path) == "pvd"
}

/// Reads the files of a collection, in the order of their times; at least one.
pub(crate) fn read_collection(path: &Path) -> Result<Vec<TimedFile>, IoError> {
    let bytes = read_whole(path)?;
    let mut files = parse(&bytes, folder(path)).map_err(|error| error.of(path))?;
    files.sort_by(|a, b| a.time.total_cmp(&b.time));
    match files.windows(2).find(|two| two[0].time == two[1].time) {
        None => Ok(files),
        Some(two) => {
            let name =
                |file: &TimedFile| quoted(&file.file.file_name().unwrap_or_default().to_string_lossy());
            let cause = format!(
                "{} and {} have the same time {}: a frame is one file; merge its parts, as ParaView's filter Merge Blocks does",
                name(&two[0]),
                name(&two[1]),
                two[0].time
            );
            Err(FormatError::whole(cause).of(path))
        }
    }
}

fn parse(bytes: &[u8], folder: &Path) -> Result<Vec<TimedFile>, FormatError> {
    let text = std::str::from_utf8(bytes).map_err(|_| FormatError::whole("not XML in UTF-8"))?;
    let elements = elements(text.strip_prefix('\u{feff}').unwrap_or(text), false)?;
    let root = elements.first().filter(|root| root.name == "VTKFile");
    let Some(root) = root else {
        return Err(FormatError::whole("the file is no VTK file: '<VTKFile' was expected"));
    };
    if root.get("type") != Some("Collection") {
        let kind = quoted(root.get("type").unwrap_or_default());
        return Err(root.refused(format!("the VTK file has the type {kind}; a Collection was expected")));
    }
    let mut files = Vec::new();
    for (number, element) in elements.iter().filter(|element| element.name == "DataSet").enumerate() {
        let name = element.get("file").ok_or_else(|| element.refused("'DataSet' has no file"))?;
        let file = Path::new(name);
        let is_below = file.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        if !is_below {
            return Err(
                element.refused(format!("{} is not below the folder of the collection", quoted(name)))
            );
        }
        if !is_vtk_name(file) {
            return Err(
                element.refused(format!("{} is no .vtu or .vtk: save its data set as one", quoted(name)))
            );
        }
        let time = match element.get("timestep") {
            None => number as f64,
            Some(text) => match text.trim().parse::<f64>() {
                Ok(time) if time.is_finite() => time,
                _ => return Err(element.refused(format!("timestep {} is not a finite number", quoted(text)))),
            },
        };
        if files.len() == MAX_COLLECTION_FILES {
            let cause = format!("the collection has more than {MAX_COLLECTION_FILES} files");
            return Err(element.refused(cause));
        }
        files.push(TimedFile { file: folder.join(file), time });
    }
    if files.is_empty() {
        return Err(root.refused("the collection has no files"));
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn collection(sets: &str) -> Result<Vec<TimedFile>, FormatError> {
        let text = format!(
            "<?xml version='1.0'?>\n<VTKFile type='Collection'><Collection>\n{sets}</Collection></VTKFile>"
        );
        parse(text.as_bytes(), Path::new("a"))
    }

    #[test]
    fn files_have_times() {
        let files =
            collection("<DataSet timestep='2.5' group='' part='0' file='b/c.vtu'/><DataSet file='d.vtk'/>")
                .unwrap();
        let found: Vec<(&Path, f64)> = files.iter().map(|file| (file.file.as_path(), file.time)).collect();
        assert_eq!(found, [(Path::new("a/b/c.vtu"), 2.5), (Path::new("a/d.vtk"), 1.0)]);
    }

    proptest! {
        /// A randomly damaged file is an error of one line, or still a collection of files below the folder.
        #[test]
        fn damaged_collections_are_errors_or_still_collections(
            damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
            part in prop::sample::select(vec!["", "&#46;", "&amp;", "<![CDATA[x]]>", "<!--", "<DataSet", "'", "/", "]]>", "\0"]),
            at in any::<prop::sample::Index>(),
            cut in any::<prop::sample::Index>(),
            whole: bool,
        ) {
            let text = "<?xml version='1.0'?>\n<VTKFile type='Collection'><Collection>\n\
                <DataSet timestep='2.5' group='' part='0' file='b/c.vtu'/><DataSet file='d.vtk'/></Collection></VTKFile>";
            let mut bytes = text.as_bytes().to_vec();
            for (at, value) in damage {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            let at = at.index(bytes.len());
            bytes.splice(at..at, part.bytes());
            let len = if whole { bytes.len() } else { cut.index(bytes.len()) };
            match parse(&bytes[..len], Path::new("a")) {
                Ok(files) => {
                    let is_below = |file: &TimedFile| {
                        file.file.starts_with("a") && !file.file.components().any(|part| part == Component::ParentDir)
                    };
                    prop_assert!(!files.is_empty());
                    prop_assert!(files.iter().all(|file| file.time.is_finite() && is_below(file)));
                }
                Err(error) => {
                    let message = error.to_string();
                    prop_assert!(!message.is_empty() && !message.contains('\n') && message.len() < 400, "{}", message);
                }
            }
        }
    }

    #[test]
    fn equal_times_are_an_error_of_one_line() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.pvd");
        let sets = "<DataSet timestep='1' file='a&#10;b.vtu'/><DataSet timestep='1' file='c.vtu'/>";
        std::fs::write(
            &path,
            format!("<VTKFile type='Collection'><Collection>{sets}</Collection></VTKFile>"),
        )
        .unwrap();
        let message = read_collection(&path).err().unwrap().to_string();
        assert!(
            message.contains(r"x.pvd: 'a\nb.vtu' and 'c.vtu' have the same time 1: a frame is one file")
                && !message.contains('\n'),
            "{message}"
        );
    }

    #[test]
    fn malformed_collections_are_refused() {
        for (sets, named) in [
            ("", "the collection has no files"),
            ("<DataSet timestep='1'/>", "line 3: 'DataSet' has no file"),
            ("<DataSet file='../x.vtu'/>", "line 3: '../x.vtu' is not below the folder of the collection"),
            ("<DataSet file='x.vtu'>", "malformed XML"),
            ("<DataSet file='/x.vtu'/>", "is not below the folder"),
            ("<DataSet file='x.pvtu'/>", "'x.pvtu' is no .vtu or .vtk"),
            ("<DataSet file='x.vtu' timestep='nan'/>", "timestep 'nan' is not a finite number"),
            ("<DataSet file='x.vtu' timestep='1s'/>", "timestep '1s' is not a finite number"),
            ("<DataSet file=x/>", "line 3: malformed XML"),
            ("</b>", "malformed XML"),
        ] {
            let message = collection(sets).err().unwrap().to_string();
            assert!(message.contains(named), "{sets}: {message}");
        }
        let other = parse(b"<VTKFile type='PolyData'/>", Path::new(".")).err().unwrap().to_string();
        assert_eq!(other, "line 1: the VTK file has the type 'PolyData'; a Collection was expected");
    }
}
