//! The hulls of the nodes of a hierarchy that are small enough for one.

use super::node_hull::{FrameRate, HullShape, NodeHull, Vertices};
use crate::ReducedModel;
use crate::hierarchy::{Hierarchy, NodePair};
use crate::model::rounding::larger_or_nan;
use crate::parallel;
use glam::DVec3;

/// Nodes of more triangles have no hull: a plane seldom separates them from others.
const MAX_TRIANGLES: u32 = 1024;

/// The hulls of a model's nodes, and the data by which a query places them. They do not depend on a metric.
pub(crate) struct NodeHulls {
    pub(super) rank: usize,
    /// For each node its hull; [`NONE`] if it has none.
    indices: Vec<u32>,
    frames: Vec<FrameRate>,
    shapes: Vec<HullShape>,
    /// The configuration about which offsets are measured.
    pub(super) configuration: Vec<f64>,
    /// An upper bound of the magnitude of every term of every position at this configuration.
    pub(super) reach: f64,
    /// The centre of the shape at this configuration.
    pub(super) center: DVec3,
    /// Half the size of the shape at this configuration.
    pub(super) half: f64,
    /// The largest magnitude of an entry of each mode.
    pub(super) sizes: Vec<f64>,
    /// For the shape at rest and each mode an upper bound of the coefficient of its factor in a coordinate of any core point of any hull.
    pub(super) weights: Vec<f64>,
}

const NONE: u32 = u32::MAX;

impl NodeHulls {
    /// Computes the hulls of the nodes of those pairs of which both nodes are small enough, about a configuration.
    /// `None` if the shape leaves the range of numbers, or is a point.
    pub(crate) fn new(
        model: &ReducedModel,
        hierarchy: &Hierarchy,
        pairs: &[NodePair],
        configuration: &[f64],
    ) -> Option<Self> {
        let reach = model.check_coordinates(configuration).ok()?;
        let (mesh, rank) = (model.mesh(), model.rank());
        let sizes: Vec<f64> = (0..rank).map(|k| model.mode_displacement_bound(k, 1.0)).collect();
        let mut positions: Vec<DVec3> =
            (0..mesh.rest_positions().len() as u32).map(|v| model.position(v, configuration)).collect();
        let used = mesh.used_vertices().into_iter().map(|v| positions[v as usize]);
        let (lower, upper) = used
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lower, upper), x| (lower.min(x), upper.max(x)));
        let center = lower * 0.5 + upper * 0.5;
        let half = (upper - center).max(center - lower).max_element();
        if !(half.is_normal() && sizes.iter().all(|size| size.is_finite())) {
            return None;
        }
        let mut modes = vec![DVec3::ZERO; positions.len() * rank];
        for v in mesh.used_vertices() {
            positions[v as usize] = (positions[v as usize] - center) / half;
            let scaled =
                modes[v as usize * rank..][..rank].iter_mut().zip(model.modes().of_vertex(v)).zip(&sizes);
            scaled
                .for_each(|((scaled, u), size)| *scaled = if *size > 0.0 { *u / *size } else { DVec3::ZERO });
        }
        let vertices = Vertices { positions: &positions, modes: &modes, rank };
        let is_small = |n: u32| hierarchy.nodes()[n as usize].triangle_count <= MAX_TRIANGLES;
        let mut is_wanted = vec![false; hierarchy.nodes().len()];
        for &(n, m) in pairs.iter().filter(|(n, m)| is_small(*n) && is_small(*m)) {
            [n, m].iter().for_each(|n| is_wanted[*n as usize] = true);
        }
        let wanted: Vec<usize> = (0..is_wanted.len()).filter(|n| is_wanted[*n]).collect();
        let fit = |residuals: &mut Vec<DVec3>, n: &usize| {
            let of_node = hierarchy.vertices(&hierarchy.nodes()[*n], mesh.faces());
            NodeHull::fit(&vertices, &of_node, residuals)
        };
        let hulls: Vec<NodeHull> = parallel::map_with(&wanted, usize::MAX, Vec::new, fit);
        let mut indices = vec![NONE; hierarchy.nodes().len()];
        wanted.iter().enumerate().for_each(|(i, n)| indices[*n] = i as u32);
        let mut weights = vec![0.0_f64; rank + 1];
        let (mut frames, mut shapes) = (Vec::new(), Vec::new());
        for hull in hulls {
            for (weight, rows) in weights.iter_mut().zip(&hull.frame) {
                let of_row = rows[..3].iter().map(|row| f64::from(row.abs().element_sum()));
                *weight = of_row.fold(*weight, larger_or_nan);
            }
            frames.extend(hull.frame);
            shapes.push(hull.shape);
        }
        weights.iter_mut().for_each(|weight| *weight *= 1.0 + 1e-6);
        let configuration = configuration.to_vec();
        Some(Self { rank, indices, frames, shapes, configuration, reach, center, half, sizes, weights })
    }

    /// Returns the number of hulls.
    pub(crate) fn count(&self) -> usize {
        self.shapes.len()
    }

    /// Returns all nodes that have a hull, each with the index of its hull.
    pub(super) fn all(&self) -> impl Iterator<Item = (u32, usize)> {
        let nodes = self.indices.iter().zip(0..).filter(|(index, _)| **index != NONE);
        nodes.map(|(index, node)| (node, *index as usize))
    }

    /// Returns the index of the hull of a node.
    #[inline]
    pub(super) fn index_of(&self, node: u32) -> Option<usize> {
        let index = self.indices[node as usize];
        (index != NONE).then_some(index as usize)
    }

    /// Returns the frame of a hull: at rest, then for each mode.
    #[inline]
    pub(super) fn frame(&self, index: usize) -> &[FrameRate] {
        &self.frames[index * (self.rank + 1)..][..self.rank + 1]
    }

    #[inline]
    pub(super) fn shape(&self, index: usize) -> &HullShape {
        &self.shapes[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificates::Scope;
    use crate::test_models::Random;
    use crate::{Modes, TriMesh};

    /// Returns a strip of triangles far from the origin, and its hierarchy. `modes`: the displacements of a vertex, from
    /// its position.
    fn strip(triangles: u32, modes: impl FnMut(&DVec3) -> Vec<DVec3>) -> (ReducedModel, Hierarchy) {
        let random = &mut Random(u64::from(triangles));
        let at =
            |i: u32| DVec3::new(10.0 + 0.01 * f64::from(i), f64::from(i % 2), 0.0) + random.vector() * 0.1;
        let positions: Vec<DVec3> = (0..triangles + 2).map(at).collect();
        let rows: Vec<DVec3> = positions.iter().flat_map(modes).collect();
        let modes = Modes::new(rows.len() / positions.len(), rows).unwrap();
        let faces = (0..triangles).map(|i| [i, i + 1, i + 2]).collect();
        let model = ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes).unwrap();
        let hierarchy = Hierarchy::build(&model, &Scope::of(&model).metric);
        (model, hierarchy)
    }

    /// The units are half the size of the shape and the largest entry of each mode, and the weights are the largest sums
    /// of the coefficients of any row of any hull. A mode that moves nothing is no obstacle.
    #[test]
    fn units_and_weights_are_those_of_all_hulls() {
        let random = &mut Random(2);
        let (model, hierarchy) = strip(100, |_| vec![random.vector(), DVec3::ZERO, random.vector() * 100.0]);
        let all: Vec<NodePair> = (0..hierarchy.nodes().len() as u32).map(|n| (n, n)).collect();
        let q = [0.3, 5.0, -0.01];
        let hulls = NodeHulls::new(&model, &hierarchy, &all, &q).unwrap();
        assert_eq!((hulls.count(), hulls.configuration.as_slice()), (all.len(), &q[..]));
        let positions = model.positions(&q).unwrap();
        let lower = positions.iter().copied().reduce(DVec3::min).unwrap();
        let upper = positions.iter().copied().reduce(DVec3::max).unwrap();
        assert!(hulls.center.abs_diff_eq((lower + upper) / 2.0, 1e-12), "{}", hulls.center);
        assert!((hulls.half - (upper - lower).max_element() / 2.0).abs() < 1e-12, "{}", hulls.half);
        for k in 0..3 {
            let entries = model.modes().displacements().iter().skip(k).step_by(3);
            assert_eq!(hulls.sizes[k], entries.map(|u| u.abs().max_element()).fold(0.0, f64::max));
        }
        for (k, weight) in hulls.weights.iter().enumerate() {
            let rows = hulls.all().flat_map(|(_, index)| hulls.frame(index)[k][..3].iter());
            let most = rows.map(|row| row.as_dvec4().abs().element_sum()).fold(0.0, f64::max);
            assert!((most..=most * (1.0 + 2e-6)).contains(weight), "{k}: {weight} {most}");
        }
    }

    /// Two nodes have hulls if neither has too many triangles. A shape that is a point has none.
    #[test]
    fn only_small_nodes_have_a_hull() {
        let (model, hierarchy) = strip(MAX_TRIANGLES, |_| vec![DVec3::X]);
        assert_eq!(NodeHulls::new(&model, &hierarchy, &[(0, 0)], &[0.0]).unwrap().count(), 1);
        let (model, hierarchy) = strip(MAX_TRIANGLES + 1, |_| vec![DVec3::X]);
        assert_eq!(NodeHulls::new(&model, &hierarchy, &[(0, 1), (2, 0)], &[0.0]).unwrap().count(), 0);
        let (model, hierarchy) = strip(20, |x| vec![-*x]);
        assert!(NodeHulls::new(&model, &hierarchy, &[(0, 0)], &[1.0]).is_none());
    }
}
