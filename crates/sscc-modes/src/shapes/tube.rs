//! Round tube along a closed curve.

use std::f64::consts::PI;

use glam::DVec3;
use sscc::TriMesh;

/// Half the parameter step of the central difference for the direction of a curve. Its error (about 1e-7) only tilts the
/// rings; no proof depends on it.
const HALF_STEP: f64 = 1e-5;

/// Steps per ring for the arc length of the curve.
const LENGTH_STEPS: usize = 16;

/// Tessellation of a tube.
#[derive(Clone, Copy)]
pub(super) struct Tube {
    /// Radius on which the vertices lie.
    pub radius: f64,
    /// Number of rings along the curve, evenly spaced by arc length. It must be even: every second ring is rotated by half
    /// a vertex, so that triangles are nearly isosceles and the last ring matches the first.
    pub rings: usize,
    /// Number of vertices of each ring.
    pub around: usize,
}

impl Tube {
    /// Sweeps the tube along `curve` (parameter 0 to 1). The curve must be closed, smooth and nowhere vertical, because the
    /// z axis aligns the rings, which makes the seam match without twist. The mesh is closed, has `2 rings around`
    /// triangles, is oriented outward and has genus 1.
    ///
    /// # Panics
    /// When there are fewer than 4 rings or an odd number, fewer than 3 vertices in each, or the curve gives a position
    /// that is not finite.
    pub fn along(self, curve: impl Fn(f64) -> DVec3) -> TriMesh {
        assert!(self.rings >= 4 && self.rings.is_multiple_of(2) && self.around >= 3);
        let mut vertices = Vec::with_capacity(self.rings * self.around);
        let circle: Vec<(f64, f64)> =
            unit_circle(self.around).into_iter().map(|(c, s)| (self.radius * c, self.radius * s)).collect();
        for (ring, t) in even_parameters(&curve, self.rings).into_iter().enumerate() {
            let [side, up] = frame(&curve, t);
            let centre = curve(t);
            for (c, s) in circle.iter().skip(ring % 2).step_by(2) {
                vertices.push(centre + side * *c + up * *s);
            }
        }
        #[expect(clippy::expect_used, reason = "shapes are constants of this crate")]
        TriMesh::new(vertices, self.faces()).expect("a tube along a finite curve is a valid mesh")
    }

    /// Returns two triangles for each vertex: with the next vertex of its ring, and with the next ring.
    fn faces(self) -> Vec<[u32; 3]> {
        let ring = |ring: usize| (ring % self.rings * self.around) as u32;
        (0..self.rings).flat_map(|i| band(self.around, i, ring(i), ring(i + 1))).collect()
    }
}

/// Returns cosines and sines of `2 around` evenly spaced angles: even ones for even rings, odd ones for odd rings.
pub(super) fn unit_circle(around: usize) -> Vec<(f64, f64)> {
    let angles = (0..2 * around).map(|k| PI * k as f64 / around as f64);
    angles.map(|angle| (libm::cos(angle), libm::sin(angle))).collect()
}

/// Returns two unit directions perpendicular to the curve at t, the first one horizontal.
pub(super) fn frame(curve: impl Fn(f64) -> DVec3, t: f64) -> [DVec3; 2] {
    let forward = (curve(t + HALF_STEP) - curve(t - HALF_STEP)).normalize();
    let side = DVec3::Z.cross(forward).normalize();
    [side, forward.cross(side)]
}

/// Returns the triangles between a ring of `around` vertices that starts with vertex `a` and the next ring, which starts
/// with `b`. Rings of odd number are rotated by half a vertex.
pub(super) fn band(around: usize, number: usize, a: u32, b: u32) -> impl Iterator<Item = [u32; 3]> {
    (0..around).flat_map(move |k| {
        let (k, next) = (k as u32, ((k + 1) % around) as u32);
        if number.is_multiple_of(2) {
            [[a + k, a + next, b + k], [a + next, b + next, b + k]]
        } else {
            [[a + k, b + next, b + k], [a + k, a + next, b + next]]
        }
    })
}

/// Returns the parameters of `count` points of a closed curve, evenly spaced by arc length, the first at 0.
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
