//! Reads a mesh of a glTF file at rest, and the groups of its triangles.

use std::path::Path;

use sscc::TriMesh;

use super::accessors::Accessors;
use super::buffers::Buffers;
use super::joined::JoinedPrimitives;
use super::json::Root;
use super::part_names::PartNames;
use super::triangles::Topology;
use super::{glb, select};
use crate::named_groups::{GroupCollector, GroupsBy, NamedGroups};
use crate::{FormatError, IoError, read_whole};

/// A mesh at rest.
struct BaseMesh {
    /// Index in the file.
    index: usize,
    mesh: TriMesh,
    /// Each primitive of triangles, by its number in the mesh, and the end of its triangles.
    primitives: Vec<(usize, u32)>,
}

/// Reads a mesh in its own coordinates, without nodes, morph targets, skins and animations: the mesh of that name (`#3`
/// is the fourth), else the only one with triangles. Its primitives of triangles are joined in file order; those of points
/// and lines are left out.
///
/// # Errors
/// When the file cannot be read or is malformed (as [`read`](super::read)); when several meshes have triangles and none is
/// named, or the named one has none.
pub fn read_base_mesh(path: &Path, mesh_name: Option<&str>) -> Result<TriMesh, IoError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let base = parse_in(&read_whole(path)?, mesh_name, folder);
    base.map(|base| base.mesh).map_err(|error| error.of(path))
}

/// Reads the groups of the triangles of the mesh that [`read_base_mesh`] reads.
///
/// # Errors
/// As [`read_base_mesh`], and when there are more than 65,536 groups.
pub fn read_base_groups(path: &Path, mesh_name: Option<&str>, by: GroupsBy) -> Result<NamedGroups, IoError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    groups_in(&read_whole(path)?, mesh_name, folder, by).map_err(|error| error.of(path))
}

fn groups_in(
    bytes: &[u8],
    name: Option<&str>,
    folder: &Path,
    by: GroupsBy,
) -> Result<NamedGroups, FormatError> {
    let BaseMesh { index, primitives, .. } = parse_in(bytes, name, folder)?;
    let names = PartNames::parse(glb::split(bytes)?.json)?;
    let node = names.node_of_mesh(index);
    let mut groups = GroupCollector::default();
    for (primitive, end) in primitives {
        groups.extend_to(end as usize, &names.group(by, node, index, primitive))?;
    }
    Ok(groups.finish())
}

fn parse_in(bytes: &[u8], name: Option<&str>, folder: &Path) -> Result<BaseMesh, FormatError> {
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
    let mut ends = Vec::new();
    for (number, primitive) in primitives {
        let range =
            joined.push(&mut accessors, primitive, &format!("meshes[{index}].primitives[{number}]"))?;
        ends.push((number, range.triangles.end));
    }
    Ok(BaseMesh { index, mesh: TriMesh::new(joined.positions, joined.faces)?, primitives: ends })
}
