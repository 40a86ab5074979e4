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
