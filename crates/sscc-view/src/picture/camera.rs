//! From where the shape is seen.

use glam::DVec3;

/// The longer side of a view in pixels, and the shorter one at least.
const LONGEST: f64 = 400.0;
const SHORTEST: f64 = 160.0;

/// Empty space around the shape in pixels.
const MARGIN: f64 = 18.0;

/// Towards the viewer: from the front (z), the right (x) and above (y).
const TOWARDS: DVec3 = DVec3::new(0.5, 0.35, 1.0);

/// A view without perspective. On the screen x goes right and y down; z comes towards the viewer.
pub struct Camera {
    right: DVec3,
    up: DVec3,
    towards: DVec3,
    /// What is in the middle of the picture.
    center: DVec3,
    /// Pixels for a unit of length.
    scale: f64,
    size: [usize; 2],
}

impl Camera {
    /// Sees all these points.
    pub fn around(points: impl Iterator<Item = DVec3>) -> Self {
        let towards = TOWARDS.normalize();
        let right = DVec3::Y.cross(towards).normalize();
        let up = towards.cross(right);
        let seen = points.map(|p| DVec3::new(p.dot(right), p.dot(up), p.dot(towards)));
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lower, upper) = seen.fold(empty, |(lower, upper), p| (lower.min(p), upper.max(p)));
        let middle = (lower + upper) / 2.0;
        let extent = (upper - lower).truncate();
        // A point has no extent, and is seen all the same.
        let longest = extent.max_element().max(f64::MIN_POSITIVE.sqrt());
        let scale = (LONGEST - 2.0 * MARGIN) / longest;
        let side = |x: f64| (x * scale + 2.0 * MARGIN).clamp(SHORTEST, LONGEST).round() as usize;
        let center = right * middle.x + up * middle.y + towards * middle.z;
        Self { right, up, towards, center, scale, size: [side(extent.x), side(extent.y)] }
    }

    /// Width and height of a view in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// A point in a view whose pixels are divided into so many along each side.
    pub fn project(&self, point: DVec3, samples: usize) -> DVec3 {
        let p = point - self.center;
        let turned = DVec3::new(p.dot(self.right), -p.dot(self.up), p.dot(self.towards)) * self.scale;
        let [width, height] = self.size.map(|n| n as f64 / 2.0);
        (turned + DVec3::new(width, height, 0.0)) * samples as f64
    }

    /// A direction, with y up and z towards the viewer.
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
            assert!(width.max(height) <= LONGEST && width.min(height) >= SHORTEST, "{width} x {height}");
            for p in points.iter().map(|p| camera.project(*p, 2)) {
                assert!(p.x >= 2.0 * MARGIN - 2.0 && p.x <= 2.0 * (width - MARGIN) + 2.0, "{p}");
                assert!(p.y >= 2.0 * MARGIN - 2.0 && p.y <= 2.0 * (height - MARGIN) + 2.0, "{p}");
            }
        }
        let camera = Camera::around([DVec3::ZERO, DVec3::Y].into_iter());
        assert!(camera.project(DVec3::Y, 1).y < camera.project(DVec3::ZERO, 1).y, "up is up");
    }
}
