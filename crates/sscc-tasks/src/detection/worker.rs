//! Answers single queries, one worker for each thread.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use sscc::parts::{BodyPenetration, Surface, body_penetration};
use sscc::{Clearance, Detector, Enclosed, Impact, Pair, Statistics};
use sscc_io::gltf::SceneState;

use super::answer::earliest_impacts;
use super::contacts::{ContactOptions, Contacts};
use super::moving_mesh::MovingMesh;
use super::near::Near;
use super::request::Detection;
use crate::error::{At, Result};

/// A detector for each mesh, and buffers.
pub(super) struct Worker<'m, 'w> {
    request: &'m Detection,
    side: Side<'m, 'w>,
    other: Option<Side<'m, 'w>>,
    /// The frame of the last answer of the run, before those about two nodes of a scene; None if another mesh has it.
    last: Option<usize>,
}

/// A mesh of a worker, and its positions at the start and the end of a motion.
pub(super) struct Side<'m, 'w> {
    pub mesh: &'m MovingMesh<'w>,
    pub detector: Detector,
    pub x_t0: Vec<DVec3>,
    pub x_t1: Vec<DVec3>,
}

/// The result of one query.
#[derive(Default)]
pub(super) struct QueryResult {
    pub pairs: Vec<Pair>,
    pub times: Option<Vec<f64>>,
    pub contacts: Contacts,
    pub near: Option<Near>,
    pub enclosed: Option<[Enclosed; 2]>,
    pub penetration: Option<BodyPenetration>,
    pub is_complete: bool,
    pub microseconds: f64,
    pub statistics: Statistics,
    /// Positions of the mesh and of the other mesh, at the start and the end; empty unless the request requires them. Results of
    /// pairs of nodes share them.
    pub positions: Vec<Arc<[Vec<DVec3>; 2]>>,
}

impl QueryResult {
    /// Returns the result without these pairs (sorted), and with at most `limit` of the others; for a motion, the
    /// earliest. The result stays as it is if `ignored` is empty: then the query has applied the limit.
    pub fn without(mut self, ignored: &[Pair], limit: Option<usize>) -> Self {
        if ignored.is_empty() {
            return self;
        }
        let counts = |pair: &Pair| ignored.binary_search(pair).is_err();
        let mut kept: Vec<usize> = (0..self.pairs.len()).filter(|i| counts(&self.pairs[*i])).collect();
        if let Some(limit) = limit.filter(|limit| *limit < kept.len()) {
            if let Some(times) = &self.times {
                kept.sort_by(|a, b| times[*a].total_cmp(&times[*b]));
            }
            kept.truncate(limit);
            kept.sort_unstable();
            self.is_complete = false;
        }
        fn select<T: Clone>(all: &[T], kept: &[usize]) -> Vec<T> {
            kept.iter().map(|i| all[*i].clone()).collect()
        }
        self.times = self.times.map(|times| select(&times, &kept));
        self.contacts.penetrations = self.contacts.penetrations.map(|all| select(&all, &kept));
        self.near = self.near.map(|near| near.of_pairs(&self.pairs, &kept));
        self.pairs = select(&self.pairs, &kept);
        self
    }
}

impl<'m, 'w> Worker<'m, 'w> {
    /// Creates a worker. `last` is the frame of the last answer of the run, if this mesh has it.
    pub fn new(
        request: &'m Detection,
        mesh: &'m MovingMesh<'w>,
        other: Option<&'m MovingMesh<'w>>,
        last: Option<usize>,
    ) -> Self {
        Self { request, side: Side::new(mesh), other: other.map(Side::new), last }
    }

    /// Answers the query at a frame, or from the frame to the next one.
    pub fn answer(&mut self, frame: usize) -> Result<QueryResult> {
        let is_continuous = self.request.is_continuous;
        self.side.read(frame, is_continuous)?;
        if let Some(other) = &mut self.other {
            other.read(frame, is_continuous)?;
        }
        let mesh = self.side.mesh;
        let sides = (&mut self.side, self.other.as_mut());
        let (request, is_last) = (self.request, self.last == Some(frame));
        let mut found = query(request, request.limit, sides, is_last).at(|| mesh.place(frame))?;
        let is_free = match &found.near {
            Some(near) => near.nearest.is_none_or(|near| near.distance > 0.0),
            None => found.pairs.is_empty(),
        };
        if let Some(other) = self.other.as_mut().filter(|_| is_free && !is_continuous) {
            let (x, y) = (&mut self.side, other);
            let enclosed = x.detector.enclosed(&x.x_t0, &mut y.detector, &y.x_t0);
            found.enclosed = Some(enclosed.at(|| mesh.place(frame))?);
        }
        if let (Some(y), true, false) = (&mut self.other, self.request.penetration, is_continuous) {
            let x = &mut self.side;
            let body = body_penetration([&mut x.detector, &mut y.detector], [&x.x_t0, &y.x_t0]);
            found.penetration = Some(body.at(|| mesh.place(frame))?);
        }
        if self.request.has_positions {
            let sides = [&self.side].into_iter().chain(&self.other);
            found.positions = sides.map(|side| Arc::new(side.positions())).collect();
        }
        Ok(found)
    }
}

/// A mesh of a query, and the other mesh if there is one.
pub(super) type Sides<'s, 'm, 'w> = (&'s mut Side<'m, 'w>, Option<&'s mut Side<'m, 'w>>);

/// Answers one query at the positions that the sides have read, with at most `limit` pairs; a request with a clearance
/// has no limit. `is_last` states whether it is the last query of the run, before those of two nodes of a scene. Only this query
/// has contact curves.
pub(super) fn query(
    request: &Detection,
    limit: Option<usize>,
    sides: Sides<'_, '_, '_>,
    is_last: bool,
) -> Result<QueryResult, sscc::Error> {
    match (request.is_continuous, &request.clearance) {
        (true, _) => continuous(limit, sides),
        (false, Some(clearance)) => near(sides, clearance),
        (false, None) => discrete(request, limit, sides, is_last),
    }
}

fn discrete(
    request: &Detection,
    limit: Option<usize>,
    (x, mut other): Sides<'_, '_, '_>,
    is_last: bool,
) -> Result<QueryResult, sscc::Error> {
    let start = Instant::now();
    let pairs = match (&mut other, limit) {
        (Some(y), Some(limit)) => x.detector.against_at_most(&x.x_t0, &mut y.detector, &y.x_t0, limit),
        (Some(y), None) => x.detector.against(&x.x_t0, &mut y.detector, &y.x_t0),
        (None, Some(limit)) => x.detector.discrete_at_most(&x.x_t0, limit),
        (None, None) => x.detector.discrete(&x.x_t0),
    };
    let microseconds = start.elapsed().as_secs_f64() * 1e6;
    let pairs = pairs?.to_vec();
    let statistics = x.detector.statistics();
    let ContactOptions { depths, curves } = request.contacts;
    let options = ContactOptions { depths, curves: curves && is_last };
    let contacts = Contacts::of(x.surface(), other.as_deref().map(Side::surface), &pairs, options)?;
    let is_complete = statistics.complete;
    Ok(QueryResult { pairs, contacts, is_complete, microseconds, statistics, ..QueryResult::default() })
}

fn near((x, other): Sides<'_, '_, '_>, clearance: &Clearance) -> Result<QueryResult, sscc::Error> {
    let start = Instant::now();
    let (pairs, near) = match other {
        None => {
            let found = x.detector.within(&x.x_t0, clearance)?.to_vec();
            Near::of(found, || x.detector.nearest(&x.x_t0, clearance.rings()))
        }
        Some(y) => {
            let found = x.detector.within_against(&x.x_t0, &mut y.detector, &y.x_t0, clearance)?.to_vec();
            Near::of(found, || x.detector.nearest_against(&x.x_t0, &mut y.detector, &y.x_t0))
        }
    }?;
    Ok(QueryResult {
        pairs,
        near: Some(near),
        is_complete: true,
        microseconds: start.elapsed().as_secs_f64() * 1e6,
        statistics: x.detector.statistics(),
        ..QueryResult::default()
    })
}

fn continuous(limit: Option<usize>, (x, other): Sides<'_, '_, '_>) -> Result<QueryResult, sscc::Error> {
    let start = Instant::now();
    let impacts = match other {
        Some(y) => x.detector.continuous_against([&x.x_t0, &x.x_t1], &mut y.detector, [&y.x_t0, &y.x_t1]),
        None => x.detector.continuous(&x.x_t0, &x.x_t1),
    };
    let microseconds = start.elapsed().as_secs_f64() * 1e6;
    let all = impacts?;
    let kept: Vec<Impact> = earliest_impacts(all, limit);
    let is_complete = kept.len() == all.len();
    Ok(QueryResult {
        pairs: kept.iter().map(|impact| impact.pair).collect(),
        times: Some(kept.iter().map(|impact| impact.time).collect()),
        is_complete,
        microseconds,
        statistics: x.detector.statistics(),
        ..QueryResult::default()
    })
}

impl<'m, 'w> Side<'m, 'w> {
    pub fn new(mesh: &'m MovingMesh<'w>) -> Self {
        Self { mesh, detector: mesh.detector.clone(), x_t0: Vec::new(), x_t1: Vec::new() }
    }

    /// Returns the mesh at the start of the motion.
    fn surface(&self) -> Surface<'_> {
        Surface { faces: self.mesh.mesh.faces(), positions: &self.x_t0 }
    }

    /// Returns the positions at the start and the end.
    pub fn positions(&self) -> [Vec<DVec3>; 2] {
        [self.x_t0.clone(), self.x_t1.clone()]
    }

    /// Reads the positions at a frame; for a motion, also at the next frame.
    fn read(&mut self, frame: usize, is_continuous: bool) -> Result<()> {
        self.read_in([None, None], frame, is_continuous)
    }

    /// As [`Side::read`], where the states of the scene at the frame and at the next one may be known. Evaluating a scene and
    /// many positions takes long, so cancellation is checked.
    fn read_in(
        &mut self,
        [start, end]: [Option<&Arc<SceneState>>; 2],
        frame: usize,
        is_continuous: bool,
    ) -> Result<()> {
        self.mesh.check_cancelled()?;
        self.mesh.positions(frame, start, &mut self.x_t0)?;
        if is_continuous {
            self.mesh.positions(frame + 1, end, &mut self.x_t1)?;
        }
        Ok(())
    }
}

/// Reads the positions of all meshes of a file at a frame; for a motion, also at the next frame. The scene is evaluated once for
/// all of them.
pub(super) fn read_all(sides: &mut [Side<'_, '_>], frame: usize, is_continuous: bool) -> Result<()> {
    let Some(first) = sides.first().map(|side| side.mesh) else { return Ok(()) };
    let start = first.scene_state(frame)?;
    let end = if is_continuous { first.scene_state(frame + 1)? } else { None };
    let states = [start.as_ref(), end.as_ref()];
    sides.iter_mut().try_for_each(|side| side.read_in(states, frame, is_continuous))
}
