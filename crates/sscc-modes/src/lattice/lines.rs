//! Where lines along the axes are inside a surface.
//!
//! Which triangles a line meets is decided exactly, as if the line was moved by an infinitely small way that is the same
//! for all triangles: so it meets a closed surface as often from outside as from inside.

use robust::{Coord, orient2d};

use super::grid::{Grid, SAMPLES};
use super::surface::Surface;

/// A stretch of a line inside the surface.
#[derive(Clone, Copy)]
pub(super) struct Inside {
    /// Where it begins and ends (coordinate along the line).
    pub ends: [f64; 2],
    /// The faces there.
    pub faces: [u32; 2],
}

/// All stretches of all lines; for each axis, the lines by their samples across.
pub(super) struct Lines {
    axes: [Vec<Vec<Inside>>; 3],
}

/// A place where a line meets the surface.
#[derive(Clone, Copy)]
struct Crossing {
    at: f64,
    face: u32,
    enters: bool,
}

impl Lines {
    /// Lines along the axes through all samples.
    pub fn through(surface: &Surface, grid: &Grid) -> Self {
        Self { axes: [0, 1, 2].map(|axis| along(surface, grid, axis)) }
    }

    /// Tells each stretch: the axis, the samples across (of the next axis and the one after), the stretch.
    pub fn each(&self, grid: &Grid, mut tell: impl FnMut(usize, [usize; 2], Inside)) {
        for (axis, lines) in self.axes.iter().enumerate() {
            let width = grid.size[(axis + 1) % 3] * SAMPLES;
            for (line, stretches) in lines.iter().enumerate() {
                stretches.iter().for_each(|inside| tell(axis, [line % width, line / width], *inside));
            }
        }
    }
}

fn along(surface: &Surface, grid: &Grid, axis: usize) -> Vec<Vec<Inside>> {
    let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
    let width = grid.size[b] * SAMPLES;
    let mut crossings: Vec<Vec<Crossing>> = vec![Vec::new(); width * grid.size[c] * SAMPLES];
    for face in 0..surface.faces.len() as u32 {
        let corners = surface.corners(face);
        let flat = corners.map(|p| Coord { x: p[b], y: p[c] });
        let area = orient2d(flat[0], flat[1], flat[2]);
        if area == 0.0 {
            continue; // seen from the side
        }
        let range = |k: usize| {
            let x = corners.map(|p| p[k]);
            grid.samples_within(k, x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]))
        };
        for j in range(c) {
            for i in range(b) {
                let at = Coord { x: grid.sample_along(b, i), y: grid.sample_along(c, j) };
                let sides = [0, 1, 2].map(|k| side(flat[(k + 1) % 3], flat[(k + 2) % 3], at));
                if sides.iter().all(|s| (*s > 0.0) == (area > 0.0)) {
                    let along = corners.map(|p| p[axis]);
                    let crossing = Crossing { at: interpolated(flat, along, at), face, enters: area < 0.0 };
                    crossings[j * width + i].push(crossing);
                }
            }
        }
    }
    crossings.into_iter().map(stretches).collect()
}

/// The side of a point of a line, never 0 unless the ends are equal: a point on it is moved a little along x, and, if
/// that does not help, less along y.
fn side(a: Coord<f64>, b: Coord<f64>, p: Coord<f64>) -> f64 {
    match orient2d(a, b, p) {
        0.0 if a.y != b.y => a.y - b.y,
        0.0 => b.x - a.x,
        side => side,
    }
}

/// The coordinate of the triangle over a point, within those of its corners.
fn interpolated(flat: [Coord<f64>; 3], along: [f64; 3], at: Coord<f64>) -> f64 {
    let weights = [0, 1, 2].map(|k| orient2d(flat[(k + 1) % 3], flat[(k + 2) % 3], at).abs());
    let sum: f64 = weights.iter().sum();
    let mean: f64 = weights.iter().zip(along).map(|(w, x)| w / sum * x).sum();
    let (low, high) = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
    if mean.is_nan() { low } else { mean.clamp(low, high) }
}

/// Pairs the crossings of a line.
fn stretches(mut crossings: Vec<Crossing>) -> Vec<Inside> {
    crossings.sort_by(|a, b| a.at.total_cmp(&b.at).then(a.face.cmp(&b.face)));
    let mut found = Vec::with_capacity(crossings.len() / 2);
    let mut begin: Option<Crossing> = None;
    while !crossings.is_empty() {
        // Coordinates are rounded: of crossings at one place, first the one that changes the side.
        let same = crossings.iter().take_while(|c| c.at == crossings[0].at);
        let next = same.take(8).position(|c| c.enters != begin.is_some()).unwrap_or(0);
        let crossing = crossings.remove(next);
        match (begin, crossing.enters) {
            (None, true) => begin = Some(crossing),
            (Some(start), false) => {
                found.push(Inside { ends: [start.at, crossing.at], faces: [start.face, crossing.face] });
                begin = None;
            }
            _ => {} // closer together than rounding: one of the two counts
        }
    }
    found
}
