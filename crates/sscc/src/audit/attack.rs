//! Attacks single claims. An attack on a radius tests a configuration inside the radius of a node or a node pair: a collision
//! there of one of its triangle pairs refutes the radius. If there are local certificates, half of the attacks are on
//! them; all attacks are, if the radius of each node is 0.

use super::claims::{Claim, Claims};
use super::local_attack::{LocalAttack, LocalQueries};
use super::minimum_search::{Collision, MinimumSearch};
use super::options::AuditOptions;
use super::random::Random;
use crate::parallel::map_with;
use crate::{Certificates, Error, Method, Pair, Progress, Query, ReducedModel};

/// One in this many attacks is on the root, and another one on a pair of its children: each costs as much as a traditional query
/// of the whole model.
const ROOT: usize = 25;

/// One in this many attacks is on a node pair, if there is a pair tree: alternately an absent pair and an entry of the tree.
const NODE_PAIR: usize = 3;

/// Attacks are divided into at most this many blocks, so that memory does not grow with their number.
const MAX_BLOCKS: usize = 1 << 16;

/// The smallest number of attacks in a block, and the largest number of lines about violations that are kept of a block.
const MIN_BLOCK: usize = 64;

/// Nodes of more triangles than this are not attacked, except the root; nor are node pairs of more triangles together,
/// except those of the root's children.
const LARGE: u32 = 2000;

pub(super) struct Attack<'a> {
    pub(super) model: &'a ReducedModel,
    pub(super) certificates: &'a Certificates,
    pub(super) claims: &'a Claims<'a>,
    pub(super) minimum: &'a MinimumSearch<'a>,
    /// Known collisions: the most dangerous directions.
    pub(super) collisions: &'a [Collision],
    pub(super) options: &'a AuditOptions,
    pub(super) progress: &'a dyn Progress,
}

/// The number of attacks made, and a line for each one that refuted a claim.
#[derive(Default)]
pub(super) struct Attacks {
    pub(super) samples: usize,
    /// How many of them were on local certificates.
    pub(super) local_samples: usize,
    pub(super) violations: Vec<String>,
}

/// The queries whose answers confirm or refute a claim.
struct Queries {
    /// The traditional method, for attacks on the root.
    root: Query,
    /// BD-tree AABBs without certificates, for parts of the model.
    part: Query,
    /// The certified method, which lists the local certificates that hold at q. None if there are no local certificates.
    local: Option<Query>,
}

impl Attack<'_> {
    /// Makes all attacks.
    pub(super) fn run(&self) -> Result<Attacks, Error> {
        let parts = self.certificates.parts();
        let is_any_claimed = parts.node_radii.iter().chain(&parts.root_pair_radii).any(|r| *r > 0.0)
            || parts.pair_tree.limit() > 0.0;
        let Self { certificates, minimum, collisions, .. } = *self;
        let local = &LocalAttack { certificates, minimum, collisions };
        if !is_any_claimed && !local.is_possible() {
            return Ok(Attacks::default());
        }
        let samples = self.options.samples;
        let in_block = samples.div_ceil(MAX_BLOCKS).max(MIN_BLOCK);
        let blocks = samples.div_ceil(in_block);
        let results: Vec<Result<Attacks, Error>> = map_with(
            0..blocks,
            usize::MAX,
            || {
                let query = |method| Query::with_method(self.model, self.certificates, method);
                let root = query(Method::Traditional)?;
                let local = local.is_possible().then(|| query(Method::Certified)).transpose()?;
                Ok(Queries { root, part: query(Method::BdTree)?, local })
            },
            |queries: &mut Result<Queries, Error>, block| {
                let queries = queries.as_mut().map_err(|error| error.clone())?;
                let mut attacks = Attacks::default();
                let first = block * in_block;
                for sample in first..samples.min(first.saturating_add(in_block)) {
                    if self.progress.is_cancelled() {
                        break;
                    }
                    let mut random = Random::new(self.options.seed, (sample as u64).wrapping_add(1_000_000));
                    let attack = match &mut queries.local {
                        Some(certified) if !is_any_claimed || random.below(2) == 0 => {
                            let queries = LocalQueries { certified, exact: &mut queries.part };
                            let attack = local.attack(sample, &mut random, queries);
                            attacks.local_samples += usize::from(attack.is_some());
                            attack
                        }
                        _ => self.attack(sample, &mut random, queries),
                    };
                    attacks.samples += usize::from(attack.is_some());
                    let is_kept = attacks.violations.len() < MIN_BLOCK;
                    attacks.violations.extend(attack.flatten().filter(|_| is_kept));
                }
                self.progress.report(block, blocks);
                Ok(attacks)
            },
        );
        let mut total = Attacks::default();
        for attacks in results {
            let Attacks { samples, local_samples, violations } = attacks?;
            total.samples += samples;
            total.local_samples += local_samples;
            total.violations.extend(violations);
        }
        Ok(total)
    }

    /// Makes one attack. None if no configuration can be drawn or tested, else the violation found, if any.
    fn attack(&self, sample: usize, random: &mut Random, queries: &mut Queries) -> Option<Option<String>> {
        let claim = self.draw_claim(sample, random);
        if claim.radius <= 0.0 {
            return None;
        }
        let q = self.draw_configuration(claim, sample, random)?;
        let query = if claim.nodes == (0, 0) { &mut queries.root } else { &mut queries.part };
        let pairs = match self.minimum.clearance {
            Some(clearance) => query.near_between(claim.nodes, &q, &clearance).ok()?,
            None => query.discrete_between(claim.nodes, &q).ok()?.to_vec(),
        };
        let norm = query.norm();
        // `near_between` lists all near pairs that share no vertex: also pairs within the rings, and excluded ones.
        let MinimumSearch { filter, rings, .. } = self.minimum;
        let is_counted = |(a, b): &Pair| !rings.contain(*a, *b) && !filter.is_excluded(*a, *b);
        let mut pairs = pairs.into_iter().filter(is_counted);
        Some(pairs.find_map(|faces| self.claims.violation(faces, norm, &q)))
    }

    /// Returns the claim that a sample attacks; its radius is 0 if none with a positive radius was drawn.
    fn draw_claim(&self, sample: usize, random: &mut Random) -> Claim {
        let hierarchy = &self.certificates.parts().hierarchy;
        let nodes = hierarchy.nodes();
        // A radius of 0 claims nothing: then the sample attacks a node of positive radius.
        let root = self.claims.node(0);
        if sample.is_multiple_of(ROOT) && root.radius > 0.0 {
            return root;
        }
        if sample % ROOT == 1 {
            let pairs: Vec<Claim> = self.claims.root_pairs().collect();
            if let Some(claim) = pairs.get(random.below(pairs.len())).filter(|claim| claim.radius > 0.0) {
                return *claim;
            }
        }
        if sample % NODE_PAIR == 2 {
            let is_attackable = |claim: &Claim| {
                let count = |n: u32| nodes[n as usize].triangle_count;
                claim.radius > 0.0 && count(claim.nodes.0) + count(claim.nodes.1) <= LARGE
            };
            let is_absent = sample % (2 * NODE_PAIR) == 2;
            if let Some(claim) = self.claims.random_pair(random, is_absent).filter(is_attackable) {
                return claim;
            }
        }
        // Radii grow towards the leaves: draw nodes until one has a positive radius.
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
        let claim = self.claims.node(n as u32);
        if claim.radius > 0.0 {
            return claim;
        }
        // Perhaps only pairs of nodes have radii.
        let pairs: Vec<Claim> = self.claims.root_pairs().filter(|claim| claim.radius > 0.0).collect();
        if random.below(2) == 0
            && let Some(claim) = pairs.get(random.below(pairs.len()))
        {
            return *claim;
        }
        let is_absent = random.below(2) == 0;
        self.claims.random_pair(random, is_absent).unwrap_or(claim)
    }

    /// Returns a q with `|z|` below the radius, mostly just below it. Its direction is that of a known collision or a
    /// similar one, that of one coordinate, or a random one; for a claim about two nodes mostly one in which two of
    /// their triangles approach. None if no direction is found.
    fn draw_configuration(&self, claim: Claim, sample: usize, random: &mut Random) -> Option<Vec<f64>> {
        let Claim { nodes: (n, m), radius } = claim;
        let scope = &self.certificates.parts().scope;
        let rank = scope.center.len();
        let decay = sample % 3;
        let approach = if n != m && random.below(4) > 0 {
            let hierarchy = &self.certificates.parts().hierarchy;
            let [a, b] = [n, m].map(|n| {
                let triangles = hierarchy.triangles(&hierarchy.nodes()[n as usize]);
                triangles[random.below(triangles.len())]
            });
            self.minimum.approach((a, b), random)
        } else {
            None
        };
        // This is the offset from the centre.
        let mut offset: Vec<f64> = match (approach, sample % 4) {
            (Some(approach), _) => approach,
            (None, 0 | 1) if !self.collisions.is_empty() => {
                let q = &self.collisions[random.below(self.collisions.len())].q;
                let noise = if sample.is_multiple_of(4) { 0.0 } else { 0.1 * random.uniform() };
                let size = noise * scope.norm(q) / (rank as f64).sqrt();
                let shift = scope.metric.unscale(&random.normals(rank));
                q.iter().zip(&scope.center).zip(shift).map(|((x, c), d)| x - c + size * d).collect()
            }
            (None, 2) if sample % 8 == 2 => {
                let k = random.below(rank);
                let sign = if random.uniform() < 0.5 { 1.0 } else { -1.0 };
                (0..rank).map(|other| if other == k { sign } else { 0.0 }).collect()
            }
            _ => {
                let weight = |k: usize| 1.0 / (1.0 + k as f64).powi(decay as i32);
                let z = random.normals(rank);
                scope.metric.unscale(&z.iter().enumerate().map(|(k, z)| weight(k) * z).collect::<Vec<_>>())
            }
        };
        let norm = scope.metric.length(&offset);
        // Three in four configurations are as close to the radius as the rounding of norms allows, the others anywhere inside.
        let share = if random.below(4) > 0 { 1.0 - 1e-13 } else { random.uniform() };
        // An infinite radius is attacked at any size that keeps positions in range.
        let goal = if radius.is_finite() { radius } else { 1.0 + 1e6 * random.uniform() };
        if !(norm > 0.0 && goal > 0.0) {
            return None;
        }
        offset.iter_mut().zip(&scope.center).for_each(|(x, c)| *x = c + *x * (goal * share / norm));
        Some(offset)
    }
}
