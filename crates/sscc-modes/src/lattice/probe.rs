//! Additional probes for pieces of a cell that the sample lines have not connected.
//!
//! If a flat side cuts off the corner of a cell, or the corner of a cell cuts off part of a thin wall, possibly no sample
//! line meets the patch there, though it belongs to the same piece as the rest of the cell. From each patch
//! - segments to samples of the other pieces join the pieces if they meet no triangle;
//! - a line inward to the opposite side joins both sides, if no sample line met the patch.

use glam::DVec3;
use robust::{Coord3D, orient3d};
use sscc::Error;
use sscc::parts::DisjointSets;

use super::cells::{CELL_SAMPLES, Cells};
use super::crossings::{SAMPLES, cross, sample_at};
use super::pieces::SampleSet;
use crate::cancel::TestCounter;

/// A cell with triangles.
pub(super) struct Probe<'a> {
    /// All cells.
    pub cells: &'a Cells,
    /// Index of this cell.
    pub cell: usize,
    /// Corner of the cell with the smallest coordinates.
    pub low: DVec3,
    /// Corners of each of its triangles.
    pub corners: &'a [[DVec3; 3]],
    /// Centroid and area vector of the part of each triangle within the cell.
    pub parts: &'a [(DVec3, DVec3)],
    /// Samples inside the solid.
    pub samples: SampleSet,
    /// Whether a sample line met each element.
    pub pierced: &'a [bool],
}

impl Probe<'_> {
    /// Joins pieces that probes show to be connected. A cell of n patches costs up to 65 n tests of each triangle.
    ///
    /// # Errors
    /// When cancelled.
    pub fn join(&self, sets: &mut DisjointSets, tests: &mut TestCounter) -> Result<(), Error> {
        let triangles = self.corners.len();
        let element = |i: usize| self.cells.triangle_element(self.cell, i);
        let mut patches: Vec<(u32, usize)> = (0..triangles).map(|i| (sets.find(element(i)), i)).collect();
        patches.sort_unstable();
        for patch in patches.chunk_by(|a, b| a.0 == b.0) {
            let area = |i: usize| self.parts[i].1.length();
            let largest =
                patch.iter().map(|part| part.1).reduce(|i, j| if area(j) > area(i) { j } else { i });
            let Some(own) = largest.filter(|i| area(*i) > 0.0) else { continue };
            self.join_samples(own, sets, tests)?;
            tests.add(triangles)?;
            let is_met = patch.iter().any(|part| self.pierced[element(part.1) as usize]);
            if !is_met && let Some(other) = self.opposite(own) {
                sets.unite(element(own), element(other));
            }
        }
        Ok(())
    }

    /// Joins a triangle with the samples that are visible inward from its centroid.
    fn join_samples(
        &self,
        own: usize,
        sets: &mut DisjointSets,
        tests: &mut TestCounter,
    ) -> Result<(), Error> {
        let (start, area) = self.parts[own];
        let first = self.cells.first_element(self.cell);
        for number in (0..CELL_SAMPLES).filter(|k| self.samples >> k & 1 == 1) {
            let of = self.cells.triangle_element(self.cell, own);
            if sets.find(of) == sets.find(first + number) {
                continue;
            }
            let place = [number % SAMPLES, number / SAMPLES % SAMPLES, number / (SAMPLES * SAMPLES)];
            let sample = self.low + DVec3::from_array(place.map(sample_at));
            let is_inward = (sample - start).dot(area) < 0.0;
            if !is_inward {
                continue;
            }
            tests.add(self.corners.len())?;
            if (0..self.corners.len()).all(|i| i == own || !blocks(self.corners[i], start, sample)) {
                sets.unite(of, first + number);
            }
        }
        Ok(())
    }

    /// Returns the triangle at which a line inward from the centroid of a triangle leaves the solid within the cell.
    fn opposite(&self, own: usize) -> Option<usize> {
        let (start, area) = self.parts[own];
        let axis = area.abs().max_position();
        let inward = -area[axis].signum();
        let at = [start[(axis + 1) % 3], start[(axis + 2) % 3]];
        let (distance, leaves, other) = (0..self.corners.len())
            .filter(|i| *i != own)
            .filter_map(|i| cross(axis, at, self.corners[i]).map(|(along, forward)| (along, forward, i)))
            .map(|(along, forward, i)| ((along - start[axis]) * inward, forward == (inward > 0.0), i))
            .filter(|(distance, ..)| *distance >= 0.0)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)))?;
        let end = start[axis] + inward * distance - self.low[axis];
        (leaves && (0.0..=1.0).contains(&end)).then_some(other)
    }
}

/// Whether a segment meets or touches a triangle.
fn blocks(corners: [DVec3; 3], from: DVec3, to: DVec3) -> bool {
    let point = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    let [a, b, c] = corners.map(point);
    let (p, q) = (point(from), point(to));
    if orient3d(a, b, c, p) * orient3d(a, b, c, q) > 0.0 {
        return false;
    }
    let sides = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
}
