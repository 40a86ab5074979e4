//! The plane of a polygon: the projection in which it is triangulated, and how far it is from being plane.

use glam::{DVec2, DVec3};

/// Size of a normal relative to that of its parts up to which the parts count as cancelling.
const CANCELLED: f64 = 1e-9;

/// A polygon in a coordinate projection.
pub(super) struct PlaneView {
    /// The corners without the coordinate along the largest component of the normal. The projection is exact.
    pub points: Vec<DVec2>,
    /// Whether the polygon turns left in the projection, by rounded arithmetic.
    pub turns_left: bool,
    /// The thickness of the polygon along its normal over the diagonal of its box, rounded; 0 without a normal.
    pub thickness: f64,
}

impl PlaneView {
    /// Projects a polygon, with coordinates within [`sscc::limits`].
    ///
    /// The normal is Newell's: half its length is the area of the projection along it. It is rounded, without fused
    /// operations, and only selects the axis.
    pub fn of(corners: &[DVec3]) -> Self {
        let origin = corners.first().copied().unwrap_or_default();
        let (mut low, mut high) = (origin, origin);
        for corner in corners {
            (low, high) = (low.min(*corner), high.max(*corner));
        }
        // Cross products of such differences neither overflow nor vanish.
        let size = (high - low).max_element();
        let scaled = |corner: &DVec3| if size > 0.0 { (*corner - origin) / size } else { DVec3::ZERO };
        let (mut normal, mut magnitude) = (DVec3::ZERO, DVec3::ZERO);
        let mut last = scaled(corners.last().unwrap_or(&origin));
        for corner in corners {
            let next = scaled(corner);
            let cross = last.cross(next);
            (normal, magnitude) = (normal + cross, magnitude + cross.abs());
            last = next;
        }
        // Where the parts of a polygon that crosses itself cancel out, the largest part is not 0 if the polygon has width.
        let is_clear = normal.abs().max_element() > CANCELLED * magnitude.max_element();
        let parts = if is_clear { normal.abs() } else { magnitude };
        let axis = (1..3).fold(0, |axis, other| if parts[other] > parts[axis] { other } else { axis });
        let along = if is_clear { normal.normalize_or_zero() } else { DVec3::ZERO };
        let heights = || corners.iter().map(|corner| scaled(corner).dot(along));
        let thickness = heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min);
        let diagonal = if size > 0.0 { ((high - low) / size).length() } else { 0.0 };
        Self {
            points: corners.iter().map(|corner| project(*corner, axis)).collect(),
            turns_left: normal[axis] > 0.0,
            thickness: if diagonal > 0.0 { thickness / diagonal } else { 0.0 },
        }
    }
}

/// Returns the point without the coordinate of that axis, so that a positive component of the normal turns left.
fn project(point: DVec3, axis: usize) -> DVec2 {
    match axis {
        0 => DVec2::new(point.y, point.z),
        1 => DVec2::new(point.z, point.x),
        _ => DVec2::new(point.x, point.y),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_projection_keeps_the_turn() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        for axis in 0..3 {
            for height in [-0.5, 0.5] {
                // A square that is steepest along one axis, seen from above or below.
                let lift = |p: &DVec2| {
                    let mut point = DVec3::splat(height * p.x);
                    (point[(axis + 1) % 3], point[(axis + 2) % 3]) = (p.x, p.y);
                    point
                };
                let view = PlaneView::of(&square.each_ref().map(lift));
                assert!(view.turns_left && view.thickness < 1e-15);
                assert_eq!(view.points, square);
                let mut turned = square.map(|p| lift(&p));
                turned.reverse();
                assert!(!PlaneView::of(&turned).turns_left);
            }
        }
    }

    #[test]
    fn thickness_does_not_depend_on_the_size() {
        let bent = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.5), DVec3::Y];
        let expected = PlaneView::of(&bent).thickness;
        assert!(expected > 0.15 && expected < 0.16, "{expected}");
        for scale in [1e-300, 1e-30, 1e30, 1e60] {
            let thickness = PlaneView::of(&bent.map(|p| p * scale)).thickness;
            assert!((thickness - expected).abs() < 1e-12, "{scale}: {thickness}");
        }
        for degenerate in
            [&[][..], &[DVec3::ONE], &[DVec3::ONE; 5], &[DVec3::ZERO, DVec3::ONE, DVec3::ONE * 2.0]]
        {
            assert_eq!(PlaneView::of(degenerate).thickness, 0.0);
        }
    }
}
