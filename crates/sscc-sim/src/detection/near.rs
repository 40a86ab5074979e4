//! Which triangles are nearer than a clearance, and the smallest distance.

use sscc::{Error, NearPair, Pair};

/// The distances of one query.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Near {
    /// Distance of each pair nearer than the clearance (model unit).
    pub distances: Vec<f64>,
    /// The nearest pair that counts, also where it is not nearer than the clearance; none where no pair counts.
    pub nearest: Option<NearPair>,
}

impl Near {
    /// Returns the near pairs and their distances. `nearest` searches for the nearest pair, where none is near.
    pub(super) fn of(
        found: Vec<NearPair>,
        nearest: impl FnOnce() -> Result<Option<NearPair>, Error>,
    ) -> Result<(Vec<Pair>, Self), Error> {
        let listed = found.iter().copied().min_by(|a, b| a.distance.total_cmp(&b.distance));
        let nearest = if listed.is_some() { listed } else { nearest()? };
        let distances = found.iter().map(|near| near.distance).collect();
        Ok((found.into_iter().map(|near| near.pair).collect(), Self { distances, nearest }))
    }
}
