//! Configurations just inside radii: at none may a pair of the node collide.

use rayon::prelude::*;

use super::AuditOptions;
use super::claims::{Claim, Claims};
use super::minimum::{Collision, Minimum};
use super::random::Random;
use crate::{Certificates, Error, Method, Progress, Query, ReducedModel};

/// One in this many attacks goes at the root, another at a pair of its children: they cost as much as
/// a traditional query of the whole model.
const WHOLE: usize = 25;

/// One in this many goes at a pair of nodes, where there is a pair tree: by turns one that it holds and one that it
/// does not.
const PAIRS: usize = 3;

/// Nodes of more triangles than this are attacked only as often as the root.
const LARGE: u32 = 2000;

pub(super) struct Attack<'a> {
    pub(super) model: &'a ReducedModel,
    pub(super) certificates: &'a Certificates,
    pub(super) claims: &'a Claims<'a>,
    pub(super) minimum: &'a Minimum<'a>,
    /// Collisions known: the most dangerous directions.
    pub(super) hot: &'a [Collision],
    pub(super) options: &'a AuditOptions,
    pub(super) progress: &'a dyn Progress,
}

impl Attack<'_> {
    /// How many attacks could be made, and every one that succeeded.
    pub(super) fn run(&self) -> Result<(usize, Vec<String>), Error> {
        let attackable = self.certificates.parts().node_radii.iter().any(|r| *r > 0.0);
        if !attackable {
            return Ok((0, Vec::new())); // nothing is claimed anywhere
        }
        let blocks = self.options.samples.div_ceil(64);
        let results: Vec<Result<(usize, Vec<String>), Error>> = (0..blocks)
            .into_par_iter()
            .map_init(
                // The traditional method, or for parts of the model lazy boxes without certificates.
                || {
                    let with = |method| Query::with_method(self.model, self.certificates, method);
                    with(Method::Traditional).and_then(|whole| Ok((whole, with(Method::BdTree)?)))
                },
                |queries, block| {
                    let (whole, part) = queries.as_mut().map_err(|error| error.clone())?;
                    let mut made = 0;
                    let mut violations = Vec::new();
                    for sample in block * 64..self.options.samples.min(block * 64 + 64) {
                        if self.progress.is_cancelled() {
                            break;
                        }
                        let attack = self.attack(sample, whole, part);
                        made += usize::from(attack.is_some());
                        violations.extend(attack.flatten());
                    }
                    self.progress.report(block, blocks);
                    Ok((made, violations))
                },
            )
            .collect();
        let mut total = (0, Vec::new());
        for result in results {
            let (made, violations) = result?;
            total.0 += made;
            total.1.extend(violations);
        }
        Ok(total)
    }

    /// One attack: none where the claim drawn cannot be attacked (a q out of range), else its violation if any.
    fn attack<'q>(
        &self,
        sample: usize,
        whole: &mut Query<'q>,
        part: &mut Query<'q>,
    ) -> Option<Option<String>> {
        let mut random = Random::new(self.options.seed, 1_000_000 + sample as u64);
        let claim = self.claim(sample, &mut random);
        let q = self.just_inside(claim, sample, &mut random)?;
        let query = if claim.nodes == (0, 0) { whole } else { part };
        let pairs = query.discrete_between(claim.nodes, &q).ok()?.to_vec();
        let norm = query.norm();
        Some(pairs.into_iter().find_map(|faces| self.claims.violation(faces, norm, &q)))
    }

    /// What to attack.
    fn claim(&self, sample: usize, random: &mut Random) -> Claim {
        let hierarchy = &self.certificates.parts().hierarchy;
        let nodes = hierarchy.nodes();
        // Claims of radius 0 promise nothing: those attacks go at a node that promises something.
        let root = self.claims.node(0);
        if sample.is_multiple_of(WHOLE) && root.radius > 0.0 {
            return root;
        }
        if sample % WHOLE == 1 {
            let pairs: Vec<Claim> = self.claims.root_pairs().collect();
            if let Some(claim) = pairs.get(random.below(pairs.len())).filter(|claim| claim.radius > 0.0) {
                return *claim;
            }
        }
        if sample % PAIRS == 2 {
            let is_small = |claim: &Claim| {
                let count = |n: u32| nodes[n as usize].triangle_count;
                claim.radius > 0.0 && count(claim.nodes.0) + count(claim.nodes.1) <= LARGE
            };
            let of_absent = sample % (2 * PAIRS) == 2;
            if let Some(claim) = self.claims.random_pair(random, of_absent).filter(is_small) {
                return claim;
            }
        }
        // Radii grow towards the leaves, and some leaf's is positive: start again until one is found.
        let mut n = random.below(nodes.len());
        for _ in 0..1000 {
            if self.claims.node(n as u32).radius > 0.0 {
                break;
            }
            n = random.below(nodes.len());
        }
        while nodes[n].triangle_count > LARGE && !nodes[n].is_leaf() {
            n = nodes[n].first_child as usize + random.below(nodes[n].child_count as usize);
        }
        self.claims.node(n as u32)
    }

    /// A q with `|z|` just below the radius: in a known hot direction, near one, or in a random one; for two nodes
    /// mostly where two of their triangles approach.
    fn just_inside(&self, claim: Claim, sample: usize, random: &mut Random) -> Option<Vec<f64>> {
        let Claim { nodes: (n, m), radius } = claim;
        let scope = &self.certificates.parts().scope;
        let rank = scope.center.len();
        let decay = sample % 3;
        // Ways from the centre.
        let approach = if n != m && random.below(4) > 0 {
            let hierarchy = &self.certificates.parts().hierarchy;
            let [x, y] = [n, m].map(|n| {
                let triangles = hierarchy.triangles(&hierarchy.nodes()[n as usize]);
                triangles[random.below(triangles.len())]
            });
            self.minimum.approach((x, y), random)
        } else {
            None
        };
        let mut way: Vec<f64> = match (approach, sample % 4) {
            (Some(approach), _) => approach,
            (None, 0 | 1) if !self.hot.is_empty() => {
                let hot = &self.hot[random.below(self.hot.len())].q;
                let noise = if sample.is_multiple_of(4) { 0.0 } else { 0.1 * random.uniform() };
                let size = noise * scope.norm(hot) / (rank as f64).sqrt();
                let shift = scope.metric.unscaled(&random.normals(rank));
                hot.iter().zip(&scope.center).zip(shift).map(|((x, c), d)| x - c + size * d).collect()
            }
            (None, 2) if sample % 8 == 2 => {
                let mode = random.below(rank);
                let sign = if random.uniform() < 0.5 { 1.0 } else { -1.0 };
                (0..rank).map(|k| if k == mode { sign } else { 0.0 }).collect()
            }
            _ => {
                let weight = |k: usize| 1.0 / (1.0 + k as f64).powi(decay as i32);
                let z = random.normals(rank);
                scope.metric.unscaled(&z.iter().enumerate().map(|(k, z)| weight(k) * z).collect::<Vec<_>>())
            }
        };
        let norm = scope.metric.norm(&way);
        // Three in four as close as the rounding of norms allows, the others anywhere inside.
        let share = if random.below(4) > 0 { 1.0 - 1e-13 } else { random.uniform() };
        // An infinite radius is tried at any size that keeps positions in range.
        let goal = if radius.is_finite() { radius } else { 1.0 + 1e6 * random.uniform() };
        if !(norm > 0.0 && goal > 0.0) {
            return None;
        }
        way.iter_mut().zip(&scope.center).for_each(|(x, c)| *x = c + *x * (goal * share / norm));
        Some(way)
    }
}
