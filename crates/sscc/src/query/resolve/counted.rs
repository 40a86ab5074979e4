//! The pairs that count in a search for a free configuration: all pairs, or all except exceptions.

use crate::query::query::Query;
use crate::{Certificates, Error, Pair};

/// The pairs that count in a search.
pub(super) struct Counted {
    /// The certificates whose exceptions do not count; `None` if all pairs count.
    certificates: Option<Certificates>,
}

impl Counted {
    /// Creates the set. `all`: exceptions count, too.
    pub(super) fn new(query: &Query, all: bool) -> Self {
        Self { certificates: query.context.certificates.clone().filter(|_| !all) }
    }

    fn exceptions(&self) -> &[Pair] {
        self.certificates.as_ref().map_or(&[], Certificates::exceptions)
    }

    /// Whether a pair counts.
    pub(super) fn contains(&self, pair: Pair) -> bool {
        self.exceptions().binary_search(&pair).is_err()
    }

    /// Returns the number of pairs that do not count: among more colliding pairs than this at least one counts.
    pub(super) fn others(&self) -> usize {
        self.exceptions().len()
    }

    /// Whether a configuration is free of pairs that count.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub(super) fn is_free(&self, query: &mut Query, q: &[f64]) -> Result<bool, Error> {
        let pairs = query.discrete_at_most(q, with_mutant!(self.others() + 1, ResolvedByFirstPair, 1))?;
        Ok(!pairs.iter().any(|pair| self.contains(*pair)))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::{Certificates, CertifyOptions, Modes, ReducedModel, TriMesh};

    #[test]
    fn exceptions_hide_no_pair_that_counts() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let standing = [[0.25, 0.25, -0.5], [0.25, 0.375, 0.5], [0.375, 0.25, 0.5]].map(DVec3::from);
        let mut p = Vec::new();
        for (i, height) in [0.0, 0.0, 1.5].into_iter().enumerate() {
            let place = DVec3::X * (10.0 * i as f64);
            p.extend(flat.map(|x| x + place));
            p.extend(standing.map(|x| x + place + DVec3::Z * height));
        }
        let faces = (0..6).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let modes = (0..18).map(|v| if v < 15 { DVec3::ZERO } else { DVec3::NEG_Z }).collect();
        let mesh = TriMesh::new(p, faces).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        assert_eq!(certificates.exceptions(), [(0, 1), (2, 3)]);
        let mut query = Query::new(&model, &certificates).unwrap();
        let counted = Counted::new(&query, false);
        assert!(counted.is_free(&mut query, &[0.0]).unwrap());
        assert!(!counted.is_free(&mut query, &[1.5]).unwrap());
    }
}
