//! Names of a glTF file's nodes and materials, for groups of triangles.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::json::{or_default, parse_parts};
use crate::FormatError;
use crate::named_groups::{DEFAULT, GroupsBy, own_name};

/// Names of nodes and materials, and the material of each primitive.
#[derive(Deserialize)]
pub(super) struct PartNames {
    #[serde(default, deserialize_with = "or_default")]
    materials: Vec<Named>,
    #[serde(default, deserialize_with = "or_default")]
    meshes: Vec<MaterialsOfMesh>,
    #[serde(default, deserialize_with = "or_default")]
    nodes: NodeNames,
}

/// Names and meshes of nodes, in maps without entries for empty nodes: a hostile file may have many of these, in three
/// bytes of text each.
#[derive(Default)]
struct NodeNames {
    names: BTreeMap<usize, Box<str>>,
    /// The first node that shows each mesh.
    first_of_mesh: BTreeMap<u32, usize>,
}

#[derive(Deserialize)]
struct Named {
    name: Option<Box<str>>,
}

#[derive(Deserialize)]
struct Node {
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
    /// Parses the names. Only groups need them, so readers of geometry keep an error until groups are asked for.
    pub fn parse(json: &[u8]) -> Result<Self, FormatError> {
        parse_parts(json)
    }

    /// Returns the first node that shows a mesh.
    pub fn node_of_mesh(&self, mesh: usize) -> Option<usize> {
        self.nodes.first_of_mesh.get(&u32::try_from(mesh).ok()?).copied()
    }

    /// Returns the name of a primitive's group; `node` shows its mesh. A material that does not exist is no error,
    /// because materials do not change the shape: it is named by its number.
    pub fn group(&self, by: GroupsBy, node: Option<usize>, mesh: usize, primitive: usize) -> String {
        let numbered = |name: Option<&Box<str>>, number: usize| {
            name.map_or_else(|| format!("#{number}"), |name| own_name(name))
        };
        let shape = self.meshes.get(mesh);
        let mesh_name = || numbered(shape.and_then(|shape| shape.name.as_ref()), mesh);
        match by {
            GroupsBy::Group => format!("#{primitive}"),
            GroupsBy::Object => match node {
                Some(node) => numbered(self.nodes.names.get(&node), node),
                None => mesh_name(),
            },
            GroupsBy::Mesh => mesh_name(),
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

impl<'de> Deserialize<'de> for NodeNames {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(NodesVisitor)
    }
}

struct NodesVisitor;

impl<'de> Visitor<'de> for NodesVisitor {
    type Value = NodeNames;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an array of nodes")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut nodes: A) -> Result<NodeNames, A::Error> {
        let mut found = NodeNames::default();
        let mut number = 0;
        while let Some(Node { name, mesh }) = nodes.next_element()? {
            if let Some(name) = name {
                found.names.insert(number, name);
            }
            if let Some(mesh) = mesh {
                found.first_of_mesh.entry(mesh).or_insert(number);
            }
            number += 1;
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_parts_differ_from_their_numbers() {
        let names = PartNames::parse(
            br##"{"nodes": [{"mesh": 0}, {"mesh": 1, "name": "#0"}], "materials": [{"name": "#1"}],
            "meshes": [{"primitives": [{"material": 0}]}, {"name": "a", "primitives": [{}]}]}"##,
        )
        .unwrap();
        let node = |node: usize| names.group(GroupsBy::Object, Some(node), node, 0);
        assert_eq!((node(0), node(1)), ("#0".into(), "##0".into()));
        assert_eq!(names.group(GroupsBy::Material, Some(0), 0, 0), "##1");
    }
}
