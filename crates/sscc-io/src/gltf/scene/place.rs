//! Places of meshes in the world: the transform of a node, or the joints of its skin.

use glam::{DMat3, DMat4, DVec3};

use super::influences::Influences;
use super::skin::Skin;
use crate::FormatError;

/// Use of weights of joints that do not sum to 1. The standard forbids them, but some files have them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SkinWeights {
    /// Divide the weights of each vertex by their sum, as three.js does. A vertex whose weights are all 0 follows its
    /// first joint (`JOINTS_0.x`) alone.
    #[default]
    Normalized,
    /// Use the weights of the file. A vertex whose weights are all 0 is at the origin of the world.
    AsStored,
}

/// The map of the vertices of a mesh at a node from the mesh's own coordinates to the world.
pub(super) enum Place<'a> {
    /// The world transform of the node.
    Rigid(DMat4),
    /// The influences of the mesh, and the transform of each joint that it uses.
    Skinned(&'a Influences, Vec<DMat4>),
}

impl<'a> Place<'a> {
    /// Returns the place of a mesh at a node, for world transforms of nodes. The transform of a node with a skin has no
    /// effect, by the standard.
    pub fn new(node: usize, skin: Option<(&Skin, &'a Influences)>, world: impl Fn(usize) -> DMat4) -> Self {
        match skin {
            None => Self::Rigid(world(node)),
            Some((skin, influences)) => {
                let joints = influences.joints.iter().map(|joint| skin.joint_transform(*joint, &world));
                Self::Skinned(influences, joints.collect())
            }
        }
    }

    /// Whether a scale of 0 flattens triangles to segments or points.
    pub fn is_flat(&self) -> bool {
        match self {
            Self::Rigid(transform) => is_flat(transform),
            Self::Skinned(_, joints) => joints.iter().any(is_flat),
        }
    }

    /// Replaces the positions of all vertices in the mesh's own coordinates by those in the world.
    pub fn apply(&self, reading: SkinWeights, positions: &mut [DVec3]) {
        match self {
            Self::Rigid(transform) => positions.iter_mut().for_each(|x| *x = transform.transform_point3(*x)),
            Self::Skinned(influences, joints) => {
                for (vertex, x) in positions.iter_mut().enumerate() {
                    *x = skinned(influences, vertex, joints, reading, *x);
                }
            }
        }
    }
}

fn skinned(
    influences: &Influences,
    vertex: usize,
    joints: &[DMat4],
    reading: SkinWeights,
    position: DVec3,
) -> DVec3 {
    let influences = influences.of_vertex(vertex);
    let sum: f64 = influences.iter().map(|(_, weight)| weight).sum();
    let share = |weight: f64| match reading {
        SkinWeights::AsStored => weight,
        // A vertex whose weights are all 0 has one influence.
        SkinWeights::Normalized if sum == 0.0 => 1.0,
        SkinWeights::Normalized => weight / sum,
    };
    let moved =
        |(joint, weight): &(u32, f64)| joints[*joint as usize].transform_point3(position) * share(*weight);
    influences.iter().map(moved).sum::<DVec3>()
}

/// Whether a transform maps space to a plane, a line or a point, up to rounding.
fn is_flat(transform: &DMat4) -> bool {
    let axes = DMat3::from_mat4(*transform);
    let lengths = axes.x_axis.length() * axes.y_axis.length() * axes.z_axis.length();
    axes.determinant().abs() <= 1e-14 * lengths
}

/// Refuses joints of a mesh that its skin does not have. `place` names the node in messages, `number` is that of the skin
/// and `mesh` that of the mesh.
pub(super) fn check_joints(
    influences: &Influences,
    (number, skin): (usize, &Skin),
    mesh: usize,
    place: &str,
) -> Result<(), FormatError> {
    let joints = skin.len();
    let wrong = influences.joints.partition_point(|joint| (*joint as usize) < joints);
    let Some(joint) = influences.joints.get(wrong) else { return Ok(()) };
    let vertex = influences.first_vertex_of(wrong as u32);
    let cause = format!(
        "vertex {vertex} (counted from 0) of meshes[{mesh}] names joint {joint}, but skins[{number}] has {joints}"
    );
    Err(FormatError::part(place, cause))
}

/// Refuses positions in the world that are not finite or exceed [`sscc::limits::LARGEST`].
pub(super) fn check_positions(positions: &[DVec3], place: &str) -> Result<(), FormatError> {
    match positions.iter().position(|x| !sscc::limits::contains(*x)) {
        Some(vertex) => {
            let cause =
                format!("the position of vertex {vertex} (counted from 0) is not finite, or beyond 2^200");
            Err(FormatError::part(place, cause))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn scales_of_zero_are_flat() {
        let turn = DMat4::from_quat(DQuat::from_rotation_y(0.3) * DQuat::from_rotation_x(1.1));
        let scaled = |x: f64, y: f64, z: f64| turn * DMat4::from_scale(DVec3::new(x, y, z)) * turn;
        for (x, y, z) in [(0.0, 1.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1e-9, 1e-9, 0.0)] {
            assert!(is_flat(&scaled(x, y, z)), "{x} {y} {z}");
        }
        for (x, y, z) in [(1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (1e-9, 1e-9, 1e-9), (1e-3, 1.0, 1e3)] {
            assert!(!is_flat(&scaled(x, y, z)), "{x} {y} {z}");
        }
    }
}
