//! The first self-collision along a direction.

use serde::{Deserialize, Serialize};
use sscc::{Certificates, Pair, Query, ReducedModel};

use super::check::{MOST_FOUND, MOST_LISTED};
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
    query: &mut Query<'_>,
    model: &ReducedModel,
    certificates: &Certificates,
    DirectionRequest { direction }: &DirectionRequest,
) -> Result<DirectionAnswer, ViewError> {
    let center = certificates.center();
    model.check_coordinates(direction)?;
    let at = |scale: f64| -> Vec<f64> { center.iter().zip(direction).map(|(c, d)| c + scale * d).collect() };
    let certified = query.safe_scale(&at(1.0))?;
    let end = end(model, direction);
    let mut first = None;
    if certified.is_finite() && end.is_finite() {
        let mut from = certified.min(end);
        while first.is_none() && from < end {
            let to = (from + end / PIECES).min(end);
            first = meet(query, &at, [from, to], end)?;
            from = to;
        }
    }
    Ok(DirectionAnswer { certified, first })
}

/// The first collision between two scales.
fn meet(
    query: &mut Query<'_>,
    at: &impl Fn(f64) -> Vec<f64>,
    [from, to]: [f64; 2],
    end: f64,
) -> Result<Option<First>, ViewError> {
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
