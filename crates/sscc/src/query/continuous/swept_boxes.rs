//! Positions at both ends of a motion, and the boxes of what lies between.

use std::sync::Arc;

use glam::DVec3;

use super::super::Method;
use super::super::aabb::Aabb;
use super::super::bd_tree::BdTree;
use super::super::boxes::margin;
use super::Ends;
use crate::hierarchy::Hierarchy;
use crate::{MovingTriangle, ReducedModel};

/// As the boxes of discrete queries, each around both ends, hence around the straight way between them. Lazily (BD-tree)
/// each entry carries the number of the query it was computed for; the traditional method computes all of them first.
#[derive(Clone)]
pub(super) struct SweptBoxes {
    bd_tree: Option<Arc<BdTree>>,
    query: u32,
    margin: f64,
    /// At both ends.
    positions: Vec<[DVec3; 2]>,
    position_query: Vec<u32>,
    triangles: Vec<Aabb>,
    nodes: Vec<Aabb>,
    node_query: Vec<u32>,
}

impl SweptBoxes {
    pub(super) fn new(
        model: &ReducedModel,
        hierarchy: &Hierarchy,
        method: Method,
        bd_tree: Option<Arc<BdTree>>,
    ) -> Self {
        let (triangles, nodes) = match method {
            Method::BruteForce => (0, 0),
            _ => (model.mesh().faces().len(), hierarchy.nodes().len()),
        };
        let vertices = model.mesh().rest_positions().len();
        Self {
            bd_tree,
            query: 0,
            margin: 0.0,
            positions: vec![[DVec3::ZERO; 2]; vertices],
            position_query: vec![0; vertices],
            triangles: vec![(DVec3::ZERO, DVec3::ZERO); triangles],
            nodes: vec![(DVec3::ZERO, DVec3::ZERO); nodes],
            node_query: vec![0; nodes],
        }
    }

    /// Starts a new motion: forgets all boxes, or (traditional) refits all of them.
    pub(super) fn update(&mut self, model: &ReducedModel, hierarchy: &Hierarchy, q: Ends<'_>, reach: f64) {
        if self.bd_tree.is_some() {
            self.margin = margin(reach, model.rank());
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
        self.move_all(model, q);
        for (corners, aabb) in model.mesh().faces().iter().zip(&mut self.triangles) {
            *aabb = around(corners.map(|v| self.positions[v as usize]));
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

    /// Moves all vertices.
    pub(super) fn move_all(&mut self, model: &ReducedModel, q: Ends<'_>) {
        for (v, x) in self.positions.iter_mut().enumerate() {
            *x = q.map(|q| model.position(v as u32, q));
        }
    }

    /// Makes a vertex current.
    #[inline]
    pub(super) fn move_vertex(&mut self, model: &ReducedModel, v: u32, q: Ends<'_>) {
        let i = v as usize;
        if self.bd_tree.is_some() && self.position_query[i] != self.query {
            self.positions[i] = q.map(|q| model.position(v, q));
            self.position_query[i] = self.query;
        }
    }

    /// The box of a node. After that the triangles and vertices of a leaf are current, too.
    #[inline]
    pub(super) fn node(&mut self, model: &ReducedModel, hierarchy: &Hierarchy, n: u32, q: Ends<'_>) -> Aabb {
        if let Some(bd_tree) = &self.bd_tree
            && self.node_query[n as usize] != self.query
        {
            match q.map(|q| bd_tree.at(n, q, self.margin)) {
                [Some(a), Some(b)] => {
                    self.nodes[n as usize] = union([a, b].into_iter());
                    self.node_query[n as usize] = self.query;
                }
                _ => self.refit(model, hierarchy, n, q),
            }
        }
        self.nodes[n as usize]
    }

    /// Tight boxes of a node and all below it (small: its depth is bounded by its size).
    fn refit(&mut self, model: &ReducedModel, hierarchy: &Hierarchy, n: u32, q: Ends<'_>) {
        let node = &hierarchy.nodes()[n as usize];
        let mut aabb = union(std::iter::empty());
        if node.is_leaf() {
            for &t in hierarchy.triangles(node) {
                let face = model.mesh().faces()[t as usize];
                face.iter().for_each(|&v| self.move_vertex(model, v, q));
                self.triangles[t as usize] = around(face.map(|v| self.positions[v as usize]));
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

    /// The motion of three current vertices.
    #[inline]
    pub(super) fn corners(&self, vertices: [u32; 3]) -> MovingTriangle {
        let ends = vertices.map(|v| self.positions[v as usize]);
        MovingTriangle { t0: ends.map(|x| x[0]), t1: ends.map(|x| x[1]) }
    }
}

/// The box of three corners at both ends.
#[inline]
fn around(corners: [[DVec3; 2]; 3]) -> Aabb {
    let [a, b, c] = corners.map(|[x, y]| (x.min(y), x.max(y)));
    (a.0.min(b.0).min(c.0), a.1.max(b.1).max(c.1))
}

fn union(boxes: impl Iterator<Item = Aabb>) -> Aabb {
    boxes.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)))
}
