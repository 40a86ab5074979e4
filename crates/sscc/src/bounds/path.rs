//! How far a shape can move along a straight path before two of its parts can meet: conservative advancement.
//!
//! Vertex v is at `x_v + t w_v`. For a fixed direction n two triangles stay apart as long as all nine pairs of
//! corners do: `n.(d_ab + t (w_b - w_a)) > 0`, which is linear in t. So a direction that separates them at t_0
//! certifies them up to some t_1; there a new direction is chosen, and so on until that gains nothing.

use glam::DVec3;

use super::min_norm::nearest_to_origin;
use super::scaled::{DOWN, direction};
use crate::ReducedModel;

/// Directions tried for one pair of triangles. Each is a proof by itself, so stopping early is safe.
const STEPS: usize = 64;

/// A step that gains less than this share of t is the last one.
const GAIN: f64 = 1e-4;

/// The vertices of a model on the way from `center` through q: at `x + t w`, `center` at t = 0 and q at t = 1.
pub(crate) struct Path {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) velocities: Vec<DVec3>,
    /// By how much a computed gap along a direction with components up to 1 may differ from the linear one:
    /// at most `rest + rate t`.
    rest: f64,
    rate: f64,
    /// Up to this t positions stay in range.
    pub(crate) farthest: f64,
}

impl Path {
    pub(crate) fn new(model: &ReducedModel, center: &[f64], q: &[f64]) -> Self {
        let offset: Vec<f64> = q.iter().zip(center).map(|(q, c)| q - c).collect();
        let vertices = 0..model.mesh().rest_positions().len() as u32;
        let velocity = |v| {
            let modes = model.modes().of_vertex(v);
            modes.iter().zip(&offset).fold(DVec3::ZERO, |w, (u, x)| w + *u * *x)
        };
        let (reach, moved) = (model.reach(center), model.moved(&offset));
        // Positions, velocities, q itself and the gaps are rounded at most 4 (r + 16) times, two vertices, three
        // components each; and once more as much as room.
        let gamma = 12.0 * (4 * q.len() + 64) as f64 * f64::EPSILON;
        Self {
            positions: vertices.clone().map(|v| model.position(v, center)).collect(),
            velocities: vertices.map(velocity).collect(),
            rest: gamma * reach + f64::MIN_POSITIVE,
            rate: gamma * moved + f64::MIN_POSITIVE,
            farthest: (crate::limits::LARGEST / 2.0 - reach) / moved.max(f64::MIN_POSITIVE),
        }
    }

    /// The t up to which a gap that is at least `gap` at `t` and closes no faster than `-opening` stays positive.
    #[inline]
    pub(crate) fn closes_at(&self, t: f64, gap: f64, opening: f64) -> f64 {
        let (gap, opening) = (gap - self.rest - t * self.rate, opening - self.rate);
        if gap.is_nan() || gap <= 0.0 {
            0.0
        } else if opening >= 0.0 {
            f64::INFINITY
        } else {
            t + gap / -opening * DOWN
        }
    }

    /// A t below which the two triangles with these vertices stay apart all the way: 0 where they already touch,
    /// infinite when it is at least `enough`.
    pub(crate) fn contact(&self, x: [u32; 3], y: [u32; 3], enough: f64) -> f64 {
        let p = |v: u32| self.positions[v as usize];
        let w = |v: u32| self.velocities[v as usize];
        let d: [DVec3; 9] = std::array::from_fn(|i| p(y[i % 3]) - p(x[i / 3]));
        let rates: [DVec3; 9] = std::array::from_fn(|i| w(y[i % 3]) - w(x[i / 3]));
        let mut t = 0.0;
        for _ in 0..STEPS {
            let now: [DVec3; 9] = std::array::from_fn(|i| d[i] + rates[i] * t);
            let Some(n) = direction(nearest_to_origin(&now).point) else { break };
            let until = (0..9)
                .map(|i| self.closes_at(t, n.dot(now[i]), n.dot(rates[i])))
                .fold(f64::INFINITY, f64::min);
            if until >= enough {
                return f64::INFINITY;
            }
            let gain = until - t;
            t = t.max(until);
            if gain.is_nan() || gain <= GAIN * t {
                break;
            }
        }
        t * DOWN
    }
}
