//! Skins: joints, and the matrices that bring a mesh into the space of each joint.

use glam::DMat4;

use super::json;
use super::nodes::Nodes;
use crate::FormatError;
use crate::gltf::accessors::Accessors;
use crate::gltf::role::Role;

/// A skin of a glTF file.
pub(super) struct Skin {
    /// Nodes of the joints.
    joints: Vec<u32>,
    /// The inverse bind matrix of each joint; empty if all are the identity.
    inverse_bind: Vec<DMat4>,
}

impl Skin {
    /// Reads a skin; `number` is its place in the file.
    pub fn read(
        accessors: &mut Accessors<'_>,
        nodes: &Nodes,
        number: usize,
        skin: &json::Skin,
    ) -> Result<Self, FormatError> {
        let refused = |cause: String| Err(FormatError::part(format!("skins[{number}]"), cause));
        if skin.joints.is_empty() {
            return refused("it has no joints".into());
        }
        if let Some(joint) = skin.joints.iter().position(|node| *node as usize >= nodes.len()) {
            return refused(format!("joint {joint} is nodes[{}], which does not exist", skin.joints[joint]));
        }
        let mut inverse_bind = Vec::new();
        if let Some(accessor) = skin.inverse_bind_matrices {
            let count = accessors.count(accessor)?;
            if count < skin.joints.len() {
                return refused(format!("{count} inverse bind matrices for {} joints", skin.joints.len()));
            }
            let numbers = accessors.read_finite(accessor, Role::Matrices)?;
            inverse_bind = numbers.as_chunks().0.iter().map(DMat4::from_cols_array).collect();
        }
        Ok(Self { joints: skin.joints.clone(), inverse_bind })
    }

    /// Number of joints, at least 1.
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// Returns the number of the node of a joint.
    pub fn node(&self, joint: u32) -> usize {
        self.joints[joint as usize] as usize
    }

    /// Returns the transform of a joint from the space of the mesh to the world, for world transforms of nodes.
    pub fn joint_transform(&self, joint: u32, world: impl Fn(usize) -> DMat4) -> DMat4 {
        let of_node = world(self.node(joint));
        self.inverse_bind.get(joint as usize).map_or(of_node, |inverse| of_node * *inverse)
    }
}
