//! Tube of varying thickness along an open curve, closed at its ends.

use glam::DVec3;
use sscc::TriMesh;

use super::tube::{band, frame, unit_circle};

/// Steps per ring for the length of the tube.
const LENGTH_STEPS: usize = 16;

/// Thickness at the ends, relative to the maximum, below which one ring is sufficient.
const THIN_SHARE: f64 = 0.03;

/// Tessellation of a capped tube.
#[derive(Clone, Copy)]
pub(super) struct CappedTube {
    /// Number of rings between the two end points. Their distance is proportional to the thickness, so that triangles
    /// are similar. Every second ring is rotated by half a vertex.
    pub rings: usize,
    /// Number of vertices of each ring.
    pub around: usize,
}

impl CappedTube {
    /// Sweeps the tube along `curve` (parameter 0 to 1, and slightly beyond; smooth and nowhere vertical). `section` returns
    /// half the width (horizontal) and half the height (perpendicular to it) at a share of the curve's length, both 0 at
    /// its ends. The mesh is closed, has `2 rings around` triangles, is oriented outward and has genus 0.
    ///
    /// # Panics
    /// When the curve gives a position that is not finite.
    pub fn along(self, curve: impl Fn(f64) -> DVec3, section: impl Fn(f64) -> [f64; 2]) -> TriMesh {
        let circle = unit_circle(self.around);
        let mut vertices = Vec::with_capacity(self.rings * self.around + 2);
        for (ring, [t, share]) in self.places(&curve, &section).into_iter().enumerate() {
            let [side, up] = frame(&curve, t);
            let [width, height] = section(share);
            let centre = curve(t);
            for (c, s) in circle.iter().skip(ring % 2).step_by(2) {
                vertices.push(centre + side * (width * *c) + up * (height * *s));
            }
        }
        vertices.extend([curve(0.0), curve(1.0)]);
        #[expect(clippy::expect_used, reason = "shapes are constants of this crate")]
        TriMesh::new(vertices, self.faces()).expect("a tube along a finite curve is a valid mesh")
    }

    /// Returns bands between the rings, and a fan at each end.
    fn faces(self) -> Vec<[u32; 3]> {
        let around = self.around as u32;
        let ring = |i: usize| i as u32 * around;
        let (last, [start, end]) = (ring(self.rings - 1), [0, 1].map(|k| ring(self.rings) + k));
        let bands = (0..self.rings - 1).flat_map(|i| band(self.around, i, ring(i), ring(i + 1)));
        let next = |k: u32| (k + 1) % around;
        let start_fan = (0..around).map(|k| [next(k), k, start]);
        let end_fan = (0..around).map(|k| [last + k, last + next(k), end]);
        bands.chain(start_fan).chain(end_fan).collect()
    }

    /// Returns parameter and share of the curve's length for each ring. Rings are evenly spaced in the integral of 1
    /// over the thickness along the surface.
    fn places(self, curve: impl Fn(f64) -> DVec3, section: impl Fn(f64) -> [f64; 2]) -> Vec<[f64; 2]> {
        let steps = self.rings * LENGTH_STEPS;
        let parameter = |i: usize| i as f64 / steps as f64;
        let mut lengths = vec![0.0];
        for i in 0..steps {
            lengths.push(lengths[i] + curve(parameter(i)).distance(curve(parameter(i + 1))));
        }
        let length = lengths[steps];
        let radius = |share: f64| 0.5 * section(share).iter().sum::<f64>();
        let radii: Vec<f64> = lengths.iter().map(|l| radius(l / length)).collect();
        let thin = THIN_SHARE * radii.iter().copied().fold(0.0, f64::max);

        let mut rings = vec![0.0]; // the number of rings up to each step, times a constant
        for i in 0..steps {
            let (step, change) = (lengths[i + 1] - lengths[i], radii[i + 1] - radii[i]);
            let middle = 0.5 * (radii[i] + radii[i + 1]);
            // A thin end counts as one ring with the width of a triangle.
            let scale = if middle < thin { thin * self.around as f64 / 6.0 } else { middle };
            rings.push(rings[i] + (step * step + change * change).sqrt() / scale);
        }
        (1..=self.rings)
            .map(|ring| {
                let wanted = rings[steps] * ring as f64 / (self.rings + 1) as f64;
                let i = rings.partition_point(|w| *w <= wanted).clamp(1, steps) - 1;
                let part = (wanted - rings[i]) / (rings[i + 1] - rings[i]);
                [
                    (i as f64 + part) / steps as f64,
                    (lengths[i] + part * (lengths[i + 1] - lengths[i])) / length,
                ]
            })
            .collect()
    }
}
