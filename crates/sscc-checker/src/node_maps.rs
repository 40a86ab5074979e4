//! Witnesses of node pairs: a direction, with an affine map of the modes of each node.
//!
//! A proof contains for each node a centre c and an affine map, `A_i ~ M + G (p_i - c)`. Any map is valid: the checker computes the
//! box of the node about c and the residuals of its vertices. All vertices lie in the hull of the eight corners of the box, whose
//! modes are those of the map, up to the residuals. So it is enough to check the pairs of corners of two boxes.

use std::sync::OnceLock;

use crate::certificates::Certificates;
use crate::dyadic::{Dyadic, Vector, dot, minus};
use crate::inequality::stays_open;
use crate::model::Model;
use crate::scaled::{Radius, ScaledModel};

/// Returns the number of numbers of a node's map: its centre, M by components, then G (for each direction three components, a row
/// each).
pub(crate) fn numbers_of_map(rank: usize) -> usize {
    3 + 12 * rank
}

/// The maps of all nodes, and the boxes of those that have been needed.
pub(crate) struct NodeMaps<'a> {
    model: &'a Model,
    scaled: &'a ScaledModel,
    certificates: &'a Certificates,
    numbers: &'a [u8],
    boxes: Vec<OnceLock<NodeBox>>,
}

struct NodeBox {
    center: Vector,
    /// Half extents about the centre.
    half: Vector,
    /// The largest residual along each axis.
    residual: Vector,
    modes: Vec<Dyadic>,
    gradient: Vec<Dyadic>,
}

impl<'a> NodeMaps<'a> {
    /// Creates the maps. `numbers`: [`numbers_of_map`] numbers of eight bytes for each node.
    pub(crate) fn new(
        model: &'a Model,
        scaled: &'a ScaledModel,
        certificates: &'a Certificates,
        numbers: &'a [u8],
    ) -> Self {
        let boxes = certificates.nodes.iter().map(|_| OnceLock::new()).collect();
        Self { model, scaled, certificates, numbers, boxes }
    }

    /// Whether a direction separates all vertices of two nodes below a radius.
    pub(crate) fn are_apart(&self, [n, m]: [u32; 2], dir: &Vector, radius: &Radius) -> bool {
        let [n, m] = [n, m].map(|n| self.boxes[n as usize].get_or_init(|| self.compute(n)));
        let [rest_error, rate_error] = self.scaled.errors(dir);
        let along = |residual: &Vector| dot(&dir.clone().map(|d| d.abs()), residual);
        let rate = &(&along(&m.residual) + &along(&n.residual)) + &rate_error;
        let [of_n, of_m] = [n, m].map(|node| node.corners(dir, self.scaled.rank));
        of_m.iter().all(|(at_m, row_m)| {
            of_n.iter().all(|(at_n, row_n)| {
                let gap = &(at_m - at_n) - &rest_error;
                let square = row_m.iter().zip(row_n).map(|(a, b)| (a - b).square()).sum();
                stays_open(&gap, &rate, &square, radius)
            })
        })
    }

    fn compute(&self, n: u32) -> NodeBox {
        let rank = self.scaled.rank;
        let len = 8 * numbers_of_map(rank);
        let numbers = self.numbers[n as usize * len..][..len].as_chunks().0.iter();
        let numbers: Vec<Dyadic> = numbers.map(|bytes| Dyadic::of(f64::from_le_bytes(*bytes))).collect();
        let center: Vector = std::array::from_fn(|c| numbers[c].clone());
        let (modes, gradient) = (numbers[3..][..3 * rank].to_vec(), numbers[3 + 3 * rank..].to_vec());
        let triangles = self.certificates.triangles(n).iter();
        let mut vertices: Vec<u32> = triangles.flat_map(|t| self.model.faces[*t as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let (mut half, mut squares) = (Vector::default(), Vector::default());
        for i in vertices {
            let offset = minus(&self.scaled.positions[i as usize], &center);
            for c in 0..3 {
                let residual = self.scaled.row(i, c).iter().enumerate().map(|(k, a)| {
                    let map = (0..3).map(|j| &offset[j] * &gradient[(3 * j + c) * rank + k]);
                    &(a - &modes[c * rank + k]) - &map.sum()
                });
                squares[c].raise(residual.map(|e| e.square()).sum());
                half[c].raise(offset[c].abs());
            }
        }
        NodeBox { center, half, residual: squares.map(|x| x.root_up()), modes, gradient }
    }
}

impl NodeBox {
    /// Returns position and modes of the eight corners along a direction.
    fn corners(&self, dir: &Vector, rank: usize) -> Vec<(Dyadic, Vec<Dyadic>)> {
        let along = |rows: &[Dyadic], k: usize| (0..3).map(|c| &dir[c] * &rows[c * rank + k]).sum::<Dyadic>();
        let center: Vec<Dyadic> = (0..rank).map(|k| along(&self.modes, k)).collect();
        let mut corners = vec![(dot(dir, &self.center), center)];
        for j in 0..3 {
            let step = &dir[j] * &self.half[j];
            let rows = &self.gradient[3 * j * rank..][..3 * rank];
            let row: Vec<Dyadic> = (0..rank).map(|k| &along(rows, k) * &self.half[j]).collect();
            let sides = |(at, modes): &(Dyadic, Vec<Dyadic>)| {
                let plus = modes.iter().zip(&row).map(|(a, b)| a + b).collect();
                let minus = modes.iter().zip(&row).map(|(a, b)| a - b).collect();
                [(at + &step, plus), (at - &step, minus)]
            };
            corners = corners.iter().flat_map(sides).collect();
        }
        corners
    }
}
