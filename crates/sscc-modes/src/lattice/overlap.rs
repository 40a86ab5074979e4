//! Overlap of triangles and segments with boxes, in units of cells.

use glam::DVec3;

/// Margin of boxes (in cells) that exceeds rounding (1e-10 cells in the largest grids), so that no overlap is missed.
/// Additional overlaps are harmless, because pieces are joined along edges of the surface, never by proximity.
pub(super) const SLACK: f64 = 1e-9;

/// Axis-aligned box.
#[derive(Clone, Copy)]
pub(super) struct Block {
    center: DVec3,
    half: DVec3,
}

impl Block {
    /// Creates the box between two corners.
    pub fn new(low: DVec3, high: DVec3) -> Self {
        Self { center: 0.5 * (low + high), half: 0.5 * (high - low) }
    }

    /// Creates the box of a block of cells, the last ones excluded.
    pub fn cells(from: [u32; 3], to: [u32; 3]) -> Self {
        Self::new(DVec3::from_array(from.map(f64::from)), DVec3::from_array(to.map(f64::from)))
    }

    /// Enlarges the box on all sides.
    pub fn enlarged(self, by: f64) -> Self {
        Self { half: self.half + by, ..self }
    }

    /// Whether a triangle has a point in the box: no axis separates them (Akenine-Möller 2001).
    pub fn meets_triangle(&self, corners: [DVec3; 3]) -> bool {
        let p = corners.map(|corner| corner - self.center);
        let edges = [p[1] - p[0], p[2] - p[1], p[0] - p[2]];
        let bounded = (p[0].min(p[1]).min(p[2])).cmple(self.half).all()
            && (p[0].max(p[1]).max(p[2])).cmpge(-self.half).all();
        bounded
            && !self.separates(edges[0].cross(edges[1]), &p)
            && edges.iter().all(|edge| DVec3::AXES.iter().all(|axis| !self.separates(axis.cross(*edge), &p)))
    }

    /// Whether a segment has a point in the box.
    pub fn meets_segment(&self, from: DVec3, to: DVec3) -> bool {
        let p = [from - self.center, to - self.center];
        let edge = p[1] - p[0];
        p[0].min(p[1]).cmple(self.half).all()
            && p[0].max(p[1]).cmpge(-self.half).all()
            && DVec3::AXES.iter().all(|axis| !self.separates(axis.cross(edge), &p))
    }

    fn separates(&self, axis: DVec3, points: &[DVec3]) -> bool {
        let reach = self.half.dot(axis.abs());
        let along = points.iter().map(|p| axis.dot(*p));
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        low > reach || high < -reach
    }

    /// Clips a triangle to the box; returns the centroid and the area vector (along the normal).
    pub fn clip(&self, corners: [DVec3; 3]) -> (DVec3, DVec3) {
        let mut polygon = corners.map(|corner| corner - self.center).to_vec();
        let mut next = Vec::with_capacity(9);
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                next.clear();
                for i in 0..polygon.len() {
                    let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                    let [over_a, over_b] = [a, b].map(|p| side * p[axis] - self.half[axis]);
                    if over_a <= 0.0 {
                        next.push(a);
                    }
                    if (over_a <= 0.0) != (over_b <= 0.0) {
                        next.push(a.lerp(b, over_a / (over_a - over_b)));
                    }
                }
                std::mem::swap(&mut polygon, &mut next);
            }
        }
        let Some(&first) = polygon.first() else { return (self.center, DVec3::ZERO) };
        let (mut area, mut weight, mut moment) = (DVec3::ZERO, 0.0, DVec3::ZERO);
        for pair in polygon[1..].windows(2) {
            let part = 0.5 * (pair[0] - first).cross(pair[1] - first);
            area += part;
            weight += part.length();
            moment += part.length() * (first + pair[0] + pair[1]) / 3.0;
        }
        (self.center + if weight > 0.0 { moment / weight } else { first }, area)
    }
}
