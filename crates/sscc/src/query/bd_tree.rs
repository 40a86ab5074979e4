//! The BD-tree (James and Pai 2004): boxes that follow q at a cost of O(r) each, without touching vertices.

use glam::DVec3;
use rayon::prelude::*;

use super::aabb::Aabb;
use crate::ReducedModel;
use crate::hierarchy::{Hierarchy, Node, bounding_box};

/// For the nodes that have one, how their box moves and grows with q:
/// `centre(q) = c + sum_k mean_k q_k`, `half(q) = h + sum_k growth_k |q_k|`.
#[derive(Default)]
pub(super) struct BdTree {
    rank: usize,
    /// For each node its place in the lists below, or `u32::MAX`.
    places: Vec<u32>,
    /// `(c, h)`
    rest: Vec<(DVec3, DVec3)>,
    /// `[place * rank + mode] = (mean, growth)`
    rates: Vec<(DVec3, DVec3)>,
}

impl BdTree {
    /// For the root and all other nodes that are wanted.
    pub(super) fn new(
        model: &ReducedModel,
        hierarchy: &Hierarchy,
        is_wanted: impl Fn(u32) -> bool + Sync,
    ) -> Self {
        let (mesh, modes) = (model.mesh(), model.modes());
        let rank = modes.rank();
        let node_rates = |node: &Node| {
            let vertices = hierarchy.vertices(node, mesh.faces());
            let (lower, upper) = bounding_box(vertices.iter().map(|&v| mesh.rest_positions()[v as usize]));
            let centre = lower * 0.5 + upper * 0.5;
            let rest = (centre, (upper - centre).max(centre - lower));
            let mut rates = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); rank];
            for &v in &vertices {
                for ((least, greatest), u) in rates.iter_mut().zip(modes.of_vertex(v)) {
                    *least = least.min(*u);
                    *greatest = greatest.max(*u);
                }
            }
            for rate in &mut rates {
                let mean = rate.0 * 0.5 + rate.1 * 0.5;
                *rate = (mean, (rate.1 - mean).max(mean - rate.0));
            }
            (rest, rates)
        };
        let has = |n: usize| n == 0 || is_wanted(n as u32);
        let nodes = hierarchy.nodes().par_iter().enumerate();
        let all: Vec<_> = nodes.filter(|(n, _)| has(*n)).map(|(_, node)| node_rates(node)).collect();
        let mut next = 0..;
        let place = |n| if has(n) { next.next().unwrap_or(u32::MAX) } else { u32::MAX };
        let places = (0..hierarchy.nodes().len()).map(place).collect();
        let rest = all.iter().map(|(rest, _)| *rest).collect();
        let rates = all.into_iter().flat_map(|(_, rates)| rates).collect();
        Self { rank, places, rest, rates }
    }

    /// A box that contains the computed positions of all vertices of a node at each q, hence all between them, or none where the
    /// node has none. `margin` covers rounding, along each axis: at least `(4 r + 64)` units of the last place of the shape's reach.
    pub(super) fn at<const E: usize>(&self, node: u32, q: [&[f64]; E], margin: DVec3) -> Option<Aabb> {
        let place = self.places[node as usize] as usize;
        (place < self.rest.len()).then(|| self.at_place(place, q, margin))
    }

    /// The same for the whole shape.
    pub(super) fn root<const E: usize>(&self, q: [&[f64]; E], margin: DVec3) -> Aabb {
        self.at_place(0, q, margin)
    }

    fn at_place<const E: usize>(&self, place: usize, q: [&[f64]; E], margin: DVec3) -> Aabb {
        let mut boxes = [self.rest[place]; E];
        let rates = &self.rates[place * self.rank..][..self.rank];
        let q = q.map(|q| &q[..rates.len()]);
        for (k, (mean, growth)) in rates.iter().enumerate() {
            for ((centre, half), q) in boxes.iter_mut().zip(q) {
                *centre += *mean * q[k];
                *half += *growth * q[k].abs();
            }
        }
        let ends = boxes.map(|(centre, half)| (centre - (half + margin), centre + (half + margin)));
        ends.into_iter().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Modes, TriMesh};

    /// Fixed pseudo-random numbers in [-1, 1).
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 33) as f64 / 2.0_f64.powi(30) - 1.0
    }

    /// A wavy strip far from the origin, with modes of very different sizes.
    fn model(rank: usize, state: &mut u64) -> ReducedModel {
        let positions: Vec<DVec3> =
            (0..202).map(|i| DVec3::new(1e3 + (i / 2) as f64, (i % 2) as f64, random(state))).collect();
        let faces = (0..200).map(|i| [i, i + 1, i + 2]).collect();
        let displacements = (0..202 * rank)
            .map(|i| {
                DVec3::new(random(state), random(state), random(state)) * 10.0_f64.powi(i as i32 % 7 - 3)
            })
            .collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        ReducedModel::new(mesh, Modes::new(rank, displacements).unwrap()).unwrap()
    }

    #[test]
    fn boxes_contain_all_computed_positions() {
        let mut state = 5;
        for rank in [1, 2, 7, 30] {
            let model = model(rank, &mut state);
            let hierarchy = Hierarchy::build(&model, model.metric());
            let tree = BdTree::new(&model, &hierarchy, |n| !hierarchy.nodes()[n as usize].is_leaf());
            let mut checked = 0;
            for case in 0..200 {
                let size = 10.0_f64.powi(case % 25 - 12);
                let q: Vec<f64> = (0..rank).map(|_| random(&mut state) * size).collect();
                let reach = model.check_coordinates(&q).unwrap();
                for (n, node) in hierarchy.nodes().iter().enumerate() {
                    let Some((lower, upper)) =
                        tree.at(n as u32, [&q], DVec3::splat(super::super::boxes::margin(reach, rank)))
                    else {
                        assert!(n != 0 && node.is_leaf());
                        continue;
                    };
                    for v in hierarchy.vertices(node, model.mesh().faces()) {
                        let x = model.position(v, &q);
                        assert!(x.cmpge(lower).all() && x.cmple(upper).all(), "rank {rank}, case {case}");
                        checked += 1;
                    }
                }
            }
            assert!(checked > 10_000);
        }
    }
}
