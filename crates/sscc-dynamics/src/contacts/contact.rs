//! Contact between two triangles: its geometry.
//!
//! A contact is rigid or soft. Triangles that do not intersect make rigid contacts: a swept query finds them, and each step
//! computes nearest points and normal again. Triangles that intersect make soft contacts: springs whose material points and
//! normal remain those of the beginning.

use glam::{DMat3, DVec3};
use sscc::Pair;

use super::contact_geometry::{ContactGeometry, DeformedTriangle, clamp_weights, weights};
use super::nearest_triangles::Nearest;
use crate::bodies::displacement::displacement;
use crate::bodies::kinematics::Kinematics;
use crate::{Body, Shape};

/// Material point of a body, as barycentric weights on a triangle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Anchor {
    pub triangle: u32,
    pub weights: [f64; 3],
}

/// Contact between two triangles. It ends when their distance exceeds a multiple of the skin, so that resting triangles
/// do not begin contacts again and again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Contact {
    /// Numbers of the two bodies; equal for a contact within one body.
    pub bodies: [u32; 2],
    pub is_rigid: bool,
    /// Features of the triangles whose nearest points it holds apart (see [`Nearest`]); 0 for soft contacts.
    pub features: u8,
    /// Whether a contact of other triangles has the same points. It then makes no constraint.
    pub is_duplicate: bool,
    pub anchors: [Anchor; 2],
    /// Unit normal, out of the second body, in axes of the second body.
    pub normal: DVec3,
    /// The normal in axes of the world; used by rigid contacts.
    pub world_normal: DVec3,
    /// Vectors from the centres of mass to the common point on which impulses act (axes of the world); used by rigid contacts.
    pub arms: [DVec3; 2],
    /// Vector between the two points at the beginning of the step (axes of the world); used by rigid contacts.
    pub between: DVec3,
    /// Minimum gap at the end of the step; used by rigid contacts.
    pub min_gap: f64,
    /// Impulses along the normal and perpendicular to it (axes of the world); used by rigid contacts.
    pub normal_impulse: f64,
    pub friction_impulse: DVec3,
    /// Difference between the distance of the points along the normal and the gap: the penetration depth at the
    /// beginning.
    pub offset: f64,
    /// Maximum tangential distance of the points (model unit). The contact ends beyond it.
    pub max_slip: f64,
    /// Length by which the spring exceeds the skin: see [`adapt_preload`](super::contact_set::adapt_preload).
    pub preload: f64,
    /// Number of steps in which its triangles have collided since its geometry was computed.
    pub age: u32,
    /// Current gap; negative where the bodies penetrate.
    pub gap: f64,
    /// Rest positions of the two points, from the centre of mass.
    pub rest: [DVec3; 2],
    /// Displacements of the two points by each mode (r vectors). Within one body the first list holds the differences,
    /// and the second is empty.
    pub modes: [Vec<DVec3>; 2],
    /// Modal inverse masses of the two points.
    pub modal_inverse_mass: [ModalInverseMass; 2],
}

/// Inverse effective mass of a point due to the modes, `sum_k U_k U_k'`, in axes of the body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModalInverseMass {
    /// All modes with weight 1: the immediate velocity change by a unit impulse.
    pub all_modes: DMat3,
    /// Each mode with weight `w^2 / (w^2 + lambda)`, where w is the angular frequency of contacts: modes slower than
    /// the contact dominate.
    pub slow_modes: DMat3,
}

/// Zero matrices; the default of a matrix is the identity.
impl Default for ModalInverseMass {
    fn default() -> Self {
        Self { all_modes: DMat3::ZERO, slow_modes: DMat3::ZERO }
    }
}

impl ModalInverseMass {
    /// Sums the modes of a point; `slow_weights` are the weights of [`slow_modes`](Self::slow_modes).
    pub fn of(modes: &[DVec3], slow_weights: &[f64]) -> Self {
        let mut sum = Self::default();
        for (u, weight) in modes.iter().zip(slow_weights) {
            let outer = DMat3::from_cols(*u * u.x, *u * u.y, *u * u.z);
            sum.all_modes += outer;
            sum.slow_modes += outer * *weight;
        }
        sum
    }
}

impl Contact {
    /// Updates the gap: the distance of the two points along the normal, less the offset. Returns their tangential
    /// distance.
    pub fn update_gap(&mut self, bodies: [&Body; 2]) -> f64 {
        let (difference, normal) = if self.is_within() {
            (self.rest[0] - self.rest[1] + displacement(&self.modes[0], &bodies[0].q), self.normal)
        } else {
            let [x, y] = self.world_points(bodies);
            (x - y, bodies[1].rigid.orientation * self.normal)
        };
        let along = difference.dot(normal);
        self.gap = along - self.offset;
        (difference - normal * along).length()
    }

    /// Returns the world positions of the two points, for a contact of two bodies.
    pub fn world_points(&self, bodies: [&Body; 2]) -> [DVec3; 2] {
        std::array::from_fn(|n| {
            let point = self.rest[n] + displacement(&self.modes[n], &bodies[n].q);
            bodies[n].rigid.position + bodies[n].rigid.orientation * point
        })
    }

    /// Whether both triangles belong to one body.
    pub fn is_within(&self) -> bool {
        self.bodies[0] == self.bodies[1]
    }

    /// Whether the contact belongs to these triangles of these bodies.
    pub fn is_of(&self, indices: [u32; 2], pair: Pair) -> bool {
        (self.bodies, self.pair()) == (indices, pair)
    }

    /// Whether the contact holds its points apart: it is rigid, and not a duplicate, which has no points.
    pub fn is_rigid_constraint(&self) -> bool {
        self.is_rigid && !self.is_duplicate
    }

    /// Returns the key that identifies the contact and orders the list of contacts.
    pub fn key(&self) -> ([u32; 2], Pair, u8) {
        (self.bodies, self.pair(), self.features)
    }

    /// Returns the two triangles.
    pub fn pair(&self) -> Pair {
        (self.anchors[0].triangle, self.anchors[1].triangle)
    }

    /// Computes the geometry of a new contact, in memory that another contact may have used. `corners` are the
    /// positions of the triangles' corners: in axes of the body for a contact within one body, else of the world.
    /// Returns false if the triangles make no contact: see [`ContactGeometry::of`].
    pub fn begin(
        &mut self,
        indices: [u32; 2],
        (i, j): Pair,
        bodies: [&Body; 2],
        corners: [[DVec3; 3]; 2],
    ) -> bool {
        let triangles = [i, j];
        let deformed: [DeformedTriangle<'_>; 2] = std::array::from_fn(|n| {
            let shape = bodies[n].shape();
            let rest = corners_at_rest(shape, triangles[n]);
            DeformedTriangle { shape, corners: corners[n], rest }
        });
        let Some(geometry) = ContactGeometry::of(&deformed[0], &deformed[1]) else { return false };
        self.bodies = indices;
        self.anchors =
            std::array::from_fn(|n| Anchor { triangle: triangles[n], weights: geometry.weights[n] });
        let longest_edge =
            |x: &[DVec3; 3]| [0, 1, 2].map(|n| x[n].distance(x[(n + 1) % 3])).into_iter().fold(0.0, f64::max);
        self.max_slip = longest_edge(&corners[0]).max(longest_edge(&corners[1]));
        self.normal = geometry.normal;
        (self.gap, self.offset, self.age) = (-geometry.depth, geometry.depth, 0);
        (self.is_rigid, self.features, self.is_duplicate) = (false, 0, false);
        let points: [DVec3; 2] = std::array::from_fn(|n| interpolate(&corners[n], geometry.weights[n]));
        self.offset += self.normal.dot(points[0] - points[1]);
        if indices[0] != indices[1] {
            self.normal = bodies[1].rigid.orientation.inverse() * self.normal;
        }
        self.attach(bodies);
        true
    }

    /// Begins a rigid contact of two triangles with these corners in the world, in memory that another contact may have
    /// used. The geometry of a duplicate is not computed.
    pub fn begin_rigid(
        &mut self,
        indices: [u32; 2],
        (i, j): Pair,
        bodies: [&Body; 2],
        corners: &[[DVec3; 3]; 2],
        nearest: &Nearest,
        is_duplicate: bool,
    ) {
        let triangles = [i, j];
        (self.bodies, self.is_rigid, self.features) = (indices, true, nearest.features);
        self.anchors = std::array::from_fn(|n| {
            let weights = clamp_weights(weights(nearest.points[n], &corners[n]));
            Anchor { triangle: triangles[n], weights }
        });
        self.normal = if indices[0] == indices[1] {
            nearest.normal
        } else {
            bodies[1].start.rigid.orientation.inverse() * nearest.normal
        };
        (self.offset, self.max_slip, self.preload, self.age) = (0.0, 0.0, 0.0, 0);
        (self.normal_impulse, self.friction_impulse) = (0.0, DVec3::ZERO);
        self.is_duplicate = is_duplicate;
        if !is_duplicate {
            self.attach(bodies);
            self.locate(bodies);
        }
    }

    /// Computes the normal, the gap and the arms of a rigid contact from its anchors at the beginning of the step.
    pub fn locate(&mut self, bodies: [&Body; 2]) {
        if self.is_within() {
            self.between = self.rest[0] - self.rest[1] + displacement(&self.modes[0], &bodies[0].start.q);
            self.gap = self.normal.dot(self.between);
            return;
        }
        self.world_normal = bodies[1].start.rigid.orientation * self.normal;
        let [x, y] = [0, 1].map(|n| bodies[n].start.point(self.rest[n], &self.modes[n]));
        self.between = x - y;
        self.gap = self.world_normal.dot(x - y);
        let middle = (x + y) * 0.5;
        self.arms = bodies.map(|body| middle - body.start.rigid.position);
    }

    /// Returns the velocity at which the points of a rigid contact approach each other along its normal at the beginning of
    /// the step, by the rigid motion of the bodies. Modes are left out, because they bounce without restitution: with
    /// restitution, the points of prestressed bodies would hammer at each other in every other step.
    pub fn approach(&self, bodies: [&Body; 2]) -> f64 {
        let [x, y] = [0, 1].map(|n| bodies[n].start.rigid.velocity_at(self.arms[n]));
        self.world_normal.dot(y - x)
    }

    /// Returns the vector between the points of a rigid contact for the given states of its bodies.
    pub fn between(&self, states: [&Kinematics; 2]) -> DVec3 {
        states[0].point(self.rest[0], &self.modes[0]) - states[1].point(self.rest[1], &self.modes[1])
    }

    /// Computes the fields that follow from bodies and anchors.
    pub fn attach(&mut self, bodies: [&Body; 2]) {
        for n in 0..2 {
            let (shape, Anchor { triangle, weights }) = (bodies[n].shape(), &self.anchors[n]);
            self.rest[n] = interpolate(&corners_at_rest(shape, *triangle), *weights) - shape.mass().center;
            let face = shape.model().mesh().faces()[*triangle as usize];
            let [a, b, c] = face.map(|v| shape.model().modes().of_vertex(v));
            let modes = &mut self.modes[n];
            modes.clear();
            let sum = |k: usize| a[k] * weights[0] + b[k] * weights[1] + c[k] * weights[2];
            modes.extend((0..shape.model().rank()).map(sum));
        }
        if self.bodies[0] == self.bodies[1] {
            let [first, second] = &mut self.modes;
            first.iter_mut().zip(second.iter()).for_each(|(a, b)| *a -= *b);
            second.clear();
        }
        self.modal_inverse_mass =
            std::array::from_fn(|n| ModalInverseMass::of(&self.modes[n], &bodies[n].slow_weights));
    }
}

/// Returns the rest positions of the corners of a triangle.
fn corners_at_rest(shape: &Shape, triangle: u32) -> [DVec3; 3] {
    let mesh = shape.model().mesh();
    mesh.faces()[triangle as usize].map(|v| mesh.rest_positions()[v as usize])
}

/// Returns the point of a triangle with these barycentric weights.
fn interpolate(x: &[DVec3; 3], weights: [f64; 3]) -> DVec3 {
    x[0] * weights[0] + x[1] * weights[1] + x[2] * weights[2]
}
