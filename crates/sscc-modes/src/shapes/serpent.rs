//! Coiled serpent, in place of the paper's dragon (about 77,000 triangles).
//!
//! The body is a long tapering tube in narrowing coils that nearly touch, so a moderate deformation makes neighbouring
//! coils collide in many places.

use std::f64::consts::PI;

use glam::DVec3;
use sscc::TriMesh;

use super::capped_tube::CappedTube;

/// Number of rings along the body.
const RINGS: usize = 1206;

/// Number of vertices of each ring; with [`RINGS`] there are 77,184 triangles of aspect ratio about 1.
const AROUND: usize = 32;

/// Radius of the body at its thickest (metre).
const BODY_RADIUS: f64 = 0.06;

/// Distance of the centrelines of neighbouring coils, in body radii; at 2 they touch.
const COIL_DISTANCE: f64 = 2.3;

/// Inward part of this distance (the rest is upward), in body radii.
const COIL_INWARD: f64 = 1.35;

/// Radius of the centreline of the outermost coil (metre).
const OUTER_RADIUS: f64 = 0.55;

/// Number of turns of the coil.
const TURNS: f64 = 4.6;

/// Number of control points of the spline in each turn.
const CONTROLS_PER_TURN: f64 = 18.0;

/// Amplitude of the radial oscillation of the body (body radii).
const WINDING: f64 = 0.13;

/// Periods of this oscillation per turn: not a whole number, so that the gap of neighbouring coils varies.
const WINDINGS_PER_TURN: f64 = 3.5;

/// Control points of the raised neck and the head after the last coil (metre), relative to the end of the coil: forward,
/// left, upward.
const NECK: [[f64; 3]; 6] = [
    [0.10, 0.00, 0.03],
    [0.20, 0.01, 0.09],
    [0.29, -0.03, 0.16],
    [0.37, -0.10, 0.20],
    [0.45, -0.17, 0.20],
    [0.53, -0.23, 0.19],
];

/// Profile of the body: share of the length, half the width and half the height (body radii), with smooth steps between.
const PROFILE: [[f64; 3]; 7] = [
    [0.0, 0.10, 0.10],
    [0.14, 0.85, 0.85],
    [0.26, 1.0, 1.0],
    [0.86, 1.0, 1.0],
    [0.955, 0.62, 0.62],
    [0.978, 1.05, 0.70],
    [1.0, 0.50, 0.40],
];

/// Share of the length over which the tail is rounded.
const TAIL_END: f64 = 0.002;

/// Share of the length over which the snout is rounded.
const SNOUT_END: f64 = 0.006;

/// Returns the serpent: 77,184 triangles, 38,594 vertices, in metres. It is one closed component (a sphere), oriented
/// outward, without self-intersections. The coils wind about the z axis, upward and inward from the tail to the head. It
/// is about 1.1 wide and 0.75 high.
///
/// The gap between neighbouring coils is about 0.17 to 0.5 body radii, with 19 local minima below 0.3. Takes about ten
/// milliseconds.
pub fn serpent() -> TriMesh {
    let controls = controls();
    CappedTube { rings: RINGS, around: AROUND }.along(|t| spline(&controls, t), section)
}

/// Returns half the width and half the height of the body (metre) at a share of its length from the tail.
fn section(share: f64) -> [f64; 2] {
    let i = PROFILE.partition_point(|knot| knot[0] <= share).clamp(1, PROFILE.len() - 1);
    let ([from, w0, h0], [to, w1, h1]) = (PROFILE[i - 1], PROFILE[i]);
    let t = (share - from) / (to - from);
    let smooth = t * t * (3.0 - 2.0 * t);
    let round = round_end(share / TAIL_END) * round_end((1.0 - share) / SNOUT_END);
    [w0 + (w1 - w0) * smooth, h0 + (h1 - h0) * smooth].map(|size| BODY_RADIUS * size * round)
}

/// Returns a quarter of a circle, from 0 at 0 to 1 at 1, then 1.
fn round_end(x: f64) -> f64 {
    let rest = 1.0 - x.clamp(0.0, 1.0);
    (1.0 - rest * rest).sqrt()
}

/// Returns the control points of the centreline, from the tail to the snout.
fn controls() -> Vec<DVec3> {
    let upward = (COIL_DISTANCE * COIL_DISTANCE - COIL_INWARD * COIL_INWARD).sqrt();
    let coil = |i: f64| {
        let turns = i / CONTROLS_PER_TURN;
        let angle = 2.0 * PI * turns;
        let winding = WINDING * libm::sin(WINDINGS_PER_TURN * angle);
        let rho = OUTER_RADIUS + BODY_RADIUS * (winding - COIL_INWARD * turns);
        let z = BODY_RADIUS * (1.0 + upward * turns);
        DVec3::new(rho * libm::cos(angle), rho * libm::sin(angle), z)
    };
    let last = (TURNS * CONTROLS_PER_TURN).round();
    let mut points: Vec<DVec3> = (0..=last as usize).map(|i| coil(i as f64)).collect();
    let (end, along) = (coil(last), coil(last) - coil(last - 1.0));
    let along = DVec3::new(along.x, along.y, 0.0).normalize();
    let left = DVec3::Z.cross(along);
    points.extend(NECK.map(|[x, y, z]| end + along * x + left * y + DVec3::Z * z));
    points
}

/// Evaluates the uniform cubic B-spline of control points (two continuous derivatives), `t` from 0 to 1.
fn spline(controls: &[DVec3], t: f64) -> DVec3 {
    let pieces = controls.len() - 3;
    let at = t * pieces as f64;
    let piece = (at.max(0.0) as usize).min(pieces - 1);
    let x = at - piece as f64;
    let y = 1.0 - x;
    let weights = [y * y * y, 4.0 + 3.0 * x * x * (x - 2.0), 4.0 + 3.0 * y * y * (y - 2.0), x * x * x];
    (0..4).fold(DVec3::ZERO, |sum, k| sum + controls[piece + k] * (weights[k] / 6.0))
}
