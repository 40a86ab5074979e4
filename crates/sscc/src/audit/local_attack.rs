//! Attacks local certificates at configurations far from the centre where a certificate only just holds. A collision there of a
//! pair that it proves free refutes it.

use super::minimum_search::{Collision, MinimumSearch};
use super::random::Random;
use crate::hierarchy::NodePair;
use crate::{Certificates, Error, Query};

/// Nodes of more triangles than this are attacked only in one of [`LARGE_SHARE`] samples.
const LARGE: u32 = 2000;

/// One in this many samples attacks a node of any size.
const LARGE_SHARE: usize = 25;

/// One in this many attacks is also on a motion.
const MOTION: usize = 4;

/// Maximum number of doublings of a scale, in search of one at which a certificate does not hold.
const DOUBLINGS: usize = 100;

/// Number of halvings of the interval in which a certificate stops holding.
const HALVINGS: usize = 20;

pub(super) struct LocalAttack<'a> {
    pub(super) certificates: &'a Certificates,
    pub(super) minimum: &'a MinimumSearch<'a>,
    /// Known collisions: the most dangerous directions.
    pub(super) collisions: &'a [Collision],
}

/// The queries of an attack.
pub(super) struct LocalQueries<'a> {
    /// The query that uses local certificates.
    pub(super) certified: &'a mut Query,
    /// The query that uses no certificates.
    pub(super) exact: &'a mut Query,
}

impl LocalAttack<'_> {
    /// Whether there are local certificates.
    pub(super) fn is_possible(&self) -> bool {
        !self.certificates.parts().local.nodes.is_empty()
    }

    /// Makes one attack. None if no configuration can be drawn or tested, else the violation found, if any.
    pub(super) fn attack(
        &self,
        sample: usize,
        random: &mut Random,
        queries: LocalQueries<'_>,
    ) -> Option<Option<String>> {
        let LocalQueries { certified, exact } = queries;
        let (index, claim) = self.draw_claim(sample, random)?;
        let q = self.draw_edge(index, claim, random, certified)?;
        if let Some(violation) = self.test(claim, &q, exact).ok()? {
            return Some(Some(violation));
        }
        if sample.is_multiple_of(MOTION)
            && let Some(end) = self.draw_edge(index, claim, random, certified)
            && certified.local_claims(index, [&q, &end]).ok()?.contains(&claim)
        {
            let t = random.uniform();
            let between: Vec<f64> = q.iter().zip(&end).map(|(x, y)| x + t * (y - x)).collect();
            return self.test(claim, &between, exact).ok();
        }
        Some(None)
    }

    /// Returns a violation if a pair of these nodes collides at q.
    fn test(&self, claim: NodePair, q: &[f64], exact: &mut Query) -> Result<Option<String>, Error> {
        let pairs = exact.discrete_between(claim, q)?;
        Ok(pairs.first().map(|(a, b)| {
            let (n, m) = claim;
            format!(
                "triangles {a} and {b} collide at a configuration where the local certificate of node {n} proves its pairs with node {m} free; \
                 q = {q:?}"
            )
        }))
    }

    /// Returns the index of a certificate, and the node pair of one of its claims.
    fn draw_claim(&self, sample: usize, random: &mut Random) -> Option<(usize, NodePair)> {
        let parts = self.certificates.parts();
        let (local, nodes) = (&parts.local, parts.hierarchy.nodes());
        let count = local.nodes.len();
        let is_small = |n: u32| nodes[n as usize].triangle_count <= LARGE;
        let mut index = random.below(count);
        if !sample.is_multiple_of(LARGE_SHARE) {
            index = (0..count).map(|i| (index + i) % count).find(|i| is_small(local.nodes[*i]))?;
        }
        let n = local.nodes[index];
        let range = local.list_starts[index] as usize..local.list_starts[index + 1] as usize;
        let list = &local.list_nodes[range];
        let is_own = list.is_empty() || random.below(2) == 0;
        Some((index, if is_own { (n, n) } else { (n, list[random.below(list.len())]) }))
    }

    /// Returns the farthest q found along a ray from the centre at which a claim holds; for one ray in four a random q
    /// before it at which the claim holds, too. None if the claim holds at no q that is tried.
    fn draw_edge(
        &self,
        index: usize,
        claim: NodePair,
        random: &mut Random,
        certified: &mut Query,
    ) -> Option<Vec<f64>> {
        let parts = self.certificates.parts();
        let center = &parts.scope.center;
        let ray = self.draw_ray(claim, random)?;
        let at = |scale: f64| -> Vec<f64> { center.iter().zip(&ray).map(|(c, d)| c + scale * d).collect() };
        let mut holds = |scale: f64| {
            certified.local_claims(index, [&at(scale)]).is_ok_and(|claims| claims.contains(&claim))
        };
        let norm = parts.scope.metric.length(&ray);
        // Begins at the cap of radii, or closer to the centre if the certificate does not hold there.
        let radius = if parts.global_radius.is_finite() { parts.global_radius } else { 1.0 };
        let first = radius / norm;
        let mut low = [1.0, 0.25, 0.05, 0.01, 1e-3].into_iter().map(|s| s * first).find(|s| holds(*s))?;
        let mut high = 2.0 * low;
        for _ in 0..DOUBLINGS {
            if !holds(high) {
                break;
            }
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if holds(middle) { low = middle } else { high = middle }
        }
        if random.below(4) == 0 {
            let inside = low * random.uniform();
            return Some(at(if holds(inside) { inside } else { low }));
        }
        Some(at(low))
    }

    /// Returns an offset from the centre: towards a q at which two triangles of a claim meet, towards a known
    /// collision, or in a random direction.
    fn draw_ray(&self, (n, m): NodePair, random: &mut Random) -> Option<Vec<f64>> {
        let scope = &self.certificates.parts().scope;
        let hierarchy = self.certificates.hierarchy();
        let [a, b] = [n, m].map(|n| {
            let triangles = hierarchy.triangles(&hierarchy.nodes()[n as usize]);
            triangles[random.below(triangles.len())]
        });
        let ray = match random.below(4) {
            0 | 1 if a != b => self.minimum.approach((a, b), random),
            2 if !self.collisions.is_empty() => {
                let q = &self.collisions[random.below(self.collisions.len())].q;
                Some(q.iter().zip(&scope.center).map(|(x, c)| x - c).collect())
            }
            _ => None,
        };
        let decay = random.below(3) as i32;
        let ray = ray.unwrap_or_else(|| {
            let z = random.normals(scope.center.len());
            let weight = |k: usize| (1.0 + k as f64).powi(-decay);
            scope.metric.unscale(&z.iter().enumerate().map(|(k, z)| weight(k) * z).collect::<Vec<_>>())
        });
        let norm = scope.metric.length(&ray);
        (norm > 0.0 && norm.is_finite()).then_some(ray)
    }
}
