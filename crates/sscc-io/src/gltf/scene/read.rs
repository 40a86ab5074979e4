//! Reads the scene of a glTF file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use super::animated_scene::AnimatedScene;
use super::animation::AnimationInfo;
use super::animation_reader::{AnimationReader, morph_targets_of_nodes};
use super::json::{self, SceneRoot};
use super::mesh_node::MeshNode;
use super::nodes::{NODE_SIZE, Nodes};
use super::place::check_joints;
use super::shape::Shape;
use super::skin::Skin;
use crate::gltf::accessors::Accessors;
use crate::gltf::buffers::Buffers;
use crate::gltf::glb;
use crate::gltf::json::{Root, parse_parts};
use crate::gltf::morph;
use crate::gltf::part_names::PartNames;
use crate::gltf::select::has_triangles;
use crate::gltf::triangles::{morph_targets, with_triangles};
use crate::{FormatError, IoError, read_whole};

/// Maximum memory of the note on a node that is left out (bytes).
const NOTE_SIZE: u64 = 256;

/// Reads the nodes with a mesh, the skins and the animations of a glTF file. Buffers may be in the file, or in files in
/// its folder or below; symbolic links are followed.
///
/// # Errors
/// When the file cannot be read or is malformed, has a version other than 2.x, geometry that exists only compressed, or
/// requires an extension that could change positions; when a buffer is outside of the folder; when the node hierarchy has
/// a cycle or a node with two parents; when joints, nodes, skins or meshes do not exist; when weights are negative; when a
/// number is not finite or beyond 2^200; when the numbers would take more than 64 MiB plus 100 times the size of the
/// files. An animation that is malformed (no key frames, key frames out of order, another number of values, nodes or
/// samplers that do not exist) is an error when it is evaluated.
pub fn read_scene(path: &Path) -> Result<AnimatedScene, IoError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    parse_in(&read_whole(path)?, Some(folder)).map_err(|error| error.of(path))
}

/// As [`read_scene`], from the bytes of a file without external buffers.
///
/// # Errors
/// As [`read_scene`], and when a buffer is in another file.
pub fn parse_scene(bytes: &[u8]) -> Result<AnimatedScene, FormatError> {
    parse_in(bytes, None)
}

fn parse_in(bytes: &[u8], folder: Option<&Path>) -> Result<AnimatedScene, FormatError> {
    let chunks = glb::split(bytes)?;
    let root = Root::parse(chunks.json)?;
    let scene: SceneRoot = parse_parts(chunks.json)?;
    let buffers = Buffers::new(&root.buffers, chunks.binary, folder);
    let mut accessors = Accessors::new(&root, buffers, used(&root, &scene), bytes.len() as u64)?;
    let refused = |cause| FormatError::part("nodes", cause);
    accessors.allowance.take(scene.nodes.len() as u64, NODE_SIZE).map_err(refused)?;
    let nodes = Nodes::new(&scene.nodes)?;
    let names = Arc::new(PartNames::parse(chunks.json));
    let (mut mesh_nodes, skins) = mesh_nodes(&mut accessors, &root, &scene, &nodes, &names)?;
    let targets = morph_targets_of_nodes(&root, &scene.nodes);
    let mut reader = AnimationReader {
        accessors: &mut accessors,
        nodes: &nodes,
        morph_targets: &targets,
        times: BTreeMap::new(),
    };
    let animations = scene.animations.iter().enumerate();
    let animations = animations.map(|(number, animation)| match reader.read(number, animation) {
        Ok((animation, info)) => (Ok(animation), info),
        Err(error) => (Err(error), AnimationInfo::unreadable(animation.name.clone())),
    });
    let (animations, infos) = animations.unzip();
    let shown: BTreeSet<usize> = mesh_nodes.iter().map(|mesh_node| mesh_node.mesh).collect();
    let of_meshes = shown.into_iter().flat_map(|mesh| morph::notes(&root.meshes[mesh], mesh));
    let numbers = mesh_nodes.iter().map(|mesh_node| mesh_node.node);
    let of_nodes = numbers.filter_map(|node| scene.nodes[node].instancing_note(node));
    let left_out = left_out(&mesh_nodes);
    let notes = of_meshes.chain(of_nodes).chain(left_out).collect();
    mesh_nodes.retain(|mesh_node| !mesh_node.faces().is_empty());
    Ok(AnimatedScene { nodes, mesh_nodes, skins, animations, infos, notes })
}

/// Returns a note on each node whose mesh has no triangles, although it has primitives of triangles.
fn left_out(mesh_nodes: &[MeshNode]) -> impl Iterator<Item = String> {
    let left_out = mesh_nodes.iter().filter(|mesh_node| mesh_node.faces().is_empty());
    left_out.map(|MeshNode { node, mesh, .. }| {
        format!(
            "nodes[{node}]: meshes[{mesh}] has only strips whose triangles have repeated corners, so it has no triangles; the \
             node is left out"
        )
    })
}

/// Returns the accessors that the scene uses; some may not exist.
fn used<'a>(root: &'a Root, scene: &'a SceneRoot) -> impl Iterator<Item = usize> {
    let primitives = root.meshes.iter().flat_map(with_triangles);
    let geometry = primitives.flat_map(|(_, primitive)| {
        let targets = primitive.targets.iter().filter_map(|target| target.position);
        primitive.attributes.position.into_iter().chain(primitive.indices).chain(targets)
    });
    let influences = scene.meshes.iter().flat_map(json::Mesh::skin_accessors);
    let matrices = scene.skins.iter().filter_map(|skin| skin.inverse_bind_matrices);
    let samplers = scene.animations.iter().flat_map(|animation| &animation.samplers);
    let keys = samplers.flat_map(|sampler| [sampler.input, sampler.output]);
    geometry.chain(influences).chain(matrices).chain(keys)
}

/// Returns the nodes whose mesh has triangles. Nodes with the same mesh share it, but those with a skin have a copy with
/// influences.
fn mesh_nodes(
    accessors: &mut Accessors<'_>,
    root: &Root,
    scene: &SceneRoot,
    nodes: &Nodes,
    names: &Arc<Result<PartNames, FormatError>>,
) -> Result<(Vec<MeshNode>, BTreeMap<usize, Skin>), FormatError> {
    let mut skins = BTreeMap::new();
    let has_triangles: Vec<bool> = root.meshes.iter().map(has_triangles).collect();
    let mut shapes: BTreeMap<(usize, bool), Arc<Shape>> = BTreeMap::new();
    let mut mesh_nodes = Vec::new();
    for (node_number, node) in scene.nodes.iter().enumerate() {
        let place = format!("nodes[{node_number}]");
        let refused = |cause: String| FormatError::part(place.clone(), cause);
        let Some(index) = node.mesh.map(|mesh| mesh as usize) else { continue };
        let Some(mesh) = root.meshes.get(index) else {
            return Err(refused(format!("meshes[{index}] does not exist")));
        };
        let skin = node.skin.map(|skin| skin as usize);
        if !has_triangles[index] {
            continue;
        }
        if let Some(number) = skin
            && !skins.contains_key(&number)
        {
            let Some(skin) = scene.skins.get(number) else {
                return Err(refused(format!("skins[{number}] does not exist")));
            };
            skins.insert(number, Skin::read(accessors, nodes, number, skin)?);
        }
        let shape = match shapes.get(&(index, skin.is_some())) {
            Some(shape) => Arc::clone(shape),
            None => {
                let attributes = skin.and_then(|_| scene.meshes.get(index));
                let rank = morph_targets(mesh);
                let shape = Arc::new(Shape::read(accessors, index, mesh, rank, attributes)?);
                shapes.insert((index, skin.is_some()), Arc::clone(&shape));
                shape
            }
        };
        if let (Some(number), Some(influences)) = (skin, &shape.influences)
            && let Some(skin) = skins.get(&number)
        {
            check_joints(influences, (number, skin), index, &place)?;
        }
        let stored = if node.weights.is_empty() { &mesh.weights[..] } else { &node.weights };
        let weights = morph::fitted_weights(stored, shape.rank);
        let note = if shape.faces.is_empty() { NOTE_SIZE } else { 0 };
        let size = note + size_of::<MeshNode>() as u64 + 8 * shape.rank as u64;
        accessors.allowance.take(1, size).map_err(refused)?;
        mesh_nodes.push(MeshNode {
            node: node_number,
            name: node.name.as_deref().map(str::to_owned),
            mesh: index,
            mesh_name: mesh.name.clone(),
            skin,
            weights,
            shape,
            names: Arc::clone(names),
        });
    }
    Ok((mesh_nodes, skins))
}
