//! `Query::discrete_between` and `near_between`: the colliding pairs of two nodes, or those nearer than a clearance, without
//! certificates, for audits.

use super::method::Method;
use super::query::Query;
use super::widened_motion::WidenedMotion;
use crate::detect::narrow_phase::ClearanceHits;
use crate::detect::vertex_motion::DeformedMotion;
use crate::hierarchy::{BUCKET_TRIANGLES, Hierarchy, Node, NodePair};
use crate::{Certificates, Clearance, Detector, Error, Pair};

impl Query {
    /// Returns the colliding pairs between the triangles of two nodes without common triangles, or within one node (n = m),
    /// without exceptions. They are found without certificates.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub(crate) fn discrete_between(&mut self, (n, m): NodePair, q: &[f64]) -> Result<&[Pair], Error> {
        debug_assert_ne!(self.context.method, Method::Certified);
        self.forget();
        let configuration = self.measure(q)?;
        self.norm = configuration.norm;
        let (context, narrow) = (&self.context, &mut self.discrete.narrow);
        let (detect, broad) = (&context.detect, &mut self.discrete.certified.broad);
        let motion = DeformedMotion::new([q], configuration.reach);
        let mut search = broad.search(detect, &motion, narrow, usize::MAX);
        search.traverse((n, m));
        search.end()?;
        let exceptions = context.certificates.as_ref().map_or(&[][..], Certificates::exceptions);
        let hierarchy = &detect.hierarchy;
        narrow
            .0
            .list
            .retain(|pair| is_between(hierarchy, (n, m), *pair) && exceptions.binary_search(pair).is_err());
        narrow.0.list.sort_unstable();
        Ok(&narrow.0.list)
    }

    /// Returns the pairs nearer than a clearance between the triangles of two nodes without common triangles, or within
    /// one node, including exceptions and pairs within the rings. They are found without certificates. The search ends
    /// after [`Detector::MAX_PAIRS`] pairs; then some may be missing.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub(crate) fn near_between(
        &mut self,
        (n, m): NodePair,
        q: &[f64],
        clearance: &Clearance,
    ) -> Result<Vec<Pair>, Error> {
        debug_assert_ne!(self.context.method, Method::Certified);
        self.forget();
        let configuration = self.measure(q)?;
        self.norm = configuration.norm;
        let (detect, broad) = (&self.context.detect, &mut self.discrete.certified.broad);
        let mut narrow = ClearanceHits { distance: clearance.distance(), ..ClearanceHits::default() };
        let deformed = DeformedMotion::new([q], configuration.reach);
        let motion = WidenedMotion::new(deformed, &detect.layout, clearance.distance());
        let mut search = broad.search(detect, &motion, &mut narrow, Detector::MAX_PAIRS);
        search.traverse((n, m));
        search.end()?;
        let found = narrow.hits.list.into_iter().map(|near| near.pair);
        let mut pairs: Vec<Pair> =
            found.filter(|pair| is_between(&detect.hierarchy, (n, m), *pair)).collect();
        pairs.sort_unstable();
        Ok(pairs)
    }
}

/// Whether one triangle of a pair is in one node and the other triangle in the other node. A node larger than a bucket contains all
/// found triangles of its side.
fn is_between(hierarchy: &Hierarchy, (n, m): NodePair, (a, b): Pair) -> bool {
    let [x, y] = [n, m].map(|n| &hierarchy.nodes()[n as usize]);
    let contains = |node: &Node, t| {
        node.triangle_count as usize > BUCKET_TRIANGLES || hierarchy.triangles(node).contains(&t)
    };
    contains(x, a) && contains(y, b) || contains(x, b) && contains(y, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificates::Scope;
    use crate::{Modes, ReducedModel, TriMesh};
    use glam::DVec3;

    /// Returns a crumpled strip, most of whose triangles meet others.
    fn model() -> ReducedModel {
        let mut state = 3_u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / 2.0_f64.powi(31)
        };
        let p: Vec<DVec3> =
            (0..302).map(|i| DVec3::new(0.01 * f64::from(i) + random(), random(), random())).collect();
        let faces = (0..300).map(|i| [i, i + 1, i + 2]).collect();
        let modes = Modes::new(1, p.iter().map(|x| *x * 0.1).collect()).unwrap();
        ReducedModel::new(TriMesh::new(p, faces).unwrap(), modes).unwrap()
    }

    #[test]
    fn pairs_between_two_nodes_are_the_colliding_pairs_of_their_triangles() {
        let model = model();
        let query = |method| Query::without_certificates(&model, Scope::of(&model), method).unwrap();
        let all = query(Method::BruteForce).discrete(&[0.5]).unwrap().to_vec();
        let mut queries = [query(Method::Traditional), query(Method::BdTree)];
        let hierarchy = queries[0].context.detect.hierarchy.clone();
        let mut found = 0;
        for (n, x) in hierarchy.nodes().iter().enumerate() {
            for (m, y) in hierarchy.nodes().iter().enumerate().skip(n) {
                let end = |node: &Node| node.first_triangle + node.triangle_count;
                if n != m && x.first_triangle < end(y) && y.first_triangle < end(x) {
                    continue; // one node is within the other
                }
                let has = |node, t| hierarchy.triangles(node).contains(&t);
                let mut expected = all.clone();
                expected.retain(|&(i, j)| has(x, i) && has(y, j) || has(x, j) && has(y, i));
                for query in &mut queries {
                    assert_eq!(query.discrete_between((n as u32, m as u32), &[0.5]).unwrap(), expected);
                }
                found += usize::from(!expected.is_empty());
            }
        }
        assert!(found > 100, "{found}");
        let clearance = Clearance::new(0.05).unwrap();
        let near = queries[0].within(&[0.5], &clearance).unwrap();
        let mut near: Vec<Pair> = near.iter().map(|near| near.pair).collect();
        near.sort_unstable();
        assert!(near.len() > all.len());
        assert_eq!(queries[0].near_between((0, 0), &[0.5], &clearance).unwrap(), near);
    }
}
