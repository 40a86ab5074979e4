//! Bounding volumes of nodes, buckets, packets and triangles in one search, each computed at most once.
//!
//! All are AABBs in the single precision of an [`F32Frame`](super::f32_frame::F32Frame). In a search between two
//! configurations each AABB is a swept AABB. Nodes down to buckets have BD-tree AABBs (paper, section 4; James and Pai
//! 2004), computed when the traversal visits them. A bucket gets tight AABBs, from its vertices, when it is opened:
//! BD-tree AABBs of smaller nodes cost as much as moving their vertices, and grow with every mode even if modes cancel.
//! The traditional method and detectors refit all AABBs first, as certified searches do after many loose pairs. For two
//! meshes detectors refit the AABBs of nodes only.

use std::sync::Arc;

use glam::{DVec3, Vec4};

use super::aabb8::{Aabb8, AabbF32, LANES};
use super::coarse_positions::CoarsePositions;
use super::exact_positions::ExactPositions;
use super::f32_frame::F32Frame;
use super::layout::Layout;
use super::vertex_motion::VertexMotion;
use crate::geometry::Aabb;
use crate::hierarchy::{BRANCHING, Hierarchy};
use crate::vectors::InstructionSet;

// The children of a node are compared as the first four lanes of a packet.
const _: () = assert!(BRANCHING <= LANES / 2);

/// The AABBs of one search and the positions from which they are computed. Each entry contains the number of the search
/// for which it is current.
#[derive(Clone)]
pub(crate) struct NodeVolumes<const E: usize> {
    pub(crate) layout: Arc<Layout>,
    pub(crate) instructions: InstructionSet,
    is_lazy: bool,
    search: u32,
    /// Buckets of this search that are not open.
    closed_buckets: usize,
    positions: ExactPositions<E>,
    coarse: CoarsePositions<E>,
    /// An upper bound, along each axis, of the error of corners in the frame; infinite if there is no bound.
    corner_error: f32,
    /// The AABB of each node that is a bucket or larger.
    nodes: Vec<AabbF32>,
    node_searches: Vec<u32>,
    /// The AABBs of the children of each node larger than a bucket.
    children: Vec<Aabb8>,
    children_searches: Vec<u32>,
    /// The AABBs of the packets of each bucket.
    packets: Vec<Aabb8>,
    packets_searches: Vec<u32>,
    /// The AABBs of the triangles of each packet.
    triangles: Vec<Aabb8>,
}

impl<const E: usize> NodeVolumes<E> {
    /// Allocates the volumes. Lazy volumes are computed when a traversal visits nodes, others at the start of each search.
    pub(crate) fn new(layout: &Arc<Layout>, is_lazy: bool) -> Self {
        let (nodes, buckets) = (layout.buckets.visited_node_count(), layout.buckets.count());
        Self {
            layout: Arc::clone(layout),
            instructions: InstructionSet::default(),
            is_lazy,
            search: 0,
            closed_buckets: buckets,
            positions: ExactPositions::new(layout.vertices.count()),
            coarse: CoarsePositions::new(layout),
            corner_error: f32::INFINITY,
            nodes: vec![AabbF32::EMPTY; nodes],
            node_searches: vec![0; nodes],
            children: vec![Aabb8::EMPTY; nodes],
            children_searches: vec![0; nodes],
            packets: vec![Aabb8::EMPTY; buckets],
            packets_searches: vec![0; buckets],
            triangles: vec![Aabb8::EMPTY; layout.buckets.packet_count()],
        }
    }

    /// Starts a new search: invalidates all AABBs and, if they are not lazy, refits all of them.
    pub(crate) fn begin<M: VertexMotion<E>>(&mut self, hierarchy: &Hierarchy, motion: &M) {
        self.begin_closed(motion);
        if !self.is_lazy {
            self.refit(hierarchy, motion);
        }
    }

    /// Starts a new search with exact positions, and refits all nodes; AABBs within buckets are computed when buckets are opened.
    pub(super) fn begin_nodes<M: VertexMotion<E>>(&mut self, hierarchy: &Hierarchy, motion: &M) {
        self.begin_closed(motion);
        let layout = Arc::clone(&self.layout);
        self.positions.move_all(&layout, motion);
        let margin = self.margin(motion);
        for bucket in 0..layout.buckets.count() as u32 {
            let aabb = self.positions.mapped_aabb(layout.buckets.vertices(bucket));
            self.set_node(layout.buckets.node(bucket), aabb.widened(margin));
        }
        self.refit_larger(hierarchy);
    }

    /// Starts a new search: invalidates all AABBs.
    fn begin_closed<M: VertexMotion<E>>(&mut self, motion: &M) {
        let layout = Arc::clone(&self.layout);
        self.search = self.search.wrapping_add(1);
        if self.search == 0 {
            [&mut self.node_searches, &mut self.children_searches, &mut self.packets_searches]
                .into_iter()
                .for_each(|searches| searches.fill(0));
            self.search = 1;
        }
        self.closed_buckets = layout.buckets.count();
        self.positions.begin(self.search, motion.overall_aabb(&layout));
        let (frame, rounding) = (self.positions.frame(), motion.rounding());
        self.coarse.begin(&layout, motion, frame);
        self.corner_error = if !M::HAS_ERROR_BOUND {
            f32::INFINITY
        } else if self.coarse.are_used() {
            self.coarse.error()
        } else {
            frame.error_bound(rounding)
        };
        // Triangles must be separate by this clearance, too, so that the bound includes it.
        let margin = motion.margin_beside_rounding() * frame.scale() * (1.0 + 1e-5);
        self.corner_error += with_mutant!(margin, SeparatedWithoutClearance, 0.0) as f32;
    }

    /// Computes all AABBs from all vertices, bottom-up, except those within open buckets, which are current.
    pub(crate) fn refit<M: VertexMotion<E>>(&mut self, hierarchy: &Hierarchy, motion: &M) {
        let layout = Arc::clone(&self.layout);
        if !self.coarse.are_used() {
            self.positions.move_all(&layout, motion);
        }
        for bucket in 0..layout.buckets.count() as u32 {
            if !self.is_bucket_open(bucket) {
                self.refit_bucket(bucket, motion);
            }
        }
        self.refit_larger(hierarchy);
    }

    /// Computes the AABBs of all nodes larger than buckets from those of buckets.
    fn refit_larger(&mut self, hierarchy: &Hierarchy) {
        for n in (0..hierarchy.nodes().len() as u32).rev() {
            if self.layout.buckets.of_node(n).is_none() {
                let union = self.gather_children(hierarchy, n);
                self.set_node(n, union);
            }
        }
    }

    /// Returns the distance by which AABBs of exact positions are widened, in the frame.
    fn margin<M: VertexMotion<E>>(&self, motion: &M) -> Vec4 {
        if motion.margin() == 0.0 {
            return Vec4::ZERO;
        }
        let margin = motion.margin() * self.positions.frame().scale() * (1.0 + 1e-5);
        // Coordinates in the frame are rounded when they are mapped and when AABBs are widened: by less than four units of 2^-24 within [-4, 4].
        let rounding = with_mutant!(4.0 * f64::from(f32::EPSILON), MarginExact, 0.0);
        Vec4::splat((margin + rounding) as f32)
    }

    /// Returns the cost of a traversal by the surface area heuristic (Goldsmith and Salmon 1987), for refitted boxes: the areas of
    /// nodes relative to the root's; a bucket counts once for each of its packets. 0 if the root has no area.
    pub(crate) fn surface_area_cost(&self) -> f64 {
        let area = |n: usize| {
            let size = self.nodes[n].upper - self.nodes[n].lower;
            f64::from(size.x * size.y + size.y * size.z + size.z * size.x)
        };
        let buckets = &self.layout.buckets;
        let cost = |n: usize| {
            let packets = buckets.of_node(n as u32).map_or(1, |bucket| buckets.packets(bucket).len());
            area(n) * packets as f64
        };
        let root = area(0);
        if root > 0.0 { (0..self.nodes.len()).map(cost).sum::<f64>() / root } else { 0.0 }
    }

    /// Returns the frame of this search.
    pub(crate) fn frame(&self) -> &F32Frame {
        self.positions.frame()
    }

    /// Whether the AABBs within a bucket are current.
    #[inline]
    pub(crate) fn is_bucket_open(&self, bucket: u32) -> bool {
        self.packets_searches[bucket as usize] == self.search
    }

    /// Returns the number of buckets whose AABBs within are not current.
    #[inline]
    pub(crate) fn closed_buckets(&self) -> usize {
        self.closed_buckets
    }

    /// Returns the AABB of a node. Call [`Self::update_node`] first, or open its parent or bucket.
    #[inline]
    pub(crate) fn node(&self, n: u32) -> &AabbF32 {
        &self.nodes[n as usize]
    }

    /// Returns the AABBs of the children of an open node.
    #[inline]
    pub(crate) fn children(&self, n: u32) -> &Aabb8 {
        &self.children[n as usize]
    }

    /// Returns the AABBs of the packets of an open bucket.
    #[inline]
    pub(crate) fn packets(&self, bucket: u32) -> &Aabb8 {
        &self.packets[bucket as usize]
    }

    /// Returns the AABBs of the triangles of a packet of an open bucket.
    #[inline]
    pub(crate) fn triangles(&self, packet: usize) -> &Aabb8 {
        &self.triangles[packet]
    }

    /// Makes the AABBs of the children of a node larger than a bucket current.
    #[inline]
    pub(crate) fn open_node<M: VertexMotion<E>>(&mut self, hierarchy: &Hierarchy, n: u32, motion: &M) {
        if self.children_searches[n as usize] != self.search {
            let children = hierarchy.nodes()[n as usize].children();
            children.for_each(|child| self.update_node(child, motion));
            self.gather_children(hierarchy, n);
        }
    }

    /// Makes all AABBs within a bucket current.
    #[inline]
    pub(crate) fn open_bucket<M: VertexMotion<E>>(&mut self, bucket: u32, motion: &M) {
        if self.packets_searches[bucket as usize] != self.search {
            if !self.coarse.are_used() {
                let layout = &*self.layout;
                let vertices = layout.buckets.vertices(bucket).iter();
                vertices.for_each(|&v| self.positions.move_vertex(layout, v, motion));
            }
            self.refit_bucket(bucket, motion);
        }
    }

    /// Computes the AABB of a node that is a bucket or larger, unless it is current.
    #[inline]
    pub(crate) fn update_node<M: VertexMotion<E>>(&mut self, n: u32, motion: &M) {
        if self.node_searches[n as usize] != self.search {
            let frame = self.positions.frame();
            if let Some(aabb) = self.coarse.node(&self.layout, n) {
                self.set_node(n, aabb.widened(CoarsePositions::slack(n, motion, frame)));
                return;
            }
            // A node without a BD-tree AABB gets the AABB that overlaps all others.
            let aabb = motion.node_aabb(&self.layout, n).map_or(AabbF32::ALL, |Aabb { lower, upper }| {
                AabbF32 { lower: frame.map(lower), upper: frame.map(upper) }
            });
            self.set_node(n, aabb);
        }
    }

    /// Computes all AABBs of a bucket. If exact positions are used, its vertices must have been moved.
    fn refit_bucket<M: VertexMotion<E>>(&mut self, bucket: u32, motion: &M) {
        let buckets = &self.layout.buckets;
        let n = buckets.node(bucket);
        let by = if self.coarse.are_used() {
            self.coarse.move_bucket(&self.layout, bucket);
            let slack = CoarsePositions::slack(n, motion, self.positions.frame());
            slack + with_mutant!(self.coarse.error(), CoarseTrianglesNotWidened, 0.0)
        } else {
            self.margin(motion)
        };
        let mut whole = AabbF32::EMPTY;
        for (lane, packet) in buckets.packets(bucket).enumerate() {
            let (slots, mut union) = (buckets.slots(packet), AabbF32::EMPTY);
            for half in 0..2 {
                let mut triangles = [AabbF32::EMPTY; LANES / 2];
                for (triangle, slot) in triangles.iter_mut().zip(slots.clone().skip(half * LANES / 2)) {
                    let (positions, [a, b, c]) = (self.mapped_positions(), self.mapped_corners(bucket, slot));
                    let corners = [positions[a as usize], positions[b as usize], positions[c as usize]];
                    *triangle = AabbF32::of_triangle(corners).widened(by);
                    union = union.union(triangle);
                }
                self.triangles[packet].set_half(half, &triangles);
            }
            self.packets[bucket as usize].set(lane, &union);
            whole = whole.union(&union);
        }
        self.packets_searches[bucket as usize] = self.search;
        self.closed_buckets -= 1;
        self.set_node(n, whole);
    }

    #[inline]
    fn set_node(&mut self, n: u32, aabb: AabbF32) {
        self.nodes[n as usize] = aabb;
        self.node_searches[n as usize] = self.search;
    }

    /// Gathers the current AABBs of a node's children in its packet, and returns their union.
    fn gather_children(&mut self, hierarchy: &Hierarchy, n: u32) -> AabbF32 {
        let mut union = AabbF32::EMPTY;
        for (lane, child) in hierarchy.nodes()[n as usize].children().enumerate() {
            let child = &self.nodes[child as usize];
            self.children[n as usize].set(lane, child);
            union = union.union(child);
        }
        self.children_searches[n as usize] = self.search;
        union
    }

    /// Returns the positions in the frame, of which those of open buckets are current.
    #[inline]
    pub(super) fn mapped_positions(&self) -> &[[Vec4; E]] {
        if self.coarse.are_used() { self.coarse.all() } else { self.positions.mapped() }
    }

    /// Returns the places of the corners of the triangle in a slot of a bucket, in [`Self::mapped_positions`].
    #[inline]
    pub(super) fn mapped_corners(&self, bucket: u32, slot: usize) -> [u32; 3] {
        if self.coarse.are_used() {
            self.layout.coarse.corners(bucket, slot)
        } else {
            self.layout.buckets.corners()[slot]
        }
    }

    /// Returns the vertices of an open bucket, with their positions in the frame at the start of the motion, which are within
    /// [`Self::corner_error`] of the exact ones.
    pub(crate) fn mapped_vertices(&self, bucket: u32) -> impl Iterator<Item = (u32, Vec4)> {
        let is_coarse = self.coarse.are_used();
        let moved = if is_coarse { self.coarse.of_bucket(&self.layout, bucket) } else { &[] };
        let exact = |v: u32| self.positions.mapped()[v as usize];
        let at = move |(i, v): (usize, &u32)| (*v, moved.get(i).copied().unwrap_or_else(|| exact(*v))[0]);
        self.layout.buckets.vertices(bucket).iter().enumerate().map(at)
    }

    /// Returns an upper bound, along each axis, of the error of corners in the frame; infinite if there is no bound.
    pub(crate) fn corner_error(&self) -> f32 {
        self.corner_error
    }

    /// Prefetches the rest positions and modes of those of three vertices that have not been moved.
    #[inline]
    pub(crate) fn prefetch_corners(&self, vertices: [u32; 3]) {
        for vertex in vertices {
            if !self.positions.is_moved(vertex) {
                self.layout.vertices.prefetch(vertex, self.instructions);
            }
        }
    }

    /// Moves three vertices to their exact positions.
    #[inline]
    pub(crate) fn move_corners<M: VertexMotion<E>>(&mut self, vertices: [u32; 3], motion: &M) {
        vertices.iter().for_each(|&v| self.positions.move_vertex(&self.layout, v, motion));
    }

    /// Returns the exact position of a moved vertex, at the start of the motion.
    #[inline]
    pub(crate) fn position(&self, vertex: u32) -> DVec3 {
        self.positions.position(vertex)
    }

    /// Returns the exact positions of three moved vertices, at each configuration.
    #[inline]
    pub(crate) fn corners(&self, vertices: [u32; 3]) -> [[DVec3; 3]; E] {
        self.positions.corners(vertices)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ContactFilter;
    use crate::filter::PairFilter;

    /// A motion in a box about 0 that has one length as margin and as slack.
    struct Wide {
        half: f64,
        margin: f64,
    }

    impl VertexMotion<1> for Wide {
        const HAS_ERROR_BOUND: bool = true;

        fn rounding(&self) -> f64 {
            0.0
        }

        fn margin(&self) -> f64 {
            self.margin
        }

        fn margin_beside_rounding(&self) -> f64 {
            self.margin
        }

        fn overall_aabb(&self, _: &Layout) -> Aabb {
            Aabb { lower: DVec3::splat(-self.half), upper: DVec3::splat(self.half) }
        }

        fn coarse_coordinates(&self) -> Option<[&[f64]; 1]> {
            None
        }

        fn coarse_slack(&self, _: u32) -> Option<DVec3> {
            Some(DVec3::splat(self.margin))
        }

        fn positions(&self, _: &Layout, _: u32) -> [DVec3; 1] {
            [DVec3::ZERO]
        }

        fn node_aabb(&self, _: &Layout, _: u32) -> Option<Aabb> {
            None
        }
    }

    #[test]
    fn lengths_in_the_frame_are_rounded_up() {
        let hierarchy = Hierarchy::build_by_median(&[[0, 1, 2]], &[DVec3::ZERO, DVec3::X, DVec3::Y]);
        let filter = PairFilter::with_classes(&[[0, 1, 2]], None, &ContactFilter::default());
        let layout = Arc::new(Layout::of_positions(3, &hierarchy, &filter));
        for (half, share) in [(1e-3, 0.4), (1.0, 0.7), (500.0, 0.01)] {
            let motion = Wide { half, margin: half * share };
            let mut volumes = NodeVolumes::<1>::new(&layout, true);
            volumes.begin(&hierarchy, &motion);
            let frame = *volumes.frame();
            let slack = CoarsePositions::<1>::slack(0, &motion, &frame);
            let rounding = 4.0 * f64::from(f32::EPSILON);
            for found in [
                f64::from(volumes.corner_error() - frame.error_bound(0.0)),
                f64::from(volumes.margin(&motion).x) - rounding,
                f64::from(slack.x),
                f64::from(slack.z),
            ] {
                assert!(found >= share * (1.0 + 5e-6) && found <= share * (1.0 + 2e-5), "{half}: {found}");
            }
            // Numbers of searches begin again, and nothing is current.
            volumes.move_corners([0, 1, 2], &motion);
            volumes.search = u32::MAX;
            volumes.begin(&hierarchy, &motion);
            assert!(volumes.search == 1 && !volumes.positions.is_moved(0));
        }
    }
}
