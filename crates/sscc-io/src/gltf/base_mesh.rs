//! Reads a mesh of a glTF file at rest.

use std::path::Path;

use sscc::TriMesh;

use super::accessors::Accessors;
use super::buffers::Buffers;
use super::joined::JoinedPrimitives;
use super::json::Root;
use super::triangles::Topology;
use super::{glb, select};
use crate::{FormatError, IoError, read_whole};

/// Reads a mesh in its own coordinates, without nodes, morph targets, skins and animations: the mesh of that name (`#3`
/// is the fourth), else the only one with triangles. Its primitives of triangles are joined in file order; those of points
/// and lines are left out.
///
/// # Errors
/// When the file cannot be read or is malformed (as [`read`](super::read)); when several meshes have triangles and none is
/// named, or the named one has none.
pub fn read_base_mesh(path: &Path, mesh_name: Option<&str>) -> Result<TriMesh, IoError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    parse_in(&read_whole(path)?, mesh_name, folder).map_err(|error| error.of(path))
}

fn parse_in(bytes: &[u8], name: Option<&str>, folder: &Path) -> Result<TriMesh, FormatError> {
    let chunks = glb::split(bytes)?;
    let root = Root::parse(chunks.json)?;
    let index = select::choose_base(&root, name)?;
    let primitives = root.meshes[index].primitives.iter().enumerate();
    let primitives: Vec<_> = primitives.filter(|(_, p)| Topology::from_mode(p.mode).is_ok()).collect();
    let used = primitives.iter().flat_map(|(_, primitive)| {
        let targets = primitive.targets.iter().filter_map(|target| target.position);
        primitive.attributes.position.into_iter().chain(primitive.indices).chain(targets)
    });
    let buffers = Buffers::new(&root.buffers, chunks.binary, Some(folder));
    let mut accessors = Accessors::new(&root, buffers, used, bytes.len() as u64)?;
    let mut joined = JoinedPrimitives::new(primitives.first().map_or(0, |(_, p)| p.targets.len()));
    for (number, primitive) in primitives {
        joined.push(&mut accessors, primitive, &format!("meshes[{index}].primitives[{number}]"))?;
    }
    Ok(TriMesh::new(joined.positions, joined.faces)?)
}
