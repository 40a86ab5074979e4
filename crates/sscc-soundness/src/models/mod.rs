//! Adversarial models: surfaces, modes and transformations drawn at random.

mod modes;
pub mod pairs;
mod surfaces;

use crate::exact::Point;
use crate::random::Random;

/// A mesh and its modes.
#[derive(Clone, Debug)]
pub struct Model {
    /// Description for messages.
    pub name: String,
    /// Rest positions.
    pub points: Vec<Point>,
    /// Vertices of triangles.
    pub faces: Vec<[u32; 3]>,
    /// The number of modes.
    pub rank: usize,
    /// Displacement of each vertex by each mode, at index `vertex * rank + mode`.
    pub modes: Vec<Point>,
    /// Pairs of modes that are nearly equal: they cancel where their weights are opposite.
    pub twins: Vec<(usize, usize)>,
}

/// Range of lengths of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extremes {
    /// Lengths from 1e-300 to 1e60, and positions far from the origin.
    All,
    /// Lengths near 1.
    Shape,
}

impl Model {
    /// Returns a random model of about `least` triangles or more.
    pub fn random(random: &mut Random, least: usize, extremes: Extremes) -> Self {
        let surface = surfaces::random(random, least);
        let (modes, twins, rank) = modes::random(random, &surface);
        let surfaces::Surface { name, points, faces, .. } = surface;
        let mut model = Self { name, points, faces, rank, modes, twins };
        if random.one_in(3) {
            model.split_vertices(random);
        }
        if extremes == Extremes::All {
            model.transform(random);
        }
        model
    }

    /// Gives some corners a vertex of their own, as at texture seams.
    fn split_vertices(&mut self, random: &mut Random) {
        let rank = self.rank;
        for corner in self.faces.iter_mut().flatten() {
            if random.one_in(8) {
                let v = *corner as usize;
                self.points.push(self.points[v]);
                self.modes.extend_from_within(v * rank..(v + 1) * rank);
                *corner = self.points.len() as u32 - 1;
            }
        }
        self.name += " split";
    }

    /// Moves the model away from the origin, or makes it tiny or huge.
    fn transform(&mut self, random: &mut Random) {
        if random.one_in(4) {
            let distance = random.power(0.0, 13.0);
            let by = random.point().map(|x| x * distance);
            self.points.iter_mut().for_each(|p| *p = std::array::from_fn(|c| p[c] + by[c]));
            self.name += &format!(" moved by {distance:.0e}");
        }
        if random.one_in(4) {
            let size = random.power(-300.0, 55.0);
            let scaled = |p: &mut Point| *p = p.map(|x| x * size);
            self.points.iter_mut().for_each(scaled);
            let size_of_modes = if random.one_in(2) { size } else { 1.0 };
            self.modes.iter_mut().for_each(|p| *p = p.map(|x| x * size_of_modes));
            self.name += &format!(" times {size:.0e} (modes {size_of_modes:.0e})");
        }
    }

    /// Returns the shape at q, as `docs/guarantees.md` defines it.
    pub fn positions(&self, q: &[f64]) -> Vec<Point> {
        let at = |(v, p): (usize, &Point)| -> Point {
            let modes = &self.modes[v * self.rank..(v + 1) * self.rank];
            std::array::from_fn(|c| {
                let mut x = p[c];
                for (u, q) in modes.iter().zip(q) {
                    let product = u[c] * q;
                    x += product;
                }
                x
            })
        };
        self.points.iter().enumerate().map(at).collect()
    }
}
