//! Compares answers about near pairs: certified ones (with and without the pair tree), those of a detector, and brute force.

use super::compare::{BRUTE_FORCE_TRIANGLES, Comparison, MAX_COMPARISONS, SAMPLES_PER_COMPARISON};
use super::random::Random;
use crate::certificates::PairTree;
use crate::filter::Relation;
use crate::{Certificates, Clearance, Error, Method, NearPair, Pair, Query, distance_triangle_triangle};

impl Comparison<'_> {
    /// Returns a line for each q at which two methods differ, and for each q at which a near pair refutes a claim.
    /// `certified` is the clearance of the certificates.
    pub(super) fn run_near(&self, certified: &Clearance) -> Result<Vec<String>, Error> {
        let Self { model, certificates, claims, options, minimum, .. } = *self;
        let query = |method| Query::with_method(model, certificates, method);
        let (mut with_tree, mut detector) = (query(Method::Certified)?, query(Method::Traditional)?);
        let mut parts = certificates.parts().clone();
        parts.pair_tree = PairTree::default();
        let without_tree = Certificates::try_from(parts)?;
        let mut nodes_alone = Query::with_method(model, &without_tree, Method::Certified)?;
        let is_small = model.mesh().faces().len() <= BRUTE_FORCE_TRIANGLES;
        let mut violations = Vec::new();
        let comparisons = (options.samples / SAMPLES_PER_COMPARISON).clamp(1, MAX_COMPARISONS);
        for sample in 0..comparisons {
            if self.progress.is_cancelled() {
                break;
            }
            let mut random = Random::new(options.seed, 2_000_000 + sample as u64);
            let q = self.draw_configuration(&mut random, sample);
            // Compares the clearance itself and smaller ones.
            let share = if sample.is_multiple_of(2) { 1.0 } else { random.uniform() };
            let clearance = Clearance::new(certified.distance() * share).unwrap_or(*certified);
            let clearance = clearance.beyond_rings(certified.rings());
            let expected = detector.within(&q, &clearance)?.to_vec();
            let norm = detector.norm();
            for (query, method) in
                [(&mut with_tree, "certified"), (&mut nodes_alone, "certified, without the pair tree,")]
            {
                if query.within(&q, &clearance)? != expected {
                    violations.push(format!(
                        "near pairs of the {method} method and of a detector differ at q = {q:?}, clearance {:e}",
                        clearance.distance()
                    ));
                }
            }
            let has_brute_force = is_small || sample * 3 / comparisons != (sample + 1) * 3 / comparisons;
            if has_brute_force && self.near_by_brute_force(&q, &clearance)? != expected {
                violations.push(format!("near pairs of a detector and of brute force differ at q = {q:?}"));
            }
            let is_claimed = |(a, b): &Pair| !minimum.filter.is_excluded(*a, *b);
            let mut near = expected.iter().map(|near| near.pair).filter(is_claimed);
            violations.extend(near.find_map(|faces| claims.violation(faces, norm, &q)));
        }
        Ok(violations)
    }

    /// Tests all pairs of triangles one by one, and returns the near ones.
    fn near_by_brute_force(&self, q: &[f64], clearance: &Clearance) -> Result<Vec<NearPair>, Error> {
        let positions = self.model.positions(q)?;
        let corners: Vec<_> =
            self.model.mesh().faces().iter().map(|face| face.map(|v| positions[v as usize])).collect();
        let minimum = self.minimum;
        let ignored = minimum.scope.filter.ignored();
        let mut near = Vec::new();
        for a in 0..corners.len() as u32 {
            for b in a + 1..corners.len() as u32 {
                let is_counted = minimum.filter.relation(a, b) == Relation::NonAdjacent
                    && !minimum.rings.contain(a, b)
                    && ignored.binary_search(&(a, b)).is_err();
                if is_counted {
                    let distance = distance_triangle_triangle(&corners[a as usize], &corners[b as usize]);
                    if distance < clearance.distance() {
                        near.push(NearPair { pair: (a, b), distance });
                    }
                }
            }
        }
        Ok(near)
    }
}
