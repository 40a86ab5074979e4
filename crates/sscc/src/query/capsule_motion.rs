//! The vertex motion of kinetic searches: an AABB of each vertex for all z in a capsule.

use glam::DVec3;

use crate::detect::layout::Layout;
use crate::detect::vertex_motion::{VertexMotion, rounding_bound};
use crate::geometry::Aabb;
use crate::hierarchy::Hierarchy;
use crate::model::ScaledModel;
use crate::model::rounding::norm_up;

/// For each vertex and each node an upper bound of the change of positions for each unit of z. By Cauchy and Schwarz, a vertex
/// moves along an axis by at most `|A| |dz|`, where A is its scaled row of that axis; the rounding of both computed positions is
/// added.
#[derive(Clone)]
pub(crate) struct CapsuleRates {
    /// The norms of the three rows of each vertex, by its index in the layout, rounded up, plus the rounding of
    /// positions per unit of `|z|`.
    vertices: Vec<DVec3>,
    /// The largest norms of all vertices of each node that is a bucket or larger.
    nodes: Vec<DVec3>,
}

impl CapsuleRates {
    pub(crate) fn new(model: &ScaledModel, hierarchy: &Hierarchy, layout: &Layout) -> Self {
        let row_len = model.row_len;
        let rounded = DVec3::from_array(DVec3::AXES.map(|axis| model.rounding.per_norm(axis)));
        let mut vertices = vec![DVec3::ZERO; layout.vertices.count()];
        for v in model.faces.as_flattened() {
            let modes = model.modes(*v);
            let norm = |axis: usize| {
                norm_up(modes[axis * row_len..][..row_len].iter().map(|a| a * a).sum(), row_len)
            };
            vertices[layout.vertices.index_of(*v) as usize] = DVec3::new(norm(0), norm(1), norm(2)) + rounded;
        }
        let mut nodes = vec![DVec3::ZERO; hierarchy.nodes().len()];
        // Parents come before their children.
        for (n, node) in hierarchy.nodes().iter().enumerate().rev() {
            nodes[n] = match layout.buckets.of_node(n as u32) {
                Some(bucket) => {
                    let own = layout.buckets.vertices(bucket).iter();
                    own.fold(DVec3::ZERO, |most, v| most.max(vertices[*v as usize]))
                }
                None => {
                    let most = node.children().fold(DVec3::ZERO, |most, n| most.max(nodes[n as usize]));
                    with_mutant!(most, CapsuleInnerNodesStill, DVec3::ZERO)
                }
            };
        }
        Self { vertices, nodes }
    }
}

/// A capsule in z: all z within a radius of the segment between the z of two q, which are the same for a ball. As a motion it has
/// two configurations: the lowest and the highest coordinates of each vertex.
///
/// At each point of the segment a position is a convex combination of the positions at the ends.
#[derive(Clone, Copy)]
pub(crate) struct CapsuleMotion<'q> {
    rates: &'q CapsuleRates,
    ends: [&'q [f64]; 2],
    radius: f64,
    rounding: f64,
    /// Five times the rounding: of the positions at both ends, of one anywhere in the capsule, and of the point of the segment
    /// from which its distance was measured. (Once would do: these are at most `(3 r + 12)` units of 2^-53 of the reach
    /// together, and [`rounding_bound`] is `8 r + 128`.)
    widening: f64,
}

impl<'q> CapsuleMotion<'q> {
    /// Creates the motion. `ends`: the q at the ends of the segment. `reach`: an upper bound of the magnitude of every term of
    /// every position in the capsule.
    pub(crate) fn new(
        rates: &'q CapsuleRates,
        [start, end]: [&'q [f64]; 2],
        radius: f64,
        reach: f64,
    ) -> Self {
        let rounding = rounding_bound(reach, start.len());
        let widening = with_mutant!(5.0 * rounding, CapsuleExact, 0.0, CapsuleWidenedOnce, rounding);
        let ends = [start, with_mutant!(end, CapsuleWithoutEnd, start)];
        Self { rates, ends, radius, rounding, widening }
    }

    /// Returns an upper bound of the change of a vertex's coordinates within the radius.
    #[inline]
    fn vertex_change(&self, vertex: u32) -> DVec3 {
        let radius = with_mutant!(self.radius, CapsuleVerticesHalfAsFar, 0.5 * self.radius);
        self.rates.vertices[vertex as usize] * radius + self.widening
    }

    /// Returns an upper bound of the change of the coordinates of all vertices of a node within the radius.
    #[inline]
    fn node_change(&self, node: u32) -> DVec3 {
        let radius = with_mutant!(self.radius, CapsuleNodesHalfAsFar, 0.5 * self.radius);
        self.rates.nodes[node as usize] * radius + self.widening
    }
}

impl VertexMotion<2> for CapsuleMotion<'_> {
    const HAS_ERROR_BOUND: bool = false;

    #[inline]
    fn rounding(&self) -> f64 {
        self.rounding
    }

    fn overall_aabb(&self, layout: &Layout) -> Aabb {
        layout.bd_tree.root(self.ends, DVec3::splat(self.rounding))
    }

    #[inline]
    fn coarse_coordinates(&self) -> Option<[&[f64]; 2]> {
        Some(self.ends)
    }

    #[inline]
    fn region_radius(&self) -> Option<f64> {
        Some(self.radius)
    }

    #[inline]
    fn coarse_slack(&self, node: u32) -> Option<DVec3> {
        Some(self.node_change(node))
    }

    #[inline]
    fn positions(&self, layout: &Layout, vertex: u32) -> [DVec3; 2] {
        let [x, y] = layout.vertices.position(vertex, self.ends);
        let change = self.vertex_change(vertex);
        [x.min(y) - change, x.max(y) + change]
    }

    #[inline]
    fn node_aabb(&self, layout: &Layout, node: u32) -> Option<Aabb> {
        layout.bd_tree.at(node, self.ends, self.node_change(node) + self.rounding)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificates::Scope;
    use crate::detect::layout::Needs;
    use crate::detect::node_volumes::NodeVolumes;
    use crate::detect::vertex_motion::DeformedMotion;
    use crate::query::widened_motion::WidenedMotion;
    use crate::test_models::{Random, strips};
    use crate::{ContactFilter, Modes, ReducedModel, TriMesh};

    /// Vertices stay in their AABBs of the capsule for z about any point of its segment, also in the direction that moves them
    /// farthest; some of them nearly leave their AABB.
    #[test]
    fn vertices_stay_in_the_capsule() {
        let (mut checked, mut farthest, mut longest) = (0, 0.0_f64, 0);
        for case in 0..100 {
            let random = &mut Random(case as u64 + 77);
            let (model, _) = strips(random, case);
            let (rank, scope) = (model.rank(), Scope::of(&model));
            let hierarchy = Hierarchy::build(&model, &scope.metric);
            let filter = crate::filter::PairFilter::new(&model, &ContactFilter::default());
            let layout = Layout::new(&model, &hierarchy, &filter, Needs::LAZY);
            let scaled = ScaledModel::new(&model, &scope.metric, &scope.center);
            let rates = CapsuleRates::new(&scaled, &hierarchy, &layout);
            let start: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
            let radius = 10.0_f64.powf(random.signed() * 8.0 - 7.0);
            let length = if case % 2 == 0 { 0.0 } else { 10.0_f64.powf(random.signed() * 4.0 - 3.0) };
            let end: Vec<f64> = start.iter().map(|q| q + length * random.signed()).collect();
            let reach = [&start, &end].map(|q| 2.0 * model.check_coordinates(q).unwrap());
            let reach = reach[0].max(reach[1]);
            let capsule = CapsuleMotion::new(&rates, [&start, &end], radius, reach);
            let node = layout.buckets.node(0);
            for v in model.mesh().used_vertices() {
                let index = layout.vertices.index_of(v);
                let [lower, upper] = capsule.positions(&layout, index);
                let aabb = capsule.node_aabb(&layout, node).unwrap();
                let mut rows = vec![DVec3::ZERO; rank];
                scope.metric.scaled_modes(model.modes().of_vertex(v), &mut rows);
                for (axis, t) in (0..3).flat_map(|axis| [0.0, 1.0, random.signed().abs()].map(|t| (axis, t)))
                {
                    let most = rows.iter().map(|a| a[axis] * a[axis]).sum::<f64>().sqrt();
                    for sign in [-1.0, 1.0] {
                        let z: Vec<f64> = rows.iter().map(|a| sign * a[axis] / most * radius).collect();
                        let d = scope.metric.unscale(&z);
                        let q: Vec<f64> =
                            (0..rank).map(|k| start[k] + t * (end[k] - start[k]) + d[k]).collect();
                        if model.check_coordinates(&q).unwrap() > reach {
                            continue;
                        }
                        let x = model.position(v, &q);
                        assert!(
                            x.cmpge(lower).all() && x.cmple(upper).all(),
                            "case {case}: {x} {lower} {upper}"
                        );
                        // All triangles are in one bucket.
                        assert!(x.cmpge(aabb.lower).all() && x.cmple(aabb.upper).all());
                        let [x0, x1] = [&start, &end].map(|q| model.position(v, q));
                        let on_segment = x0 + (x1 - x0) * t;
                        let moved = (x - on_segment).abs();
                        let allowed = capsule.vertex_change(index);
                        assert!(moved.cmple(allowed).all(), "case {case}: {moved} {allowed}");
                        assert!(moved.cmple(capsule.node_change(node)).all());
                        farthest = farthest.max(moved[axis] / allowed[axis]);
                        checked += 1;
                        longest += usize::from((x1 - x0).length() > allowed.length());
                    }
                }
            }
        }
        assert!(checked > 10_000 && farthest > 0.999 && longest > 1000, "{checked} {farthest} {longest}");
    }

    /// Returns a rolled sheet of many buckets, with smooth modes.
    fn rolled_sheet(side: u32, random: &mut Random) -> ReducedModel {
        let ways: Vec<[DVec3; 2]> = (0..5).map(|_| [random.vector(), random.vector() * 2.0]).collect();
        let positions: Vec<DVec3> = (0..side * side)
            .map(|i| {
                let [u, v] = [i % side, i / side].map(|i| f64::from(i) / f64::from(side - 1));
                DVec3::new((4.0 * u).cos(), (4.0 * u).sin(), 2.0 * v)
            })
            .collect();
        let modes = positions.iter().flat_map(|x| ways.iter().map(|[w, k]| *w * 0.3 * x.dot(*k).sin()));
        let modes = Modes::new(5, modes.collect()).unwrap();
        let squares = (0..(side - 1) * (side - 1)).map(|i| i + i / (side - 1));
        let faces = squares.flat_map(|a| [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]);
        ReducedModel::new(TriMesh::new(positions, faces.collect()).unwrap(), modes).unwrap()
    }

    /// Refitted AABBs of triangles, buckets and larger nodes, from coarse positions, and BD-tree AABBs of nodes contain the
    /// positions at all z of a capsule.
    #[test]
    fn node_volumes_contain_the_capsule() {
        let mut checked = 0;
        for case in 0..24 {
            let random = &mut Random(case + 3000);
            let model = rolled_sheet(16, random);
            let (rank, scope) = (model.rank(), Scope::of(&model));
            let hierarchy = Hierarchy::build(&model, &scope.metric);
            let filter = crate::filter::PairFilter::new(&model, &ContactFilter::default());
            let layout = std::sync::Arc::new(Layout::new(&model, &hierarchy, &filter, Needs::LAZY));
            assert!(layout.buckets.count() > 4);
            let scaled = ScaledModel::new(&model, &scope.metric, &scope.center);
            let rates = CapsuleRates::new(&scaled, &hierarchy, &layout);
            let mut q = |size: f64| -> Vec<f64> { (0..rank).map(|_| size * random.signed()).collect() };
            let start = q(0.5);
            let end: Vec<f64> = start.iter().zip(q(0.3)).map(|(a, b)| a + b).collect();
            let radius = [0.0, 1e-3, 0.2][case as usize % 3];
            let reach = [&start, &end].map(|q| 2.0 * model.check_coordinates(q).unwrap());
            let capsule = CapsuleMotion::new(&rates, [&start, &end], radius, reach[0].max(reach[1]));
            let mut volumes = NodeVolumes::<2>::new(&layout, true);
            volumes.begin(&hierarchy, &capsule);
            if case % 2 == 0 {
                volumes.refit(&hierarchy, &capsule);
            }
            for (n, node) in hierarchy.nodes().iter().enumerate() {
                let n = n as u32;
                let is_volume = node.child_count > 0 || layout.buckets.of_node(n).is_some();
                let Some(own) = capsule.node_aabb(&layout, n).filter(|_| is_volume) else { continue };
                volumes.update_node(n, &capsule);
                for v in hierarchy.vertices(node, model.mesh().faces()).into_iter().step_by(5) {
                    let mut rows = vec![DVec3::ZERO; rank];
                    scope.metric.scaled_modes(model.modes().of_vertex(v), &mut rows);
                    for axis in 0..3 {
                        let most = rows.iter().map(|a| a[axis] * a[axis]).sum::<f64>().sqrt();
                        for (sign, t) in [(-1.0, 0.0), (1.0, 0.4), (-1.0, 0.7), (1.0, 1.0)] {
                            let z: Vec<f64> = rows.iter().map(|a| sign * a[axis] / most * radius).collect();
                            let d = scope.metric.unscale(&z);
                            let q: Vec<f64> =
                                (0..rank).map(|k| start[k] + t * (end[k] - start[k]) + d[k]).collect();
                            let x = model.position(v, &q);
                            assert!(x.cmpge(own.lower).all() && x.cmple(own.upper).all(), "case {case}");
                            let y = volumes.frame().map(x);
                            let aabb = volumes.node(n);
                            let is_in = y.cmpge(aabb.lower) & y.cmple(aabb.upper);
                            assert_eq!(is_in.bitmask() & 0b111, 0b111, "case {case}, node {n}: {y} {aabb:?}");
                            checked += 1;
                        }
                    }
                }
            }
        }
        assert!(checked > 10_000, "{checked}");
    }

    #[test]
    fn motions_are_as_wide_as_their_widest_vertex_and_their_clearance() {
        let (model, _) = strips(&mut Random(5), 2);
        let (rank, scope) = (model.rank(), Scope::of(&model));
        let hierarchy = Hierarchy::build(&model, &scope.metric);
        let filter = crate::filter::PairFilter::new(&model, &ContactFilter::default());
        let layout = Layout::new(&model, &hierarchy, &filter, Needs::LAZY);
        let node = layout.buckets.node(0);
        let scaled = ScaledModel::new(&model, &scope.metric, &scope.center);
        let rates = CapsuleRates::new(&scaled, &hierarchy, &layout);
        let q = vec![0.3; rank];
        let reach = model.check_coordinates(&q).unwrap();
        let capsule = CapsuleMotion::new(&rates, [&q, &q], 50.0, reach);
        let changes = model.mesh().used_vertices().into_iter();
        let changes = changes.map(|v| capsule.vertex_change(layout.vertices.index_of(v)));
        assert_eq!(capsule.node_change(node), changes.fold(DVec3::ZERO, DVec3::max));
        assert_eq!(capsule.rounding(), rounding_bound(reach, rank));

        let deformed = DeformedMotion::new([&q[..]], reach);
        let whole = deformed.overall_aabb(&layout);
        let extent = (whole.upper - whole.lower).max_element();
        assert!(extent > 0.25);
        let widened = WidenedMotion::new(deformed, &layout, 0.25);
        let margin = 0.125 + 4.0 * f64::from(f32::EPSILON) * extent;
        assert_eq!([widened.margin(), widened.margin_beside_rounding()], [margin; 2]);
        assert_eq!(widened.rounding(), deformed.rounding());
        let [own, wide] =
            [deformed.node_aabb(&layout, node), widened.node_aabb(&layout, node)].map(Option::unwrap);
        assert_eq!((wide.lower, wide.upper), (own.lower - margin, own.upper + margin));
    }
}
