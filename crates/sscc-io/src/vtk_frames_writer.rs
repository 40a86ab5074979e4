//! Writer for VTK: frames with their times as a `.pvd` collection, whole or not at all.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use glam::DVec3;
use quick_xml::escape::escape;
use sscc::TriMesh;

use crate::IoError;
use crate::collection_target::Target;
use crate::error::quoted;
use crate::file::{folder, not_written, sync_folder, write_whole};
use crate::modes::MAX_COLLECTION_FILES;
use crate::part_folder::PartFolder;
use crate::pose::check_pose;
use crate::vtk_writer::vtu;

/// Writes frames of a mesh as a `.pvd` collection: `x.pvd`, and the files `x/x_000000.vtu`, `x/x_000001.vtu`, ..., which
/// [`write_vtu_pose`](crate::write_vtu_pose) describes.
///
/// Files are written to a temporary folder beside `x`. [`VtkFramesWriter::finish`] renames them, and replaces an
/// earlier collection of that name. If a writer is dropped before that, the folder is removed, and earlier files are
/// unchanged.
pub struct VtkFramesWriter {
    target: Target,
    part: PartFolder,
    frames: usize,
    /// The frame of each time, by its bits.
    frame_of_time: BTreeMap<u64, usize>,
    sets: String,
}

impl VtkFramesWriter {
    /// Maximum number of frames: readers refuse larger collections.
    pub const MAX_FRAMES: usize = MAX_COLLECTION_FILES;

    /// Checks, before long work, that [`create`](Self::create) can begin a collection, and that no file of these inputs is in
    /// the folder whose files the collection replaces. The inputs are not compared with `path` itself.
    ///
    /// # Errors
    /// As [`create`](Self::create); when an input, which may be a file, `FILE#NAME`, a folder or a collection, has files in the folder
    /// of the collection.
    pub fn check(path: &Path, inputs: &[&Path]) -> Result<(), IoError> {
        let target = Target::new(path)?;
        match inputs.iter().find(|input| target.has_files_of(input)) {
            None => target.check(),
            Some(input) => {
                let input = quoted(&input.display().to_string());
                let cause = format!("its folder has files of the input {input}: choose another name");
                Err(IoError::request(path, cause))
            }
        }
    }

    /// Begins a collection.
    ///
    /// # Errors
    /// When the name is no text or does not end in `.pvd`; when the target is a folder or a device; when its folder is
    /// a file, or has files other than those of an earlier collection, which the present `.pvd` file names; or when no
    /// folder can be created beside it.
    pub fn create(path: &Path) -> Result<Self, IoError> {
        let target = Target::new(path)?;
        target.check()?;
        let refused = |cause| not_written(path, cause);
        let part = PartFolder::create_in(folder(path)).map_err(refused)?;
        for name in ["new", "old"] {
            fs::create_dir(part.path().join(name)).map_err(refused)?;
        }
        Ok(Self { target, part, frames: 0, frame_of_time: BTreeMap::new(), sets: String::new() })
    }

    /// Writes the next frame, at a time (s). Times may be in any order.
    ///
    /// # Errors
    /// As [`write_vtu_pose`](crate::write_vtu_pose); when the time is not finite or that of an earlier frame, or there are
    /// [`MAX_FRAMES`](Self::MAX_FRAMES) frames: readers refuse such collections.
    pub fn push(
        &mut self,
        time: f64,
        mesh: &TriMesh,
        positions: &[DVec3],
        colliding: &[bool],
    ) -> Result<(), IoError> {
        self.check_frame(time)?;
        let name = &self.target.name;
        let file = format!("{name}_{:06}.vtu", self.frames);
        let shown = self.target.folder.join(&file);
        check_pose(&shown, mesh, positions, colliding)?;
        let written =
            write_whole(&self.part.path().join("new").join(&file), &vtu(mesh, positions, colliding));
        written.map_err(|error| shown_as(&shown, error))?;
        let file = format!("{name}/{file}");
        let _ = writeln!(self.sets, "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{}\"/>", escape(&file));
        self.frame_of_time.insert(time_bits(time), self.frames);
        self.frames += 1;
        Ok(())
    }

    /// Refuses a frame with which readers would refuse the collection.
    fn check_frame(&self, time: f64) -> Result<(), IoError> {
        let (frame, most) = (self.frames, Self::MAX_FRAMES);
        let cause = if frame >= most {
            format!("a collection has at most {most} frames: write fewer, or write a .npy file")
        } else if !time.is_finite() {
            format!("frame {frame} (counted from 0) has the time {time}: give each frame a finite time")
        } else if let Some(first) = self.frame_of_time.get(&time_bits(time)) {
            format!(
                "frames {first} and {frame} (counted from 0) have the time {time:?}: give each its own time"
            )
        } else {
            return Ok(());
        };
        Err(IoError::request(&self.target.path, cause))
    }

    /// Completes the collection: an earlier one is set aside, and removed when the new one is in place. If the process ends in
    /// between, each file of the earlier collection is in its place or in the temporary folder.
    ///
    /// # Errors
    /// When there are no frames, or the target has become one that [`create`](Self::create) refuses, or cannot be replaced. It
    /// is then unchanged, unless renaming its files back fails, too: then the temporary folder is kept, which contains them.
    pub fn finish(mut self) -> Result<(), IoError> {
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n\
             {}</Collection>\n</VTKFile>\n",
            self.sets
        );
        self.target.check()?;
        let Target { path, folder, .. } = &self.target;
        if self.frames == 0 {
            return Err(IoError::request(path, "the collection has no frames: write at least one"));
        }
        let (new, old) = (self.part.path().join("new"), self.part.path().join("old"));
        let new_file = self.part.path().join("new.pvd");
        let refused = |cause| not_written(path, cause);
        write_whole(&new_file, text.as_bytes()).map_err(|error| shown_as(path, error))?;
        let mut moves = Vec::new();
        for (present, aside) in [(path, "x.pvd"), (folder, "x")] {
            if fs::symlink_metadata(present).is_ok() {
                moves.push((present.clone(), old.join(aside)));
            }
        }
        moves.extend([(new, folder.clone()), (new_file, path.clone())]);
        self.part.rename_all(&moves).map_err(refused)?;
        sync_folder(path);
        Ok(())
    }
}

/// Returns an error of writing a temporary file with the name of the file that it would become.
fn shown_as(path: &Path, error: IoError) -> IoError {
    match error {
        IoError::System { cause, .. } => not_written(path, cause),
        other => other,
    }
}

/// Returns bits that are equal for equal times: those of 0 for -0.
fn time_bits(time: f64) -> u64 {
    (time + 0.0).to_bits()
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::FrameReader;

    fn mesh() -> TriMesh {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.1, 1e-300, -1.0 / 3.0)];
        TriMesh::new(positions, vec![[0, 1, 2], [2, 1, 3]]).unwrap()
    }

    #[test]
    fn frames_have_times() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a & b.pvd");
        let mesh = mesh();
        let mut writer = VtkFramesWriter::create(&path).unwrap();
        let frames =
            [0.0, 0.5, 2.0].map(|x| mesh.rest_positions().iter().map(|p| *p * x).collect::<Vec<_>>());
        for (frame, time) in frames.iter().zip([0.25, 0.5, 1e-3]) {
            writer.push(time, &mesh, frame, &[false; 2]).unwrap();
        }
        writer.finish().unwrap();
        let reader = FrameReader::open(&path, &mesh, "m.obj".as_ref()).unwrap();
        assert_eq!(reader.times(), Some(&[1e-3, 0.25, 0.5][..]));
        let mut positions = Vec::new();
        for (at, frame) in [2, 0, 1].into_iter().enumerate() {
            reader.read(at, &mut positions).unwrap();
            assert_eq!(positions, frames[frame]);
        }
        let other = TriMesh::new(mesh.rest_positions().to_vec(), vec![[0, 1, 2]]).unwrap();
        let message = FrameReader::open(&path, &other, "m.obj".as_ref()).unwrap().read(0, &mut positions);
        let message = message.unwrap_err().to_string();
        assert!(message.contains("000002.vtu: the surface of this frame has 2 triangles"), "{message}");
    }

    #[test]
    fn collections_that_no_reader_takes_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.pvd");
        let mesh = mesh();
        let mut writer = VtkFramesWriter::create(&path).unwrap();
        let mut push = |time: f64| writer.push(time, &mesh, mesh.rest_positions(), &[false; 2]);
        push(0.5).unwrap();
        push(-0.0).unwrap();
        for (time, named) in [
            (f64::NAN, "x.pvd: frame 2 (counted from 0) has the time NaN: give each frame a finite time"),
            (
                f64::INFINITY,
                "x.pvd: frame 2 (counted from 0) has the time inf: give each frame a finite time",
            ),
            (0.5, "x.pvd: frames 0 and 2 (counted from 0) have the time 0.5: give each its own time"),
            (0.0, "x.pvd: frames 1 and 2 (counted from 0) have the time 0.0: give each its own time"),
        ] {
            let message = push(time).unwrap_err().to_string();
            assert!(message.ends_with(named), "{message}");
        }
        push(0.25).unwrap();
        writer.frames = VtkFramesWriter::MAX_FRAMES;
        let message = writer.push(1.0, &mesh, mesh.rest_positions(), &[false; 2]).unwrap_err().to_string();
        assert!(
            message
                .ends_with("x.pvd: a collection has at most 10000 frames: write fewer, or write a .npy file"),
            "{message}"
        );
        writer.finish().unwrap();
        assert_eq!(
            FrameReader::open(&path, &mesh, "m.obj".as_ref()).unwrap().times(),
            Some(&[0.0, 0.25, 0.5][..])
        );
        assert!(
            write(&path, 0)
                .unwrap_err()
                .to_string()
                .ends_with("x.pvd: the collection has no frames: write at least one")
        );
        assert_eq!(content(directory.path()).len(), 4);
    }

    #[test]
    fn a_collection_that_cannot_be_read_is_named() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.pvd");
        write(&path, 2).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, text.replace("timestep=\"1.0\"", "timestep=\"0.0\"")).unwrap();
        let message = VtkFramesWriter::create(&path).err().unwrap().to_string();
        assert!(message.contains("x: contains 'x_00000") && !message.contains('\n'), "{message}");
        let cause = "x.pvd: 'x_000000.vtu' and 'x_000001.vtu' have the same time 0: a frame is one file; merge its parts, as \
                     ParaView's filter Merge Blocks does): move both away, or choose another name";
        assert!(
            message.contains(", and the collection cannot be read (") && message.ends_with(cause),
            "{message}"
        );
        // A folder without files loses nothing.
        fs::remove_dir_all(directory.path().join("x")).unwrap();
        fs::create_dir(directory.path().join("x")).unwrap();
        write(&path, 1).unwrap();
    }

    fn write(path: &Path, frames: usize) -> Result<(), IoError> {
        let mesh = mesh();
        let mut writer = VtkFramesWriter::create(path)?;
        for frame in 0..frames {
            writer.push(frame as f64, &mesh, mesh.rest_positions(), &[false; 2])?;
        }
        writer.finish()
    }

    /// Names of all files in a folder and those in it, with their lengths.
    fn content(folder: &Path) -> Vec<(PathBuf, u64)> {
        let mut found = Vec::new();
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            found.push((path.clone(), fs::metadata(&path).unwrap().len()));
            if path.is_dir() {
                found.pop();
                found.extend(content(&path));
            }
        }
        found.sort();
        found
    }

    #[test]
    fn nothing_is_left_of_an_incomplete_collection() {
        let directory = tempfile::tempdir().unwrap();
        let mesh = mesh();
        let path = directory.path().join("x.pvd");
        for earlier in [0, 2] {
            if earlier > 0 {
                write(&path, earlier).unwrap();
            }
            let before = content(directory.path());
            let mut writer = VtkFramesWriter::create(&path).unwrap();
            writer.push(0.0, &mesh, mesh.rest_positions(), &[true; 2]).unwrap();
            let message = writer.push(1.0, &mesh, &[DVec3::NAN; 4], &[false; 2]).unwrap_err().to_string();
            assert!(message.contains("x_000001.vtu: "), "{message}");
            drop(writer);
            assert_eq!(content(directory.path()), before);
        }
    }

    #[test]
    fn earlier_collections_are_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.pvd");
        fs::create_dir(directory.path().join("x")).unwrap(); // empty
        for frames in [3, 1, 2] {
            write(&path, frames).unwrap();
            let reader = FrameReader::open(&path, &mesh(), "m.obj".as_ref()).unwrap();
            assert_eq!(
                (reader.times().unwrap().len(), content(directory.path()).len()),
                (frames, frames + 1)
            );
            assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 2);
        }
    }

    #[test]
    fn other_files_are_not_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let path = at("x.pvd");
        write(&path, 2).unwrap();
        // In each case the folder has files that the collection does not name.
        for (name, is_removed) in [("x/notes.txt", false), ("x/x_000002.vtu", false), ("x.pvd", true)] {
            let saved = fs::read(&path).unwrap();
            if is_removed {
                fs::remove_file(at(name)).unwrap()
            } else {
                fs::write(at(name), "a").unwrap()
            }
            let before = content(directory.path());
            let message = VtkFramesWriter::create(&path).err().unwrap().to_string();
            assert!(message.ends_with(
                "which is not a file of an earlier collection 'x.pvd': move it away, or choose another name"
            ), "{message}");
            assert!(!message.contains('\n') && content(directory.path()) == before);
            if is_removed { fs::write(at(name), saved).unwrap() } else { fs::remove_file(at(name)).unwrap() }
        }
        // The other file appears while frames are written.
        let writer = VtkFramesWriter::create(&path).unwrap();
        fs::write(at("x/notes.txt"), "a").unwrap();
        assert!(writer.finish().unwrap_err().to_string().contains("contains 'notes.txt', which is not"));
        assert_eq!(content(directory.path()).len(), 4);
        fs::write(at("y"), "a").unwrap();
        let message = VtkFramesWriter::create(&at("y.pvd")).err().unwrap().to_string();
        assert!(message.contains("y: is not a folder, which the files"), "{message}");
        fs::create_dir(at("z.pvd")).unwrap();
        assert!(write(&at("z.pvd"), 1).unwrap_err().to_string().contains("z.pvd: is a directory"));
        assert!(VtkFramesWriter::create(&at("z")).is_err() && !at("z").exists());
    }

    #[test]
    fn inputs_are_not_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let path = at("x.pvd");
        write(&path, 2).unwrap();
        fs::copy(&path, at("other.pvd")).unwrap();
        write(&at("free.pvd"), 1).unwrap();
        for input in
            ["x.pvd", "x.pvd#u", "other.pvd", "other.pvd#", "x", "x/x_000001.vtu", "x/x_000000.vtu#u"]
        {
            let message =
                VtkFramesWriter::check(&path, &[&at("free.pvd"), &at(input)]).unwrap_err().to_string();
            assert!(message.contains("x.pvd: its folder has files of the input"), "{input}: {message}");
        }
        VtkFramesWriter::check(&path, &[&at("free.pvd"), &at("missing")]).unwrap();
    }
}
