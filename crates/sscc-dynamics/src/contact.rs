//! Contact between two triangles: its geometry, which is kept over many steps.

use glam::{DMat3, DVec3};
use sscc::Pair;

use crate::Shape;
use crate::body::Body;
use crate::crossing::{Crossing, Facet};

/// Material point of a body, as barycentric weights on a triangle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Anchor {
    pub triangle: u32,
    pub weights: [f64; 3],
}

/// Contact between two triangles. It begins when they collide, and ends when their distance exceeds a multiple of the
/// skin; so triangles at rest do not collide again and again.
///
/// The material points and the normal stay those of the beginning. A gap within one body is therefore a linear function
/// of q, and a step costs O(r).
#[derive(Clone, Debug, Default)]
pub(crate) struct Contact {
    /// Numbers of the two bodies; equal for a contact within one body.
    pub bodies: [u32; 2],
    pub anchors: [Anchor; 2],
    /// Unit normal, out of the second body, in axes of the second body.
    pub normal: DVec3,
    /// Difference between the distance of the points along the normal and the gap: the penetration depth at the
    /// beginning.
    pub offset: f64,
    /// Maximum tangential distance of the points (model unit). Beyond it the contact ends.
    pub slack: f64,
    /// Length by which the spring exceeds the skin: see [`adapted`](crate::contacts::adapted).
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
    /// Mobility of the two points.
    pub mobility: [Mobility; 2],
}

/// Inverse effective mass of a point due to its modes, `sum_k U_k U_k'`, in axes of the body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mobility {
    /// All modes with weight 1: the immediate velocity change by a unit impulse.
    pub quick: DMat3,
    /// Each mode with weight `w^2 / (w^2 + lambda)`, where w is the angular frequency of contacts: modes slower than
    /// the contact dominate.
    pub slow: DMat3,
}

/// Zero matrices; the default of a matrix is the identity.
impl Default for Mobility {
    fn default() -> Self {
        Self { quick: DMat3::ZERO, slow: DMat3::ZERO }
    }
}

impl Mobility {
    pub fn of(modes: &[DVec3], shares: &[f64]) -> Self {
        let mut sum = Self::default();
        for (u, share) in modes.iter().zip(shares) {
            let outer = DMat3::from_cols(*u * u.x, *u * u.y, *u * u.z);
            sum.quick += outer;
            sum.slow += outer * *share;
        }
        sum
    }
}

impl Contact {
    /// Brings the gap up to date: how far the two points are apart along the normal, less the depth at the beginning.
    /// Gives how far they are apart across.
    pub fn measure(&mut self, bodies: [&Body<'_>; 2]) -> f64 {
        let (apart, normal) = if self.is_within() {
            (self.rest[0] - self.rest[1] + moved(&self.modes[0], &bodies[0].q), self.normal)
        } else {
            let [x, y] = self.places(bodies);
            (x - y, bodies[1].rigid.orientation * self.normal)
        };
        let along = apart.dot(normal);
        self.gap = along - self.offset;
        (apart - normal * along).length()
    }

    /// Where the two points are in the world; of two bodies.
    pub fn places(&self, bodies: [&Body<'_>; 2]) -> [DVec3; 2] {
        std::array::from_fn(|n| {
            let point = self.rest[n] + moved(&self.modes[n], &bodies[n].q);
            bodies[n].rigid.position + bodies[n].rigid.orientation * point
        })
    }

    /// Whether both triangles belong to one body.
    pub fn is_within(&self) -> bool {
        self.bodies[0] == self.bodies[1]
    }

    /// Key that identifies the contact and orders the list of contacts.
    pub fn key(&self) -> ([u32; 2], Pair) {
        (self.bodies, (self.anchors[0].triangle, self.anchors[1].triangle))
    }

    /// Begins anew, in memory that may have served another one; corners are where the triangles are, in axes of the
    /// body (within one body) or of the world. False where they are none.
    pub fn begin(
        &mut self,
        indices: [u32; 2],
        (i, j): Pair,
        bodies: [&Body<'_>; 2],
        corners: [[DVec3; 3]; 2],
    ) -> bool {
        let triangles = [i, j];
        let facets: [Facet<'_>; 2] = std::array::from_fn(|n| {
            let shape = bodies[n].shape();
            let rest = corners_at_rest(shape, triangles[n]);
            Facet { shape, corners: corners[n], rest }
        });
        let Some(crossing) = Crossing::of(&facets[0], &facets[1]) else { return false };
        self.bodies = indices;
        self.anchors =
            std::array::from_fn(|n| Anchor { triangle: triangles[n], weights: crossing.weights[n] });
        let longest =
            |x: &[DVec3; 3]| [0, 1, 2].map(|n| x[n].distance(x[(n + 1) % 3])).into_iter().fold(0.0, f64::max);
        self.slack = longest(&corners[0]).max(longest(&corners[1]));
        self.normal = crossing.normal;
        (self.gap, self.offset, self.age) = (-crossing.depth, crossing.depth, 0);
        let points: [DVec3; 2] = std::array::from_fn(|n| mean(&corners[n], crossing.weights[n]));
        self.offset += self.normal.dot(points[0] - points[1]);
        if indices[0] != indices[1] {
            self.normal = bodies[1].rigid.orientation.inverse() * self.normal;
        }
        self.attach(bodies);
        true
    }

    /// Makes all that follows from bodies and anchors.
    pub fn attach(&mut self, bodies: [&Body<'_>; 2]) {
        for n in 0..2 {
            let (shape, Anchor { triangle, weights }) = (bodies[n].shape(), &self.anchors[n]);
            self.rest[n] = mean(&corners_at_rest(shape, *triangle), *weights) - shape.mass().center;
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
        self.mobility = std::array::from_fn(|n| Mobility::of(&self.modes[n], &bodies[n].shares));
    }
}

fn corners_at_rest(shape: &Shape, triangle: u32) -> [DVec3; 3] {
    let mesh = shape.model().mesh();
    mesh.faces()[triangle as usize].map(|v| mesh.rest_positions()[v as usize])
}

fn mean(x: &[DVec3; 3], weights: [f64; 3]) -> DVec3 {
    x[0] * weights[0] + x[1] * weights[1] + x[2] * weights[2]
}

/// `sum_k U_k q_k`
pub(crate) fn moved(modes: &[DVec3], q: &[f64]) -> DVec3 {
    modes.iter().zip(q).fold(DVec3::ZERO, |sum, (u, q)| sum + *u * *q)
}
