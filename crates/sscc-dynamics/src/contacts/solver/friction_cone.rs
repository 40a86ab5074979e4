//! Coulomb's cone: the friction impulses that a contact can exert, and the directions along which an impulse moves its points.

use glam::{DMat3, DVec3};

/// Maximum change of the normal velocity by friction, as a share of the change by the normal impulse. The iterations of
/// Gauss-Seidel compute the two impulses alternately. Where friction changes the normal velocity by more than the normal
/// impulse does, the iterations alternate between no impulse and one that is too large. Where friction pulls the points
/// together by more, no sliding contact can hold them apart (Painlevé's paradox). Vertices of thin parts that bend in few
/// modes behave like this.
const MAX_COUPLING: f64 = 0.75;

/// Share of the whole mobility below which the mobility along a direction counts as 0. Where only modes move the points of a
/// contact, the mobility along a direction may be 0 up to rounding.
const MIN_MOBILITY: f64 = 1e-10;

/// Whether an impulse along some direction moves the points of a contact. `mobility` is the change of their velocity along it
/// by a unit impulse; below the bound it is the rounding error of 0, and impulses divided by it would have no bound.
pub(crate) fn is_mobile(mobility: f64, inverse_mass: &DMat3) -> bool {
    let whole = inverse_mass.x_axis.x + inverse_mass.y_axis.y + inverse_mass.z_axis.z;
    mobility > MIN_MOBILITY * whole
}

/// Returns the change of the friction impulse that stops points from sliding with a velocity; zero where no impulse along it
/// moves them. `inverse_mass` is the matrix from impulse to velocity.
pub(crate) fn stop_sliding(sliding: DVec3, inverse_mass: &DMat3) -> DVec3 {
    let Some(direction) = sliding.try_normalize() else { return DVec3::ZERO };
    let mobility = direction.dot(*inverse_mass * direction);
    if is_mobile(mobility, inverse_mass) { direction * (-sliding.length() / mobility) } else { DVec3::ZERO }
}

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
    fn sliding_stops_where_an_impulse_can_stop_it() {
        let inverse_mass = DMat3::from_diagonal(DVec3::new(2.0, 0.5, 0.0));
        let sliding = DVec3::new(0.0, 3.0, 0.0);
        assert_eq!(sliding + inverse_mass * stop_sliding(sliding, &inverse_mass), DVec3::ZERO);
        // One mode moves the points only along x, up to rounding.
        let one_mode = DMat3::from_diagonal(DVec3::new(2.0, 1e-17, -1e-17));
        for sliding in [DVec3::Y, DVec3::Z, DVec3::ZERO, DVec3::Y * 1e-17] {
            assert_eq!(stop_sliding(sliding, &one_mode), DVec3::ZERO);
            assert_eq!(stop_sliding(sliding, &DMat3::ZERO), DVec3::ZERO);
        }
    }

    #[test]
    fn mobilities_that_are_rounding_errors_count_as_zero() {
        let one_mode = DMat3::from_diagonal(DVec3::new(2.0, 1e-17, -1e-17));
        for (mobility, moves) in [(2.0, true), (1e-8, true), (1e-11, false), (1e-17, false), (-1e-17, false)]
        {
            assert_eq!(is_mobile(mobility, &one_mode), moves, "{mobility}");
        }
        assert!(!is_mobile(0.0, &DMat3::ZERO) && !is_mobile(f64::NAN, &DMat3::ZERO));
    }

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
