//! Double-helix spring, in place of the paper's (Table 1: 16,000 triangles; Figure 13).
//!
//! The spring is one closed tube. It goes up as one helix and down as a second one, half a turn behind, so the strands
//! alternate along the axis. At each end the two strands bend inward and join in an S across the axis. In cylindrical
//! coordinates the centreline is `(rho, phi, h phi)`, where phi is a triangle wave with rounded peaks and rho a square
//! wave with smooth steps at those peaks.

use std::f64::consts::PI;

use glam::DVec3;
use sscc::TriMesh;

use super::tube::Tube;

/// Radius of the tube (metre).
const TUBE_RADIUS: f64 = 0.03;

/// Radius of the helices: distance of the tube's centreline from the axis (metre).
const COIL_RADIUS: f64 = 0.18;

/// Rise of a strand in one turn (metre). The other strand is half way between, so neighbouring coils are 0.091 apart along
/// the axis and 0.0898 perpendicular to the strands. The gap is 0.0298, about one tube radius.
const PITCH: f64 = 0.182;

/// Number of turns of each strand, joins included.
const TURNS: f64 = 5.0;

/// Angle (radian) over which a strand bends from the coil to the axis. The radius of curvature of the S is more than two
/// tube radii everywhere.
const JOIN_ANGLE: f64 = 0.6 * PI;

/// Number of rings along the tube.
const RINGS: usize = 500;

/// Number of vertices of each ring; with [`RINGS`] there are 16,000 triangles of aspect ratio about 2.
const AROUND: usize = 16;

/// Returns the spring: 16,000 triangles, 8,000 vertices, in metres. It is one closed component (a torus), oriented
/// outward, without self-intersections. Its axis is along z and its centre at the origin.
///
/// The spring is about 0.42 wide and 0.93 high. Neighbouring coils are about one tube radius (0.03) apart, so a moderate
/// deformation makes them collide. Takes about a millisecond.
pub fn spring() -> TriMesh {
    spring_of(RINGS, AROUND)
}

/// Returns the same shape with `2 rings around` triangles; the [`spring`] has 500 rings of 16 vertices.
///
/// # Panics
/// When there are fewer than 4 rings or an odd number, or fewer than 3 vertices in each.
pub fn spring_of(rings: usize, around: usize) -> TriMesh {
    Tube { radius: TUBE_RADIUS, rings, around }.along(centreline)
}

/// Returns the centreline: `t` from 0 (bottom, on the axis) up to 1/2 (top, on the axis) and down to 1.
fn centreline(t: f64) -> DVec3 {
    let half = PI * TURNS; // phi goes from -half to half and back
    let from_top = 4.0 * half * (t - 0.5); // negative on the way up
    let (sign, down) = (if from_top < 0.0 { 1.0 } else { -1.0 }, from_top.abs());
    // Both ends are congruent, so the nearer one is the reference. Beyond the bottom, the other strand begins.
    let from_bottom = 2.0 * half - down;
    let from_end = down.min(from_bottom);
    let phi_from_end = half - rounded(from_end);
    let phi = if down < from_bottom { phi_from_end } else { -phi_from_end };
    let rho = sign * COIL_RADIUS * step(from_end);
    DVec3::new(rho * libm::cos(phi), rho * libm::sin(phi), PITCH / (2.0 * PI) * phi)
}

/// Returns `|x|`, rounded within the join angle (two continuous derivatives).
fn rounded(x: f64) -> f64 {
    let s = x / JOIN_ANGLE;
    if s.abs() >= 1.0 { x.abs() } else { JOIN_ANGLE * (3.0 + s * s * (6.0 - s * s)) / 8.0 }
}

/// Returns the sign of x, as a smooth odd step within the join angle (two continuous derivatives).
fn step(x: f64) -> f64 {
    let s = (x / JOIN_ANGLE).clamp(-1.0, 1.0);
    s * (15.0 + s * s * (3.0 * s * s - 10.0)) / 8.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: usize = 4000;

    fn samples() -> Vec<DVec3> {
        (0..SAMPLES).map(|i| centreline(i as f64 / SAMPLES as f64)).collect()
    }

    #[test]
    fn the_radius_of_curvature_exceeds_two_tube_radii() {
        let p = samples();
        for i in 0..SAMPLES {
            let [a, b, c] = [0, 1, 2].map(|k| p[(i + k) % SAMPLES]);
            // The radius of the circle through three points is (product of the sides) / (4 area).
            let radius = (b - a).length() * (c - b).length() * (c - a).length()
                / (2.0 * (b - a).cross(c - a).length()).max(1e-300);
            assert!(radius > 2.0 * TUBE_RADIUS, "sample {i}: {}", radius / TUBE_RADIUS);
        }
    }

    #[test]
    fn coils_are_one_tube_radius_apart() {
        let p = samples();
        // Points within half a turn along the strand belong to the same coil.
        let same_coil = SAMPLES / (4.0 * TURNS) as usize;
        for (i, a) in p.iter().enumerate() {
            let distance = (same_coil..=SAMPLES - same_coil)
                .map(|k| (*a - p[(i + k) % SAMPLES]).length())
                .fold(f64::INFINITY, f64::min);
            let gap = (distance - 2.0 * TUBE_RADIUS) / TUBE_RADIUS;
            assert!(gap > 0.98, "sample {i}: {gap}");
            let in_a_join = i % (SAMPLES / 2) < same_coil || i % (SAMPLES / 2) > SAMPLES / 2 - same_coil;
            assert!(in_a_join || gap < 1.02, "sample {i}: {gap}");
        }
    }

    #[test]
    fn both_ends_and_both_strands_are_congruent() {
        for i in 0..100 {
            let t = i as f64 / 200.0;
            let a = centreline(t);
            // A rotation by half a turn about the axis maps one strand to the other.
            let b = centreline(1.0 - t);
            assert!((a - DVec3::new(-b.x, -b.y, b.z)).length() < 1e-13, "{t}");
            // A rotation by half a turn about x maps one end to the other.
            let c = centreline(0.5 - t);
            assert!((a - DVec3::new(c.x, -c.y, -c.z)).length() < 1e-13, "{t}");
        }
    }
}
