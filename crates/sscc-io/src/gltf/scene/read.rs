//! Reads the scene of a glTF file.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use super::animated_scene::AnimatedScene;
use super::animation_reader::AnimationReader;
use super::json::{self, SceneRoot};
use super::mesh_node::MeshNode;
use super::nodes::Nodes;
use super::shape::{Shape, morph_targets};
use super::skin::Skin;
use crate::gltf::accessors::Accessors;
use crate::gltf::buffers::Buffers;
use crate::gltf::glb;
use crate::gltf::json::{Mesh, Root, parse_parts};
use crate::gltf::morph::default_weights;
use crate::gltf::part_names::PartNames;
use crate::gltf::select::has_triangles;
use crate::{FormatError, IoError, read_whole};

/// Memory of a node for each 3 bytes of text (`{},`), in bytes.
const NODE_SIZE: u64 = 512;

/// Reads all nodes with a mesh, skins and animations of a `.gltf` or `.glb` file. Buffers may be in the file, or in files
/// in its folder or below; symbolic links are followed.
///
/// # Errors
/// When the file cannot be read or is malformed, has a version other than 2.x, compressed geometry or another required
/// extension that could change positions; when a buffer is outside of the folder; when the node hierarchy has a cycle or
/// a node with two parents; when joints, nodes, skins, meshes or samplers do not exist; when weights are negative; when
/// an animation has no key frames, key frames out of order or another number of values; when a number is not finite;
/// when the numbers would take more than 100 times the files' size and 64 MiB.
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
    let skins = scene.skins.iter().enumerate();
    let skins = skins
        .map(|(number, skin)| Skin::read(&mut accessors, &nodes, number, skin))
        .collect::<Result<Vec<_>, _>>()?;
    let names = Arc::new(PartNames::parse(chunks.json)?);
    let mesh_nodes = mesh_nodes(&mut accessors, &root, &scene, &skins, &names)?;
    let of_meshes: Vec<usize> = root.meshes.iter().map(morph_targets).collect();
    let targets = |node: &json::Node| of_meshes.get(node.mesh? as usize).copied();
    let targets: Vec<usize> = scene.nodes.iter().map(|node| targets(node).unwrap_or(0)).collect();
    let mut reader = AnimationReader {
        accessors: &mut accessors,
        nodes: &nodes,
        morph_targets: &targets,
        times: BTreeMap::new(),
    };
    let animations = scene.animations.iter().enumerate();
    let animations: Vec<_> = animations
        .map(|(number, animation)| reader.read(number, animation))
        .collect::<Result<_, FormatError>>()?;
    let (animations, infos) = animations.into_iter().unzip();
    Ok(AnimatedScene { nodes, mesh_nodes, skins, animations, infos })
}

/// Returns the accessors that the scene uses; some may not exist.
fn used<'a>(root: &'a Root, scene: &'a SceneRoot) -> impl Iterator<Item = usize> {
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let geometry = primitives.flat_map(|primitive| {
        let targets = primitive.targets.iter().filter_map(|target| target.position);
        primitive.attributes.position.into_iter().chain(primitive.indices).chain(targets)
    });
    let attributes =
        scene.meshes.iter().flat_map(|mesh| &mesh.primitives).map(|primitive| &primitive.attributes);
    let influences =
        attributes.flat_map(|a| a.joints.iter().chain(&a.weights).map(|(_, accessor)| *accessor));
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
    skins: &[Skin],
    names: &Arc<PartNames>,
) -> Result<Vec<MeshNode>, FormatError> {
    let has_triangles: Vec<bool> = root.meshes.iter().map(has_triangles).collect();
    let mut shapes: BTreeMap<(usize, bool), Arc<Shape>> = BTreeMap::new();
    let mut mesh_nodes = Vec::new();
    for (number, node) in scene.nodes.iter().enumerate() {
        let refused = |cause: String| FormatError::part(format!("nodes[{number}]"), cause);
        let Some(index) = node.mesh.map(|mesh| mesh as usize) else { continue };
        let Some(mesh) = root.meshes.get(index) else {
            return Err(refused(format!("meshes[{index}] does not exist")));
        };
        let skin = node.skin.map(|skin| skin as usize);
        if let Some(skin) = skin.filter(|skin| *skin >= skins.len()) {
            return Err(refused(format!("skins[{skin}] does not exist")));
        }
        if !has_triangles[index] {
            continue;
        }
        let shape = match shapes.get(&(index, skin.is_some())) {
            Some(shape) => Arc::clone(shape),
            None => {
                let attributes = skin.and_then(|_| scene.meshes.get(index));
                let shape = Arc::new(Shape::read(accessors, index, mesh, attributes)?);
                shapes.insert((index, skin.is_some()), Arc::clone(&shape));
                shape
            }
        };
        if let (Some(skin), Some(influences)) = (skin, &shape.influences) {
            let joints = skins[skin].len();
            let wrong = influences.joints.partition_point(|joint| (*joint as usize) < joints);
            if let Some(joint) = influences.joints.get(wrong) {
                let vertex = influences.first_vertex_of(wrong as u32);
                return Err(refused(format!(
                    "vertex {vertex} (counted from 0) of meshes[{index}] names joint {joint}, but skins[{skin}] \
                     has {joints}"
                )));
            }
        }
        let weights = stored_weights(node, mesh, index, shape.rank).map_err(|error| match error {
            WeightsError::OfNode(cause) => refused(cause),
            WeightsError::OfMesh(error) => error,
        })?;
        accessors.allowance.take(1, size_of::<MeshNode>() as u64 + 8 * shape.rank as u64).map_err(refused)?;
        mesh_nodes.push(MeshNode {
            node: number,
            name: node.name.as_deref().map(str::to_owned),
            mesh: index,
            mesh_name: mesh.name.clone(),
            skin,
            weights,
            shape,
            names: Arc::clone(names),
        });
    }
    Ok(mesh_nodes)
}

enum WeightsError {
    OfNode(String),
    OfMesh(FormatError),
}

/// Returns the weights of a node's morph targets: its own, else those of the mesh, else zeros.
fn stored_weights(
    node: &json::Node,
    mesh: &Mesh,
    index: usize,
    rank: usize,
) -> Result<Vec<f64>, WeightsError> {
    match node.weights.len() {
        0 => default_weights(mesh, rank, index).map_err(WeightsError::OfMesh),
        n if n == rank => Ok(node.weights.to_vec()),
        n => Err(WeightsError::OfNode(format!("{n} weights for {rank} morph targets"))),
    }
}
