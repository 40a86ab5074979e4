//! Smooth solids as the regions where a function is negative.

use glam::DVec3;

/// Maximum number of Newton steps of a projection. A start within a lattice cell of the surface needs about four steps.
const MAX_NEWTON_STEPS: usize = 8;

/// Tolerance of a projection (model unit).
const PROJECTION_TOLERANCE: f64 = 1e-12;

/// Function and gradient of the empty union.
const EMPTY: (f64, DVec3) = (f64::INFINITY, DVec3::ZERO);

/// Simple solid. Its function approximates the distance (negative inside) well enough for blending, and is 0 exactly on
/// its surface.
pub(super) enum Primitive {
    /// Ellipsoid. `forward` is the direction of its first axis; the second is horizontal, the third upward.
    Ellipsoid { centre: DVec3, radii: DVec3, forward: DVec3 },
    /// Segment whose thickness changes linearly from the first radius to the second. Perpendicular to the segment, it is
    /// `flat` times thinner in the unit direction `thin` (1: round).
    Limb { ends: [DVec3; 2], radii: [f64; 2], thin: DVec3, flat: f64 },
}

/// Solid with the width of its blend with the parts before it in its group.
pub(super) struct Part {
    /// Solid to add.
    pub primitive: Primitive,
    /// Width of the smooth seam (model unit, not 0). Wider gaps are unchanged.
    pub blend: f64,
}

/// Smooth union of groups, each a smooth union of parts, all in their order.
pub(super) struct Implicit {
    groups: Vec<Group>,
}

struct Group {
    parts: Vec<Part>,
    /// Centre and radius of a ball around each part.
    balls: Vec<(DVec3, f64)>,
    blend: f64,
}

impl Primitive {
    /// Returns a ball that contains the solid.
    fn ball(&self) -> (DVec3, f64) {
        match self {
            Self::Ellipsoid { centre, radii, .. } => (*centre, radii.max_element()),
            Self::Limb { ends: [a, b], radii: [at_a, at_b], .. } => {
                (0.5 * (*a + *b), 0.5 * (*b - *a).length() + at_a.max(*at_b))
            }
        }
    }

    /// Returns the function and its gradient (approximate away from the surface).
    fn sample(&self, p: DVec3) -> (f64, DVec3) {
        match *self {
            Self::Ellipsoid { centre, radii, forward } => {
                let forward = forward.normalize();
                let left = DVec3::Z.cross(forward).normalize();
                let axes = [forward, left, forward.cross(left)];
                let local = DVec3::from_array(axes.map(|axis| axis.dot(p - centre)));
                let scaled = local / radii;
                let normal = scaled / radii;
                if normal == DVec3::ZERO {
                    return (-radii.min_element(), DVec3::ZERO);
                }
                let size = scaled.length();
                let normal = normal / normal.length();
                // First-order distance (size - 1) / |gradient of size|, with |gradient of size| = |normal| / size.
                let value = size * (size - 1.0) / (scaled / radii).length();
                (value, axes[0] * normal.x + axes[1] * normal.y + axes[2] * normal.z)
            }
            Self::Limb { ends: [a, b], radii: [at_a, at_b], thin, flat } => {
                // A round limb in a space stretched along `thin`.
                let stretch = |v: DVec3| v + thin * ((flat - 1.0) * thin.dot(v));
                let (along, from_a) = (stretch(b - a), stretch(p - a));
                let t = along.dot(from_a) / along.length_squared();
                let inner = t.clamp(0.0, 1.0);
                let away = from_a - along * inner;
                let distance = away.length();
                let mut gradient = away / distance.max(f64::MIN_POSITIVE);
                if t == inner {
                    gradient -= along * ((at_b - at_a) / along.length_squared());
                }
                let gradient = stretch(gradient);
                let slope = gradient.length().max(0.5); // converts to distances in the original space
                ((distance - at_a - inner * (at_b - at_a)) / slope, gradient / slope)
            }
        }
    }
}

impl Implicit {
    /// Creates the union of groups of parts, each with the width of its blend with those before it (model unit, not 0).
    pub fn new(groups: impl IntoIterator<Item = (Vec<Part>, f64)>) -> Self {
        let group = |(parts, blend): (Vec<Part>, f64)| {
            let balls = parts.iter().map(|part| part.primitive.ball()).collect();
            Group { parts, balls, blend }
        };
        Self { groups: groups.into_iter().map(group).collect() }
    }

    /// Returns the function at p (model unit, about the distance near the surface; negative inside), and its gradient.
    pub fn sample(&self, p: DVec3) -> (f64, DVec3) {
        let mut all = EMPTY;
        for group in &self.groups {
            let mut own = EMPTY;
            for (part, (centre, radius)) in group.parts.iter().zip(&group.balls) {
                // Most parts are too far away to change the value.
                let reach = radius + part.blend + own.0.min(all.0 + group.blend);
                if reach > 0.0 && p.distance_squared(*centre) < reach * reach {
                    own = smooth_minimum(own, part.primitive.sample(p), part.blend);
                }
            }
            all = smooth_minimum(all, own, group.blend);
        }
        all
    }

    /// Projects a point to the surface by Newton steps along the gradient; returns the point and the outward unit normal.
    pub fn project(&self, mut p: DVec3) -> (DVec3, DVec3) {
        let (mut value, mut gradient) = self.sample(p);
        for _ in 0..MAX_NEWTON_STEPS {
            if value.abs() < PROJECTION_TOLERANCE {
                break;
            }
            p -= gradient * (value / gradient.length_squared().max(0.01));
            (value, gradient) = self.sample(p);
        }
        (p, gradient.normalize_or_zero())
    }
}

/// Returns the minimum of two functions. If they differ by less than `width`, a quadratic with one continuous derivative
/// replaces it, which is smaller than both.
fn smooth_minimum(a: (f64, DVec3), b: (f64, DVec3), width: f64) -> (f64, DVec3) {
    let (low, high) = if a.0 <= b.0 { (a, b) } else { (b, a) };
    let closeness = 1.0 - (high.0 - low.0) / width;
    if closeness <= 0.0 || high.0 == f64::INFINITY {
        return low;
    }
    (low.0 - 0.25 * width * closeness * closeness, low.1 + (high.1 - low.1) * (0.5 * closeness))
}
