//! The sweep of one mode, for the page's column of first collisions.

use serde::{Deserialize, Serialize};
use sscc::{ModeRange, Pair, Query, Sweep, SweepOutcome};

use super::cancellation::Cancellation;
use super::check::MAX_LISTED_PAIRS;
use crate::ViewError;

/// A mode and the range of its weight.
#[derive(Clone, Debug, Deserialize)]
pub struct SweepRequest {
    /// The q with the other weights, and the weight at the start (r numbers).
    q: Vec<f64>,
    /// The mode, from 0.
    mode: usize,
    /// The smallest and the largest weight.
    range: [f64; 2],
}

/// The result of a sweep in one direction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepAnswer {
    from: f64,
    to: f64,
    /// The shape is proven free from `from` up to this weight; `None` if it collides at `from`.
    first_free: Option<f64>,
    /// A weight at which the shape collides, or comes within the tolerance (a grazing contact); `None` if none was found up to
    /// `to`. It need not be the first one if `note` states that nothing is proven beyond `first_free`: see [`SweepOutcome`].
    first_hit: Option<f64>,
    /// The first of the pairs that collide there, or come within the tolerance, sorted.
    pairs: Vec<Pair>,
    /// The number of these pairs.
    count: usize,
    /// The outcome in words, unless the sweep is free or ends at a collision.
    note: Option<String>,
}

impl From<Sweep> for SweepAnswer {
    fn from(mut sweep: Sweep) -> Self {
        let is_usual = matches!(sweep.outcome, SweepOutcome::Free | SweepOutcome::Hit);
        let count = sweep.pairs.len();
        sweep.pairs.truncate(MAX_LISTED_PAIRS);
        Self {
            from: sweep.from,
            to: sweep.to,
            first_free: sweep.first_free,
            first_hit: sweep.first_hit,
            pairs: sweep.pairs,
            count,
            note: (!is_usual).then(|| sweep.outcome.to_string()),
        }
    }
}

/// Sweeps a mode upwards, then downwards.
pub(super) fn sweep(
    query: &Query,
    SweepRequest { q, mode, range }: &SweepRequest,
    cancellation: &Cancellation,
) -> Result<Vec<SweepAnswer>, ViewError> {
    let [low, high] = *range;
    let sweeps = query.sweep_modes(q, &[ModeRange { mode: *mode, low, high }], None, cancellation);
    let sweeps = sweeps.map_err(|error| cancellation.explain(error))?;
    Ok(sweeps.into_iter().map(SweepAnswer::from).collect())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering};

    use glam::DVec3;
    use sscc::{Certificates, CertifyOptions, Modes, ReducedModel, TriMesh};

    use super::*;

    /// Returns the result for two triangles of which the upper one is lowered, and the number of checks for cancellation. After
    /// `over` checks the time limit is reached; after `unwanted` checks the client has left.
    fn lowered(over: u32, unwanted: u32) -> (Result<Vec<SweepAnswer>, ViewError>, u32) {
        let below = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let positions = [below, below.map(|p| p + DVec3::Z)].concat();
        let modes = Modes::from_matrix(6, 1, |row, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 });
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let model = ReducedModel::new(mesh, modes.unwrap()).unwrap();
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        let query = Query::new(&model, &certificates).unwrap();
        let checks = Arc::new(AtomicU32::new(0));
        let [before, until] = [(); 2].map(|()| Arc::clone(&checks));
        let is_over = move || before.load(Ordering::Relaxed) > over;
        let is_wanted = move || until.fetch_add(1, Ordering::Relaxed) < unwanted;
        let cancellation = Cancellation::new(None, is_over, is_wanted);
        let request = SweepRequest { q: vec![0.0], mode: 0, range: [-3.0, 3.0] };
        let answer = sweep(&query, &request, &cancellation);
        (answer, checks.load(Ordering::Relaxed))
    }

    #[test]
    fn a_sweep_ends_at_its_time_limit_and_when_it_is_no_longer_wanted() {
        let (whole, checks) = lowered(u32::MAX, u32::MAX);
        let whole = whole.unwrap();
        assert_eq!((whole[0].to, whole[1].to, whole[1].first_hit), (3.0, -3.0, None));
        assert_eq!((&whole[0].pairs[..], whole[0].count, &whole[0].note), (&[(0, 1)][..], 1, &None));
        assert!(checks > 0);
        assert!(lowered(0, u32::MAX).0.unwrap_err().to_string().contains("no result within 10 s"));
        assert!(lowered(u32::MAX, 0).0.unwrap_err().to_string().contains("a newer search"));
    }
}
