//! Motion state of a body at one time: where it is, how it is deformed, and its velocities.

use glam::{DMat3, DVec3};
use sscc::parts::Pose;

use super::displacement::displacement;
use crate::{RigidMotion, Shape};

/// State of motion of a body.
#[derive(Clone, Debug)]
pub(crate) struct Kinematics {
    pub rigid: RigidMotion,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
}

impl Kinematics {
    /// Copies a state into this one.
    pub fn set(&mut self, rigid: &RigidMotion, q: &[f64], v: &[f64]) {
        self.rigid = *rigid;
        self.q.copy_from_slice(q);
        self.v.copy_from_slice(v);
    }

    /// Returns the world position of the point that is at `rest` from the centre of mass in the rest pose.
    pub fn point(&self, rest: DVec3, modes: &[DVec3]) -> DVec3 {
        self.rigid.position + self.rigid.orientation * (rest + displacement(modes, &self.q))
    }

    /// Returns the positions of the corners of a triangle in the world.
    pub fn corners(&self, shape: &Shape, triangle: u32) -> [DVec3; 3] {
        let (model, pose) = (shape.model(), self.pose(shape));
        model.mesh().faces()[triangle as usize].map(|v| pose.apply(model.position(v, &self.q)))
    }

    /// Returns the pose of the shape.
    pub fn pose(&self, shape: &Shape) -> Pose {
        pose(&self.rigid, shape)
    }
}

/// Returns the pose of a shape with this rigid motion.
pub(crate) fn pose(rigid: &RigidMotion, shape: &Shape) -> Pose {
    let rotation = DMat3::from_quat(rigid.orientation);
    Pose { rotation, translation: rigid.position - rotation * shape.mass().center }
}
