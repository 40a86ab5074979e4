//! A round tube along a closed curve.

use std::f64::consts::PI;

use glam::DVec3;
use sscc::TriMesh;

/// Half the parameter step of the central difference that gives the direction of a curve. Its error
/// (about 1e-7) only tilts the rings; no proof depends on it.
const HALF_STEP: f64 = 1e-5;

/// Steps for each ring when the arc length of the curve is added up.
const LENGTH_STEPS: usize = 16;

/// How a tube is cut into triangles.
#[derive(Clone, Copy)]
pub(super) struct Tube {
    /// Radius on which the vertices lie.
    pub radius: f64,
    /// Number of rings along the curve, evenly spaced by arc length. Must be even: every second ring is
    /// turned by half a vertex, so that triangles are nearly isosceles and the last ring meets the first.
    pub rings: usize,
    /// Vertices of each ring.
    pub around: usize,
}

impl Tube {
    /// Sweeps the tube along `curve` (parameter 0 to 1; the curve must be closed, smooth and nowhere
    /// vertical, since rings are aligned by the z axis: so the seam matches without twist). Closed,
    /// `2 rings around` triangles, oriented outward, genus 1.
    ///
    /// # Panics
    /// When the curve gives a position that is not finite.
    pub fn along(self, curve: impl Fn(f64) -> DVec3) -> TriMesh {
        assert!(self.rings >= 4 && self.rings.is_multiple_of(2) && self.around >= 3);
        let mut vertices = Vec::with_capacity(self.rings * self.around);
        let circle: Vec<(f64, f64)> = (0..2 * self.around)
            .map(|k| PI * k as f64 / self.around as f64)
            .map(|angle| (self.radius * libm::cos(angle), self.radius * libm::sin(angle)))
            .collect();
        for (ring, t) in even_parameters(&curve, self.rings).into_iter().enumerate() {
            let forward = (curve(t + HALF_STEP) - curve(t - HALF_STEP)).normalize();
            let side = DVec3::Z.cross(forward).normalize();
            let up = forward.cross(side);
            let centre = curve(t);
            for (c, s) in circle.iter().skip(ring % 2).step_by(2) {
                vertices.push(centre + side * *c + up * *s);
            }
        }
        TriMesh::new(vertices, self.faces()).expect("a tube along a finite curve is a valid mesh")
    }

    /// Two triangles for each vertex: with the next vertex of its ring, and with the next ring.
    fn faces(self) -> Vec<[u32; 3]> {
        let index = |ring: usize, k: usize| ((ring % self.rings) * self.around + k % self.around) as u32;
        let mut faces = Vec::with_capacity(2 * self.rings * self.around);
        for ring in 0..self.rings {
            for k in 0..self.around {
                let [a, a_next] = [index(ring, k), index(ring, k + 1)];
                let [b, b_next] = [index(ring + 1, k), index(ring + 1, k + 1)];
                if ring % 2 == 0 {
                    faces.extend([[a, a_next, b], [a_next, b_next, b]]);
                } else {
                    faces.extend([[a, b_next, b], [a, a_next, b_next]]);
                }
            }
        }
        faces
    }
}

/// Parameters of `count` points of a closed curve, evenly spaced by arc length, the first at 0.
fn even_parameters(curve: impl Fn(f64) -> DVec3, count: usize) -> Vec<f64> {
    let steps = count * LENGTH_STEPS;
    let mut lengths = vec![0.0]; // from parameter 0 to parameter i / steps
    let mut length = 0.0;
    let mut last = curve(0.0);
    for i in 1..=steps {
        let next = curve(i as f64 / steps as f64);
        length += (next - last).length();
        lengths.push(length);
        last = next;
    }
    (0..count)
        .map(|ring| {
            let wanted = length * ring as f64 / count as f64;
            let i = lengths.partition_point(|l| *l <= wanted) - 1;
            (i as f64 + (wanted - lengths[i]) / (lengths[i + 1] - lengths[i])) / steps as f64
        })
        .collect()
}
