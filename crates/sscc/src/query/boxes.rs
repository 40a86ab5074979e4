//! Positions and boxes at the current q, each computed at most once for a query.

use std::sync::Arc;

use glam::{DVec3, Vec4};

use super::Method;
use super::bd_tree::BdTree;
use super::clusters::{CLUSTER, Clusters};
use super::frame::Frame;
use super::pack::{Box32, Pack};
use crate::ReducedModel;
use crate::hierarchy::Hierarchy;
use crate::pairs::PairFilter;

/// Vertex positions, exact, and boxes in the single precision of a [`Frame`].
///
/// Lazily each entry carries the number of the query it was computed for. Clusters then get tight boxes, from their
/// vertices, when they are first met, larger nodes a BD-tree box. BD boxes of small nodes cost as much as moving their
/// vertices, and grow with every mode whether modes cancel or not: with them alone, queries of the spring at large q
/// (30% of its half diagonal) made more than twice as many box tests. The traditional method computes everything first.
#[derive(Clone)]
pub(super) struct Boxes {
    pub(super) clusters: Arc<Clusters>,
    bd_tree: Arc<BdTree>,
    is_lazy: bool,
    query: u32,
    margin: f64,
    frame: Frame,
    positions: Vec<DVec3>,
    /// The positions in the frame.
    mapped: Vec<Vec4>,
    position_query: Vec<u32>,
    /// The box of each node that is a cluster or larger.
    nodes: Vec<Box32>,
    /// For each node its children, for a cluster its blocks.
    packs: Vec<Pack>,
    /// The query for which a node's pack is current.
    open_query: Vec<u32>,
    /// The triangles of each block.
    blocks: Vec<Pack>,
}

impl Boxes {
    pub(super) fn new(
        model: &ReducedModel,
        hierarchy: &Hierarchy,
        filter: &PairFilter,
        method: Method,
    ) -> Self {
        let is_lazy = matches!(method, Method::Certified | Method::BdTree);
        let tight = if is_lazy { CLUSTER as u32 } else { u32::MAX };
        let clusters = Clusters::new(model.mesh(), hierarchy, filter);
        let (vertices, nodes) = (model.mesh().rest_positions().len(), hierarchy.nodes().len());
        Self {
            bd_tree: Arc::new(BdTree::new(model, hierarchy, tight)),
            is_lazy,
            query: 0,
            margin: 0.0,
            frame: Frame::of((DVec3::ZERO, DVec3::ZERO)),
            positions: vec![DVec3::ZERO; vertices],
            mapped: vec![Vec4::ZERO; vertices],
            position_query: vec![0; vertices],
            nodes: vec![Box32::EMPTY; nodes],
            packs: vec![Pack::EMPTY; nodes],
            open_query: vec![0; nodes],
            blocks: vec![Pack::EMPTY; clusters.block_count()],
            clusters: Arc::new(clusters),
        }
    }

    /// The tree of a lazy method: continuous queries use the same.
    pub(super) fn bd_tree(&self) -> Option<Arc<BdTree>> {
        self.is_lazy.then(|| Arc::clone(&self.bd_tree))
    }

    /// Starts a new q: forgets all boxes, or (traditional) refits all of them.
    pub(super) fn update(&mut self, model: &ReducedModel, hierarchy: &Hierarchy, q: &[f64], reach: f64) {
        self.margin = margin(reach, q.len());
        self.frame = Frame::of(self.bd_tree.root(q, self.margin));
        self.query = match self.query.checked_add(1) {
            Some(next) => next,
            None => {
                self.position_query.fill(0);
                self.open_query.fill(0);
                1
            }
        };
        if self.is_lazy {
            return;
        }
        self.position_query.fill(self.query);
        // Four vertices side by side were no faster: this waits for memory.
        for (v, (x, mapped)) in self.positions.iter_mut().zip(&mut self.mapped).enumerate() {
            *x = model.position(v as u32, q);
            *mapped = self.frame.map(*x);
        }
        for cluster in 0..self.clusters.count() as u32 {
            self.refit_cluster(cluster);
        }
        for n in (0..hierarchy.nodes().len() as u32).rev() {
            if self.clusters.of_node(n).is_none() {
                self.nodes[n as usize] = self.gather(hierarchy, n);
            }
        }
    }

    /// The box of a node that has been enclosed, or whose parent has been opened.
    #[inline]
    pub(super) fn node(&self, n: u32) -> &Box32 {
        &self.nodes[n as usize]
    }

    /// The children of an open node, or the blocks of an open cluster.
    #[inline]
    pub(super) fn pack(&self, n: u32) -> &Pack {
        &self.packs[n as usize]
    }

    /// The triangles of a block of an open cluster.
    #[inline]
    pub(super) fn block(&self, block: usize) -> &Pack {
        &self.blocks[block]
    }

    /// Makes all boxes within a cluster current, or the boxes of the children of a larger node.
    #[inline]
    pub(super) fn open(&mut self, model: &ReducedModel, hierarchy: &Hierarchy, n: u32, q: &[f64]) {
        if self.open_query[n as usize] != self.query {
            self.open_now(model, hierarchy, n, q);
        }
    }

    fn open_now(&mut self, model: &ReducedModel, hierarchy: &Hierarchy, n: u32, q: &[f64]) {
        if let Some(cluster) = self.clusters.of_node(n) {
            let clusters = Arc::clone(&self.clusters);
            clusters.vertices(cluster).iter().for_each(|&v| _ = self.position(model, v, q));
            self.refit_cluster(cluster);
        } else {
            hierarchy.nodes()[n as usize]
                .children()
                .for_each(|child| self.enclose(model, hierarchy, child, q));
            self.gather(hierarchy, n);
        }
    }

    /// Makes the box of a node current that is a cluster or larger.
    pub(super) fn enclose(&mut self, model: &ReducedModel, hierarchy: &Hierarchy, n: u32, q: &[f64]) {
        if !self.is_lazy {
            return;
        }
        if self.clusters.of_node(n).is_some() {
            self.open(model, hierarchy, n, q);
        } else if let Some((lower, upper)) = self.bd_tree.at(n, q, self.margin) {
            self.nodes[n as usize] = Box32 { lower: self.frame.map(lower), upper: self.frame.map(upper) };
        }
    }

    /// All boxes of a cluster whose vertices have been moved.
    fn refit_cluster(&mut self, cluster: u32) {
        let n = self.clusters.node(cluster) as usize;
        let mut whole = Box32::EMPTY;
        for (lane, block) in self.clusters.blocks(cluster).enumerate() {
            let mut union = Box32::EMPTY;
            for (i, corners) in self.clusters.corners()[self.clusters.places(block)].iter().enumerate() {
                let triangle = Box32::of(corners.map(|v| self.mapped[v as usize]));
                self.blocks[block].set(i, &triangle);
                union = union.union(&triangle);
            }
            self.packs[n].set(lane, &union);
            whole = whole.union(&union);
        }
        self.nodes[n] = whole;
        self.open_query[n] = self.query;
    }

    /// Packs the boxes of a node's children, which are current, and gives their union.
    fn gather(&mut self, hierarchy: &Hierarchy, n: u32) -> Box32 {
        let mut union = Box32::EMPTY;
        for (lane, child) in hierarchy.nodes()[n as usize].children().enumerate() {
            let child = &self.nodes[child as usize];
            self.packs[n as usize].set(lane, child);
            union = union.union(child);
        }
        self.open_query[n as usize] = self.query;
        union
    }

    /// The corners of any triangle at the current q.
    pub(super) fn moved_corners(&mut self, model: &ReducedModel, face: [u32; 3], q: &[f64]) -> [DVec3; 3] {
        face.map(|v| self.position(model, v, q))
    }

    #[inline]
    fn position(&mut self, model: &ReducedModel, v: u32, q: &[f64]) -> DVec3 {
        let i = v as usize;
        if self.position_query[i] != self.query {
            self.positions[i] = model.position(v, q);
            self.mapped[i] = self.frame.map(self.positions[i]);
            self.position_query[i] = self.query;
        }
        self.positions[i]
    }

    /// The corners of a triangle of an open cluster, by its place there.
    #[inline]
    pub(super) fn corners(&self, place: usize) -> [DVec3; 3] {
        self.clusters.corners()[place].map(|v| self.positions[v as usize])
    }
}

/// What rounding can add to a BD-tree box and to positions: well above the 2 (r + 1) roundings of each.
pub(super) fn margin(reach: f64, rank: usize) -> f64 {
    reach * ((4 * rank + 64) as f64 * f64::EPSILON) + f64::MIN_POSITIVE
}
