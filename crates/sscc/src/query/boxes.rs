//! Positions and boxes at the current q, each computed at most once for a query.

use std::sync::Arc;

use glam::DVec3;

use super::Method;
use super::bd_tree::BdTree;
use crate::ReducedModel;
use crate::hierarchy::Hierarchy;

/// An axis-aligned box: lower and upper corner.
pub(super) type Aabb = (DVec3, DVec3);

/// Whether two boxes have no point in common. NaN counts as overlap.
#[inline]
pub(super) fn disjoint(a: &Aabb, b: &Aabb) -> bool {
    (a.0.cmpgt(b.1) | b.0.cmpgt(a.1)).any()
}

/// Leaves, and nodes of at most this many triangles, get tight boxes, from their vertices, when they are first met; larger ones
/// a BD-tree box. BD boxes of small nodes cost as much as moving their vertices, and grow with every mode
/// whether modes cancel or not: with them alone, queries of the spring at large q
/// (30% of its half diagonal) made 783,000 box tests instead of 351,000.
pub(super) const TIGHT_TRIANGLES: u32 = 64;

/// Vertex positions, triangle boxes and node boxes. Lazily (BD-tree) each entry carries the number of the query
/// it was computed for; the traditional method computes all of them first.
#[derive(Clone)]
pub(super) struct Boxes {
    bd_tree: Option<Arc<BdTree>>,
    query: u32,
    margin: f64,
    positions: Vec<DVec3>,
    position_query: Vec<u32>,
    triangles: Vec<Aabb>,
    nodes: Vec<Aabb>,
    node_query: Vec<u32>,
}

impl Boxes {
    pub(super) fn new(model: &ReducedModel, hierarchy: &Hierarchy, method: Method) -> Self {
        let (vertices, triangles, nodes) = match method {
            Method::BruteForce => (0, 0, 0),
            _ => (model.mesh().rest_positions().len(), model.mesh().faces().len(), hierarchy.nodes().len()),
        };
        let lazy = matches!(method, Method::Certified | Method::BdTree);
        Self {
            bd_tree: lazy.then(|| Arc::new(BdTree::new(model, hierarchy, TIGHT_TRIANGLES))),
            query: 0,
            margin: 0.0,
            positions: vec![DVec3::ZERO; vertices],
            position_query: vec![0; vertices],
            triangles: vec![(DVec3::ZERO, DVec3::ZERO); triangles],
            nodes: vec![(DVec3::ZERO, DVec3::ZERO); nodes],
            node_query: vec![0; nodes],
        }
    }

    /// The tree of a lazy method: continuous queries use the same.
    pub(super) fn bd_tree(&self) -> Option<Arc<BdTree>> {
        self.bd_tree.clone()
    }

    /// Starts a new q: forgets all boxes, or (traditional) refits all of them.
    pub(super) fn update(&mut self, model: &ReducedModel, hierarchy: &Hierarchy, q: &[f64], reach: f64) {
        if self.bd_tree.is_some() {
            self.margin = margin(reach, q.len());
            self.query = match self.query.checked_add(1) {
                Some(next) => next,
                None => {
                    self.position_query.fill(0);
                    self.node_query.fill(0);
                    1
                }
            };
            return;
        }
        for (v, x) in self.positions.iter_mut().enumerate() {
            *x = model.position(v as u32, q);
        }
        for (corners, aabb) in model.mesh().faces().iter().zip(&mut self.triangles) {
            *aabb = triangle_box(corners.map(|v| self.positions[v as usize]));
        }
        for n in (0..self.nodes.len()).rev() {
            let node = &hierarchy.nodes()[n];
            self.nodes[n] = if node.is_leaf() {
                union(hierarchy.triangles(node).iter().map(|&t| self.triangles[t as usize]))
            } else {
                let children = node.children().start as usize..node.children().end as usize;
                union(self.nodes[children].iter().copied())
            };
        }
    }

    /// The box of a node at the current q. After that the triangles of a leaf are current, too.
    #[inline]
    pub(super) fn node(&mut self, model: &ReducedModel, hierarchy: &Hierarchy, n: u32, q: &[f64]) -> Aabb {
        if let Some(bd_tree) = &self.bd_tree
            && self.node_query[n as usize] != self.query
        {
            match bd_tree.at(n, q, self.margin) {
                Some(aabb) => {
                    self.nodes[n as usize] = aabb;
                    self.node_query[n as usize] = self.query;
                }
                None => self.refit(model, hierarchy, n, q),
            }
        }
        self.nodes[n as usize]
    }

    /// Tight boxes of a node and all below it (small: its depth is bounded by its size).
    fn refit(&mut self, model: &ReducedModel, hierarchy: &Hierarchy, n: u32, q: &[f64]) {
        let node = &hierarchy.nodes()[n as usize];
        let mut aabb = union(std::iter::empty());
        if node.is_leaf() {
            for &t in hierarchy.triangles(node) {
                let corners = self.moved_corners(model, model.mesh().faces()[t as usize], q);
                self.triangles[t as usize] = triangle_box(corners);
                aabb = union([aabb, self.triangles[t as usize]].into_iter());
            }
        } else {
            for child in node.children() {
                self.refit(model, hierarchy, child, q);
                aabb = union([aabb, self.nodes[child as usize]].into_iter());
            }
        }
        self.nodes[n as usize] = aabb;
        self.node_query[n as usize] = self.query;
    }

    /// The box of a triangle of a leaf whose box is current.
    #[inline]
    pub(super) fn triangle(&self, t: u32) -> &Aabb {
        &self.triangles[t as usize]
    }

    /// The corners of any triangle at the current q.
    #[inline]
    pub(super) fn moved_corners(&mut self, model: &ReducedModel, face: [u32; 3], q: &[f64]) -> [DVec3; 3] {
        face.map(|v| self.position(model, v, q))
    }

    #[inline]
    fn position(&mut self, model: &ReducedModel, v: u32, q: &[f64]) -> DVec3 {
        let i = v as usize;
        if self.bd_tree.is_some() && self.position_query[i] != self.query {
            self.positions[i] = model.position(v, q);
            self.position_query[i] = self.query;
        }
        self.positions[i]
    }

    /// The corners of a triangle of such a leaf.
    #[inline]
    pub(super) fn corners(&self, face: [u32; 3]) -> [DVec3; 3] {
        face.map(|v| self.positions[v as usize])
    }
}

/// What rounding can add to a BD-tree box and to positions: well above the 2 (r + 1) roundings of each.
pub(super) fn margin(reach: f64, rank: usize) -> f64 {
    reach * ((4 * rank + 64) as f64 * f64::EPSILON) + f64::MIN_POSITIVE
}

/// The box of three points.
pub(super) fn triangle_box([a, b, c]: [DVec3; 3]) -> Aabb {
    (a.min(b).min(c), a.max(b).max(c))
}

fn union(boxes: impl Iterator<Item = Aabb>) -> Aabb {
    boxes.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)))
}
