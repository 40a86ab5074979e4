//! Common point, contact normal and penetration depth of two intersecting triangles.

use glam::{DMat3, DVec3};

use crate::{DepthField, Shape, SignedDistance};

/// Deformed triangle of a shape, in any axes.
#[derive(Clone, Copy)]
pub(crate) struct DeformedTriangle<'a> {
    pub shape: &'a Shape,
    pub corners: [DVec3; 3],
    pub rest: [DVec3; 3],
}

/// Geometry of the contact of two intersecting triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ContactGeometry {
    /// Mean of the intersection points, as barycentric weights on each triangle.
    pub weights: [[f64; 3]; 2],
    /// Unit contact normal; pushes the first triangle away from the second.
    pub normal: DVec3,
    /// Penetration depth: how deep, along the normal, corners of one triangle are inside the other shape's material.
    pub depth: f64,
}

impl ContactGeometry {
    /// Returns the contact of two triangles that have a point in common. None if their normals are similar: such
    /// triangles graze each other, and adjacent triangles define the contact.
    ///
    /// Each corner is mapped into the rest pose of the other shape through the frame of the triangle there. The
    /// material depth at the mapped point and the direction out of the material, mapped back, give penetration depth
    /// and normal (Hirota et al. 2000). The direction must leave through the intersected triangle: near an edge it may
    /// leave through the face behind the edge, which separates nothing. If no corner is inside, or no direction
    /// qualifies, the normals of both triangles give the contact normal.
    pub fn of(a: &DeformedTriangle<'_>, b: &DeformedTriangle<'_>) -> Option<Self> {
        let x = intersection_point(&a.corners, &b.corners);
        let weights = [a, b].map(|triangle| clamp_weights(weights(x, &triangle.corners)));
        let normals = [a, b].map(|triangle| normal(&triangle.corners).normalize_or_zero());
        if normals[0].dot(normals[1]) > MAX_NORMAL_COSINE {
            return None;
        }
        let (mut direction, mut depth) = (DVec3::ZERO, 0.0_f64);
        for (sign, from, to, outwards) in [(1.0, a, b, normals[1]), (-1.0, b, a, normals[0])] {
            if let Some(frame) = RestFrame::of(to) {
                for (d, out) in from.corners.iter().filter_map(|corner| frame.depth(*corner)) {
                    if out.dot(outwards) > MIN_EXIT_COSINE {
                        direction += out * (sign * d);
                        depth = depth.max(d);
                    }
                }
            }
        }
        // A triangle that reaches less far behind the other's plane is more likely to have entered through that plane.
        let behind = |from: &DeformedTriangle<'_>, to: &DeformedTriangle<'_>, outwards: DVec3| {
            let deepest = from.corners.iter().map(|x| outwards.dot(to.corners[0] - *x)).fold(0.0, f64::max);
            outwards / deepest.max(MIN_DEPTH)
        };
        let separating = behind(a, b, normals[1]) - behind(b, a, normals[0]);
        let normal = direction.try_normalize().or_else(|| separating.try_normalize())?;
        Some(Self { weights, normal, depth })
    }
}

/// Minimum depth behind a plane: squares of quotients by it are in the range of f64.
const MIN_DEPTH: f64 = 1e-100;

/// Triangles whose normals have a larger cosine between them graze each other.
const MAX_NORMAL_COSINE: f64 = 0.5;

/// Minimum cosine between a triangle's normal and a direction that leaves the material through this triangle.
const MIN_EXIT_COSINE: f64 = 0.7;

/// Map from the neighbourhood of a deformed triangle into its rest pose.
struct RestFrame<'a> {
    field: &'a DepthField,
    inverse: DMat3,
    rest: DVec3,
    deformed: DVec3,
}

impl<'a> RestFrame<'a> {
    fn of(triangle: &DeformedTriangle<'a>) -> Option<Self> {
        let frame =
            |x: &[DVec3; 3]| DMat3::from_cols(x[1] - x[0], x[2] - x[0], normal(x).normalize_or_zero());
        let inverse = frame(&triangle.rest) * frame(&triangle.corners).inverse();
        let (rest, deformed) = (triangle.rest[0], triangle.corners[0]);
        inverse.is_finite().then_some(Self { field: triangle.shape.depth(), inverse, rest, deformed })
    }

    /// Returns the depth of a point inside the material and the unit direction out of it. None outside.
    fn depth(&self, x: DVec3) -> Option<(f64, DVec3)> {
        let SignedDistance { distance, gradient } =
            self.field.at(self.rest + self.inverse * (x - self.deformed))?;
        // Derivative of the distance with respect to the deformed position.
        let slope = self.inverse.transpose() * gradient;
        let depth = -distance / slope.length();
        (depth > 0.0 && depth.is_finite()).then(|| (depth, slope.normalize()))
    }
}

/// Returns the normal of a triangle, with twice the area as its length.
fn normal(x: &[DVec3; 3]) -> DVec3 {
    (x[1] - x[0]).cross(x[2] - x[0])
}

/// Returns the mean of the points where edges of one triangle pass through the other. It lies on both triangles up to
/// rounding. If rounding hides all points, it is the mean of the six corners.
fn intersection_point(a: &[DVec3; 3], b: &[DVec3; 3]) -> DVec3 {
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for (edges, face) in [(a, b), (b, a)] {
        let plane = normal(face);
        let heights = edges.map(|x| plane.dot(x - face[0]));
        for i in 0..3 {
            let (j, [h, k]) = ((i + 1) % 3, [heights[i], heights[(i + 1) % 3]]);
            if (h > 0.0) != (k > 0.0) {
                let x = edges[i] + (edges[j] - edges[i]) * (h / (h - k));
                if weights(x, face).iter().all(|w| *w >= -1e-9) {
                    sum += x;
                    count += 1.0;
                }
            }
        }
    }
    if count > 0.0 { sum / count } else { (a.iter().sum::<DVec3>() + b.iter().sum::<DVec3>()) / 6.0 }
}

/// Returns the barycentric coordinates of the projection of a point onto the triangle's plane; 1/3 each for a triangle without
/// area.
pub(crate) fn weights(x: DVec3, corners: &[DVec3; 3]) -> [f64; 3] {
    let n = normal(corners);
    let square = n.length_squared();
    let of = |i: usize| {
        let [p, q] = [corners[(i + 1) % 3], corners[(i + 2) % 3]];
        n.dot((q - p).cross(x - p)) / square
    };
    let all = [0, 1, 2].map(of);
    if all.iter().all(|w| w.is_finite()) { all } else { [1.0 / 3.0; 3] }
}

/// Clamps barycentric weights to the triangle: negative ones to 0, then scaled to the sum 1.
pub(crate) fn clamp_weights(weights: [f64; 3]) -> [f64; 3] {
    let positive = weights.map(|w| w.max(0.0));
    let sum: f64 = positive.iter().sum();
    positive.map(|w| w / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_intersection_point_is_on_both_triangles() {
        let a = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
        let b = [DVec3::new(1.0, 1.0, -1.0), DVec3::new(1.0, 1.0, 2.0), DVec3::new(3.0, 3.0, 0.5)];
        // Their intersection is the segment from (1, 1, 0) to (2, 2, 0).
        let x = intersection_point(&a, &b);
        assert!((x - DVec3::new(1.5, 1.5, 0.0)).length() < 1e-12, "{x}");
        for corners in [a, b] {
            let w = weights(x, &corners);
            let y = corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2];
            assert!((x - y).length() < 1e-12 && (w.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(w.iter().all(|w| *w >= -1e-12));
        }
        assert_eq!(clamp_weights([1.5, -0.5, 0.0]), [1.0, 0.0, 0.0]);
        assert_eq!(weights(x, &[DVec3::X; 3]), [1.0 / 3.0; 3]);
    }
}
