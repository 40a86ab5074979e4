//! Names of a glTF file's nodes and materials, for groups of triangles.

use serde::Deserialize;

use super::json::parse_parts;
use crate::FormatError;
use crate::named_groups::{DEFAULT, GroupsBy};

/// Names of nodes and materials, and the material of each primitive.
#[derive(Deserialize)]
pub(super) struct PartNames {
    #[serde(default)]
    materials: Vec<Named>,
    #[serde(default)]
    meshes: Vec<MaterialsOfMesh>,
    #[serde(default)]
    nodes: Vec<NodeName>,
}

#[derive(Deserialize)]
struct Named {
    name: Option<Box<str>>,
}

#[derive(Deserialize)]
struct NodeName {
    name: Option<Box<str>>,
    mesh: Option<u32>,
}

#[derive(Deserialize)]
struct MaterialsOfMesh {
    name: Option<Box<str>>,
    primitives: Vec<MaterialOfPrimitive>,
}

#[derive(Deserialize)]
struct MaterialOfPrimitive {
    material: Option<u32>,
}

impl PartNames {
    pub fn parse(json: &[u8]) -> Result<Self, FormatError> {
        parse_parts(json)
    }

    /// The first node that shows a mesh.
    pub fn node_of_mesh(&self, mesh: usize) -> Option<usize> {
        self.nodes.iter().position(|node| node.mesh.is_some_and(|shown| shown as usize == mesh))
    }

    /// The name of the group of a primitive; `node` shows its mesh. Materials that do not exist are named by number:
    /// they do not change the shape.
    pub fn group(&self, by: GroupsBy, node: Option<usize>, mesh: usize, primitive: usize) -> String {
        let numbered = |name: Option<&Box<str>>, number: usize| {
            name.map_or_else(|| format!("#{number}"), |name| name.to_string())
        };
        let shape = self.meshes.get(mesh);
        match by {
            GroupsBy::Group => format!("#{primitive}"),
            GroupsBy::Object => match node {
                Some(node) => numbered(self.nodes.get(node).and_then(|node| node.name.as_ref()), node),
                None => numbered(shape.and_then(|shape| shape.name.as_ref()), mesh),
            },
            GroupsBy::Material => {
                let material = shape.and_then(|shape| shape.primitives.get(primitive)?.material);
                match material.map(|material| material as usize) {
                    Some(material) => {
                        numbered(self.materials.get(material).and_then(|named| named.name.as_ref()), material)
                    }
                    None => DEFAULT.to_owned(),
                }
            }
        }
    }
}
