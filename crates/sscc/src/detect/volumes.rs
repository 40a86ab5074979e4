//! Positions and boxes at the current q, or from one q to another, each computed at most once for a query.

use std::sync::Arc;

use glam::{DVec3, Vec4};

use crate::detect::packet::{Box32, Pack};
use crate::detect::positions::Positions;
use crate::detect::quantization::Motion;
use crate::detect::separating_axis::are_apart;
use crate::detect::tables::Tables;
use crate::geometry::Aabb;
use crate::hierarchy::Hierarchy;
use crate::query::context::{Asked, Ends};

/// Boxes in the single precision of a [`Frame`](crate::detect::frame::Frame), and exact positions of vertices where they are
/// asked for. Where there are two ends, a box goes around both, hence around the straight way between them.
///
/// Each entry carries the number of the query it was computed for. Lazily, nodes down to clusters have BD-tree boxes; a
/// cluster gets tight ones, from its vertices, when it is opened. BD boxes of still smaller nodes cost as much as
/// moving their vertices, and grow with every mode whether modes cancel or not: with them alone, queries of the spring
/// at large q (30% of its half diagonal) made more than twice as many box tests. The traditional method computes
/// everything first.
#[derive(Clone)]
pub(crate) struct Boxes<const E: usize> {
    pub(crate) tables: Arc<Tables>,
    is_lazy: bool,
    query: u32,
    margin: f64,
    positions: Positions<E>,
    /// Whether boxes of triangles are made from positions in single precision, and how vertices move then.
    is_rough: bool,
    motion: Motion<E>,
    rough: Vec<[Vec4; E]>,
    /// How far along an axis corners in the frame may be from the exact ones; infinite where that is not known.
    wrong_by: f32,
    /// The box of each node that is a cluster or larger.
    nodes: Vec<Box32>,
    node_query: Vec<u32>,
    /// The children of each node larger than a cluster.
    packs: Vec<Pack>,
    pack_query: Vec<u32>,
    /// The blocks of each cluster.
    clusters: Vec<Pack>,
    cluster_query: Vec<u32>,
    /// The triangles of each block.
    blocks: Vec<Pack>,
}

impl<const E: usize> Boxes<E> {
    pub(crate) fn new(tables: &Arc<Tables>, is_lazy: bool) -> Self {
        let (nodes, clusters) = (tables.clusters.node_count(), tables.clusters.count());
        Self {
            tables: Arc::clone(tables),
            is_lazy,
            query: 0,
            margin: 0.0,
            positions: Positions::new(tables.vertices.count()),
            is_rough: false,
            motion: Motion::default(),
            rough: tables.rough.memory(),
            wrong_by: f32::INFINITY,
            nodes: vec![Box32::EMPTY; nodes],
            node_query: vec![0; nodes],
            packs: vec![Pack::EMPTY; nodes],
            pack_query: vec![0; nodes],
            clusters: vec![Pack::EMPTY; clusters],
            cluster_query: vec![0; clusters],
            blocks: vec![Pack::EMPTY; tables.clusters.block_count()],
        }
    }

    /// Starts a new query: forgets all boxes, or (traditional) refits all of them.
    pub(crate) fn update(&mut self, hierarchy: &Hierarchy, ends: &Ends<'_, E>) {
        debug_assert!(ends.ball.is_none() || E == 2 && self.is_lazy, "only lazy boxes know balls");
        let tables = Arc::clone(&self.tables);
        self.margin = margin(ends.reach, ends.q[0].len());
        self.query = self.query.wrapping_add(1);
        if self.query == 0 {
            [&mut self.node_query, &mut self.pack_query, &mut self.cluster_query]
                .into_iter()
                .for_each(|queries| queries.fill(0));
            self.query = 1;
        }
        let whole = tables.bd_tree.root(ends.q, DVec3::splat(self.margin));
        self.positions.update(self.query, ends.pose.map_or(whole, |pose| pose.around));
        let frame = self.positions.frame();
        // In the world coordinates have no bound.
        self.is_rough = ends.pose.is_none()
            && !tables.rough.is_empty()
            && tables.units.begin(&mut self.motion, ends.q, frame, self.margin);
        self.wrong_by = if ends.pose.is_some() || ends.ball.is_some() {
            f32::INFINITY
        } else if self.is_rough {
            self.motion.margin
        } else {
            frame.wrong_by(self.margin)
        };
        if self.is_lazy {
            return;
        }
        if !self.is_rough {
            self.positions.move_all(&tables.vertices, ends);
        }
        for cluster in 0..tables.clusters.count() as u32 {
            self.refit_cluster(cluster, ends);
        }
        for n in (0..hierarchy.nodes().len() as u32).rev() {
            if tables.clusters.of_node(n).is_none() {
                let union = self.gather(hierarchy, n);
                self.set_node(n, union);
            }
        }
    }

    /// The box of a node that has been enclosed, or whose parent or cluster has been opened.
    #[inline]
    pub(crate) fn node(&self, n: u32) -> &Box32 {
        &self.nodes[n as usize]
    }

    /// The children of an open node.
    #[inline]
    pub(crate) fn pack(&self, n: u32) -> &Pack {
        &self.packs[n as usize]
    }

    /// The blocks of an open cluster.
    #[inline]
    pub(crate) fn cluster(&self, cluster: u32) -> &Pack {
        &self.clusters[cluster as usize]
    }

    /// The triangles of a block of an open cluster.
    #[inline]
    pub(crate) fn block(&self, block: usize) -> &Pack {
        &self.blocks[block]
    }

    /// Whether a cluster is open.
    #[inline]
    pub(crate) fn is_open(&self, cluster: u32) -> bool {
        self.cluster_query[cluster as usize] == self.query
    }

    /// Makes the boxes of the children of a node larger than a cluster current.
    #[inline]
    pub(crate) fn open(&mut self, asked: &Asked<'_>, n: u32, ends: &Ends<'_, E>) {
        if self.pack_query[n as usize] != self.query {
            let children = asked.hierarchy.nodes()[n as usize].children();
            children.for_each(|child| self.enclose(child, ends));
            self.gather(&asked.hierarchy, n);
        }
    }

    /// Makes all boxes within a cluster current.
    #[inline]
    pub(crate) fn open_cluster(&mut self, cluster: u32, ends: &Ends<'_, E>) {
        if !self.is_open(cluster) {
            if !self.is_rough {
                let Tables { clusters, vertices, .. } = &*self.tables;
                clusters.vertices(cluster).iter().for_each(|&v| self.positions.move_one(vertices, v, ends));
            }
            self.refit_cluster(cluster, ends);
        }
    }

    /// Makes the box of a node current that is a cluster or larger.
    #[inline]
    pub(crate) fn enclose(&mut self, n: u32, ends: &Ends<'_, E>) {
        if self.node_query[n as usize] != self.query {
            if self.is_rough
                && let Some(aabb) = self.tables.bd_tree.rough(n, &self.motion)
            {
                self.set_node(n, aabb.widened(self.reach(n, ends)));
                return;
            }
            let frame = self.positions.frame();
            let margin = ends.ball.map_or(DVec3::ZERO, |ball| ball.of_node(n)) + self.margin;
            let aabb = self.tables.bd_tree.at(n, ends.q, margin);
            let aabb = match ends.pose {
                None => aabb,
                Some(placement) => aabb.map(|aabb| placement.pose.enclose(aabb, self.margin)),
            };
            // What has no box of its own overlaps everything.
            let aabb = aabb.map_or(Box32::ALL, |Aabb { lower, upper }| Box32 {
                lower: frame.map(lower),
                upper: frame.map(upper),
            });
            self.set_node(n, aabb);
        }
    }

    /// All boxes of a cluster; where exact positions are needed, its vertices have been moved.
    fn refit_cluster(&mut self, cluster: u32, ends: &Ends<'_, E>) {
        let Tables { clusters, rough, .. } = &*self.tables;
        let n = clusters.node(cluster);
        let mut by = Vec4::ZERO;
        if self.is_rough {
            rough.move_cluster(cluster, &self.motion, &mut self.rough);
            by = self.reach(n, ends) + right_or!(self.motion.margin, CoarseTrianglesNotWidened, 0.0);
        }
        let mut whole = Box32::EMPTY;
        for (lane, block) in clusters.blocks(cluster).enumerate() {
            let mut union = Box32::EMPTY;
            for (i, place) in clusters.places(block).enumerate() {
                let triangle = Box32::around(self.mapped(cluster, place)).widened(by);
                self.blocks[block].set(i, &triangle);
                union = union.union(&triangle);
            }
            self.clusters[cluster as usize].set(lane, &union);
            whole = whole.union(&union);
        }
        self.cluster_query[cluster as usize] = self.query;
        self.set_node(n, whole);
    }

    /// How far the vertices of a node may be from where they are in the ball asked about, in the frame, rounded up.
    #[inline]
    fn reach(&self, n: u32, ends: &Ends<'_, E>) -> Vec4 {
        ends.ball.map_or(Vec4::ZERO, |ball| {
            let reach = ball.of_node(n) * (self.positions.frame().scale() * (1.0 + 1e-5));
            // Finite, as all corners of boxes are that hold something.
            reach.as_vec3().extend(0.0).min(Vec4::MAX)
        })
    }

    #[inline]
    fn set_node(&mut self, n: u32, aabb: Box32) {
        self.nodes[n as usize] = aabb;
        self.node_query[n as usize] = self.query;
    }

    /// Packs the boxes of a node's children, which are current, and gives their union.
    fn gather(&mut self, hierarchy: &Hierarchy, n: u32) -> Box32 {
        let mut union = Box32::EMPTY;
        for (lane, child) in hierarchy.nodes()[n as usize].children().enumerate() {
            let child = &self.nodes[child as usize];
            self.packs[n as usize].set(lane, child);
            union = union.union(child);
        }
        self.pack_query[n as usize] = self.query;
        union
    }

    /// Whether two triangles, each given by an open cluster and its place there, certainly have no point in common, as
    /// far as that is seen without exact positions.
    #[inline]
    pub(crate) fn are_apart(&self, x: (u32, usize), y: (u32, usize)) -> bool {
        are_apart(&self.mapped(x.0, x.1), &self.mapped(y.0, y.1), self.wrong_by)
    }

    /// The corners of the triangle at a place of a cluster, in the frame.
    #[inline]
    fn mapped(&self, cluster: u32, place: usize) -> [[Vec4; E]; 3] {
        let Tables { clusters, rough, .. } = &*self.tables;
        if self.is_rough {
            rough.corners(cluster, place, &self.rough)
        } else {
            self.positions.mapped(clusters.corners()[place])
        }
    }

    /// Moves the corners of any triangle, and gives their places.
    pub(crate) fn moved(&mut self, asked: &Asked<'_>, triangle: u32, ends: &Ends<'_, E>) -> [u32; 3] {
        let faces = asked.model.mesh().faces();
        let places = faces[triangle as usize].map(|v| self.tables.vertices.place(v));
        self.move_corners(places, ends);
        places
    }

    /// Moves three vertices.
    #[inline]
    pub(crate) fn move_corners(&mut self, places: [u32; 3], ends: &Ends<'_, E>) {
        places.iter().for_each(|&v| self.positions.move_one(&self.tables.vertices, v, ends));
    }

    /// The positions of three moved vertices, at each end.
    #[inline]
    pub(crate) fn corners(&self, places: [u32; 3]) -> [[DVec3; 3]; E] {
        self.positions.corners(places)
    }
}

/// What rounding can add to a BD-tree box and to positions: well above the 2 (r + 1) roundings of each.
pub(crate) fn margin(reach: f64, rank: usize) -> f64 {
    right_or!(reach * ((4 * rank + 64) as f64 * f64::EPSILON) + f64::MIN_POSITIVE, BoxesNotWidened, 0.0)
}
