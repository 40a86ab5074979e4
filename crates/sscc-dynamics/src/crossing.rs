//! Where two triangles cross, and which way apart.

use glam::{DMat3, DVec3};

use crate::{DepthField, Shape, SignedDistance};

/// A deformed triangle of a shape, in any axes.
#[derive(Clone, Copy)]
pub(crate) struct Facet<'a> {
    pub shape: &'a Shape,
    pub corners: [DVec3; 3],
    pub rest: [DVec3; 3],
}

/// Two crossing triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// The middle of what they have in common, by weights of the corners of each.
    pub weights: [[f64; 3]; 2],
    /// Pushes the first away from the second.
    pub normal: DVec3,
    /// How far, along the normal, corners of one are inside the other one's material.
    pub depth: f64,
}

impl Crossing {
    /// Of two triangles that have a point in common.
    ///
    /// Each corner is taken into the other shape's rest pose through the frame of the triangle there; its depth in
    /// the material, and the way out, taken back, are depth and normal (Hirota et al. 2000). That way must lead out
    /// through the triangle that was crossed: near an edge it may lead through the face behind, along which nothing
    /// comes apart. Where no corner is inside, or the way is another one, the normals of both triangles tell it. None
    /// where both look the same way: such triangles graze each other, and others beside them tell where to go.
    pub fn of(a: &Facet<'_>, b: &Facet<'_>) -> Option<Self> {
        let x = middle(&a.corners, &b.corners);
        let weights = [a, b].map(|facet| inside(weights(x, &facet.corners)));
        let normals = [a, b].map(|facet| normal(&facet.corners).normalize_or_zero());
        if normals[0].dot(normals[1]) > ALIKE {
            return None;
        }
        let (mut way, mut depth) = (DVec3::ZERO, 0.0_f64);
        for (sign, from, to, outwards) in [(1.0, a, b, normals[1]), (-1.0, b, a, normals[0])] {
            if let Some(frame) = RestFrame::of(to) {
                for (d, out) in from.corners.iter().filter_map(|corner| frame.depth(*corner)) {
                    if out.dot(outwards) > THROUGH {
                        way += out * (sign * d);
                        depth = depth.max(d);
                    }
                }
            }
        }
        // The less one reaches behind the other's plane, the more likely it came through there.
        let behind = |from: &Facet<'_>, to: &Facet<'_>, outwards: DVec3| {
            let deepest = from.corners.iter().map(|x| outwards.dot(to.corners[0] - *x)).fold(0.0, f64::max);
            outwards / deepest.max(LEAST)
        };
        let apart = behind(a, b, normals[1]) - behind(b, a, normals[0]);
        let normal = way.try_normalize().or_else(|| apart.try_normalize())?;
        Some(Self { weights, normal, depth })
    }
}

/// What touches reaches so far, that quotients have squares within the range of numbers.
const LEAST: f64 = 1e-100;

/// The cosine of the angle between normals that look the same way.
const ALIKE: f64 = 0.5;

/// The cosine of the angle between a triangle's normal and a way out that leads through it.
const THROUGH: f64 = 0.7;

/// The way from the axes of a deformed triangle into its rest pose.
struct RestFrame<'a> {
    field: &'a DepthField,
    inverse: DMat3,
    rest: DVec3,
    deformed: DVec3,
}

impl<'a> RestFrame<'a> {
    fn of(facet: &Facet<'a>) -> Option<Self> {
        let frame =
            |x: &[DVec3; 3]| DMat3::from_cols(x[1] - x[0], x[2] - x[0], normal(x).normalize_or_zero());
        let inverse = frame(&facet.rest) * frame(&facet.corners).inverse();
        let (rest, deformed) = (facet.rest[0], facet.corners[0]);
        inverse.is_finite().then_some(Self { field: facet.shape.depth(), inverse, rest, deformed })
    }

    /// How deep a point is inside, and the way out (length 1); none outside.
    fn depth(&self, x: DVec3) -> Option<(f64, DVec3)> {
        let SignedDistance { distance, gradient } =
            self.field.at(self.rest + self.inverse * (x - self.deformed))?;
        // The derivative of the distance by the deformed position.
        let slope = self.inverse.transpose() * gradient;
        let depth = -distance / slope.length();
        (depth > 0.0 && depth.is_finite()).then(|| (depth, slope.normalize()))
    }
}

fn normal(x: &[DVec3; 3]) -> DVec3 {
    (x[1] - x[0]).cross(x[2] - x[0])
}

/// The mean of the points where edges of one pass through the other. It is on both up to rounding; where rounding
/// hides all points, the triangles only touch.
fn middle(a: &[DVec3; 3], b: &[DVec3; 3]) -> DVec3 {
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

/// Barycentric coordinates of the foot of a point; equal ones on a triangle without area.
fn weights(x: DVec3, corners: &[DVec3; 3]) -> [f64; 3] {
    let n = normal(corners);
    let square = n.length_squared();
    let of = |i: usize| {
        let [p, q] = [corners[(i + 1) % 3], corners[(i + 2) % 3]];
        n.dot((q - p).cross(x - p)) / square
    };
    let found = [0, 1, 2].map(of);
    if found.iter().all(|w| w.is_finite()) { found } else { [1.0 / 3.0; 3] }
}

/// The nearest weights (about) of a point of the triangle.
fn inside(weights: [f64; 3]) -> [f64; 3] {
    let positive = weights.map(|w| w.max(0.0));
    let sum: f64 = positive.iter().sum();
    positive.map(|w| w / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_on_both_triangles() {
        let a = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
        let b = [DVec3::new(1.0, 1.0, -1.0), DVec3::new(1.0, 1.0, 2.0), DVec3::new(3.0, 3.0, 0.5)];
        // They have in common the way from (1, 1, 0) to (2, 2, 0).
        let x = middle(&a, &b);
        assert!((x - DVec3::new(1.5, 1.5, 0.0)).length() < 1e-12, "{x}");
        for corners in [a, b] {
            let w = weights(x, &corners);
            let y = corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2];
            assert!((x - y).length() < 1e-12 && (w.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(w.iter().all(|w| *w >= -1e-12));
        }
        assert_eq!(inside([1.5, -0.5, 0.0]), [1.0, 0.0, 0.0]);
        assert_eq!(weights(x, &[DVec3::X; 3]), [1.0 / 3.0; 3]);
    }
}
