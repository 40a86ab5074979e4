//! The camera of a picture: an orthographic view from one direction.

use glam::DVec3;

/// The longer side of a view (pixels).
const MAX_SIDE: f64 = 400.0;

/// Minimum of the shorter side of a view (pixels).
const MIN_SIDE: f64 = 160.0;

/// Empty space around the shape (pixels).
const MARGIN: f64 = 18.0;

/// The direction towards the viewer: in front (z), to the right (x) and above (y).
const VIEW_DIRECTION: DVec3 = DVec3::new(0.5, 0.35, 1.0);

/// An orthographic view. In the picture x points right, y down and z towards the viewer.
pub struct Camera {
    right: DVec3,
    up: DVec3,
    towards: DVec3,
    /// The point in the middle of the picture.
    center: DVec3,
    /// Pixels per unit of length.
    scale: f64,
    size: [usize; 2],
}

impl Camera {
    /// Returns a camera that sees all points.
    pub fn around(points: impl Iterator<Item = DVec3>) -> Self {
        let towards = VIEW_DIRECTION.normalize();
        let right = DVec3::Y.cross(towards).normalize();
        let up = towards.cross(right);
        let seen = points.map(|p| DVec3::new(p.dot(right), p.dot(up), p.dot(towards)));
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lower, upper) = seen.fold(empty, |(lower, upper), p| (lower.min(p), upper.max(p)));
        let middle = (lower + upper) / 2.0;
        let extent = (upper - lower).truncate();
        // A single point has no extent; any scale shows it.
        let longest = extent.max_element().max(f64::MIN_POSITIVE.sqrt());
        let scale = (MAX_SIDE - 2.0 * MARGIN) / longest;
        let side = |x: f64| (x * scale + 2.0 * MARGIN).clamp(MIN_SIDE, MAX_SIDE).round() as usize;
        let center = right * middle.x + up * middle.y + towards * middle.z;
        Self { right, up, towards, center, scale, size: [side(extent.x), side(extent.y)] }
    }

    /// Returns the width and height of a view (pixels).
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Returns the position of a point in a view with `samples` samples along each side of a pixel.
    pub fn project(&self, point: DVec3, samples: usize) -> DVec3 {
        let p = point - self.center;
        let turned = DVec3::new(p.dot(self.right), -p.dot(self.up), p.dot(self.towards)) * self.scale;
        let [width, height] = self.size.map(|n| n as f64 / 2.0);
        (turned + DVec3::new(width, height, 0.0)) * samples as f64
    }

    /// Returns a direction in coordinates of the view, with y up and z towards the viewer.
    pub fn turn(&self, direction: DVec3) -> DVec3 {
        DVec3::new(direction.dot(self.right), direction.dot(self.up), direction.dot(self.towards))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_points_are_within_the_view() {
        let points: Vec<DVec3> = (0..200)
            .map(|i| DVec3::new(f64::from(i % 7), f64::from(i % 11) * 3.0, f64::from(i % 13)) * 1e-30)
            .collect();
        for points in [&points[..], &points[..1], &[]] {
            let camera = Camera::around(points.iter().copied());
            let [width, height] = camera.size().map(|n| n as f64);
            assert!(width.max(height) <= MAX_SIDE && width.min(height) >= MIN_SIDE, "{width} x {height}");
            for p in points.iter().map(|p| camera.project(*p, 2)) {
                assert!(p.x >= 2.0 * MARGIN - 2.0 && p.x <= 2.0 * (width - MARGIN) + 2.0, "{p}");
                assert!(p.y >= 2.0 * MARGIN - 2.0 && p.y <= 2.0 * (height - MARGIN) + 2.0, "{p}");
            }
        }
        let camera = Camera::around([DVec3::ZERO, DVec3::Y].into_iter());
        assert!(camera.project(DVec3::Y, 1).y < camera.project(DVec3::ZERO, 1).y, "y points up in the model");
    }
}
