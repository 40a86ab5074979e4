//! Writers for VTK: a pose as `.vtu`, and frames with their times as a `.pvd` collection of such files.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;
use quick_xml::escape::escape;
use sscc::TriMesh;

use crate::pose::check_pose;
use crate::{IoError, write_whole};

/// VTK's type of a triangle.
const TRIANGLE: u8 = 5;

/// Writes a pose as an unstructured grid of triangles: positions as Float64, and the cell data `colliding`, 1 for
/// colliding triangles and 0 for others.
///
/// # Errors
/// As [`write_obj_pose`](crate::write_obj_pose).
pub fn write_vtu_pose(
    path: &Path,
    mesh: &TriMesh,
    positions: &[DVec3],
    colliding: &[bool],
) -> Result<(), IoError> {
    check_pose(path, mesh, positions, colliding)?;
    write_whole(path, &vtu(mesh, positions, colliding))
}

/// Writes frames of a mesh as a `.pvd` collection: `x.pvd`, and the files `x/x_000000.vtu`, `x/x_000001.vtu`, ..., which
/// [`write_vtu_pose`] describes. Dropped before [`VtkFramesWriter::finish`], it removes what it has written.
pub struct VtkFramesWriter {
    path: PathBuf,
    folder: PathBuf,
    name: String,
    /// Whether the folder was not there before.
    is_new: bool,
    files: Vec<PathBuf>,
    sets: String,
    is_complete: bool,
}

impl VtkFramesWriter {
    /// Begins a collection.
    ///
    /// # Errors
    /// When the name is no text, or the folder cannot be created.
    pub fn create(path: &Path) -> Result<Self, IoError> {
        let folder = path.with_extension("");
        let Some(name) = folder.file_name().and_then(|name| name.to_str()).map(str::to_owned) else {
            return Err(IoError::request(path, "the name of a collection must be text in UTF-8"));
        };
        let is_new = !folder.is_dir();
        if is_new {
            let refused = |cause| IoError::System { path: folder.clone(), action: "written", cause };
            fs::create_dir(&folder).map_err(refused)?;
        }
        let (path, files) = (path.to_owned(), Vec::new());
        Ok(Self { path, folder, name, is_new, files, sets: String::new(), is_complete: false })
    }

    /// Writes the next frame, at a time (s).
    ///
    /// # Errors
    /// As [`write_vtu_pose`].
    pub fn push(
        &mut self,
        time: f64,
        mesh: &TriMesh,
        positions: &[DVec3],
        colliding: &[bool],
    ) -> Result<(), IoError> {
        let file = format!("{}_{:06}.vtu", self.name, self.files.len());
        let path = self.folder.join(&file);
        self.files.push(path.clone());
        write_vtu_pose(&path, mesh, positions, colliding)?;
        let file = format!("{}/{file}", self.name);
        let _ = writeln!(self.sets, "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{}\"/>", escape(&file));
        Ok(())
    }

    /// Completes the collection.
    ///
    /// # Errors
    /// When the `.pvd` file cannot be written.
    pub fn finish(mut self) -> Result<(), IoError> {
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n\
             {}</Collection>\n</VTKFile>\n",
            self.sets
        );
        write_whole(&self.path, text.as_bytes())?;
        self.is_complete = true;
        Ok(())
    }
}

impl Drop for VtkFramesWriter {
    fn drop(&mut self) {
        if self.is_complete {
            return;
        }
        for file in &self.files {
            let _ = fs::remove_file(file);
        }
        if self.is_new {
            let _ = fs::remove_dir(&self.folder);
        }
    }
}

/// Returns the file. Arrays follow the XML as raw bytes, each after its length.
fn vtu(mesh: &TriMesh, positions: &[DVec3], colliding: &[bool]) -> Vec<u8> {
    let faces = mesh.faces();
    let coordinates = positions.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes).collect();
    let corners = faces.iter().flatten().flat_map(|v| i64::from(*v).to_le_bytes()).collect();
    let ends = (1..=faces.len() as i64).flat_map(|end| (3 * end).to_le_bytes()).collect();
    let marks = colliding.iter().map(|collides| u8::from(*collides)).collect();
    let arrays: [Vec<u8>; 5] = [marks, coordinates, corners, ends, vec![TRIANGLE; faces.len()]];
    let mut offset = 0;
    let offsets = arrays.each_ref().map(|array| {
        let start = offset;
        offset += size_of::<u64>() + array.len();
        start
    });
    let array = |kind: &str, name: &str, components: u8, offset: usize| {
        // meshio reads one component that is stated as a table of one column.
        let components =
            if components > 1 { format!(" NumberOfComponents=\"{components}\"") } else { String::new() };
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\"{components} format=\"appended\" offset=\"{offset}\"/>"
        )
    };
    let [marks, points, corners, ends, types] = offsets;
    let head = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n\
         <CellData Scalars=\"colliding\">\n{}\n</CellData>\n<Points>\n{}\n</Points>\n<Cells>\n{}\n{}\n{}\n</Cells>\n\
         </Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
        positions.len(),
        faces.len(),
        array("UInt8", "colliding", 1, marks),
        array("Float64", "Points", 3, points),
        array("Int64", "connectivity", 1, corners),
        array("Int64", "offsets", 1, ends),
        array("UInt8", "types", 1, types),
    );
    let mut bytes = head.into_bytes();
    for array in &arrays {
        bytes.extend((array.len() as u64).to_le_bytes());
        bytes.extend(array);
    }
    bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FrameReader, load_mesh};

    fn mesh() -> TriMesh {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.1, 1e-300, -1.0 / 3.0)];
        TriMesh::new(positions, vec![[0, 1, 2], [2, 1, 3]]).unwrap()
    }

    #[test]
    fn a_pose_is_read_again() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.vtu");
        let mesh = mesh();
        write_vtu_pose(&path, &mesh, mesh.rest_positions(), &[false, true]).unwrap();
        let read = load_mesh(&path, None).unwrap();
        assert_eq!((read.faces(), read.rest_positions()), (mesh.faces(), mesh.rest_positions()));
        let refused = write_vtu_pose(&path, &mesh, &[DVec3::NAN; 4], &[false; 2]);
        assert!(refused.unwrap_err().to_string().ends_with("is not finite"));
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
    fn nothing_is_left_of_an_incomplete_collection() {
        let directory = tempfile::tempdir().unwrap();
        let mesh = mesh();
        let mut writer = VtkFramesWriter::create(&directory.path().join("x.pvd")).unwrap();
        writer.push(0.0, &mesh, mesh.rest_positions(), &[false; 2]).unwrap();
        assert!(writer.push(1.0, &mesh, &[], &[]).is_err());
        drop(writer);
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
    }
}
