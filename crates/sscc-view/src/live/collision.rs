//! The first self-collision along a direction.

use serde::{Deserialize, Serialize};
use sscc::{Certificates, Error, Pair, Query, ReducedModel};

use super::cancellation::Cancellation;
use super::check::{MAX_LISTED_PAIRS, MAX_PAIRS};
use crate::ViewError;

/// A direction from the centre.
#[derive(Clone, Debug, Deserialize)]
pub struct DirectionRequest {
    direction: Vec<f64>,
}

/// The result of a search along `centre + s direction`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DirectionAnswer {
    /// The safe scale: the certificates prove the shape free at every s up to it.
    certified: f64,
    /// The first collision; `None` if the shape collides nowhere up to `searched`.
    first: Option<FirstCollision>,
    /// The end of the search, which covers every s up to it: the first collision, the time limit, or the s at which
    /// some vertex has moved by half the diagonal of the AABB.
    searched: f64,
    /// Whether the search ended before its time limit.
    complete: bool,
}

/// The first collision.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct FirstCollision {
    /// The s of the collision; the shape is free at every smaller s.
    scale: f64,
    /// The pairs that collide there. Thin sheets may pass each other between two floating-point numbers; then these are the
    /// pairs with the earliest time of impact.
    pairs: Vec<Pair>,
}

/// Largest number of segments of a search.
const MAX_SEGMENTS: f64 = 64.0;

/// A time of impact may be slightly earlier than the contact. Discrete queries search for the contact at these
/// offsets, as shares of the largest scale.
const SEARCH_OFFSETS: [f64; 8] = [0.0, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7];

/// Impacts within this time of the first are simultaneous with it, as a share of a segment.
const SIMULTANEITY: f64 = 1e-9;

/// Searches the first collision along a direction from the centre.
pub(super) fn along(
    mut query: Query,
    model: &ReducedModel,
    certificates: &Certificates,
    DirectionRequest { direction }: &DirectionRequest,
    cancellation: &Cancellation,
) -> Result<DirectionAnswer, ViewError> {
    let center = certificates.center();
    model.check_coordinates(direction)?;
    let at = |scale: f64| -> Vec<f64> { center.iter().zip(direction).map(|(c, d)| c + scale * d).collect() };
    let certified = query.safe_scale(&at(1.0)).map_err(|error| cancellation.explain(error))?;
    let end = end(model, direction);
    let mut answer = DirectionAnswer { certified, first: None, searched: certified, complete: true };
    if certified.is_finite() && end.is_finite() {
        answer.searched = certified.min(end);
        while answer.first.is_none() && answer.searched < end {
            let to = (answer.searched + end / MAX_SEGMENTS).min(end);
            let found = match cancellation.token.is_cancelled() {
                true => Err(Error::Cancelled),
                false => meet(&mut query, &at, [answer.searched, to], end),
            };
            match found {
                Ok(first) => {
                    answer.searched = first.as_ref().map_or(to, |first| first.scale);
                    answer.first = first;
                }
                // The result until its time limit is valid.
                Err(Error::Cancelled) if cancellation.is_wanted() && cancellation.is_over() => {
                    answer.complete = false;
                    break;
                }
                Err(error) => return Err(cancellation.explain(error)),
            }
        }
    }
    Ok(answer)
}

/// Returns the first collision between two scales.
fn meet(
    query: &mut Query,
    at: &impl Fn(f64) -> Vec<f64>,
    [from, to]: [f64; 2],
    end: f64,
) -> Result<Option<FirstCollision>, Error> {
    let impacts = query.continuous(&at(from), &at(to))?;
    let Some(time) = impacts.iter().map(|impact| impact.time).min_by(f64::total_cmp) else { return Ok(None) };
    let together = impacts.iter().filter(|impact| impact.time <= time + SIMULTANEITY);
    let meeting = together.map(|impact| impact.pair).take(MAX_LISTED_PAIRS).collect();
    let met = from + time * (to - from);
    for nudge in SEARCH_OFFSETS {
        let scale = met + nudge * end;
        let pairs = query.discrete_at_most(&at(scale), MAX_PAIRS)?;
        if !pairs.is_empty() {
            return Ok(Some(FirstCollision {
                scale,
                pairs: pairs[..pairs.len().min(MAX_LISTED_PAIRS)].to_vec(),
            }));
        }
    }
    Ok(Some(FirstCollision { scale: met, pairs: meeting }))
}

/// Returns the scale at which the fastest vertex has moved by half the diagonal of the AABB.
fn end(model: &ReducedModel, direction: &[f64]) -> f64 {
    let rest = model.mesh().rest_positions();
    let Some(first) = rest.first() else { return f64::INFINITY };
    let (min, max) = rest.iter().fold((*first, *first), |(min, max), p| (min.min(*p), max.max(*p)));
    let speed =
        |v: u32| model.modes().of_vertex(v).iter().zip(direction).map(|(u, d)| *u * *d).sum::<glam::DVec3>();
    let fastest = (0..rest.len() as u32).map(|v| speed(v).length()).fold(0.0, f64::max);
    0.5 * (max - min).length() / fastest
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering};

    use glam::DVec3;
    use sscc::{CertifyOptions, Modes, TriMesh};

    use super::*;

    /// Returns the answer for two triangles that move away from each other, so that the search covers the whole range,
    /// and the number of checks for cancellation. After `over` checks the time limit is reached; after `unwanted`
    /// checks the client has left.
    fn separating(over: u32, unwanted: u32) -> (Result<DirectionAnswer, ViewError>, u32) {
        let below = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let positions = [below, below.map(|p| p + DVec3::new(0.1, 0.1, 0.01))].concat();
        let modes = Modes::from_matrix(6, 2, |row, k| match (row % 3, row >= 9, k) {
            (2, true, 0) => 1.0,
            (2, false, 1) => -1.0,
            _ => 0.0,
        });
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let model = ReducedModel::new(mesh, modes.unwrap()).unwrap();
        // Larger radii would prove the whole range free, without a search.
        let options = CertifyOptions::default().reach(1.0);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let checks = Arc::new(AtomicU32::new(0));
        let [before, until] = [(); 2].map(|()| Arc::clone(&checks));
        let is_over = move || before.load(Ordering::Relaxed) > over;
        let is_wanted = move || until.fetch_add(1, Ordering::Relaxed) < unwanted;
        let cancellation = Cancellation::new(None, is_over, is_wanted);
        let query = Query::new(&model, &certificates).unwrap().cancelled_by(cancellation.token.clone());
        let request = DirectionRequest { direction: vec![1.0, 1.0] };
        let answer = along(query, &model, &certificates, &request, &cancellation);
        (answer, checks.load(Ordering::Relaxed))
    }

    #[test]
    fn a_search_ends_at_its_time_limit_with_its_result() {
        let (whole, checks) = separating(u32::MAX, u32::MAX);
        let whole = whole.unwrap();
        assert!(whole.complete && whole.first.is_none() && whole.searched > whole.certified, "{whole:?}");
        // The safe scale is found by then, but not all segments are searched.
        let late = checks - 4;
        let part = separating(late, u32::MAX).0.unwrap();
        assert!(!part.complete && part.first.is_none() && part.certified == whole.certified, "{part:?}");
        assert!(part.certified < part.searched && part.searched < whole.searched, "{part:?}");
        assert!(separating(0, u32::MAX).0.unwrap_err().to_string().contains("within 10 s"));
        for checks in [0, late] {
            let error = separating(u32::MAX, checks).0.unwrap_err().to_string();
            assert!(error.contains("a newer search"), "{error}");
        }
    }
}
