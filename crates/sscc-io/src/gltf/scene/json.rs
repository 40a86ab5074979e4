//! Structure of a glTF file's JSON, as far as nodes, scenes, skins and animations need it.
//!
//! Fields are boxed where most entries leave them out: the format allows empty nodes, which take 3 bytes of text.

use std::fmt;

use serde::de::{IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::gltf::json::or_default;

/// Nodes and scenes, for meshes at rest.
#[derive(Deserialize)]
pub(super) struct PlacedRoot {
    #[serde(default, deserialize_with = "or_default")]
    pub nodes: Vec<Node>,
    #[serde(default, deserialize_with = "or_default")]
    pub scenes: Vec<Scene>,
    /// The default scene.
    pub scene: Option<usize>,
}

/// A scene, with its root nodes.
#[derive(Deserialize)]
pub(super) struct Scene {
    pub name: Option<Box<str>>,
    #[serde(default, deserialize_with = "or_default")]
    pub nodes: Box<[u32]>,
}

/// Skins, for meshes at rest.
#[derive(Default, Deserialize)]
pub(super) struct SkinRoot {
    #[serde(default, deserialize_with = "or_default")]
    pub meshes: Vec<Mesh>,
    #[serde(default, deserialize_with = "or_default")]
    pub skins: Vec<Skin>,
}

/// Skins and animations, beside nodes and scenes.
#[derive(Deserialize)]
pub(super) struct MotionRoot {
    #[serde(default, deserialize_with = "or_default")]
    pub skins: Vec<Skin>,
    #[serde(default, deserialize_with = "or_default")]
    pub animations: Vec<Animation>,
}

#[derive(Deserialize)]
pub(super) struct SceneRoot {
    #[serde(default, deserialize_with = "or_default")]
    pub nodes: Vec<Node>,
    #[serde(default, deserialize_with = "or_default")]
    pub meshes: Vec<Mesh>,
    #[serde(default, deserialize_with = "or_default")]
    pub skins: Vec<Skin>,
    #[serde(default, deserialize_with = "or_default")]
    pub animations: Vec<Animation>,
}

#[derive(Deserialize)]
pub(super) struct Node {
    pub name: Option<Box<str>>,
    #[serde(default, deserialize_with = "or_default")]
    pub children: Box<[u32]>,
    pub mesh: Option<u32>,
    pub skin: Option<u32>,
    /// Columns first.
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<Box<[f64; 3]>>,
    /// Quaternion x, y, z, w.
    pub rotation: Option<Box<[f64; 4]>>,
    pub scale: Option<Box<[f64; 3]>>,
    #[serde(default, deserialize_with = "or_default")]
    pub weights: Box<[f64]>,
    extensions: Option<Box<NodeExtensions>>,
}

/// The extensions of a node that change where a mesh is shown.
#[derive(Deserialize)]
struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    instancing: Option<IgnoredAny>,
}

impl Node {
    /// Returns a note if an extension shows the node's mesh at many places.
    pub fn instancing_note(&self, node: usize) -> Option<String> {
        self.extensions.as_ref()?.instancing.as_ref().map(|_| {
            format!(
                "nodes[{node}]: the extension EXT_mesh_gpu_instancing shows its mesh at many places; it is not evaluated, \
                 so that instances are not compared with anything"
            )
        })
    }
}

/// A mesh of the file, with the attributes of its skin alone.
#[derive(Deserialize)]
pub(super) struct Mesh {
    pub primitives: Vec<Primitive>,
}

impl Mesh {
    /// Returns the accessors of all joints and weights; some may not exist.
    pub fn skin_accessors(&self) -> impl Iterator<Item = usize> {
        let attributes = self.primitives.iter().map(|primitive| &primitive.attributes);
        attributes.flat_map(|a| a.joints.iter().chain(&a.weights).map(|(_, accessor)| *accessor))
    }
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub attributes: SkinAttributes,
}

/// Accessors of the attributes `JOINTS_n` and `WEIGHTS_n`, by n.
pub(super) struct SkinAttributes {
    pub joints: Vec<(u32, usize)>,
    pub weights: Vec<(u32, usize)>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    pub name: Option<Box<str>>,
    pub inverse_bind_matrices: Option<usize>,
    pub joints: Vec<u32>,
}

#[derive(Deserialize)]
pub(super) struct Animation {
    pub name: Option<String>,
    pub channels: Vec<Channel>,
    pub samplers: Vec<Sampler>,
}

#[derive(Deserialize)]
pub(super) struct Channel {
    pub sampler: usize,
    pub target: Target,
}

#[derive(Deserialize)]
pub(super) struct Target {
    pub node: Option<usize>,
    pub path: String,
}

#[derive(Deserialize)]
pub(super) struct Sampler {
    pub input: usize,
    pub output: usize,
    pub interpolation: Option<String>,
}

impl<'de> Deserialize<'de> for SkinAttributes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(AttributesVisitor)
    }
}

struct AttributesVisitor;

impl<'de> Visitor<'de> for AttributesVisitor {
    type Value = SkinAttributes;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of attributes")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<SkinAttributes, A::Error> {
        let mut attributes = SkinAttributes { joints: Vec::new(), weights: Vec::new() };
        while let Some(key) = map.next_key::<String>()? {
            let number = |prefix| key.strip_prefix(prefix)?.parse::<u32>().ok();
            if let Some(n) = number("JOINTS_") {
                attributes.joints.push((n, map.next_value()?));
            } else if let Some(n) = number("WEIGHTS_") {
                attributes.weights.push((n, map.next_value()?));
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        attributes.joints.sort_unstable();
        attributes.weights.sort_unstable();
        Ok(attributes)
    }
}
