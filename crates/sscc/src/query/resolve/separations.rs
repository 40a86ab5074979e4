//! Separating directions of near triangle pairs, and the half-spaces in q-space in which they separate.
//!
//! At the current q the direction n between the closest points of two simplices separates them. With the scaled modes A of
//! their corners, the gap of corners i and j after a displacement s in z is `n.d_ij + (A_j - A_i)'n . s`, which is linear
//! in s. So within the nine half-spaces "gap at least the margin" n separates the pair; they are the half-spaces of the
//! pair. They do not cover the rounding of positions, so every q must be checked.

use std::collections::HashSet;
use std::ops::Range;

use glam::DVec3;

use super::projection::{dot, length};
use crate::Pair;
use crate::geometry::nearest_to_origin;
use crate::query::context::QueryContext;

/// Corners of the two simplices of a pair: three of each.
const CORNERS: usize = 6;

/// Once the half-spaces of all pairs take this much memory (bytes), no more pairs are added.
const MAX_BYTES: usize = 1 << 26;
/// The largest number of simplex pairs.
const MAX_SEPARATIONS: usize = 1 << 14;

/// The separating direction of one pair of simplices.
struct Separation {
    pair: Pair,
    /// Positions of the six corners along the direction, relative to the first one.
    positions: [f64; CORNERS],
    /// The smallest gap that the half-spaces allow.
    margin: f64,
    /// The range of its modes in [`Separations::modes`].
    modes: Range<usize>,
}

/// Separating directions of all near pairs that were added.
pub(super) struct Separations {
    list: Vec<Separation>,
    known: HashSet<Pair>,
    /// The modes of each separation that move its corners along the direction. Few modes move a vertex of a skin.
    modes: Vec<u32>,
    /// Six rows of each separation: the rates of its corners along the direction, for its modes.
    rates: Vec<f64>,
    rank: usize,
    /// Scratch: the scaled modes of a vertex, and six rows for all modes.
    scaled: Vec<DVec3>,
    rows: Vec<f64>,
}

impl Separations {
    pub(super) fn new(rank: usize) -> Self {
        Self {
            list: Vec::new(),
            known: HashSet::new(),
            modes: Vec::new(),
            rates: Vec::new(),
            rank,
            scaled: vec![DVec3::ZERO; rank],
            rows: Vec::new(),
        }
    }

    /// Adds a pair with its directions at q. `margin`: the gap to keep; a smaller gap is kept as it is. False if, up to
    /// rounding, no direction separates the pair, or the memory is used up.
    pub(super) fn add(&mut self, context: &QueryContext, q: &[f64], pair: Pair, margin: f64) -> bool {
        let count = self.list.len();
        for simplices in context.detect.filter.simplex_pairs(pair.0, pair.1) {
            let vertices: [u32; CORNERS] =
                std::array::from_fn(|i| if i < 3 { simplices.a[i] } else { simplices.b[i - 3] });
            if !self.add_simplices(context, q, pair, vertices, margin) {
                self.list.truncate(count);
                let modes = self.list.last().map_or(0, |last| last.modes.end);
                self.modes.truncate(modes);
                self.rates.truncate(CORNERS * modes);
                return false;
            }
        }
        self.known.insert(pair);
        self.list.len() > count
    }

    fn add_simplices(
        &mut self,
        context: &QueryContext,
        q: &[f64],
        pair: Pair,
        vertices: [u32; CORNERS],
        margin: f64,
    ) -> bool {
        let bytes = size_of_val(&self.rates[..]) + size_of_val(&self.modes[..]);
        if self.list.len() >= MAX_SEPARATIONS || (bytes >= MAX_BYTES && !self.list.is_empty()) {
            return false;
        }
        let model = &context.model;
        let corners = vertices.map(|v| model.position(v, q));
        let differences: [DVec3; 9] = std::array::from_fn(|ij| corners[3 + ij % 3] - corners[ij / 3]);
        let dir = nearest_to_origin(&differences).point;
        let dir = dir / length(&dir.to_array());
        let positions = corners.map(|x| dir.dot(x - corners[0]));
        let gap = smallest_gap(&positions);
        // NaN must fail this test, too.
        if !(gap > 0.0 && gap.is_finite()) {
            return false;
        }
        let Self { modes, rates, rank, scaled, rows, .. } = self;
        rows.clear();
        for v in vertices {
            context.scope.metric.scaled_modes(model.modes().of_vertex(v), scaled);
            rows.extend(scaled.iter().map(|mode| dir.dot(*mode)));
        }
        let first = modes.len();
        let moves = |k: &u32| (0..CORNERS).any(|corner| rows[corner * *rank + *k as usize] != 0.0);
        modes.extend((0..*rank as u32).filter(moves));
        let modes = first..modes.len();
        for corner in 0..CORNERS {
            rates.extend(self.modes[modes.clone()].iter().map(|k| rows[corner * *rank + *k as usize]));
        }
        self.list.push(Separation { pair, positions, margin: margin.min(gap), modes });
        true
    }

    /// Whether the pair was added.
    pub(super) fn contains(&self, pair: Pair) -> bool {
        self.known.contains(&pair)
    }

    /// Removes all pairs, and returns those that a displacement of this length could bring together.
    pub(super) fn take_near(&mut self, reach: f64) -> Vec<Pair> {
        let is_near = |at: &usize| {
            let separation = &self.list[*at];
            let gap = smallest_gap(&separation.positions);
            let rates: [&[f64]; CORNERS] = std::array::from_fn(|corner| self.row(*at, corner));
            // The sum of the largest rates of the corners bounds the rate of the gap.
            let largest = |rows: &[&[f64]]| rows.iter().map(|row| length(row)).fold(0.0, f64::max);
            let relative = largest(&rates[..3]) + largest(&rates[3..]);
            gap <= relative * reach
        };
        let mut pairs: Vec<Pair> =
            (0..self.list.len()).filter(is_near).map(|at| self.list[at].pair).collect();
        pairs.dedup();
        self.list.clear();
        self.known.clear();
        self.modes.clear();
        self.rates.clear();
        pairs
    }

    /// Returns the half-spaces `normal . s >= offset` that a displacement violates by more than a share of the margin: at
    /// most `count`, the most violated ones first, relative to the lengths of their normals.
    pub(super) fn most_violated(&self, displacement: &[f64], count: usize) -> Vec<(Vec<f64>, f64)> {
        let (mut violated, mut scratch) = (Vec::new(), Vec::new());
        for (at, separation) in self.list.iter().enumerate() {
            let rates = self.rates_along(at, displacement, &mut scratch);
            let positions = std::array::from_fn(|corner| separation.positions[corner] + rates[corner]);
            let (i, j) = nearest_corners(&positions);
            let violation = separation.margin - (positions[j] - positions[i]);
            if violation > TOLERANCE * separation.margin {
                let normal = self.row(at, j).iter().zip(self.row(at, i)).map(|(b, a)| b - a);
                let normal: Vec<f64> = normal.collect();
                let depth = violation / length(&normal).max(f64::MIN_POSITIVE);
                violated.push((depth, at, i, j));
            }
        }
        violated.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
        violated.truncate(count);
        let half_space = |(_, at, i, j): (f64, usize, usize, usize)| {
            let Separation { positions, margin, .. } = &self.list[at];
            let mut normal = vec![0.0; self.rank];
            self.normal(at, i, j).for_each(|(k, rate)| normal[k] = rate);
            (normal, margin - (positions[j] - positions[i]))
        };
        violated.into_iter().map(half_space).collect()
    }

    /// Returns the largest share of a displacement, at most 1, that stays in all half-spaces, up to twice the tolerance.
    pub(super) fn allowed_share(&self, displacement: &[f64]) -> f64 {
        let (mut share, mut scratch) = (1.0_f64, Vec::new());
        for (at, separation) in self.list.iter().enumerate() {
            let rates = self.rates_along(at, displacement, &mut scratch);
            for ij in 0..9 {
                let (i, j) = (ij / 3, 3 + ij % 3);
                let margin = separation.margin * (1.0 - 2.0 * TOLERANCE);
                let room = separation.positions[j] - separation.positions[i] - margin;
                let closing = rates[i] - rates[j];
                if closing > 0.0 {
                    share = share.min(room.max(0.0) / closing);
                }
            }
        }
        share
    }

    /// Returns how far a displacement moves the corners along the direction.
    #[inline(always)]
    fn rates_along(&self, at: usize, displacement: &[f64], scratch: &mut Vec<f64>) -> [f64; CORNERS] {
        let modes = &self.modes[self.list[at].modes.clone()];
        let mut of_modes = displacement;
        if modes.len() < self.rank {
            scratch.clear();
            scratch.extend(modes.iter().map(|k| displacement[*k as usize]));
            of_modes = with_mutant!(&scratch[..], HalfSpacesOfFirstModes, displacement);
        }
        let rates = &self.rates[CORNERS * self.list[at].modes.start..];
        std::array::from_fn(|corner| dot(&rates[corner * modes.len()..][..modes.len()], of_modes))
    }

    /// Returns the rates of a corner, for the modes of the separation.
    fn row(&self, at: usize, corner: usize) -> &[f64] {
        let modes = &self.list[at].modes;
        &self.rates[CORNERS * modes.start + corner * modes.len()..][..modes.len()]
    }

    /// Returns the rate of the gap of two corners, for each mode of the separation.
    fn normal(&self, at: usize, i: usize, j: usize) -> impl Iterator<Item = (usize, f64)> {
        let modes = self.modes[self.list[at].modes.clone()].iter();
        let rates = self.row(at, j).iter().zip(self.row(at, i)).map(|(b, a)| b - a);
        modes.map(|k| *k as usize).zip(rates)
    }
}

/// A half-space counts as violated beyond this share of the margin.
const TOLERANCE: f64 = 1e-3;

/// Returns the corner of the first simplex that is farthest along the direction, and the nearest one of the second simplex.
fn nearest_corners(positions: &[f64; CORNERS]) -> (usize, usize) {
    let i = (1..3).fold(0, |i, k| if positions[k] > positions[i] { k } else { i });
    let j = (4..6).fold(3, |j, k| if positions[k] < positions[j] { k } else { j });
    (i, j)
}

fn smallest_gap(positions: &[f64; CORNERS]) -> f64 {
    let (i, j) = nearest_corners(positions);
    positions[j] - positions[i]
}

#[cfg(test)]
mod tests;
