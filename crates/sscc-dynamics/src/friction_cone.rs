//! Coulomb's cone: the friction impulses that a contact can give.

use glam::{DMat3, DVec3};

/// Maximum change of the normal velocity by friction, as a share of that by the normal impulse. The iterations of
/// Gauss-Seidel find the two impulses in turn. Where friction changes the normal velocity by more than the normal impulse
/// does, they alternate between no impulse and one that is too large; and where it pulls the points together by more, no
/// sliding contact holds them apart at all (Painlevé's paradox). Vertices of thin parts that bend in few modes do this.
const MAX_COUPLING: f64 = 0.75;

/// Returns the friction impulse, shortened into the cone of this normal impulse. `inverse_mass` is the matrix from impulse
/// to velocity.
pub(crate) fn limit_friction(
    friction_impulse: DVec3,
    friction: f64,
    normal: DVec3,
    normal_impulse: f64,
    inverse_mass: &DMat3,
) -> DVec3 {
    // Rounding may have made the sum of impulses negative.
    let normal_impulse = normal_impulse.max(0.0);
    let friction_impulse = friction_impulse.clamp_length_max(friction * normal_impulse);
    let change = normal.dot(*inverse_mass * friction_impulse).abs();
    let max_change = MAX_COUPLING * normal_impulse * normal.dot(*inverse_mass * normal);
    if change > max_change { friction_impulse * (max_change / change) } else { friction_impulse }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_stays_in_the_cone_and_changes_the_normal_velocity_little() {
        let normal = DVec3::Z;
        let free = limit_friction(DVec3::X * 3.0, 0.5, normal, 2.0, &DMat3::IDENTITY);
        assert_eq!(free, DVec3::X);
        let coupled = DMat3::from_cols(
            DVec3::new(100.0, 0.0, 8.0),
            DVec3::new(0.0, 100.0, 0.0),
            DVec3::new(8.0, 0.0, 1.0),
        );
        for sign in [-1.0, 1.0] {
            let limited = limit_friction(DVec3::X * (3.0 * sign), 0.5, normal, 2.0, &coupled);
            let change = normal.dot(coupled * limited);
            assert!((change - 2.0 * MAX_COUPLING * sign).abs() < 1e-12, "{change}");
        }
        assert_eq!(limit_friction(DVec3::X, 0.5, normal, 0.0, &coupled), DVec3::ZERO);
        assert_eq!(limit_friction(DVec3::X, 0.5, normal, -1e-20, &coupled), DVec3::ZERO);
    }
}
