//! The pairs between two nodes alone.

use super::{Method, Query};
use crate::detect::buckets::CLUSTER;
use crate::hierarchy::Node;
use crate::{Certificates, Error, Pair};

impl Query<'_> {
    /// The colliding pairs between the triangles of two nodes without common triangles, or within one node
    /// (n = m), exceptions left out, found without certificates: for audits.
    pub(crate) fn discrete_between(&mut self, n: u32, m: u32, q: &[f64]) -> Result<&[Pair], Error> {
        debug_assert_ne!(self.asked.method, Method::Certified);
        let ends = self.begin([q], usize::MAX)?;
        let (asked, finder) = (&self.asked, &mut self.discrete);
        finder.boxes.update(&asked.hierarchy, &ends);
        finder.traverse(asked, (n, m), &ends);
        finder.outcome()?;
        let exceptions = asked.certificates.map_or(&[][..], Certificates::exceptions);
        let [x, y] = [n, m].map(|n| &asked.hierarchy.nodes()[n as usize]);
        let has = |node: &Node, t| {
            node.triangle_count as usize > CLUSTER || asked.hierarchy.triangles(node).contains(&t)
        };
        finder.found.retain(|pair| {
            let (i, j) = *pair;
            exceptions.binary_search(pair).is_err() && (has(x, i) && has(y, j) || has(x, j) && has(y, i))
        });
        finder.found.sort_unstable();
        Ok(&finder.found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Modes, ReducedModel, Scope, TriMesh};
    use glam::DVec3;

    /// A crumpled strip, of which nearly everything meets.
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
    fn pairs_of_nodes_of_every_size_are_theirs_alone() {
        let model = model();
        let query = |method| Query::without_certificates(&model, Scope::of(&model), method).unwrap();
        let all = query(Method::BruteForce).discrete(&[0.5]).unwrap().to_vec();
        let mut queries = [query(Method::Traditional), query(Method::BdTree)];
        let hierarchy = queries[0].asked.hierarchy.clone();
        let mut found = 0;
        for (n, x) in hierarchy.nodes().iter().enumerate() {
            for (m, y) in hierarchy.nodes().iter().enumerate().skip(n) {
                let end = |node: &Node| node.first_triangle + node.triangle_count;
                if n != m && x.first_triangle < end(y) && y.first_triangle < end(x) {
                    continue; // one is within the other
                }
                let has = |node, t| hierarchy.triangles(node).contains(&t);
                let mut expected = all.clone();
                expected.retain(|&(i, j)| has(x, i) && has(y, j) || has(x, j) && has(y, i));
                for query in &mut queries {
                    assert_eq!(query.discrete_between(n as u32, m as u32, &[0.5]).unwrap(), expected);
                }
                found += usize::from(!expected.is_empty());
            }
        }
        assert!(found > 100, "{found}");
    }
}
