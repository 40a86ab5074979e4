//! Smooth solids as the places where a function is negative.

use glam::DVec3;

/// Newton steps of a projection at most, and the distance (model unit) that is near enough. From within a lattice
/// cell of the surface about four steps are needed.
const MAX_NEWTON_STEPS: usize = 8;
const PROJECTION_TOLERANCE: f64 = 1e-12;

/// The function of the empty union, and its gradient.
const EMPTY: (f64, DVec3) = (f64::INFINITY, DVec3::ZERO);

/// A simple solid. Its function is about the distance to it (negative inside), exact enough to blend with
/// others, and zero exactly on its surface.
pub(super) enum Primitive {
    /// An ellipsoid. `forward` is the direction of its first axis, the second is level, the third upward.
    Ellipsoid { centre: DVec3, radii: DVec3, forward: DVec3 },
    /// A segment whose thickness goes evenly from the first radius to the second, flattened across: at right
    /// angles to the segment it is `flat` times thinner in the unit direction `thin` (1: round).
    Limb { ends: [DVec3; 2], radii: [f64; 2], thin: DVec3, flat: f64 },
}

/// A solid, and how it joins those before it in its group: surfaces closer than `blend` flow together.
pub(super) struct Part {
    /// What is added.
    pub primitive: Primitive,
    /// Width of the soft seam (model unit, not 0). Gaps wider than this stay as they are.
    pub blend: f64,
}

/// A smooth union of groups, each a smooth union of parts; all in their order.
pub(super) struct Implicit {
    groups: Vec<Group>,
}

struct Group {
    parts: Vec<Part>,
    /// For each part, the centre and radius of a ball around it.
    balls: Vec<(DVec3, f64)>,
    blend: f64,
}

impl Primitive {
    /// A ball that contains the solid.
    fn ball(&self) -> (DVec3, f64) {
        match self {
            Self::Ellipsoid { centre, radii, .. } => (*centre, radii.max_element()),
            Self::Limb { ends: [a, b], radii: [at_a, at_b], .. } => {
                (0.5 * (*a + *b), 0.5 * (*b - *a).length() + at_a.max(*at_b))
            }
        }
    }

    /// The function and its gradient (away from the surface approximately).
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
                // To first order (size - 1) / |gradient of size|, where that is |normal| / size.
                let value = size * (size - 1.0) / (scaled / radii).length();
                (value, axes[0] * normal.x + axes[1] * normal.y + axes[2] * normal.z)
            }
            Self::Limb { ends: [a, b], radii: [at_a, at_b], thin, flat } => {
                // A round limb in a space that is stretched along `thin`.
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
                let slope = gradient.length().max(0.5); // back to distances of the space that is not stretched
                ((distance - at_a - inner * (at_b - at_a)) / slope, gradient / slope)
            }
        }
    }
}

impl Implicit {
    /// The union of groups of parts; a group joins those before it with the given blend (model unit, not 0).
    pub fn new(groups: impl IntoIterator<Item = (Vec<Part>, f64)>) -> Self {
        let group = |(parts, blend): (Vec<Part>, f64)| {
            let balls = parts.iter().map(|part| part.primitive.ball()).collect();
            Group { parts, balls, blend }
        };
        Self { groups: groups.into_iter().map(group).collect() }
    }

    /// The function at p (model unit, about the distance near the surface; negative inside), and its gradient.
    pub fn sample(&self, p: DVec3) -> (f64, DVec3) {
        let mut all = EMPTY;
        for group in &self.groups {
            let mut own = EMPTY;
            for (part, (centre, radius)) in group.parts.iter().zip(&group.balls) {
                // Most parts are too far away to change anything.
                let reach = radius + part.blend + own.0.min(all.0 + group.blend);
                if reach > 0.0 && p.distance_squared(*centre) < reach * reach {
                    own = smooth_minimum(own, part.primitive.sample(p), part.blend);
                }
            }
            all = smooth_minimum(all, own, group.blend);
        }
        all
    }

    /// The nearby point of the surface that Newton steps along the gradient lead to, and the outward unit normal.
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

/// The smaller of two functions; where they differ by less than `width`, a smooth passage (a quadratic, with one
/// continuous derivative) that is smaller than both.
fn smooth_minimum(a: (f64, DVec3), b: (f64, DVec3), width: f64) -> (f64, DVec3) {
    let (low, high) = if a.0 <= b.0 { (a, b) } else { (b, a) };
    let near = 1.0 - (high.0 - low.0) / width;
    if near <= 0.0 || high.0 == f64::INFINITY {
        return low;
    }
    (low.0 - 0.25 * width * near * near, low.1 + (high.1 - low.1) * (0.5 * near))
}
