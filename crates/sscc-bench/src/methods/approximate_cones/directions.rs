//! The 14 directions of the normal cones, and the signs of a triangle's normal along them.

use glam::DVec3;

/// Rounding bound of a normal's component along a direction, as a share of the sum of the magnitudes of its products.
/// Each difference, product and sum is rounded once.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Centres of the faces, and corners, of a cube (Volino and Magnenat-Thalmann 1994).
const DIRECTIONS: [DVec3; 14] = [
    DVec3::X,
    DVec3::NEG_X,
    DVec3::Y,
    DVec3::NEG_Y,
    DVec3::Z,
    DVec3::NEG_Z,
    DVec3::new(1.0, 1.0, 1.0),
    DVec3::new(1.0, 1.0, -1.0),
    DVec3::new(1.0, -1.0, 1.0),
    DVec3::new(1.0, -1.0, -1.0),
    DVec3::new(-1.0, 1.0, 1.0),
    DVec3::new(-1.0, 1.0, -1.0),
    DVec3::new(-1.0, -1.0, 1.0),
    DVec3::new(-1.0, -1.0, -1.0),
];

/// Returns the directions, one bit each, with which the normal of a triangle certainly has a positive product.
#[inline]
pub fn positive_sides([a, b, c]: [DVec3; 3]) -> u16 {
    let (e, f) = (b - a, c - a);
    let normal = e.cross(f);
    let (x, y) = (e.abs(), f.abs());
    let size = DVec3::new(x.y * y.z + x.z * y.y, x.z * y.x + x.x * y.z, x.x * y.y + x.y * y.x);
    let bits = DIRECTIONS.iter().enumerate().map(|(k, direction)| {
        // Up to six products may underflow.
        let error = ROUNDING * size.dot(direction.abs()) + f64::MIN_POSITIVE;
        u16::from(normal.dot(*direction) > error) << k
    });
    bits.fold(0, |all, bit| all | bit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_of_normals_are_certain() {
        let up = positive_sides([DVec3::ZERO, DVec3::X, DVec3::Y]);
        for (k, direction) in DIRECTIONS.iter().enumerate() {
            assert_eq!(up >> k & 1 == 1, direction.z > 0.0);
        }
        assert_eq!(positive_sides([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]), 0);
        assert_eq!(positive_sides([DVec3::splat(1.0 / 3.0); 3]), 0);
        assert_eq!(positive_sides([DVec3::ZERO, DVec3::X * 1e-200, DVec3::Y * 1e-200]), 0);
    }
}
