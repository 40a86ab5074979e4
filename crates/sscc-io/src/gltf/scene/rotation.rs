//! Rotations as quaternions: normalization and interpolation.

use glam::DQuat;

/// Returns a quaternion divided by its length; None if the length is 0 or not finite.
pub(super) fn unit(q: DQuat) -> Option<DQuat> {
    let [x, y, z, w] = q.to_array();
    // Squares of large numbers overflow.
    let largest = [x, y, z, w].into_iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let scaled = DQuat::from_xyzw(x / largest, y / largest, z / largest, w / largest);
    let length = scaled.length();
    length.is_finite().then(|| scaled / length)
}

/// Returns the rotation of a quaternion x, y, z, w of any length; the identity for length 0.
pub(super) fn unit_or_identity(values: &[f64]) -> DQuat {
    unit(DQuat::from_slice(values)).unwrap_or(DQuat::IDENTITY)
}

/// Interpolates rotations on the shorter arc, at constant speed. Quaternions that are not of length 1 are blended as
/// stored, as players do; the result has length 1. `DQuat::slerp` of glam is linear for small angles, with errors up to
/// 1e-5.
pub(super) fn slerp(a: &[f64], b: &[f64], share: f64) -> DQuat {
    let (unit_a, mut unit_b) = (unit_or_identity(a), unit_or_identity(b));
    let mut of_b = 1.0;
    if unit_a.dot(unit_b) < 0.0 {
        (unit_b, of_b) = (-unit_b, -of_b);
    }
    // The angle follows from lengths: acos of the dot product has errors of 1e-8 for small angles. The functions of libm have
    // the same results on every machine, so the pairs that collide are the same, too.
    let angle = 2.0 * libm::atan2((unit_a - unit_b).length(), (unit_a + unit_b).length());
    let sine = libm::sin(angle);
    let (share_a, share_b) = if sine < 1e-12 {
        (1.0 - share, share)
    } else {
        (libm::sin((1.0 - share) * angle) / sine, libm::sin(share * angle) / sine)
    };
    let blended = DQuat::from_slice(a) * share_a + DQuat::from_slice(b) * (share_b * of_b);
    unit(blended).unwrap_or(unit_a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn rotations_take_the_shorter_arc_at_constant_speed() {
        let axis = DVec3::new(2.0, -1.0, 2.0) / 3.0;
        for angle in [1e-12, 1e-6, 0.01, 1.0, 3.0] {
            for sign in [1.0, -1.0] {
                let start = DQuat::from_axis_angle(DVec3::X, 0.4);
                let end = DQuat::from_axis_angle(axis, angle) * start * sign;
                for share in [0.0, 0.1, 0.5, 0.9, 1.0] {
                    let expected = DQuat::from_axis_angle(axis, share * angle) * start;
                    let found = slerp(&start.to_array(), &end.to_array(), share);
                    let error = (found - expected).length().min((found + expected).length());
                    assert!(error < 1e-15, "{angle} {sign} {share}: {error}");
                }
            }
        }
    }

    #[test]
    fn quaternions_of_any_length_are_normalized() {
        let expected = DQuat::from_xyzw(0.6, 0.0, 0.0, 0.8);
        for length in [1e-300, 0.5, 1.0, 1e200] {
            let q = DQuat::from_xyzw(0.6 * length, 0.0, 0.0, 0.8 * length);
            assert!((unit(q).unwrap() - expected).length() < 1e-15);
        }
        assert!(unit(DQuat::from_xyzw(0.0, -0.0, 0.0, 0.0)).is_none());
        assert!(unit(DQuat::from_xyzw(0.0, f64::INFINITY, 0.0, 0.0)).is_none());
    }
}
