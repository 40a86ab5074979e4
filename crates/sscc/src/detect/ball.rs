//! How far vertices may be from where they are while z stays in a ball.

use glam::DVec3;

use crate::detect::tables::Tables;
use crate::detect::volumes;
use crate::hierarchy::Hierarchy;
use crate::model::ScaledModel;
use crate::model::rounding::norm_up;

/// A ball around the z of a query. By Cauchy and Schwarz, a vertex moves along an axis by at most `|A| |dz|`, where A
/// is its scaled row of that axis; what both computed positions are rounded by comes on top.
pub(crate) struct Ball {
    /// The norms of the three rows of each vertex, by its place, rounded up.
    rates: Vec<DVec3>,
    /// The largest of all vertices of each node that is a cluster or larger.
    node_rates: Vec<DVec3>,
    radius: f64,
    rounding: f64,
}

impl Ball {
    pub(crate) fn new(model: &ScaledModel, hierarchy: &Hierarchy, tables: &Tables) -> Self {
        let row = model.row;
        let rounded = DVec3::from_array(DVec3::AXES.map(|axis| model.rounding.per_norm(axis)));
        let mut rates = vec![DVec3::ZERO; tables.vertices.count()];
        for v in model.faces.as_flattened() {
            let modes = model.modes(*v);
            let norm = |axis: usize| norm_up(modes[axis * row..][..row].iter().map(|a| a * a).sum(), row);
            rates[tables.vertices.place(*v) as usize] = DVec3::new(norm(0), norm(1), norm(2)) + rounded;
        }
        let mut node_rates = vec![DVec3::ZERO; hierarchy.nodes().len()];
        // Parents come before their children.
        for (n, node) in hierarchy.nodes().iter().enumerate().rev() {
            node_rates[n] = match tables.clusters.of_node(n as u32) {
                Some(cluster) => {
                    let vertices = tables.clusters.vertices(cluster).iter();
                    vertices.fold(DVec3::ZERO, |most, v| most.max(rates[*v as usize]))
                }
                None => node.children().fold(DVec3::ZERO, |most, n| most.max(node_rates[n as usize])),
            };
        }
        Self { rates, node_rates, radius: 0.0, rounding: 0.0 }
    }

    /// From now on the ball has this radius, and the reach of the shape in it is at most that.
    pub(crate) fn set(&mut self, radius: f64, reach: f64, rank: usize) {
        self.radius = radius;
        self.rounding = right_or!(4.0 * volumes::margin(reach, rank), BallExact, 0.0);
    }

    /// By how much the vertex at a place may move.
    #[inline]
    pub(crate) fn of_vertex(&self, place: u32) -> DVec3 {
        let radius = right_or!(self.radius, BallVerticesHalfAsFar, 0.5 * self.radius);
        self.rates[place as usize] * radius + self.rounding
    }

    /// By how much any vertex of a node may move.
    #[inline]
    pub(crate) fn of_node(&self, node: u32) -> DVec3 {
        let radius = right_or!(self.radius, BallNodesHalfAsFar, 0.5 * self.radius);
        self.node_rates[node as usize] * radius + self.rounding
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::kinetic::tests::{Random, strips};
    use crate::{Certificates, CertifyOptions, Query, Scope};

    /// Vertices stay where the ball says, also for the way that moves them farthest; and some nearly leave.
    #[test]
    fn vertices_stay_in_the_ball() {
        let (mut checked, mut farthest) = (0, 0.0_f64);
        for case in 0..100 {
            let random = &mut Random(case as u64 + 77);
            let (model, _) = strips(random, case);
            let (rank, scope) = (model.rank(), Scope::of(&model));
            let options = CertifyOptions { epsilon: 0.9, budget: 0, ..CertifyOptions::default() };
            let certificates = Certificates::compute(&model, &options, &()).unwrap();
            let query = Query::new(&model, &certificates).unwrap();
            let tables = &query.discrete.boxes.tables;
            let scaled = ScaledModel::new(&model, &scope.metric, &scope.center);
            let mut ball = Ball::new(&scaled, certificates.hierarchy(), tables);
            let q: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
            let radius = 10.0_f64.powf(random.signed() * 8.0 - 7.0);
            let reach = 2.0 * model.check_coordinates(&q).unwrap();
            ball.set(radius, reach, rank);
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
                    let allowed = ball.of_vertex(tables.vertices.place(v));
                    assert!(moved.cmple(allowed).all(), "case {case}: {moved} {allowed}");
                    // All triangles are in one cluster.
                    assert!(moved.cmple(ball.of_node(tables.clusters.node(0))).all());
                    farthest = farthest.max(moved[axis] / allowed[axis]);
                    checked += 1;
                }
            }
        }
        assert!(checked > 2000 && farthest > 0.999, "{checked} {farthest}");
    }
}
