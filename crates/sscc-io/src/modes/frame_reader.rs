//! Reads the frames of a given mesh one by one: an array of positions, a point cache, a grid or a collection of VTK, or a folder of
//! meshes.

use std::path::{Path, PathBuf};

use glam::DVec3;
use sscc::{TriMesh, limits};

use super::collection::is_collection;
use super::folder::positions_like;
use super::frames::frame_files;
use super::point_cache::PointCache;
use super::vtk_frames::VtkFrames;
use crate::error::shown_name;
use crate::file::{ending, unsupported};
use crate::mesh_path::split_mesh_name;
use crate::npy::Blocks;
use crate::solid::vtk::{Displacement, is_vtk_name, read_surface};
use crate::{FormatError, IoError};

/// Memory for the positions of meshes from a folder and of grids of VTK, in bytes. Further ones are read again.
const MAX_KEPT: usize = 1 << 30;

/// The frames of a mesh: positions of all its vertices in each.
///
/// Frames of a `.npy` file are read when they are needed; a point cache is read as a whole. Meshes of a folder and
/// grids of VTK take longer to read than to check, so [`FrameReader::check`] keeps their positions until they take 1 GiB.
pub struct FrameReader {
    path: PathBuf,
    mesh: TriMesh,
    /// Name of the mesh in messages.
    name: String,
    source: Source,
    warnings: Vec<String>,
}

enum Source {
    Array(Blocks),
    PointCache(PointCache),
    Vtk { frames: VtkFrames, kept: Vec<Option<Vec<DVec3>>> },
    Folder { files: Vec<PathBuf>, kept: Vec<Option<Vec<DVec3>>> },
}

impl FrameReader {
    /// Opens the frames of a mesh:
    /// - a `.npy` file of floats or integers, of shape (T, V, 3), or (V, 3) for one frame;
    /// - a `.pc2` point cache;
    /// - a `.vtu` or `.vtk` grid, or a `.pvd` collection of them, deformed by its displacements, or by the point data that
    ///   `FILE#NAME` names (`FILE#` names none);
    /// - a folder of meshes with the same faces or none, in the natural order of their names (`9.obj` before `10.obj`), as
    ///   in [`read_frames`](crate::read_frames).
    ///
    /// `mesh_path` names the mesh in messages. If it is in the folder and cannot be a frame, it is skipped.
    ///
    /// # Errors
    /// When the path is none of them; when the array or the point cache is malformed, cut off, without a frame or for
    /// another number of vertices; when the collection or the first grid of VTK is malformed; when the folder has no
    /// mesh or more than 10,000.
    pub fn open(path: &Path, mesh: &TriMesh, mesh_path: &Path) -> Result<Self, IoError> {
        let source = if path.is_dir() {
            let files = frame_files(path, Some(&split_mesh_name(mesh_path).0))?;
            Source::Folder { kept: vec![None; files.len()], files }
        } else if ending(path) == "npy" {
            let blocks = Blocks::open(path)?;
            check_shape(blocks.shape(), mesh.rest_positions().len()).map_err(|error| error.of(path))?;
            Source::Array(blocks)
        } else if ending(path) == "pc2" {
            let cache = PointCache::open(path)?;
            check_shape(cache.shape(), mesh.rest_positions().len()).map_err(|error| error.of(path))?;
            Source::PointCache(cache)
        } else {
            let (file, name) = split_mesh_name(path);
            if !is_vtk_name(&file) && !is_collection(&file) {
                let supported = ".npy of shape (T, V, 3), .pc2, .pvd, .vtu, .vtk, and a folder of meshes";
                return Err(unsupported(path, "frame", supported));
            }
            let frames = VtkFrames::open(&file, name.as_deref())?;
            Source::Vtk { kept: vec![None; frames.len()], frames }
        };
        let name = format!("the mesh ({})", shown_name(mesh_path));
        let warnings = match &source {
            Source::Vtk { frames, .. } => frames.warnings()?,
            Source::Folder { files, .. } if is_vtk_name(&files[0]) => {
                read_surface(&files[0], &Displacement::ByName)?.1
            }
            _ => Vec::new(),
        };
        Ok(Self { path: path.to_owned(), mesh: mesh.clone(), name, source, warnings })
    }

    /// Returns lines about the first frame if it is a grid of VTK: the point data that moves its points, or that may be meant to.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Returns the number of frames, at least 1.
    #[allow(clippy::len_without_is_empty)] // there is always a frame
    pub fn len(&self) -> usize {
        match &self.source {
            Source::Array(blocks) if blocks.shape().len() == 2 => 1,
            Source::Array(blocks) => blocks.shape()[0],
            Source::PointCache(cache) => cache.shape()[0],
            Source::Folder { files, .. } => files.len(),
            Source::Vtk { frames, .. } => frames.len(),
        }
    }

    /// Returns the time of each frame (s), where the file states them: in a `.pvd` collection.
    pub fn times(&self) -> Option<&[f64]> {
        match &self.source {
            Source::Vtk { frames, .. } => frames.times.as_deref(),
            _ => None,
        }
    }

    /// As [`FrameReader::read`], to check a frame early. Keeps the positions of meshes and grids until they take 1 GiB.
    ///
    /// # Errors
    /// As [`FrameReader::read`].
    ///
    /// # Panics
    /// When there is no such frame.
    pub fn check(&mut self, frame: usize, positions: &mut Vec<DVec3>) -> Result<(), IoError> {
        *positions = self.positions(frame)?;
        if let Source::Folder { kept, .. } | Source::Vtk { kept, .. } = &mut self.source
            && frame.saturating_mul(size_of_val(&positions[..])) < MAX_KEPT
        {
            kept[frame] = Some(positions.clone());
        }
        Ok(())
    }

    /// Replaces `positions` by those of a frame, counted from 0. Threads may call this at the same time.
    ///
    /// # Errors
    /// When a file cannot be read or has changed; when a mesh has another number of vertices, or faces other than those of
    /// the mesh; when a coordinate is not finite, or beyond [`sscc::limits::LARGEST`].
    ///
    /// # Panics
    /// When there is no such frame.
    pub fn read(&self, frame: usize, positions: &mut Vec<DVec3>) -> Result<(), IoError> {
        match &self.source {
            Source::Folder { kept, .. } | Source::Vtk { kept, .. } if kept[frame].is_some() => {
                positions.clear();
                positions.extend(kept[frame].iter().flatten());
            }
            _ => *positions = self.positions(frame)?,
        }
        Ok(())
    }

    fn positions(&self, frame: usize) -> Result<Vec<DVec3>, IoError> {
        let length = 3 * self.mesh.rest_positions().len();
        let numbers = match &self.source {
            Source::Folder { files, .. } => {
                return positions_like(&files[frame], &self.mesh, "frame", &self.name);
            }
            Source::Vtk { frames, .. } => return frames.read(frame, &self.mesh, &self.name),
            Source::Array(blocks) => blocks.read(frame * length, length)?,
            Source::PointCache(cache) => cache.read(frame * length, length),
        };
        let positions: Vec<DVec3> = numbers.as_chunks().0.iter().map(|x| DVec3::from_array(*x)).collect();
        match positions.iter().position(|x| !limits::contains(*x)) {
            Some(vertex) => {
                let cause = format!(
                    "frame {frame}: vertex {vertex} (counted from 0) has the position {:?}: not finite, or beyond 2^200",
                    positions[vertex].to_array()
                );
                Err(FormatError::whole(cause).of(&self.path))
            }
            None => Ok(positions),
        }
    }
}

fn check_shape(shape: &[usize], vertices: usize) -> Result<(), FormatError> {
    let refused = |cause: String| Err(FormatError::whole(cause));
    match *shape {
        [frames, v, 3] if frames > 0 && v == vertices => Ok(()),
        [v, 3] if v == vertices => Ok(()),
        [frames, v, 3] if frames > 0 => refused(format!(
            "the frames have {v} vertices, the mesh has {vertices}: are they of another mesh?"
        )),
        ref other => {
            refused(format!("shape {other:?}: (T, {vertices}, 3) was expected, with at least one frame"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write_npy;

    const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    fn mesh() -> TriMesh {
        crate::mesh::obj::parse(MESH.as_bytes()).unwrap()
    }

    fn all(reader: &FrameReader) -> Vec<Vec<DVec3>> {
        let read = |frame| {
            let mut positions = vec![DVec3::NAN];
            reader.read(frame, &mut positions).unwrap();
            positions
        };
        (0..reader.len()).map(read).collect()
    }

    #[test]
    fn arrays_and_folders_agree() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path();
        let numbers: Vec<f64> = (0..18).map(|i| f64::from(i * i)).collect();
        let array = folder.join("x.npy");
        write_npy(&array, &[2, 3, 3], &numbers).unwrap();
        let frames = folder.join("frames");
        std::fs::create_dir(&frames).unwrap();
        for (name, numbers) in [("9.obj", &numbers[..9]), ("10.obj", &numbers[9..])] {
            let line = |x: &[f64]| format!("v {} {} {}\n", x[0], x[1], x[2]);
            let text: String = numbers.chunks(3).map(line).collect();
            std::fs::write(frames.join(name), text + "f 1 2 3\n").unwrap();
        }
        let mut readers =
            [array, frames].map(|path| FrameReader::open(&path, &mesh(), "m.obj".as_ref()).unwrap());
        assert_eq!(all(&readers[0]), all(&readers[1]));
        assert_eq!(all(&readers[0])[1][0], DVec3::new(81.0, 100.0, 121.0));
        for reader in &mut readers {
            reader.check(0, &mut Vec::new()).unwrap();
            reader.check(1, &mut Vec::new()).unwrap();
        }
        // Meshes are kept: their files are not read again.
        std::fs::remove_dir_all(folder.join("frames")).unwrap();
        assert_eq!(all(&readers[0]), all(&readers[1]));
    }

    #[test]
    fn point_caches_are_frames() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.PC2");
        let open = |points: i32, samples: i32, last: f32| {
            let words = [1, points, 0, 0, samples].map(i32::to_le_bytes);
            let mut coordinates = vec![0.5_f32; (3 * points * samples) as usize];
            *coordinates.last_mut().unwrap() = last;
            let data = coordinates.iter().flat_map(|x| x.to_le_bytes());
            let bytes: Vec<u8> =
                b"POINTCACHE2\0".iter().copied().chain(words.into_iter().flatten()).chain(data).collect();
            std::fs::write(&path, bytes).unwrap();
            FrameReader::open(&path, &mesh(), "m.obj".as_ref())
        };
        let frames = all(&open(3, 2, 2.0).unwrap());
        assert_eq!(frames.len(), 2);
        assert_eq!(frames[1], [DVec3::splat(0.5), DVec3::splat(0.5), DVec3::new(0.5, 0.5, 2.0)]);
        let message = open(4, 2, 0.0).err().unwrap().to_string();
        assert!(message.ends_with("the frames have 4 vertices, the mesh has 3: are they of another mesh?"));
        let message = open(3, 2, f32::NAN).unwrap().read(1, &mut Vec::new()).unwrap_err().to_string();
        assert!(message.contains("x.PC2: frame 1: vertex 2 (counted from 0)"), "{message}");
    }

    #[test]
    fn frames_that_do_not_fit_the_mesh_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.npy");
        let open = || FrameReader::open(&path, &mesh(), "m.obj".as_ref());
        let message = |shape: &[usize]| {
            write_npy(&path, shape, &vec![0.0; shape.iter().product()]).unwrap();
            open().err().unwrap().to_string()
        };
        assert!(
            message(&[2, 4, 3])
                .ends_with("the frames have 4 vertices, the mesh has 3: are they of another mesh?")
        );
        for shape in [&[0, 3, 3][..], &[2, 3, 2], &[4, 3], &[9], &[1, 1, 3, 3], &[3, 3, 0]] {
            let message = message(shape);
            assert!(message.ends_with("(T, 3, 3) was expected, with at least one frame"), "{message}");
        }
        write_npy(&path, &[3, 3], &[1.0; 9]).unwrap();
        assert_eq!(all(&open().unwrap()), [[DVec3::ONE; 3]]);
        for bad in [f64::NAN, f64::INFINITY, 1e70] {
            let mut numbers = [0.0; 18];
            numbers[13] = bad;
            write_npy(&path, &[2, 3, 3], &numbers).unwrap();
            let mut reader = open().unwrap();
            reader.check(0, &mut Vec::new()).unwrap();
            let message = reader.check(1, &mut Vec::new()).unwrap_err().to_string();
            assert!(
                message.contains("x.npy: frame 1: vertex 1 (counted from 0) has the position [0.0, "),
                "{message}"
            );
        }
        let message =
            FrameReader::open("x.csv".as_ref(), &mesh(), "m.obj".as_ref()).err().unwrap().to_string();
        assert_eq!(message, "x.csv: not found");
    }
}
