//! Decides whether a pair that only some methods list for a motion is a mismatch.

use glam::DVec3;
use sscc::{Impact, MovingTriangle, ReducedModel};
use sscc_testing::{distance, first_contact};

/// Returns whether a pair that some methods list for a motion and others do not proves one of them wrong. It does if
/// the two triangles have a common point during the motion (exact arithmetic on the positions at both ends), or if
/// their distance exceeds [`Impact::TOLERANCE`] at the listed time. Every other pair may be listed or not.
pub fn is_mismatch(model: &ReducedModel, q_t0: &[f64], q_t1: &[f64], impact: &Impact) -> bool {
    let faces = model.mesh().faces();
    let moving = |t: u32| {
        let at = |q: &[f64]| faces[t as usize].map(|v| model.position(v, q));
        MovingTriangle { t0: at(q_t0), t1: at(q_t1) }
    };
    let (x, y) = (moving(impact.pair.0), moving(impact.pair.1));
    first_contact(&x, &y).is_some() || !are_close(&x, &y, impact.time)
}

/// Returns whether the distance is within twice the tolerance at a time.
fn are_close(x: &MovingTriangle, y: &MovingTriangle, time: f64) -> bool {
    // The tolerance is relative to the extent of both triangles, not to their distance from the origin.
    let extent = |ends: [[DVec3; 3]; 2], origin: DVec3| {
        ends.as_flattened().iter().fold(0.0_f64, |m, p| m.max((*p - origin).abs().max_element()))
    };
    let size = extent([x.t0, y.t0], x.t0[0]).max(extent([x.t1, y.t1], x.t1[0]));
    distance(x, y, time) <= 2.0 * Impact::TOLERANCE * size
}

#[cfg(test)]
mod tests {
    use super::*;
    use sscc::{Modes, TriMesh};

    /// Returns a triangle at rest, and one above it at this height, which mode 0 lowers.
    fn model(height: f64) -> ReducedModel {
        let lower = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let upper = lower.map(|p| p + DVec3::Z * height);
        let mesh = TriMesh::new([lower, upper].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let modes = Modes::from_matrix(6, 1, |row, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 });
        ReducedModel::new(mesh, modes.unwrap()).unwrap()
    }

    #[test]
    fn pairs_within_the_tolerance_are_not_mismatches() {
        let model = model(1.0);
        let listed = |q: f64, time: f64| is_mismatch(&model, &[0.0], &[q], &Impact { pair: (0, 1), time });
        assert!(listed(1.0, 1.0), "contact at the end");
        assert!(listed(2.0, 0.5), "intersection during the motion");
        assert!(listed(1.0 - 1e-9, 1.0), "no contact");
        assert!(listed(1.0 - 1e-13, 0.5), "within the tolerance at another time");
        assert!(!listed(1.0 - 1e-13, 1.0), "within the tolerance");
    }
}
