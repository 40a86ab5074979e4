//! Extremal deformations of the root's ellipsoid (paper, Figure 11).

use serde::Serialize;
use sscc::Certificates;

/// The paper shows the first four modes, in the positive and the negative direction.
const MODES: usize = 4;

/// Just inside, whatever rounding does.
const INSIDE: f64 = 1.0 - 1e-9;

/// A q as far along one mode as the root's certificate reaches.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Extremal {
    /// The mode, counted from 1, and the direction.
    pub name: String,
    /// Where.
    pub q: Vec<f64>,
}

/// For each of the first modes both of them; none where the root's radius is 0 or without limit.
pub fn extremal(certificates: &Certificates) -> Vec<Extremal> {
    let (center, radius) = (certificates.center(), certificates.root_radius());
    if radius <= 0.0 || !radius.is_finite() {
        return Vec::new();
    }
    let along = |k: usize, sign: f64| {
        let mut unit = vec![0.0; center.len()];
        unit[k] = 1.0;
        let mut q = center.to_vec();
        q[k] += sign * INSIDE * radius / certificates.metric().norm(&unit);
        Extremal { name: format!("mode {} {}", k + 1, if sign > 0.0 { "+" } else { "-" }), q }
    };
    (0..center.len().min(MODES)).flat_map(|k| [along(k, 1.0), along(k, -1.0)]).collect()
}
