//! Configurations just inside radii: at none may a pair of the node collide.

use rayon::prelude::*;

use super::AuditOptions;
use super::minimum::Collision;
use super::random::Random;
use crate::certificates::child_pairs;
use crate::{Certificates, Method, Progress, Query, ReducedModel};

/// One in this many attacks goes at the root, another at a pair of its children: they cost as much as
/// a traditional query of the whole model.
const WHOLE: usize = 25;

/// Nodes of more triangles than this are attacked only as often as the root.
const LARGE: u32 = 2000;

pub(super) struct Attack<'a> {
    pub(super) model: &'a ReducedModel,
    pub(super) certificates: &'a Certificates,
    /// Collisions known: the most dangerous directions.
    pub(super) hot: &'a [Collision],
    pub(super) options: &'a AuditOptions,
    pub(super) progress: &'a dyn Progress,
}

impl Attack<'_> {
    /// Every attack that succeeded.
    pub(super) fn run(&self) -> Vec<String> {
        let blocks = self.options.samples.div_ceil(64);
        (0..blocks)
            .into_par_iter()
            .map_init(
                // The traditional method, or for parts of the model the same boxes without certificates.
                || {
                    let with = |method| Query::with_method(self.model, self.certificates, method).ok();
                    (with(Method::Traditional), with(Method::BdTree))
                },
                |(whole, part), block| {
                    let mut violations = Vec::new();
                    for sample in block * 64..self.options.samples.min(block * 64 + 64) {
                        if self.progress.is_cancelled() {
                            break;
                        }
                        if let (Some(whole), Some(part)) = (whole.as_mut(), part.as_mut()) {
                            violations.extend(self.attack(sample, whole, part));
                        }
                    }
                    self.progress.report(block, blocks);
                    violations
                },
            )
            .flatten()
            .collect()
    }

    fn attack(&self, sample: usize, whole: &mut Query<'_>, part: &mut Query<'_>) -> Option<String> {
        let parts = self.certificates.parts();
        let nodes = parts.hierarchy.nodes();
        let mut random = Random::new(self.options.seed, 1_000_000 + sample as u64);
        let pairs: Vec<(u32, u32)> = child_pairs(&nodes[0]).collect();
        let (what, radius, target) = if sample.is_multiple_of(WHOLE) {
            ("the root".to_owned(), parts.node_radii[0], None)
        } else if sample % WHOLE == 1 && !pairs.is_empty() {
            let i = random.below(pairs.len());
            (format!("the nodes {:?}", pairs[i]), parts.root_pair_radii[i], Some(pairs[i]))
        } else {
            let mut n = random.below(nodes.len());
            while nodes[n].triangle_count > LARGE && !nodes[n].is_leaf() {
                n = nodes[n].first_child as usize + random.below(nodes[n].child_count as usize);
            }
            (format!("node {n}"), parts.node_radii[n], Some((n as u32, n as u32)))
        };
        let q = self.just_inside(radius, sample, &mut random)?;
        let (pairs, norm) = match target {
            None => (whole.discrete(&q).ok()?.to_vec(), whole.norm()),
            Some((n, m)) => (part.discrete_between(n, m, &q).ok()?.to_vec(), part.norm()),
        };
        if norm < radius && !pairs.is_empty() {
            let (i, j) = pairs[0];
            return Some(format!(
                "triangles {i} and {j} of {what} collide at |z| = {norm:e}, below its radius {radius:e}; q = {q:?}"
            ));
        }
        None
    }

    /// A q with `|z|` just below the radius, in a known hot direction, near one, or in a random one.
    fn just_inside(&self, radius: f64, sample: usize, random: &mut Random) -> Option<Vec<f64>> {
        let metric = self.certificates.metric();
        let scales = metric.scales();
        let decay = sample % 3;
        let mut q: Vec<f64> = match sample % 4 {
            0 | 1 if !self.hot.is_empty() => {
                let hot = &self.hot[random.below(self.hot.len())].q;
                let noise = if sample.is_multiple_of(4) { 0.0 } else { 0.1 * random.uniform() };
                let size = self.certificates.metric().norm(hot) / (scales.len() as f64).sqrt();
                hot.iter().zip(scales).map(|(x, s)| x + noise * size * random.normal() / s).collect()
            }
            2 if sample % 8 == 2 => {
                let mode = random.below(scales.len());
                let sign = if random.uniform() < 0.5 { 1.0 } else { -1.0 };
                (0..scales.len()).map(|k| if k == mode { sign } else { 0.0 }).collect()
            }
            _ => {
                let weight = |k: usize| 1.0 / (1.0 + k as f64).powi(decay as i32);
                scales.iter().enumerate().map(|(k, s)| weight(k) * random.normal() / s).collect()
            }
        };
        let norm = metric.norm(&q);
        // Three in four as close as the rounding of norms allows, the others anywhere inside.
        let share = if random.below(4) > 0 { 1.0 - 1e-13 } else { random.uniform() };
        // An infinite radius is tried at any size that keeps positions in range.
        let goal = if radius.is_finite() { radius } else { 1.0 + 1e6 * random.uniform() };
        if !(norm > 0.0 && goal > 0.0) {
            return None;
        }
        q.iter_mut().for_each(|x| *x *= goal * share / norm);
        Some(q)
    }
}
