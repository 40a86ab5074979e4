//! Lists what a glTF file contains: scenes, nodes that place meshes, meshes, skins and animations.

use std::collections::BTreeMap;
use std::iter;
use std::path::Path;

use super::animation::AnimationInfo;
use super::animation_reader::{AnimationReader, morph_targets_of_nodes};
use super::json::{self, MotionRoot, PlacedRoot};
use super::nodes::{NODE_SIZE, Nodes};
use super::shown::nodes_of_default_scene;
use crate::gltf::accessors::Accessors;
use crate::gltf::buffers::Buffers;
use crate::gltf::glb;
use crate::gltf::joined::JoinedPrimitives;
use crate::gltf::json::{Mesh, Root, parse_parts};
use crate::gltf::morph::{fitted_weights, target_names};
use crate::gltf::select::mesh_name;
use crate::gltf::triangles::{geometry_accessors, morph_targets, with_triangles};
use crate::{FormatError, IoError, read_whole};

/// The contents of a glTF file. All lists are in file order, so numbers in the file are indices.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Contents {
    /// Scenes, with the number of root nodes of each.
    pub scenes: Vec<NamedPart>,
    /// Number of the scene that players show first; None without scenes.
    pub default_scene: Option<usize>,
    /// Number of all nodes.
    pub nodes: usize,
    /// Nodes that place a mesh.
    pub mesh_nodes: Vec<MeshNodeContents>,
    /// Meshes.
    pub meshes: Vec<MeshContents>,
    /// Skins, with the number of joints of each.
    pub skins: Vec<NamedPart>,
    /// Animations.
    pub animations: Vec<AnimationContents>,
}

/// A part of a file that has a number of smaller parts.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct NamedPart {
    /// Its name, if the file has one. Names may repeat.
    pub name: Option<String>,
    /// The number of its parts.
    pub parts: usize,
}

/// A node that places a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct MeshNodeContents {
    /// Number of the node.
    pub node: usize,
    /// Its name, if the file has one. Names may repeat.
    pub name: Option<String>,
    /// Number of the mesh.
    pub mesh: usize,
    /// Number of the skin; None if the node moves the mesh by its own transform.
    pub skin: Option<usize>,
    /// Whether the default scene has the node.
    pub is_in_default_scene: bool,
}

/// A mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshContents {
    /// Name that selects it: its own, or `#3` for an unnamed fourth mesh. Names may repeat.
    pub name: String,
    /// Number of primitives, those of points and lines among them.
    pub primitives: usize,
    /// Names of the morph targets.
    pub targets: Vec<String>,
    /// Stored weight of each morph target.
    pub default_weights: Vec<f64>,
    /// Numbers of triangles and vertices, both 0 without primitives of triangles; or the error of a malformed mesh.
    pub size: Result<[usize; 2], FormatError>,
}

/// An animation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AnimationContents {
    /// Its name, times and channels.
    pub info: AnimationInfo,
    /// The error of a malformed animation.
    pub error: Option<FormatError>,
}

/// Reads the contents of a glTF file. A malformed mesh or animation, or one whose buffer is missing, has its error in the
/// list.
///
/// # Errors
/// When the file cannot be read, is no glTF file of a supported version, or requires an extension that could change positions;
/// when the node hierarchy is malformed, or would take more than 64 MiB plus 100 times the size of the file.
pub fn read_contents(path: &Path) -> Result<Contents, IoError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    parse_in(&read_whole(path)?, Some(folder)).map_err(|error| error.of(path))
}

/// Returns the number of meshes of a glTF file, with or without triangles. Reads no geometry.
///
/// # Errors
/// When the file cannot be read, is no glTF file of a supported version, or requires an extension that could change
/// positions.
pub fn count_meshes(path: &Path) -> Result<usize, IoError> {
    let bytes = read_whole(path)?;
    let root = glb::split(&bytes).and_then(|chunks| Root::parse(chunks.json));
    Ok(root.map_err(|error| error.of(path))?.meshes.len())
}

/// As [`read_contents`], from the bytes of a file without external buffers.
///
/// # Errors
/// As [`read_contents`].
pub fn parse_contents(bytes: &[u8]) -> Result<Contents, FormatError> {
    parse_in(bytes, None)
}

fn parse_in(bytes: &[u8], folder: Option<&Path>) -> Result<Contents, FormatError> {
    let chunks = glb::split(bytes)?;
    let root = Root::parse(chunks.json)?;
    let placed: PlacedRoot = parse_parts(chunks.json)?;
    let MotionRoot { skins, animations } = parse_parts(chunks.json)?;
    let buffers = Buffers::new(&root.buffers, chunks.binary, folder);
    let mut accessors = Accessors::new(&root, buffers, iter::empty(), bytes.len() as u64)?;
    let refused = |cause| FormatError::part("nodes", cause);
    accessors.allowance.take(placed.nodes.len() as u64, NODE_SIZE).map_err(refused)?;
    let meshes = root.meshes.iter().enumerate().map(|(number, mesh)| MeshContents {
        name: mesh_name(mesh, number),
        primitives: mesh.primitives.len(),
        targets: target_names(mesh, morph_targets(mesh)),
        default_weights: fitted_weights(&mesh.weights, morph_targets(mesh)),
        size: size(&mut accessors, number, mesh),
    });
    let meshes = meshes.collect();
    let named = |name: Option<Box<str>>, parts: usize| NamedPart { name: name.map(String::from), parts };
    Ok(Contents {
        animations: read_animations(&mut accessors, &root, &placed.nodes, &animations)?,
        meshes,
        mesh_nodes: mesh_nodes(&placed),
        nodes: placed.nodes.len(),
        default_scene: Some(placed.scene.unwrap_or(0)).filter(|scene| *scene < placed.scenes.len()),
        scenes: placed.scenes.into_iter().map(|scene| named(scene.name, scene.nodes.len())).collect(),
        skins: skins.into_iter().map(|skin| named(skin.name, skin.joints.len())).collect(),
    })
}

/// Returns the numbers of triangles and vertices of a mesh, all primitives joined.
fn size(accessors: &mut Accessors<'_>, number: usize, mesh: &Mesh) -> Result<[usize; 2], FormatError> {
    accessors.load(geometry_accessors(mesh))?;
    let mut joined = JoinedPrimitives::new(0);
    for (primitive_number, primitive) in with_triangles(mesh) {
        let part = format!("meshes[{number}].primitives[{primitive_number}]");
        joined.push(accessors, primitive_number, primitive, &part)?;
    }
    Ok([joined.faces.len(), joined.positions.len()])
}

fn mesh_nodes(placed: &PlacedRoot) -> Vec<MeshNodeContents> {
    let is_in_default_scene = nodes_of_default_scene(placed);
    let mesh_node = |(number, node): (usize, &json::Node)| {
        Some(MeshNodeContents {
            node: number,
            name: node.name.as_deref().map(str::to_owned),
            mesh: node.mesh? as usize,
            skin: node.skin.map(|skin| skin as usize),
            is_in_default_scene: is_in_default_scene[number],
        })
    };
    placed.nodes.iter().enumerate().filter_map(mesh_node).collect()
}

fn read_animations(
    accessors: &mut Accessors<'_>,
    root: &Root,
    nodes: &[json::Node],
    animations: &[json::Animation],
) -> Result<Vec<AnimationContents>, FormatError> {
    let hierarchy = Nodes::new(nodes)?;
    let targets = morph_targets_of_nodes(root, nodes);
    let mut reader =
        AnimationReader { accessors, nodes: &hierarchy, morph_targets: &targets, times: BTreeMap::new() };
    let contents = |(number, animation): (usize, &json::Animation)| {
        let keys = animation.samplers.iter().flat_map(|sampler| [sampler.input, sampler.output]);
        let read = reader.accessors.load(keys).and_then(|()| reader.read(number, animation));
        match read {
            Ok((_, info)) => AnimationContents { info, error: None },
            Err(error) => AnimationContents {
                info: AnimationInfo::unreadable(animation.name.clone()),
                error: Some(error),
            },
        }
    };
    Ok(animations.iter().enumerate().map(contents).collect())
}
