//! The vertex motion of kinetic searches: an AABB of each vertex for all z in a ball.

use glam::DVec3;

use super::layout::Layout;
use super::vertex_motion::{VertexMotion, rounding_bound};
use crate::geometry::Aabb;
use crate::hierarchy::Hierarchy;
use crate::model::ScaledModel;
use crate::model::rounding::norm_up;

/// For each vertex and each node how fast positions can change with z. By Cauchy and Schwarz, a vertex moves along an axis
/// by at most `|A| |dz|`, where A is its scaled row of that axis; the rounding of both computed positions is added.
pub(crate) struct BallRates {
    /// The norms of the three rows of each vertex, by its index in the layout, rounded up.
    vertices: Vec<DVec3>,
    /// The largest norms of all vertices of each node that is a bucket or larger.
    nodes: Vec<DVec3>,
}

impl BallRates {
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
                None => node.children().fold(DVec3::ZERO, |most, n| most.max(nodes[n as usize])),
            };
        }
        Self { vertices, nodes }
    }
}

/// A ball around the z of one q. Its two configurations have the lowest and the highest coordinates of each vertex.
#[derive(Clone, Copy)]
pub(crate) struct BallMotion<'q> {
    rates: &'q BallRates,
    q: &'q [f64],
    radius: f64,
    rounding: f64,
    /// Four times the rounding: of a position here, and of one anywhere in the ball.
    widening: f64,
}

impl<'q> BallMotion<'q> {
    /// `reach`: an upper bound of the magnitude of every term of every position in the ball.
    pub(crate) fn new(rates: &'q BallRates, q: &'q [f64], radius: f64, reach: f64) -> Self {
        let rounding = rounding_bound(reach, q.len());
        Self { rates, q, radius, rounding, widening: right_or!(4.0 * rounding, BallExact, 0.0) }
    }

    /// An upper bound of the change of a vertex's coordinates in the ball.
    #[inline]
    fn vertex_change(&self, vertex: u32) -> DVec3 {
        let radius = right_or!(self.radius, BallVerticesHalfAsFar, 0.5 * self.radius);
        self.rates.vertices[vertex as usize] * radius + self.widening
    }

    /// The same for all vertices of a node.
    #[inline]
    fn node_change(&self, node: u32) -> DVec3 {
        let radius = right_or!(self.radius, BallNodesHalfAsFar, 0.5 * self.radius);
        self.rates.nodes[node as usize] * radius + self.widening
    }
}

impl VertexMotion<2> for BallMotion<'_> {
    const HAS_ERROR_BOUND: bool = false;

    #[inline]
    fn rounding(&self) -> f64 {
        self.rounding
    }

    fn overall_aabb(&self, layout: &Layout) -> Aabb {
        layout.bd_tree.root([self.q, self.q], DVec3::splat(self.rounding))
    }

    #[inline]
    fn coarse_coordinates(&self) -> Option<[&[f64]; 2]> {
        Some([self.q, self.q])
    }

    #[inline]
    fn coarse_slack(&self, node: u32) -> Option<DVec3> {
        Some(self.node_change(node))
    }

    #[inline]
    fn positions(&self, layout: &Layout, vertex: u32) -> [DVec3; 2] {
        let [x] = layout.vertices.position(vertex, [self.q]);
        let change = self.vertex_change(vertex);
        [x - change, x + change]
    }

    #[inline]
    fn node_aabb(&self, layout: &Layout, node: u32) -> Option<Aabb> {
        layout.bd_tree.at(node, [self.q, self.q], self.node_change(node) + self.rounding)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detect::layout::Needs;
    use crate::test_models::{Random, strips};
    use crate::{ContactFilter, Scope};

    /// Vertices stay where the ball says, also for the direction that moves them farthest; and some nearly leave.
    #[test]
    fn vertices_stay_in_the_ball() {
        let (mut checked, mut farthest) = (0, 0.0_f64);
        for case in 0..100 {
            let random = &mut Random(case as u64 + 77);
            let (model, _) = strips(random, case);
            let (rank, scope) = (model.rank(), Scope::of(&model));
            let hierarchy = Hierarchy::build(&model, &scope.metric);
            let filter = crate::filter::PairFilter::new(&model, &ContactFilter::default());
            let layout = Layout::new(&model, &hierarchy, &filter, Needs::LAZY);
            let scaled = ScaledModel::new(&model, &scope.metric, &scope.center);
            let rates = BallRates::new(&scaled, &hierarchy, &layout);
            let q: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
            let radius = 10.0_f64.powf(random.signed() * 8.0 - 7.0);
            let reach = 2.0 * model.check_coordinates(&q).unwrap();
            let ball = BallMotion::new(&rates, &q, radius, reach);
            for v in model.mesh().used_vertices() {
                let mut rows = vec![DVec3::ZERO; rank];
                scope.metric.scaled_modes(model.modes().of_vertex(v), &mut rows);
                for axis in 0..3 {
                    let length = rows.iter().map(|a| a[axis] * a[axis]).sum::<f64>().sqrt();
                    let z: Vec<f64> = rows.iter().map(|a| a[axis] / length * radius).collect();
                    let there: Vec<f64> =
                        q.iter().zip(scope.metric.unscaled(&z)).map(|(q, d)| q + d).collect();
                    if model.check_coordinates(&there).unwrap() > reach {
                        continue;
                    }
                    let moved = (model.position(v, &there) - model.position(v, &q)).abs();
                    let allowed = ball.vertex_change(layout.vertices.index_of(v));
                    assert!(moved.cmple(allowed).all(), "case {case}: {moved} {allowed}");
                    // All triangles are in one bucket.
                    assert!(moved.cmple(ball.node_change(layout.buckets.node(0))).all());
                    farthest = farthest.max(moved[axis] / allowed[axis]);
                    checked += 1;
                }
            }
        }
        assert!(checked > 2000 && farthest > 0.999, "{checked} {farthest}");
    }
}
