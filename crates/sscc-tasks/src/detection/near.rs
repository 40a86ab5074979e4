//! The pairs of triangles nearer than a clearance, and the smallest distance.

use sscc::{Error, NearPair, Pair};

/// The distances of one query.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Near {
    /// Distance of each pair nearer than the clearance (model unit).
    pub distances: Vec<f64>,
    /// The nearest pair that counts, even if it is not nearer than the clearance. None if no pair counts, or if it is not
    /// nearer and certificates do not determine its distance.
    pub nearest: Option<NearPair>,
    /// Whether no pair is near, and certificates do not determine the smallest distance.
    pub is_open: bool,
}

impl Near {
    /// Returns the distances of the near pairs at the places `kept` of `pairs`, and the nearest of these pairs; None if
    /// `kept` is empty.
    pub(super) fn of_pairs(&self, pairs: &[Pair], kept: &[usize]) -> Self {
        let near = |i: &usize| NearPair { pair: pairs[*i], distance: self.distances[*i] };
        Self {
            distances: kept.iter().map(|i| self.distances[*i]).collect(),
            nearest: kept.iter().map(near).min_by(|a, b| a.distance.total_cmp(&b.distance)),
            is_open: false,
        }
    }

    /// Returns the near pairs and their distances. The nearest pair is known only if a pair is near.
    pub(super) fn of_certified(found: Vec<NearPair>) -> (Vec<Pair>, Self) {
        let nearest = found.iter().copied().min_by(|a, b| a.distance.total_cmp(&b.distance));
        let distances = found.iter().map(|near| near.distance).collect();
        let near = Self { distances, nearest, is_open: nearest.is_none() };
        (found.into_iter().map(|near| near.pair).collect(), near)
    }

    /// Returns the near pairs and their distances. `nearest` searches for the nearest pair if no pair is near.
    pub(super) fn of(
        found: Vec<NearPair>,
        nearest: impl FnOnce() -> Result<Option<NearPair>, Error>,
    ) -> Result<(Vec<Pair>, Self), Error> {
        let (pairs, near) = Self::of_certified(found);
        let nearest = if near.is_open { nearest()? } else { near.nearest };
        Ok((pairs, Self { nearest, is_open: false, ..near }))
    }
}
