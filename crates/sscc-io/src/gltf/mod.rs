//! Reads morph targets ([`read`]), meshes at rest ([`read_placed_mesh`]), animated scenes ([`read_scene`]) and the list of all
//! parts ([`read_contents`]) of glTF 2.0 files (`.gltf`, `.glb` and `.vrm`), and writes animated bodies as `.glb` ([`write_animation`]).
//!
//! A mesh with morph targets is a reduced model: rest positions are the base mesh, and mode k is the displacement of
//! target k. [`read`] ignores nodes and their transforms, skins and animations: models, and certificates about them, are
//! in the coordinates of the mesh. An affine map, such as the transform of a node, does not change which triangles
//! intersect. A mesh at rest ([`PlacedMesh`]) has world positions instead, for comparisons with other meshes.
//!
//! [`read`] does not read data that a model does not need, so an error in them refuses no file: accessors, buffers, skins
//! and nodes that the mesh does not use, materials, images, and extensions that a file uses but does not require. Meshes at
//! rest and scenes also need all nodes, their groups the names of materials, and scenes the buffers of all meshes, skins and
//! animations.
//!
//! A scene ([`AnimatedScene`]) has world positions at any time of an animation, with node hierarchy, morph targets and
//! skins.
//!
//! The module has its own parser: version 1.4.1 of the crate `gltf` panics on unchecked accessors. See
//! `docs/notes/files-and-page.md#readers-of-files`.

mod accessors;
mod animation;
mod buffers;
mod component;
mod glb;
mod joined;
mod json;
mod morph;
mod part_names;
mod role;
mod scene;
mod select;
mod triangles;

use std::path::Path;

use self::buffers::Buffers;
use self::json::Root;
use self::part_names::PartNames;
use crate::file::ending;
use crate::named_groups::{GroupCollector, GroupsBy, NamedGroups};
use crate::{FormatError, IoError, read_whole};

pub use animation::{NamedModel, Track, animation_to_bytes, key_frames, write_animation};
pub use joined::PrimitiveRange;
pub use morph::MorphModel;
pub use scene::{
    AnimatedScene, AnimationContents, AnimationInfo, Contents, MeshContents, MeshNode, MeshNodeContents,
    NamedPart, PlacedMesh, ScenePose, SceneState, SkinWeights, count_meshes, parse_contents,
    parse_placed_mesh, parse_scene, read_contents, read_model_placement, read_placed_mesh, read_scene,
};

/// Whether the ending of a file name is that of a glTF file: `.gltf`, `.glb` or `.vrm`, an avatar in binary glTF.
pub fn is_gltf(path: &Path) -> bool {
    matches!(ending(path).as_str(), "gltf" | "glb" | "vrm")
}

/// Reads a mesh with its morph targets: the mesh of that name (`#3` is the fourth), else the only one with targets.
/// Buffers may be in the file, or in files in its folder or below; symbolic links are followed.
///
/// - Primitives of triangles, strips and fans are joined in file order, indexed or not. Points, lines and primitives
///   without positions are left out.
/// - Where primitives have different numbers of morph targets, the missing ones move nothing ([`MorphModel::notes`]).
/// - Positions are float32, or integers of 8 or 16 bits as in KHR_mesh_quantization. Accessors may be sparse.
/// - A target without positions is a mode of zeros.
///
/// # Errors
/// When a file cannot be read or is malformed, has a version other than 2.x, geometry that exists only compressed, or
/// requires an extension that could change positions; when a buffer is outside of the folder; when no mesh has morph
/// targets, or several have and none is named; when the name is that of no mesh, of several, or of one without morph
/// targets; when the numbers would take more than 64 MiB plus 100 times the size of the files.
pub fn read(path: &Path, mesh_name: Option<&str>) -> Result<MorphModel, IoError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    parse_in(&read_whole(path)?, mesh_name, Some(folder)).map_err(|error| error.of(path))
}

/// As [`read`], from the bytes of a file without external buffers.
///
/// # Errors
/// As [`read`], and when a buffer is in another file.
pub fn parse(bytes: &[u8], mesh_name: Option<&str>) -> Result<MorphModel, FormatError> {
    parse_in(bytes, mesh_name, None)
}

/// Reads the groups of the triangles of a mesh, which is chosen as [`read`] chooses it.
///
/// # Errors
/// As [`read`], and when there are more than 65,536 groups.
pub fn read_groups(path: &Path, mesh_name: Option<&str>, by: GroupsBy) -> Result<NamedGroups, IoError> {
    let bytes = read_whole(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    groups_in(&bytes, mesh_name, Some(folder), by).map_err(|error| error.of(path))
}

/// As [`read_groups`], from the bytes of a file without external buffers.
///
/// # Errors
/// As [`read_groups`], and when a buffer is in another file.
pub fn parse_groups(bytes: &[u8], mesh_name: Option<&str>, by: GroupsBy) -> Result<NamedGroups, FormatError> {
    groups_in(bytes, mesh_name, None, by)
}

fn groups_in(
    bytes: &[u8],
    name: Option<&str>,
    folder: Option<&Path>,
    by: GroupsBy,
) -> Result<NamedGroups, FormatError> {
    let model = parse_in(bytes, name, folder)?;
    let chunks = glb::split(bytes)?;
    let mesh = select::choose(&Root::parse(chunks.json)?, name)?;
    let names = PartNames::parse(chunks.json)?;
    let node = names.node_of_mesh(mesh);
    let mut groups = GroupCollector::default();
    for range in &model.primitives {
        groups.extend_to(range.triangles.end as usize, &names.group(by, node, mesh, range.number))?;
    }
    Ok(groups.finish())
}

fn parse_in(bytes: &[u8], name: Option<&str>, folder: Option<&Path>) -> Result<MorphModel, FormatError> {
    let chunks = glb::split(bytes)?;
    let root = Root::parse(chunks.json)?;
    let index = select::choose(&root, name)?;
    let mesh_name = select::mesh_name(&root.meshes[index], index);
    let buffers = Buffers::new(&root.buffers, chunks.binary, folder);
    morph::model(&root, index, mesh_name, buffers, bytes.len() as u64)
}

#[cfg(test)]
mod tests;
