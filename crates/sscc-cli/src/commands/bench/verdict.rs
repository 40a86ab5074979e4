//! Which of two methods is right about a pair that only one of them lists.

use glam::DVec3;
use sscc::{Impact, MovingTriangle, ReducedModel, impact_triangle_triangle};
use sscc_exact::first_contact;

/// Whether a pair that some methods list for a motion and others do not proves one of them wrong: if the two triangles truly
/// meet on the way (exact arithmetic on the positions at both ends), or if they are further apart than
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

/// Whether nothing proves the two further apart than twice the tolerance at a time: as far as doubles tell.
fn are_close(x: &MovingTriangle, y: &MovingTriangle, time: f64) -> bool {
    // Seen from a corner, what is small against the distance from the origin is not lost.
    let (origin_t0, origin_t1) = (x.t0[0], x.t1[0]);
    let still = |m: &MovingTriangle| {
        let at = |i: usize| -> DVec3 {
            let (a, b) = (m.t0[i] - origin_t0, m.t1[i] - origin_t1);
            a + (b - a) * time
        };
        let here = [0, 1, 2].map(at);
        MovingTriangle { t0: here, t1: here }
    };
    impact_triangle_triangle(&still(x), &still(y), 2.0 * Impact::TOLERANCE).is_some()
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
        let modes = Modes::from_matrix(18, 1, |row, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 });
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
}
