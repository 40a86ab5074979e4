//! The part of two triangles in the volume that two closed bodies share.
//!
//! A line along z meets a body between its surfaces, so the body is a signed sum of prisms: one below each triangle,
//! with the sign of the triangle's direction. The integral of the product of two such sums is the volume that both
//! bodies share: the sum over pairs of triangles of `sign_a sign_b` times the integral of `min(z_a, z_b)` over the
//! common part of their projections. The parts of prisms below z = 0 cancel, because the bodies are closed. Each term
//! depends continuously on the corners, so no case needs special care: a rounding error changes the sum by about as
//! much.

use glam::{DVec2, DVec3};

/// Bound of the rounding errors of one pair, in units of the products that [`error`] names. Clips have at most 8 errors each,
/// heights 16, and integrals 8.
const ERROR: f64 = 128.0 * f64::EPSILON;

/// A term of the volume.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OverlapIntegral {
    pub value: f64,
    /// Bound of the rounding error of `value`.
    pub error: f64,
}

/// Returns the term of a pair of triangles.
pub(crate) fn overlap_integral(a: &[DVec3; 3], b: &[DVec3; 3]) -> OverlapIntegral {
    let reach = a.iter().chain(b).map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let (plane_a, plane_b) = (Plane::new(a, reach), Plane::new(b, reach));
    let mut polygon = Polygon::of(b);
    if plane_b.area < 0.0 {
        polygon.points[..3].reverse();
    }
    let turn = plane_a.area.signum();
    let corners = a.map(DVec3::truncate);
    for k in 0..3 {
        let (from, edge) = (corners[k], corners[(k + 1) % 3] - corners[k]);
        polygon = polygon.clip(|p| turn * edge.perp_dot(p - from));
    }
    let area = polygon.integral(|_| 1.0);
    let error = error([&plane_a, &plane_b], reach, area.abs());
    if plane_a.area == 0.0 || plane_b.area == 0.0 {
        return OverlapIntegral { value: 0.0, error };
    }
    let (height_a, height_b) = (|p| plane_a.height(p), |p| plane_b.height(p));
    let is_below = |p: DVec2| height_b(p) - height_a(p);
    // `min(z_a, z_b) = z_a + min(z_b - z_a, 0)`. For triangles in one plane the difference is a rounding error of any sign, so the clip
    // may be any part of the polygon; but the integral of that rounding error is within the bound.
    let under = polygon.clip(|p| -is_below(p)).integral(is_below);
    let integral = with_mutant!(
        polygon.integral(height_a) + under,
        OnePlaneCutInTwo,
        polygon.clip(is_below).integral(height_a) + polygon.clip(|p| -is_below(p)).integral(height_b)
    );
    OverlapIntegral { value: turn * plane_b.area.signum() * integral, error }
}

/// Bounds the rounding error of a term whose projections have an area in common. A clip moves the border of the polygon by a few
/// rounding errors of its coordinates. The height of a plane may be off by the same share as its projected area.
fn error(planes: [&Plane; 2], reach: f64, area: f64) -> f64 {
    let width = planes.iter().map(|plane| plane.width).fold(f64::INFINITY, f64::min);
    let height = planes.iter().map(|plane| plane.z.0.abs().max(plane.z.1.abs())).fold(0.0, f64::max);
    let steep = |plane: &Plane| {
        let share = if plane.area == 0.0 { 1.0 } else { (area / plane.area.abs()).min(1.0) };
        share * (plane.z.1 - plane.z.0) * reach * plane.width
    };
    // A slope beyond the range of numbers is replaced by 0.
    let vague = |plane: &Plane| if plane.is_vague { area * (plane.z.1 - plane.z.0) } else { 0.0 };
    let clips = with_mutant!(reach * width * height, VolumeWithoutClipError, 0.0);
    let heights = with_mutant!(steep(planes[0]) + steep(planes[1]), VolumeWithoutSteepError, 0.0);
    vague(planes[0]) + vague(planes[1]) + ERROR * (clips + heights)
}

/// The plane of a triangle, as heights over its projection.
struct Plane {
    /// Area of the projection, with the sign of its direction.
    area: f64,
    from: DVec3,
    slope: DVec2,
    /// Whether heights by the slope were beyond the range of numbers; then the slope is replaced by 0.
    is_vague: bool,
    /// The heights of the lowest and of the highest corner.
    z: (f64, f64),
    /// Diameter of the projection.
    width: f64,
}

impl Plane {
    /// Creates the plane; `reach`: the largest magnitude of a coordinate of points at which its height is wanted.
    fn new(corners: &[DVec3; 3], reach: f64) -> Self {
        let [p, q, r] = *corners;
        let normal = (q - p).cross(r - p);
        let z = (p.z.min(q.z).min(r.z), p.z.max(q.z).max(r.z));
        let flat = corners.map(DVec3::truncate);
        let width = (0..3).map(|k| flat[k].distance(flat[(k + 1) % 3])).fold(0.0, f64::max);
        let slope = -normal.truncate() / normal.z;
        // Products with differences of points must not overflow, since the sum of two may be NaN.
        let largest = slope.abs().max_element() * (8.0 * reach);
        let is_vague = with_mutant!(
            !(slope.is_finite() && largest.is_finite()),
            SlopeBeyondRangeKept,
            false,
            SlopeOfInfiniteHeightsKept,
            !slope.is_finite()
        );
        let slope = if is_vague { DVec2::ZERO } else { slope };
        Self { area: 0.5 * normal.z, from: p, slope, is_vague, z, width }
    }

    /// Returns the height at a point of the projection. It is between the corners, whatever the slope.
    fn height(&self, p: DVec2) -> f64 {
        (self.from.z + self.slope.dot(p - self.from.truncate())).clamp(self.z.0, self.z.1)
    }
}

/// A convex polygon: a triangle that is clipped four times.
#[derive(Clone, Copy)]
struct Polygon {
    points: [DVec2; 8],
    len: usize,
}

impl Polygon {
    fn of(corners: &[DVec3; 3]) -> Self {
        let mut points = [DVec2::ZERO; 8];
        points[..3].copy_from_slice(&corners.map(DVec3::truncate));
        Self { points, len: 3 }
    }

    /// Returns the part on which a function is not negative.
    fn clip(&self, side: impl Fn(DVec2) -> f64) -> Self {
        let mut clipped = Self { points: [DVec2::ZERO; 8], len: 0 };
        let mut push = |p: DVec2| {
            // A clip adds at most one corner; there is room for one more, which rounding may add.
            if let Some(place) = clipped.points.get_mut(clipped.len) {
                *place = p;
                clipped.len += 1;
            }
        };
        let all = &self.points[..self.len];
        for (k, &p) in all.iter().enumerate() {
            let q = all[(k + 1) % all.len()];
            let (at_p, at_q) = (side(p), side(q));
            if at_p >= 0.0 {
                push(p);
            }
            if at_p < 0.0 && at_q > 0.0 || at_p > 0.0 && at_q < 0.0 {
                push(p + (q - p) * (at_p / (at_p - at_q)));
            }
        }
        clipped
    }

    /// Returns the integral of a linear function.
    fn integral(&self, value: impl Fn(DVec2) -> f64) -> f64 {
        let mut sum = 0.0;
        for k in 2..self.len {
            let [p, q, r] = [self.points[0], self.points[k - 1], self.points[k]];
            sum += 0.5 * (q - p).perp_dot(r - p) * (value(p) + value(q) + value(r)) / 3.0;
        }
        sum
    }
}

#[cfg(test)]
mod tests;
