//! The BD-tree (James and Pai 2004): boxes that follow q at a cost of O(r) each, without touching vertices.

use glam::DVec3;
use rayon::prelude::*;

use super::boxes::TIGHT_TRIANGLES;
use crate::ReducedModel;
use crate::hierarchy::{Hierarchy, Node, bounding_box};

/// For each node of more than [`TIGHT_TRIANGLES`] triangles, how its box moves and grows with q:
/// `centre(q) = c + sum_k mean_k q_k`, `half(q) = h + sum_k growth_k |q_k|`.
pub(super) struct BdTree {
    rank: usize,
    /// For each node its place in the lists below, or `u32::MAX` for a small one.
    places: Vec<u32>,
    /// `(c, h)`
    rest: Vec<(DVec3, DVec3)>,
    /// `[place * rank + mode] = (mean, growth)`
    rates: Vec<(DVec3, DVec3)>,
}

impl BdTree {
    pub(super) fn new(model: &ReducedModel, hierarchy: &Hierarchy) -> Self {
        let (mesh, modes) = (model.mesh(), model.modes());
        let rank = modes.rank();
        let node_rates = |node| {
            let triangles: &[u32] = hierarchy.triangles(node);
            let mut vertices: Vec<u32> = triangles.iter().flat_map(|&t| mesh.faces()[t as usize]).collect();
            vertices.sort_unstable();
            vertices.dedup();
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
        let large = |node: &&Node| node.triangle_count > TIGHT_TRIANGLES;
        let all: Vec<_> = hierarchy.nodes().par_iter().filter(large).map(node_rates).collect();
        let mut next = 0..;
        let place = |node| if large(&node) { next.next().unwrap_or(u32::MAX) } else { u32::MAX };
        let places = hierarchy.nodes().iter().map(place).collect();
        let rest = all.iter().map(|(rest, _)| *rest).collect();
        let rates = all.into_iter().flat_map(|(_, rates)| rates).collect();
        Self { rank, places, rest, rates }
    }

    /// A box that contains the computed positions of all vertices of a node at q, or none for a small node.
    /// `margin` covers rounding: at least `(4 r + 64)` units of the last place of the shape's reach.
    pub(super) fn at(&self, node: u32, q: &[f64], margin: f64) -> Option<(DVec3, DVec3)> {
        let place = self.places[node as usize] as usize;
        let (mut centre, mut half) = *self.rest.get(place)?;
        for ((mean, growth), &x) in self.rates[place * self.rank..][..self.rank].iter().zip(q) {
            centre += *mean * x;
            half += *growth * x.abs();
        }
        half += DVec3::splat(margin);
        Some((centre - half, centre + half))
    }
}
