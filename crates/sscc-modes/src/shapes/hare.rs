//! Crouching hare with long ears laid back, in place of the paper's bunny (Table 1: 14,964 triangles).
//!
//! The ears are two upright blades close to each other and to the back, so a moderate bend makes them collide.

use std::f64::consts::PI;

use glam::DVec3;
use sscc::TriMesh;

use super::implicit::{Implicit, Part, Primitive};
use super::marching::Lattice;
use super::remesh::{decimate, relax};

/// Number of triangles of the hare.
const FACES: usize = 14_964;

/// Distance of lattice points (metre). It gives 53,296 triangles before decimation.
const SPACING: f64 = 0.0095;

/// Radius of curvature (metre) below which triangles become smaller: about that of the feet and of the ears' edges.
const BEND_RADIUS: f64 = 0.015;

/// Ratio of height to thickness of the ears.
const EAR_FLATTENING: f64 = 1.65;

/// Width of the smooth seam between an ear and the rest (metre), less than the gaps.
const EAR_BLEND: f64 = 0.025;

/// Number of iterations of flips and smoothing.
const RELAX_ITERATIONS: usize = 6;

/// Returns the hare: 14,964 triangles, 7,484 vertices, in metres. It is one closed component (a sphere), oriented outward,
/// without self-intersections. It faces along x, z is up, and its feet are near z = 0. Its length is about 0.64.
///
/// Marching tetrahedra extract the surface of an implicit solid, which is then decimated and relaxed. Takes about half a
/// second.
///
/// The ears are at most 0.042 thick, 0.028 apart, and 0.025 above the back.
pub fn hare() -> TriMesh {
    let solid = solid();
    let lattice =
        Lattice { low: DVec3::new(-0.3371, -0.1713, -0.0167), spacing: SPACING, size: [72, 36, 40] };
    let mut surface = lattice.extract(&solid);
    decimate(&mut surface, &solid, FACES, BEND_RADIUS);
    relax(&mut surface, &solid, RELAX_ITERATIONS);
    #[expect(clippy::expect_used, reason = "the hare is a constant of this crate")]
    surface.into_mesh().expect("the hare is a valid mesh")
}

/// Returns the smooth union of the hare's parts.
fn solid() -> Implicit {
    Implicit::new([(body(), EAR_BLEND), (ear(1.0), EAR_BLEND), (ear(-1.0), EAR_BLEND)])
}

/// Returns all parts but the ears (metre).
fn body() -> Vec<Part> {
    let v = DVec3::new;
    let egg = |blend, centre, radii, forward| Part {
        primitive: Primitive::Ellipsoid { centre, radii, forward },
        blend,
    };
    let limb = |blend, ends, radii| Part {
        primitive: Primitive::Limb { ends, radii, thin: DVec3::Y, flat: 1.0 },
        blend,
    };
    let mut parts = vec![
        // Rump, chest, neck, head, muzzle, tail.
        egg(0.05, v(-0.13, 0.0, 0.150), v(0.145, 0.090, 0.110), v(1.0, 0.0, -0.15)),
        egg(0.08, v(0.06, 0.0, 0.135), v(0.125, 0.072, 0.090), v(1.0, 0.0, 0.1)),
        limb(0.06, [v(0.12, 0.0, 0.165), v(0.20, 0.0, 0.250)], [0.062, 0.048]),
        egg(0.04, v(0.235, 0.0, 0.272), v(0.072, 0.047, 0.052), v(1.0, 0.0, -0.35)),
        egg(0.03, v(0.288, 0.0, 0.248), v(0.036, 0.030, 0.030), v(1.0, 0.0, -0.35)),
        egg(0.02, v(-0.275, 0.0, 0.160), v(0.042, 0.028, 0.034), v(-1.0, 0.0, 0.9)),
    ];
    for side in [1.0, -1.0] {
        let w = |x: f64, y: f64, z: f64| DVec3::new(x, side * y, z);
        parts.extend([
            // Haunch and hind foot, foreleg and forepaw, cheek and eye.
            egg(0.015, w(-0.120, 0.085, 0.112), v(0.100, 0.042, 0.088), v(1.0, 0.0, 0.5)),
            limb(0.025, [w(-0.17, 0.100, 0.026), w(0.02, 0.106, 0.022)], [0.026, 0.022]),
            limb(0.04, [w(0.125, 0.045, 0.110), w(0.150, 0.048, 0.030)], [0.040, 0.021]),
            limb(0.02, [w(0.148, 0.048, 0.022), w(0.190, 0.050, 0.018)], [0.022, 0.017]),
            egg(0.02, w(0.262, 0.022, 0.245), v(0.030, 0.022, 0.024), v(1.0, 0.0, 0.0)),
            egg(0.008, w(0.252, 0.041, 0.285), v(0.013, 0.009, 0.012), v(1.0, 0.0, -0.3)),
        ]);
    }
    parts
}

/// Returns one ear (side 1: left, -1: right): a flat, bent chain of limbs from the top of the head over the shoulders
/// (metre).
fn ear(side: f64) -> Vec<Part> {
    const PIECES: usize = 8;
    let thin = DVec3::new(0.0, side, -0.12).normalize();
    let at = |t: f64| {
        let bow = libm::sin(PI * t);
        DVec3::new(0.208 - 0.350 * t, side * (0.027 + 0.009 * bow), 0.312 - 0.022 * bow - 0.004 * t)
    };
    // Half the height of the ear.
    let half_height = |t: f64| {
        let swell = libm::sin(PI * (0.05 + 0.90 * t));
        0.016 + 0.019 * swell * swell
    };
    let piece = |piece| {
        let [t0, t1] = [piece, piece + 1].map(|k| k as f64 / PIECES as f64);
        let (ends, radii) = ([at(t0), at(t1)], [half_height(t0), half_height(t1)]);
        Part { primitive: Primitive::Limb { ends, radii, thin, flat: EAR_FLATTENING }, blend: 0.002 }
    };
    (0..PIECES).map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the minimum distance of an ear from vertices of `others`, at least `x` metres behind the root of the ears,
    /// where they join the head.
    fn gap(others: Vec<Part>, x: f64) -> f64 {
        let (left, others) = (Implicit::new([(ear(1.0), EAR_BLEND)]), Implicit::new([(others, EAR_BLEND)]));
        let mesh = hare();
        let points = mesh.rest_positions().iter().filter(|p| p.x < 0.208 - x);
        let of_others = points.filter(|p| others.sample(**p).0.abs() < 1e-6);
        of_others.map(|p| left.sample(*p).0).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn ears_come_close_to_each_other_and_to_the_back() {
        let thickness = 2.0 * 0.035 / EAR_FLATTENING;
        let (between, above) = (gap(ear(-1.0), 0.1), gap(body(), 0.1));
        assert!((0.5..1.0).contains(&(between / thickness)), "{between} of {thickness}");
        assert!((0.5..1.0).contains(&(above / thickness)), "{above} of {thickness}");
    }
}
