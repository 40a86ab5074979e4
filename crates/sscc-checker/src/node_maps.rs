//! Witnesses of node pairs: a direction, with an affine map of the modes of each node.
//!
//! A proof contains for each node a centre c and an affine map, `A_i ~ M + G (p_i - c)`. Any map is valid: the checker computes the
//! box of the node about c and the residuals of its vertices. All vertices lie in the hull of the eight corners of the box, whose
//! modes are those of the map, up to the residuals. So it is enough to check the pairs of corners of two boxes.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use crate::container::reals;
use crate::counted::CountedPairs;
use crate::dyadic::{Dyadic, Vector, dot};
use crate::points::{Radius, along, are_apart, difference, position, squared_residual, sum};
use crate::scaled::ScaledModel;

/// Returns the number of bytes of a node's map: c, M by components, then G (for each direction three components, a row each).
pub(crate) fn bytes_of_map(rank: usize) -> usize {
    8 * (3 + 12 * rank)
}

/// The maps of all nodes, and the boxes of those that have been needed.
pub(crate) struct NodeMaps<'a> {
    pub(crate) counted: &'a CountedPairs<'a>,
    pub(crate) scaled: &'a ScaledModel,
    /// [`bytes_of_map`] bytes for each node.
    pub(crate) numbers: &'a [u8],
    pub(crate) boxes: Vec<OnceLock<NodeBox>>,
}

/// The corners of a box, with the modes of the map: the sums of the centre and of each half extent or its negative.
pub(crate) struct NodeBox {
    center: Vec<Dyadic>,
    /// For each axis its unit vector with the rates of the map, as a point. With the half extent, this is half an edge of the box.
    axes: [Vec<Dyadic>; 3],
    half: Vector,
    /// The largest residual along each axis.
    residual: Vector,
}

impl NodeMaps<'_> {
    /// Whether a direction separates all vertices of two nodes below a radius.
    pub(crate) fn are_apart(&self, [n, m]: [u32; 2], dir: &Vector, radius: &Radius) -> bool {
        let [n, m] = [n, m].map(|n| self.boxes[n as usize].get_or_init(|| self.compute(n)));
        let [rest_error, rate_error] = self.scaled.errors(dir);
        let magnitudes = dir.each_ref().map(Dyadic::abs);
        let [of_m, of_n] = [m, n].map(|node| dot(&magnitudes, &node.residual));
        let errors = [rest_error, &(&of_m + &of_n) + &rate_error];
        let [of_n, of_m] = [n, m].map(|node| node.corners(dir));
        of_n.iter().all(|x| of_m.iter().all(|y| are_apart(x, y, &errors, radius)))
    }

    fn compute(&self, n: u32) -> NodeBox {
        let rank = self.scaled.rank;
        let len = bytes_of_map(rank);
        let numbers = reals(&self.numbers[n as usize * len..][..len]);
        let numbers: Vec<Dyadic> = numbers.into_iter().map(Dyadic::of).collect();
        let (center, rows) = numbers.split_at(3);
        let rows: Vec<&[Dyadic]> = rows.chunks(rank).collect();
        let center: Vec<Dyadic> = (0..3).flat_map(|c| [&center[c..=c], rows[c]].concat()).collect();
        let CountedPairs { model, certificates, .. } = self.counted;
        let triangles = certificates.triangles(n).iter();
        let vertices: BTreeSet<u32> = triangles.flat_map(|t| model.faces[*t as usize]).collect();
        let [mut half, mut squares] = <[Vector; 2]>::default();
        for i in vertices {
            let from_center = difference(self.scaled.point(i), &center);
            let offset = position(&from_center);
            for c in 0..3 {
                squares[c].raise(squared_residual(&from_center, c, [rows[3 + c], rows[6 + c], rows[9 + c]]));
                half[c].raise(offset[c].abs());
            }
        }
        let row = |j: usize, c: usize| [&[Dyadic::new(i64::from(c == j), 0)], rows[3 + 3 * j + c]].concat();
        let axes = std::array::from_fn(|j| (0..3).flat_map(|c| row(j, c)).collect());
        NodeBox { center, axes, half, residual: squares.map(|x| x.root_up()) }
    }
}

impl NodeBox {
    /// Returns the rows of the eight corners along a direction.
    fn corners(&self, dir: &Vector) -> Vec<Vec<Dyadic>> {
        let mut corners = vec![along(&self.center, dir)];
        for (axis, half) in self.axes.iter().zip(&self.half) {
            let step: Vec<Dyadic> = along(axis, dir).iter().map(|x| x * half).collect();
            corners = corners.iter().flat_map(|row| [sum(row, &step), difference(row, &step)]).collect();
        }
        corners
    }
}
