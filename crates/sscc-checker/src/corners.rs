//! Pairs of triangles or edges, and quarters of them, with exact positions and modes, and the directions that separate them.

use std::collections::HashMap;

use crate::dyadic::{Dyadic, Vector, dot, minus};
use crate::inequality::stays_open;
use crate::scaled::{Radius, ScaledModel};
use crate::scope::Simplices;

/// The number of values that a direction may keep. Lists of triangles of usual leaves and ranks have fewer. Values of others are
/// computed again, so that no proof exhausts the memory.
const MAX_KEPT: usize = 1 << 14;

/// A point of a triangle: its position at the centre and its modes (three rows).
#[derive(Clone)]
pub(crate) struct Corner {
    pub(crate) position: Vector,
    pub(crate) modes: Vec<Dyadic>,
}

/// A triangle, or a quarter of one.
pub(crate) type Triangle = [Corner; 3];

impl Corner {
    pub(crate) fn of(model: &ScaledModel, vertex: u32) -> Self {
        let modes = (0..3).flat_map(|c| model.row(vertex, c).iter().cloned()).collect();
        Self { position: model.positions[vertex as usize].clone(), modes }
    }

    fn middle(&self, other: &Self) -> Self {
        let half = |a: &Dyadic, b: &Dyadic| (a + b).times_power(-1);
        let modes = self.modes.iter().zip(&other.modes).map(|(a, b)| half(a, b)).collect();
        Self { position: std::array::from_fn(|c| half(&self.position[c], &other.position[c])), modes }
    }

    /// Returns position and modes along a direction.
    fn along(&self, dir: &Vector) -> (Dyadic, Vec<Dyadic>) {
        let rank = self.modes.len() / 3;
        let row = (0..rank).map(|k| (0..3).map(|c| &dir[c] * &self.modes[c * rank + k]).sum());
        (dot(dir, &self.position), row.collect())
    }
}

/// Returns the four quarters of a triangle, cut at the middles of its edges.
pub(crate) fn quarters([p, q, r]: &Triangle) -> [Triangle; 4] {
    let (pq, qr, rp) = (p.middle(q), q.middle(r), r.middle(p));
    let quarter = |a: &Corner, b: &Corner, c: &Corner| [a.clone(), b.clone(), c.clone()];
    [quarter(p, &pq, &rp), quarter(&pq, q, &qr), quarter(&rp, &qr, r), quarter(&pq, &qr, &rp)]
}

/// Returns the nine differences of corners, from the first triangle to the second.
pub(crate) fn differences(x: &Triangle, y: &Triangle) -> Vec<Vector> {
    x.iter().flat_map(|i| y.iter().map(move |j| minus(&j.position, &i.position))).collect()
}

/// A direction, and the positions and modes of vertices along it that have been computed.
pub(crate) struct Direction {
    dir: Vector,
    errors: [Dyadic; 2],
    vertices: HashMap<u32, (Dyadic, Vec<Dyadic>)>,
    apart: HashMap<[u32; 2], bool>,
}

impl Direction {
    pub(crate) fn new(model: &ScaledModel, dir: Vector) -> Self {
        let errors = model.errors(&dir);
        Self { dir, errors, vertices: HashMap::new(), apart: HashMap::new() }
    }

    /// Whether the direction separates two simplices below a radius, that is, all nine pairs of their corners. Results
    /// are kept, so all calls on one direction must have the same radius.
    pub(crate) fn separates(&mut self, model: &ScaledModel, [x, y]: Simplices, radius: &Radius) -> bool {
        let rank = self.vertices.values().next().map_or(0, |(_, row)| row.len());
        if self.vertices.len() * (rank + 1) > MAX_KEPT || self.apart.len() > MAX_KEPT {
            self.vertices.clear();
            self.apart.clear();
        }
        for i in x.into_iter().chain(y) {
            self.vertices.entry(i).or_insert_with(|| Corner::of(model, i).along(&self.dir));
        }
        let Self { errors, vertices, apart, .. } = self;
        x.into_iter().flat_map(|i| y.map(|j| [i, j])).all(|pair @ [i, j]| {
            *apart.entry(pair).or_insert_with(|| are_apart(&vertices[&i], &vertices[&j], errors, radius))
        })
    }

    /// Whether the direction separates two triangles, or quarters of them, below a radius.
    pub(crate) fn separates_corners(&self, x: &Triangle, y: &Triangle, radius: &Radius) -> bool {
        let [x, y] = [x, y].map(|triangle| triangle.each_ref().map(|corner| corner.along(&self.dir)));
        x.iter().all(|i| y.iter().all(|j| are_apart(i, j, &self.errors, radius)))
    }
}

fn are_apart(
    (at_i, row_i): &(Dyadic, Vec<Dyadic>),
    (at_j, row_j): &(Dyadic, Vec<Dyadic>),
    [rest_error, rate_error]: &[Dyadic; 2],
    radius: &Radius,
) -> bool {
    let gap = &(at_j - at_i) - rest_error;
    let square = row_i.iter().zip(row_j).map(|(a, b)| (a - b).square()).sum();
    stays_open(&gap, rate_error, &square, radius)
}
