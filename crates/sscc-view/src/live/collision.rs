//! The first self-collision along a direction.

use serde::{Deserialize, Serialize};
use sscc::{Certificates, Pair, Query, ReducedModel};

use super::check::MOST_LISTED;
use crate::ViewError;

/// A direction from the centre.
#[derive(Clone, Debug, Deserialize)]
pub struct DirectionRequest {
    direction: Vec<f64>,
}

/// What is known of `centre + s direction`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DirectionAnswer {
    /// Free at every s up to it.
    certified: f64,
    /// None where nothing meets until some vertex has moved by half the box's diagonal.
    first: Option<First>,
}

/// The first collision.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct First {
    /// The way from the certified scale to it is free, but for a millionth of it.
    scale: f64,
    /// What collides there.
    pairs: Vec<Pair>,
}

/// The way is searched in so many pieces at the most.
const PIECES: f64 = 64.0;

/// Continuous queries list what comes within a tolerance before it meets: looked for so much farther, in steps of 10.
const NUDGES: [f64; 8] = [0.0, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7];

/// After as many near misses nothing is found.
const MOST_MISSES: usize = 256;

pub(super) fn along(
    query: &mut Query<'_>,
    model: &ReducedModel,
    certificates: &Certificates,
    DirectionRequest { direction }: &DirectionRequest,
) -> Result<DirectionAnswer, ViewError> {
    let center = certificates.center();
    let at = |scale: f64| -> Vec<f64> { center.iter().zip(direction).map(|(c, d)| c + scale * d).collect() };
    model.check_coordinates(direction)?;
    let certified = query.safe_scale(&at(1.0))?;
    let end = end(model, direction);
    if !certified.is_finite() || !end.is_finite() {
        return Ok(DirectionAnswer { certified, first: None });
    }
    let (mut from, mut misses) = (certified.min(end), 0);
    if from == 0.0 && !query.discrete(center)?.is_empty() {
        return Ok(DirectionAnswer { certified, first: Some(First::of(0.0, query)) });
    }
    while from < end && misses < MOST_MISSES {
        let to = (from + end / PIECES).min(end);
        let Some(time) = query.time_of_impact(&at(from), &at(to))? else {
            from = to;
            continue;
        };
        let met = from + time * (to - from);
        for nudge in NUDGES {
            let scale = met + nudge * end;
            if !query.discrete(&at(scale))?.is_empty() {
                return Ok(DirectionAnswer { certified, first: Some(First::of(scale, query)) });
            }
        }
        // They came near and did not meet.
        (from, misses) = (met + 1e-6 * end, misses + 1);
    }
    Ok(DirectionAnswer { certified, first: None })
}

impl First {
    fn of(scale: f64, query: &Query<'_>) -> Self {
        let pairs = query.pairs();
        Self { scale, pairs: pairs[..pairs.len().min(MOST_LISTED)].to_vec() }
    }
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
