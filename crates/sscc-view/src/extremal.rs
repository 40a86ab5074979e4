//! The largest deformations along single modes that the root's certificate proves free (paper, Figure 11).

use serde::Serialize;
use sscc::{Certificates, ReducedModel};

/// The paper shows the first four modes, in the positive and the negative direction.
const MAX_MODES: usize = 4;

/// Factor that keeps q inside the root's radius in spite of rounding.
const SHRINK: f64 = 1.0 - 1e-9;

/// A q just inside the root's radius, along one mode.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Extremal {
    /// The mode's number, counted from 0, and the sign of the direction.
    pub name: String,
    /// The q (r numbers).
    pub q: Vec<f64>,
}

/// Factor on half the diagonal of the AABB: a shape whose vertices all move by less looks like the shape at the centre. The
/// factor is about one pixel of a picture.
const VISIBLE: f64 = 0.02;

/// Returns q along each of the first modes, in both directions, unless the shape looks like the shape at the centre. Returns
/// an empty list if the root's radius is 0 or infinite.
pub fn extremal(model: &ReducedModel, certificates: &Certificates) -> Vec<Extremal> {
    let (center, radius) = (certificates.center(), certificates.root_radius());
    if radius <= 0.0 || !radius.is_finite() {
        return Vec::new();
    }
    let limits = model.weight_limits();
    let along = |k: usize, sign: f64| {
        let mut unit = vec![0.0; center.len()];
        unit[k] = 1.0;
        let mut q = center.to_vec();
        let weight = SHRINK * radius / certificates.metric().norm(&unit).ok()?;
        if weight < VISIBLE * limits[k] {
            return None;
        }
        q[k] += sign * weight;
        Some(Extremal { name: format!("mode {k} {}", if sign > 0.0 { "+" } else { "-" }), q })
    };
    (0..center.len().min(MAX_MODES)).flat_map(|k| [along(k, 1.0), along(k, -1.0)]).flatten().collect()
}
