//! The first self-collision along a direction.

use serde::{Deserialize, Serialize};
use sscc::{Certificates, Error, Pair, Progress, Query, ReducedModel};

use super::check::{MOST_FOUND, MOST_LISTED};
use super::patience::Patience;
use crate::ViewError;

/// A direction from the centre.
#[derive(Clone, Debug, Deserialize)]
pub struct DirectionRequest {
    direction: Vec<f64>,
}

/// What is known of `centre + s direction`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DirectionAnswer {
    /// Proven free at every s up to it, by certificates.
    certified: f64,
    /// None where nothing meets up to `searched`.
    first: Option<First>,
    /// So far was looked, at every s: until some vertex has moved by half the box's diagonal, unless there was a
    /// collision before, or time ran out.
    searched: f64,
    /// Whether time did not run out.
    complete: bool,
}

/// The first collision.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct First {
    /// The way to it is free.
    scale: f64,
    /// What collides there. Where nothing does, because sheets pass each other between two numbers: what meets.
    pairs: Vec<Pair>,
}

/// The way is searched in so many pieces at the most.
const PIECES: f64 = 64.0;

/// Continuous queries tell a time a little before the triangles meet. They are looked for so much farther, as shares
/// of the whole way.
const NUDGES: [f64; 8] = [0.0, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7];

/// What meets so soon after the first, as a share of a piece, meets with it.
const TOGETHER: f64 = 1e-9;

pub(super) fn along(
    mut query: Query<'_>,
    model: &ReducedModel,
    certificates: &Certificates,
    DirectionRequest { direction }: &DirectionRequest,
    patience: &Patience<'_>,
) -> Result<DirectionAnswer, ViewError> {
    let center = certificates.center();
    model.check_coordinates(direction)?;
    let at = |scale: f64| -> Vec<f64> { center.iter().zip(direction).map(|(c, d)| c + scale * d).collect() };
    let certified = query.safe_scale(&at(1.0)).map_err(|error| patience.explain(error))?;
    let end = end(model, direction);
    let mut answer = DirectionAnswer { certified, first: None, searched: certified, complete: true };
    if certified.is_finite() && end.is_finite() {
        answer.searched = certified.min(end);
        while answer.first.is_none() && answer.searched < end {
            let to = (answer.searched + end / PIECES).min(end);
            let found = match patience.is_cancelled() {
                true => Err(Error::Cancelled),
                false => meet(&mut query, &at, [answer.searched, to], end),
            };
            match found {
                Ok(first) => {
                    answer.searched = first.as_ref().map_or(to, |first| first.scale);
                    answer.first = first;
                }
                // What was found until then holds.
                Err(Error::Cancelled) if (patience.is_wanted)() && (patience.is_over)() => {
                    answer.complete = false;
                    break;
                }
                Err(error) => return Err(patience.explain(error)),
            }
        }
    }
    Ok(answer)
}

/// The first collision between two scales.
fn meet(
    query: &mut Query<'_>,
    at: &impl Fn(f64) -> Vec<f64>,
    [from, to]: [f64; 2],
    end: f64,
) -> Result<Option<First>, Error> {
    let impacts = query.continuous(&at(from), &at(to))?;
    let Some(time) = impacts.iter().map(|impact| impact.time).min_by(f64::total_cmp) else { return Ok(None) };
    let together = impacts.iter().filter(|impact| impact.time <= time + TOGETHER);
    let meeting = together.map(|impact| impact.pair).take(MOST_LISTED).collect();
    let met = from + time * (to - from);
    for nudge in NUDGES {
        let scale = met + nudge * end;
        let pairs = query.discrete_at_most(&at(scale), MOST_FOUND)?;
        if !pairs.is_empty() {
            return Ok(Some(First { scale, pairs: pairs[..pairs.len().min(MOST_LISTED)].to_vec() }));
        }
    }
    Ok(Some(First { scale: met, pairs: meeting }))
}

/// Where the vertex that moves fastest has moved by half the box's diagonal.
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
    use std::sync::atomic::{AtomicU32, Ordering};

    use glam::DVec3;
    use sscc::{CertifyOptions, Modes, TriMesh};

    use super::*;

    /// What is answered of two triangles that move away from each other, so that all of their way is searched, where
    /// after so many looks its time is over, or nobody wants it; and how many looks there were.
    fn parted(over: u32, unwanted: u32) -> (Result<DirectionAnswer, ViewError>, u32) {
        let below = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let positions = [below, below.map(|p| p + DVec3::new(0.1, 0.1, 0.01))].concat();
        let modes = Modes::from_matrix(6, 2, |row, k| match (row % 3, row >= 9, k) {
            (2, true, 0) => 1.0,
            (2, false, 1) => -1.0,
            _ => 0.0,
        });
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let model = ReducedModel::new(mesh, modes.unwrap()).unwrap();
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        let looks = AtomicU32::new(0);
        let is_over = || looks.load(Ordering::Relaxed) > over;
        let is_wanted = || looks.fetch_add(1, Ordering::Relaxed) < unwanted;
        let patience = Patience { all: &(), is_over: &is_over, is_wanted: &is_wanted };
        let query = Query::new(&model, &certificates).unwrap().cancelled_by(&patience);
        let request = DirectionRequest { direction: vec![1.0, 1.0] };
        let answer = along(query, &model, &certificates, &request, &patience);
        (answer, looks.into_inner())
    }

    #[test]
    fn a_search_ends_in_time_with_what_it_found() {
        let (whole, looks) = parted(u32::MAX, u32::MAX);
        let whole = whole.unwrap();
        assert!(whole.complete && whole.first.is_none() && whole.searched > whole.certified, "{whole:?}");
        // Certificates have been looked at by then, and not yet all pieces of the way.
        let late = looks - 4;
        let part = parted(late, u32::MAX).0.unwrap();
        assert!(!part.complete && part.first.is_none() && part.certified == whole.certified, "{part:?}");
        assert!(part.certified < part.searched && part.searched < whole.searched, "{part:?}");
        assert!(parted(0, u32::MAX).0.unwrap_err().to_string().contains("within 10 s"));
        for looks in [0, late] {
            let error = parted(u32::MAX, looks).0.unwrap_err().to_string();
            assert!(error.contains("another question"), "{error}");
        }
    }
}
