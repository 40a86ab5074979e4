//! Random configurations of a given largest displacement.

use sscc::ReducedModel;

use super::random::Random;

const SEED: u64 = 7;

/// Directions in q-space: `z_i = N(0,1) / i`, mode i counted from 1, in the model's metric.
pub fn directions(model: &ReducedModel, count: usize) -> Vec<Vec<f64>> {
    let mut random = Random(SEED);
    let mut direction = || {
        let z: Vec<f64> = (0..model.rank()).map(|k| random.normal() / (1.0 + k as f64)).collect();
        model.metric().unscaled(&z)
    };
    (0..count).map(|_| direction()).collect()
}

/// Along each direction, the q at which the vertex that moves farthest has moved one half of the box's diagonal.
pub fn to_unit(model: &ReducedModel, directions: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let half = half_diagonal(model);
    directions.iter().map(|way| scaled(way, half / largest_displacement(model, way))).collect()
}

pub fn scaled(q: &[f64], factor: f64) -> Vec<f64> {
    q.iter().map(|x| x * factor).collect()
}

/// Half the diagonal of the box at rest.
pub fn half_diagonal(model: &ReducedModel) -> f64 {
    let p = model.mesh().rest_positions();
    let (lower, upper) = p.iter().fold((p[0], p[0]), |(lower, upper), p| (lower.min(*p), upper.max(*p)));
    (upper - lower).length() / 2.0
}

/// How far the vertex that moves farthest has moved at q.
pub fn largest_displacement(model: &ReducedModel, q: &[f64]) -> f64 {
    let rest = model.mesh().rest_positions();
    let moved = |v: usize| (model.position(v as u32, q) - rest[v]).length();
    (0..rest.len()).map(moved).fold(0.0, f64::max)
}
