//! Node pairs of which no pair of triangles counts.

use crate::certificates::{BUCKET, Certificates};
use crate::refusal::{Refusal, proof};
use crate::scope::CountedPairs;

/// The largest number of pairs of triangles of two nodes that are tested one by one: those of two leaves.
const MAX_TESTED: u64 = (BUCKET as u64).pow(2);

/// The common properties of the triangles of each node.
pub(crate) struct UncountedPairs<'a> {
    certificates: &'a Certificates,
    counted: &'a CountedPairs<'a>,
    nodes: Vec<Common>,
}

/// The properties that all triangles of a node have.
#[derive(Clone, Default)]
struct Common {
    /// Their group, if they have the same.
    group: Option<u32>,
    /// The classes of vertices that all of them contain.
    vertices: Vec<u32>,
}

impl Common {
    /// Returns the common properties of two sets of triangles.
    fn and(self, other: &Self) -> Self {
        let is_common = |class: &u32| other.vertices.contains(class);
        Self {
            group: self.group.filter(|_| self.group == other.group),
            vertices: self.vertices.into_iter().filter(is_common).collect(),
        }
    }
}

impl<'a> UncountedPairs<'a> {
    pub(crate) fn new(certificates: &'a Certificates, counted: &'a CountedPairs<'a>) -> Self {
        let of_triangle = |t: &u32| Common {
            group: counted.scope.groups.as_ref().map(|groups| groups.of_triangles[*t as usize]),
            vertices: counted.model.faces[*t as usize].map(|i| counted.classes[i as usize]).to_vec(),
        };
        let mut nodes = vec![Common::default(); certificates.nodes.len()];
        // Children come after their parents.
        for n in (0..nodes.len()).rev() {
            let children = certificates.nodes[n].children();
            let parts: Vec<Common> = match children.is_empty() {
                true => certificates.triangles(n as u32).iter().map(of_triangle).collect(),
                false => children.map(|child| nodes[child as usize].clone()).collect(),
            };
            nodes[n] = parts.into_iter().reduce(|a, b| a.and(&b)).unwrap_or_default();
        }
        Self { certificates, counted, nodes }
    }

    /// Checks that no pair of triangles of two nodes, or of one node, counts. Large nodes need one group each, which do not count
    /// together, or a vertex that all triangles have. Otherwise one byte of a proof could demand a test of all pairs of the mesh.
    pub(crate) fn check(&self, [n, m]: [u32; 2]) -> Result<(), Refusal> {
        let [x, y] = [n, m].map(|n| &self.nodes[n as usize]);
        let scope = self.counted.scope;
        let is_group_ignored = match (&scope.groups, x.group, y.group) {
            (Some(groups), Some(g), Some(h)) => !groups.count(g, h),
            _ => false,
        };
        // Without `one_vertex` no pair with a common vertex counts.
        let is_adjacent = !scope.one_vertex && x.vertices.iter().any(|class| y.vertices.contains(class));
        if is_group_ignored || is_adjacent {
            return Ok(());
        }
        let [x, y] = [n, m].map(|n| u64::from(self.certificates.nodes[n as usize].count));
        if x * y > MAX_TESTED {
            return proof(format!("nodes {n} and {m} have too many pairs of triangles to test each of them"));
        }
        let mut pairs = self.certificates.pairs([n, m]);
        match pairs.find(|[a, b]| !self.counted.simplices(*a, *b).is_empty()) {
            Some([a, b]) => proof(format!("triangles {a} and {b} count")),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::scope::{Groups, Scope};

    /// More triangles than two leaves can have.
    const TRIANGLES: u32 = 100;

    /// Checks a node with these triangles against itself.
    fn check(faces: Vec<[u32; 3]>, change: impl FnOnce(&mut Scope)) -> Result<(), Refusal> {
        let certificates = Certificates::of_leaf(faces.len() as u32, 1.0);
        let vertices = faces.as_flattened().iter().max().map_or(0, |last| *last as usize + 1);
        let positions = (0..vertices).map(|i| [i as f64, 0.0, 0.0]).collect();
        let model = Model::new(positions, faces, vec![0.0; 3 * vertices], 1).unwrap();
        let mut scope = Scope::of_factor(vec![1.0], 1);
        change(&mut scope);
        let counted = CountedPairs::new(&model, &scope);
        UncountedPairs::new(&certificates, &counted).check([0, 0])
    }

    /// Triangles around vertex 0.
    fn fan() -> Vec<[u32; 3]> {
        (0..TRIANGLES).map(|i| [i + 1, 0, i + 2]).collect()
    }

    /// Triangles without common vertices.
    fn apart(count: u32) -> Vec<[u32; 3]> {
        (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()
    }

    #[test]
    fn large_nodes_need_a_common_vertex_or_groups() {
        let groups = |of_triangles: Vec<u32>, listed: Vec<[u32; 2]>| {
            move |scope: &mut Scope| {
                scope.groups = Some(Groups { of_triangles, others_count: true, listed });
            }
        };
        let one = || vec![1; TRIANGLES as usize];
        let two = || (0..TRIANGLES).map(|t| t % 2).collect::<Vec<u32>>();
        assert_eq!(check(fan(), |_| ()), Ok(()));
        assert_eq!(check(fan(), groups(two(), vec![])), Ok(()));
        assert_eq!(check(apart(TRIANGLES), groups(one(), vec![[1, 1]])), Ok(()));
        let is_refused = |result: Result<(), Refusal>| {
            assert!(matches!(&result, Err(Refusal::Proof(line)) if line.contains("too many")), "{result:?}");
        };
        is_refused(check(apart(TRIANGLES), |_| ()));
        is_refused(check([fan(), vec![[1, 2, 3]]].concat(), |_| ()));
        is_refused(check(fan(), |scope| scope.one_vertex = true));
        is_refused(check(apart(TRIANGLES), groups(one(), vec![[0, 0]])));
        is_refused(check(apart(TRIANGLES), groups(two(), vec![[0, 1], [1, 1]])));
    }

    #[test]
    fn pairs_of_small_nodes_are_tested_one_by_one() {
        assert_eq!(check(apart(1), |_| ()), Ok(()));
        assert_eq!(check(vec![[0, 1, 2], [0, 3, 4], [1, 3, 5]], |_| ()), Ok(()));
        let counts = |a: u32, b: u32| Err(Refusal::Proof(format!("triangles {a} and {b} count")));
        assert_eq!(check(vec![[0, 1, 2], [0, 3, 4], [2, 5, 6]], |_| ()), counts(1, 2));
        assert_eq!(check(vec![[0, 1, 2], [0, 3, 4]], |scope| scope.one_vertex = true), counts(0, 1));
        assert_eq!(check(apart(64), |scope| scope.ignored = vec![[0, 1]]), counts(0, 2));
        assert_eq!(check(apart(2), |scope| scope.ignored = vec![[0, 1]]), Ok(()));
        assert_eq!(check(apart(2), |scope| scope.exceptions = vec![[0, 1]]), Ok(()));
    }

    /// Neither groups nor a common vertex stand for a pair that counts: tests of all pairs are the oracle.
    #[test]
    fn answers_are_those_of_all_pairs() {
        let mut state = 7_u64;
        let mut random = |n: u32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % u64::from(n)) as u32
        };
        let (mut by_shortcut, mut refused) = (0, 0);
        for case in 0..3000 {
            let triangles = 2 + random(4);
            // Few vertices, so that triangles often have one in common; in some cases all of them contain vertex 0.
            let face = |random: &mut dyn FnMut(u32) -> u32| {
                let first = if case % 3 == 0 { 0 } else { random(7) };
                [first, (first + 1 + random(3)) % 7, (first + 4 + random(3)) % 7]
            };
            let faces: Vec<[u32; 3]> = (0..triangles).map(|_| face(&mut random)).collect();
            let model = Model::new(vec![[0.0; 3]; 7], faces, vec![0.0; 21], 1).unwrap();
            let mut scope = Scope::of_factor(vec![1.0], 1);
            scope.one_vertex = random(2) == 0;
            let kinds = 1 + random(2);
            let of_triangles = (0..triangles).map(|_| random(kinds)).collect();
            let listed = [[0, 0], [0, 1], [1, 1]].into_iter().filter(|_| random(2) == 0).collect();
            scope.groups =
                (case % 2 == 0).then_some(Groups { of_triangles, others_count: random(2) == 0, listed });
            let counted = CountedPairs::new(&model, &scope);
            let certificates = Certificates::of_leaf(triangles, 1.0);
            let uncounted = UncountedPairs::new(&certificates, &counted);
            let counts = certificates.pairs([0, 0]).any(|[a, b]| !counted.simplices(a, b).is_empty());
            assert_eq!(uncounted.check([0, 0]).is_err(), counts, "case {case}");
            let Common { group, vertices } = &uncounted.nodes[0];
            by_shortcut += usize::from(!counts && (group.is_some() || !vertices.is_empty()));
            refused += usize::from(counts && (group.is_some() || !vertices.is_empty()));
        }
        assert!(by_shortcut > 300 && refused > 100, "{by_shortcut} {refused}");
    }
}
