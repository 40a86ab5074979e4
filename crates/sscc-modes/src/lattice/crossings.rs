//! Intervals of sample lines inside the solid.
//!
//! [`SAMPLES`]^2 lines go through the cross-section of each cell, and lines of different axes meet in samples, 64 in a
//! cell. A line that would hit an edge or a vertex is moved aside by an infinitesimal (e, e^2), e > 0, the same for all
//! triangles, and signs are exact: so a line through a closed surface enters as often as it leaves.

use glam::DVec3;
use robust::{Coord, orient2d};
use sscc::Progress;

use crate::cancel::check_cancelled;

/// Number of lines through a cell along each of the other axes. Even, so that each octant has half of them.
pub(super) const SAMPLES: u32 = 4;

/// Distance (in cells) of crossings whose order may be wrong by rounding.
const TIE: f64 = 1e-9;

/// An end of an interval: coordinate along the line (in cells), and triangle.
pub(super) type End = (f64, u32);

/// A part of a line inside the solid.
pub(super) struct Interval {
    /// Number of the line along the next axis and the one after it, in samples.
    pub line: [u32; 2],
    /// Begin.
    pub enter: End,
    /// End.
    pub leave: End,
}

/// Intersects a line along an axis with a triangle. Returns the coordinate along the axis, and whether the triangle's
/// normal points forward along it. `u`, `v` are the coordinates of the line along the next axis and the one after it.
pub(super) fn cross(axis: usize, [u, v]: [f64; 2], corners: [DVec3; 3]) -> Option<(f64, bool)> {
    let flat = corners.map(|p| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] });
    if flat[0] == flat[1] && flat[1] == flat[2] {
        return None;
    }
    let sides: [(f64, bool); 3] = std::array::from_fn(|k| {
        let (a, b) = (flat[(k + 1) % 3], flat[(k + 2) % 3]);
        let side = orient2d(a, b, Coord { x: u, y: v });
        // For a point on the line of the edge, the side of the point moved by (e, e^2) counts. For an edge that is a
        // point any side is valid: the other two edges are then opposite, and their sides differ.
        let left = if side != 0.0 { side > 0.0 } else { (b.y, a.x) < (a.y, b.x) };
        (side.abs(), left)
    });
    let forward = sides[0].1;
    if sides.iter().any(|side| side.1 != forward) {
        return None;
    }
    let along = corners.map(|p| p[axis]);
    let total: f64 = sides.iter().map(|side| side.0).sum();
    // Relative to one corner, which is more precise for small triangles. All weights have one sign.
    let moved = (1..3).map(|k| sides[k].0 * (along[k] - along[0])).sum::<f64>();
    let at = along[0] + if total > 0.0 { moved / total } else { 0.0 };
    let smallest = along.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Some((at.clamp(smallest, largest), forward))
}

/// Returns the coordinate of a line or a sample (in cells).
pub(super) fn sample_at(number: u32) -> f64 {
    (f64::from(number) + 0.5) / f64::from(SAMPLES)
}

struct Crossing {
    line: [u32; 2],
    end: End,
    leaves: bool,
}

/// Returns the inside intervals of all lines along an axis, in the order of lines and along them. Triangles of
/// inconsistent crossings, which enter the inside from the inside or leave the outside, are added to `odd`.
///
/// # Errors
/// When cancelled.
pub(super) fn intervals(
    axis: usize,
    points: &[DVec3],
    faces: &[[u32; 3]],
    odd: &mut Vec<u32>,
    progress: &dyn Progress,
) -> Result<Vec<Interval>, sscc::Error> {
    let mut crossings = Vec::new();
    for (number, face) in (0_u32..).zip(faces) {
        if number.is_multiple_of(4096) {
            check_cancelled(progress)?;
        }
        let corners = face.map(|v| points[v as usize]);
        let [u, v] = [1, 2].map(|k| corners.map(|p| p[(axis + k) % 3]));
        for row in lines_between(span(&v)) {
            for column in lines_between(slice(u, v, sample_at(row))) {
                let crossing = cross(axis, [sample_at(column), sample_at(row)], corners);
                crossings.extend(crossing.map(|(at, leaves)| Crossing {
                    line: [column, row],
                    end: (at, number),
                    leaves,
                }));
            }
        }
    }
    let place = |c: &Crossing| (c.line[1], c.line[0]);
    crossings.sort_unstable_by(|a, b| {
        place(a).cmp(&place(b)).then(a.end.0.total_cmp(&b.end.0)).then(a.end.1.cmp(&b.end.1))
    });
    let mut inside = Vec::new();
    for line in crossings.chunk_by_mut(|a, b| a.line == b.line) {
        pair_crossings(line, &mut inside, odd);
    }
    Ok(inside)
}

/// Adds the parts of one line with a positive winding number. The surface may be folded at triangles that share a vertex.
/// Elsewhere the winding number is 0 or 1, so another order is caused by rounding and corrected.
fn pair_crossings(line: &mut [Crossing], inside: &mut Vec<Interval>, odd: &mut Vec<u32>) {
    let (mut winding, mut enter) = (0, (0.0, 0));
    for i in 0..line.len() {
        let expected = winding >= 1;
        if line[i].leaves != expected {
            let reach = line[i].end.0 + TIE;
            let mut near = line[i..].iter().take_while(|c| c.end.0 <= reach);
            if let Some(ahead) = near.position(|c| c.leaves == expected) {
                line[i..=i + ahead].rotate_right(1);
            }
        }
        let Crossing { line: place, end, leaves } = line[i];
        winding += if leaves { -1 } else { 1 };
        match (leaves, winding) {
            (false, 1) => enter = end,
            (true, 0) => inside.push(Interval { line: place, enter, leave: (end.0.max(enter.0), end.1) }),
            _ => odd.push(end.1),
        }
    }
}

fn span(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
}

/// Returns the range of u in which a triangle meets a row.
fn slice(u: [f64; 3], v: [f64; 3], row: f64) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..3 {
        let (a, b) = (k, (k + 1) % 3);
        if v[a].min(v[b]) <= row && row <= v[a].max(v[b]) {
            let ends = if v[a] == v[b] {
                [u[a], u[b]]
            } else {
                [u[a] + (row - v[a]) / (v[b] - v[a]) * (u[b] - u[a]); 2]
            };
            (low, high) = (low.min(ends[0]).min(ends[1]), high.max(ends[0]).max(ends[1]));
        }
    }
    (low, high)
}

/// Returns the lines (or samples) between two coordinates in cells, with a margin for rounding.
pub(super) fn lines_between((low, high): (f64, f64)) -> std::ops::Range<u32> {
    let scale = f64::from(SAMPLES);
    // The casts saturate: negative numbers become 0, and an empty range of infinities stays empty.
    ((low - TIE) * scale + 0.5).floor() as u32..((high + TIE) * scale + 0.5).floor() as u32
}
