//! Which of two methods is right about a pair that only one of them lists.

use glam::DVec3;
use sscc::{Impact, MovingTriangle, ReducedModel};
use sscc_exact::first_contact;

/// Whether a pair that some methods list for a motion and others do not proves one of them wrong: if the two triangles
/// truly meet on the way (exact arithmetic on the positions at both ends), or if they are further apart than
/// [`Impact::TOLERANCE`] at the time for which they are listed. Else it may be listed or not.
pub fn is_wrong(model: &ReducedModel, q_t0: &[f64], q_t1: &[f64], impact: &Impact) -> bool {
    let faces = model.mesh().faces();
    let moving = |t: u32| {
        let at = |q: &[f64]| faces[t as usize].map(|v| model.position(v, q));
        MovingTriangle { t0: at(q_t0), t1: at(q_t1) }
    };
    let (x, y) = (moving(impact.pair.0), moving(impact.pair.1));
    first_contact(&x, &y).is_some() || !are_close(&x, &y, impact.time)
}

/// Whether the two are within twice the tolerance at a time, as far as doubles tell.
fn are_close(x: &MovingTriangle, y: &MovingTriangle, time: f64) -> bool {
    // Seen from a corner, what is small against the distance from the origin is not lost.
    let origin = [x.t0[0], x.t1[0]];
    let ends = |m: &MovingTriangle| [m.t0.map(|p| p - origin[0]), m.t1.map(|p| p - origin[1])];
    let (x, y) = (ends(x), ends(y));
    let size = [x, y].as_flattened().as_flattened().iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    let at = |[t0, t1]: [[DVec3; 3]; 2]| [0, 1, 2].map(|i: usize| t0[i] + (t1[i] - t0[i]) * time);
    distance(&at(x), &at(y)) <= 2.0 * Impact::TOLERANCE * size
}

/// The distance of two triangles that do not meet.
fn distance(x: &[DVec3; 3], y: &[DVec3; 3]) -> f64 {
    let edges = |[a, b, c]: [DVec3; 3]| [[a, b], [b, c], [c, a]];
    let between_edges = edges(*x).into_iter().flat_map(|a| edges(*y).map(|b| segment_segment(a, b)));
    let to_faces = x.iter().map(|p| vertex_face(*p, y)).chain(y.iter().map(|p| vertex_face(*p, x)));
    between_edges.chain(to_faces).fold(f64::INFINITY, f64::min)
}

/// The distance of a point from a triangle above or below which it is; infinite elsewhere, where an edge is nearest.
fn vertex_face(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = |a: DVec3, b: DVec3| (b - a).cross(p - a).dot(normal) >= 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) && normal != DVec3::ZERO {
        (p - a).dot(normal.normalize()).abs()
    } else {
        f64::INFINITY
    }
}

/// The distance of two segments (Ericson 2005, *Real-Time Collision Detection*, 5.1.9).
fn segment_segment([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> f64 {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, vv, uv, uw, vw) = (u.dot(u), v.dot(v), u.dot(v), u.dot(w), v.dot(w));
    let clamped = |over: f64, under: f64| if under > 0.0 { (over / under).clamp(0.0, 1.0) } else { 0.0 };
    let s = clamped(uv * vw - uw * vv, uu * vv - uv * uv);
    let t = clamped(uv * s + vw, vv);
    let s = clamped(uv * t - uw, uu);
    (a + u * s).distance(c + v * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sscc::{Modes, TriMesh};

    /// A triangle at rest, and one above it at this height which mode 0 lowers.
    fn model(height: f64) -> ReducedModel {
        let lower = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let upper = lower.map(|p| p + DVec3::Z * height);
        let mesh = TriMesh::new([lower, upper].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let modes = Modes::from_matrix(6, 1, |row, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 });
        ReducedModel::new(mesh, modes.unwrap()).unwrap()
    }

    #[test]
    fn only_what_nearly_meets_may_be_listed_or_not() {
        let model = model(1.0);
        let listed = |q: f64, time: f64| is_wrong(&model, &[0.0], &[q], &Impact { pair: (0, 1), time });
        assert!(listed(1.0, 1.0), "they touch at the end");
        assert!(listed(2.0, 0.5), "they pass");
        assert!(listed(1.0 - 1e-9, 1.0), "they stay apart");
        assert!(listed(1.0 - 1e-13, 0.5), "they are close, but not then");
        assert!(!listed(1.0 - 1e-13, 1.0), "within the tolerance");
    }

    #[test]
    fn distances_are_known() {
        let x = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let moved = |by: DVec3| x.map(|p| p + by);
        assert_eq!(distance(&x, &moved(DVec3::Z * 0.5)), 0.5); // a vertex and a face, two edges
        assert_eq!(distance(&x, &moved(DVec3::X * 3.0)), 2.0); // two vertices
        let needle = [DVec3::new(0.25, 0.25, 0.125), DVec3::new(0.25, 0.25, 1.0), DVec3::new(0.25, 0.5, 2.0)];
        assert_eq!([distance(&x, &needle), distance(&needle, &x)], [0.125; 2]); // a vertex and a face only
        let across = [DVec3::new(0.5, -1.0, 0.25), DVec3::new(0.5, 1.0, 0.25), DVec3::new(0.5, 0.0, 4.0)];
        assert_eq!(distance(&[DVec3::ZERO, DVec3::X, DVec3::X], &across), 0.25); // two edges only
    }
}
