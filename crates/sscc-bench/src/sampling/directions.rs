//! Random directions in q-space, scaled to a given largest displacement.

use sscc::ReducedModel;

use crate::random::Random;

const SEED: u64 = 7;

/// Returns random directions in q-space: `z_i = N(0,1) / i`, mode i counted from 1, in the model's metric.
///
/// # Errors
/// None in practice.
pub fn directions(model: &ReducedModel, count: usize) -> Result<Vec<Vec<f64>>, sscc::Error> {
    let mut random = Random(SEED);
    let mut direction = || {
        let z: Vec<f64> = (0..model.rank()).map(|k| random.normal() / (1.0 + k as f64)).collect();
        model.metric().unscaled(&z)
    };
    (0..count).map(|_| direction()).collect()
}

/// Returns for each direction the q along it at which the largest displacement of a vertex is half the diagonal of the
/// rest AABB.
pub fn unit_displacements(model: &ReducedModel, directions: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let half = half_diagonal(model);
    directions.iter().map(|dir| scaled(dir, half / largest_displacement(model, dir))).collect()
}

/// Returns a multiple of q.
pub fn scaled(q: &[f64], factor: f64) -> Vec<f64> {
    q.iter().map(|x| x * factor).collect()
}

/// Returns half the diagonal of the AABB at rest (model unit).
pub fn half_diagonal(model: &ReducedModel) -> f64 {
    let p = model.mesh().rest_positions();
    let (lower, upper) = p.iter().fold((p[0], p[0]), |(lower, upper), p| (lower.min(*p), upper.max(*p)));
    (upper - lower).length() / 2.0
}

/// Returns the largest displacement of a vertex at q (model unit).
pub fn largest_displacement(model: &ReducedModel, q: &[f64]) -> f64 {
    let rest = model.mesh().rest_positions();
    let displacement = |v: usize| (model.position(v as u32, q) - rest[v]).length();
    (0..rest.len()).map(displacement).fold(0.0, f64::max)
}
