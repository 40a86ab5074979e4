//! The pairs of triangles that count, and node pairs of which none counts.

use std::collections::{BTreeSet, HashMap};

use crate::certificates::{BUCKET, Certificates};
use crate::model::Model;
use crate::refusal::{Result, proof};
use crate::scope::Scope;

/// The largest number of pairs of triangles of two nodes that are tested one by one: those of two leaves.
const MAX_TESTED: u64 = (BUCKET as u64).pow(2);

/// Two simplices by their vertices: triangles, or edges, whose last vertex is repeated.
pub(crate) type Simplices = [[u32; 3]; 2];

/// The pairs of triangles that count.
pub(crate) struct CountedPairs<'a> {
    pub(crate) model: &'a Model,
    pub(crate) scope: &'a Scope,
    pub(crate) certificates: &'a Certificates,
    /// For each vertex the lowest vertex with the same position and modes; without welds the vertex itself.
    pub(crate) classes: Vec<u32>,
    /// The common properties of the triangles of each node.
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

impl<'a> CountedPairs<'a> {
    pub(crate) fn new(model: &'a Model, scope: &'a Scope, certificates: &'a Certificates) -> Self {
        let mut lowest = HashMap::new();
        let class = |i: u32| {
            if !scope.weld {
                return i;
            }
            let numbers =
                model.positions[i as usize].iter().chain((0..3).flat_map(|c| model.row(i as usize, c)));
            // Adding 0 makes -0 equal to 0.
            let key: Vec<u64> = numbers.map(|x| (x + 0.0).to_bits()).collect();
            *lowest.entry(key).or_insert(i)
        };
        let classes: Vec<u32> = (0..model.positions.len() as u32).map(class).collect();
        let of_triangle = |t: &u32| Common {
            group: scope.group(*t),
            vertices: model.faces[*t as usize].map(|i| classes[i as usize]).to_vec(),
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
        Self { model, scope, certificates, classes, nodes }
    }

    /// Returns pairs of simplices such that one pair meets if two triangles collide in a way that counts; no pairs for triangles
    /// that never count together, or are an exception.
    pub(crate) fn simplices(&self, a: u32, b: u32) -> Vec<Simplices> {
        let pair = [a.min(b), a.max(b)];
        let is_exception = self.scope.exceptions.binary_search(&pair).is_ok();
        if is_exception { Vec::new() } else { self.with_exceptions(a, b) }
    }

    /// Returns the pairs of simplices of [`Self::simplices`], also for exceptions.
    pub(crate) fn with_exceptions(&self, a: u32, b: u32) -> Vec<Simplices> {
        let scope = self.scope;
        let is_ignored = scope.ignored.binary_search(&[a.min(b), a.max(b)]).is_ok();
        if a == b || is_ignored || !scope.groups_count(scope.group(a), scope.group(b)) {
            return Vec::new();
        }
        let common = |[x, y]: [[u32; 3]; 2]| x.into_iter().filter(|i| y.contains(i)).collect::<BTreeSet<_>>();
        let faces = [a, b].map(|t| self.model.faces[t as usize]);
        let classes = faces.map(|face| face.map(|i| self.classes[i as usize]));
        let Some(class) = classes[0].into_iter().find(|i| classes[1].contains(i)) else { return vec![faces] };
        if !scope.one_vertex || common(classes).len() > 1 || common(faces).len() > 1 {
            return Vec::new();
        }
        // If two triangles with one common vertex have another common point, the edge opposite to the vertex in one of them
        // meets the other triangle (follow the ray from the vertex through that point to the first of the two edges).
        let opposite = |face: [u32; 3]| {
            let others: Vec<u32> = face.into_iter().filter(|i| self.classes[*i as usize] != class).collect();
            Some([*others.first()?, *others.last()?, *others.last()?])
        };
        // A face that consists of the common vertex alone has no opposite edge.
        let [Some(of_x), Some(of_y)] = faces.map(opposite) else { return Vec::new() };
        vec![[of_x, faces[1]], [faces[0], of_y]]
    }

    /// Checks that no pair of triangles of two nodes, or of one node, counts. Large nodes need one group each, which do not count
    /// together, or a vertex that all triangles have. Otherwise one byte of a proof could demand a test of all pairs of the mesh.
    pub(crate) fn check_uncounted(&self, [n, m]: [u32; 2]) -> Result<()> {
        let [x, y] = [n, m].map(|n| &self.nodes[n as usize]);
        // Without `one_vertex` no pair with a common vertex counts.
        let is_adjacent = !self.scope.one_vertex && x.vertices.iter().any(|class| y.vertices.contains(class));
        if is_adjacent || !self.scope.groups_count(x.group, y.group) {
            return Ok(());
        }
        let [x, y] = [n, m].map(|n| u64::from(self.certificates.nodes[n as usize].count));
        if x * y > MAX_TESTED {
            return proof(format!("nodes {n} and {m} have too many pairs of triangles to test each of them"));
        }
        let mut pairs = self.certificates.pairs([n, m]);
        match pairs.find(|[a, b]| !self.simplices(*a, *b).is_empty()) {
            Some([a, b]) => proof(format!("triangles {a} and {b} count")),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refusal::Refusal;
    use crate::scope::Groups;

    /// More triangles than two leaves can have.
    const TRIANGLES: u32 = 100;

    /// Checks a node with these triangles against itself.
    fn check(faces: Vec<[u32; 3]>, change: impl FnOnce(&mut Scope)) -> Result<()> {
        let certificates = Certificates::of_leaf(faces.len() as u32, 1.0);
        let vertices = faces.as_flattened().iter().max().map_or(0, |last| *last as usize + 1);
        let positions = (0..vertices).map(|i| [i as f64, 0.0, 0.0]).collect();
        let model = Model::new(positions, faces, vec![0.0; 3 * vertices], 1).unwrap();
        let mut scope = Scope::of_factor(vec![1.0], 1);
        change(&mut scope);
        CountedPairs::new(&model, &scope, &certificates).check_uncounted([0, 0])
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
        let is_refused = |result: Result<()>| {
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
            let certificates = Certificates::of_leaf(triangles, 1.0);
            let counted = CountedPairs::new(&model, &scope, &certificates);
            let counts = certificates.pairs([0, 0]).any(|[a, b]| !counted.simplices(a, b).is_empty());
            assert_eq!(counted.check_uncounted([0, 0]).is_err(), counts, "case {case}");
            let Common { group, vertices } = &counted.nodes[0];
            by_shortcut += usize::from(!counts && (group.is_some() || !vertices.is_empty()));
            refused += usize::from(counts && (group.is_some() || !vertices.is_empty()));
        }
        assert!(by_shortcut > 300 && refused > 100, "{by_shortcut} {refused}");
    }
}
