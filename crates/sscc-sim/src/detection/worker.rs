//! Answers single queries, one worker for each thread.

use std::time::Instant;

use glam::DVec3;
use sscc::{Detector, DetectorStatistics, Impact, Pair};

use super::answer::earliest_impacts;
use super::moving_mesh::MovingMesh;
use super::request::Detection;
use crate::error::{At, Result};

/// A detector for each mesh, and buffers.
pub(super) struct Worker<'m, 'w> {
    request: &'m Detection,
    side: Side<'m, 'w>,
    other: Option<Side<'m, 'w>>,
}

/// A mesh of a worker, and its positions at the start and the end of a motion.
struct Side<'m, 'w> {
    mesh: &'m MovingMesh<'w>,
    detector: Detector<'w>,
    x_t0: Vec<DVec3>,
    x_t1: Vec<DVec3>,
}

/// The result of one query.
pub(super) struct Found {
    pub pairs: Vec<Pair>,
    pub times: Option<Vec<f64>>,
    pub is_complete: bool,
    pub microseconds: f64,
    pub statistics: DetectorStatistics,
    /// Positions of the mesh and of the other one, at the start and the end; empty unless the request asks for them.
    pub positions: Vec<[Vec<DVec3>; 2]>,
}

impl<'m, 'w> Worker<'m, 'w> {
    pub fn new(request: &'m Detection, mesh: &'m MovingMesh<'w>, other: Option<&'m MovingMesh<'w>>) -> Self {
        Self { request, side: Side::new(mesh), other: other.map(Side::new) }
    }

    /// Answers the query at a frame, or from it to the next one.
    pub fn answer(&mut self, frame: usize) -> Result<Found> {
        let is_continuous = self.request.is_continuous;
        self.side.read(frame, is_continuous)?;
        if let Some(other) = &mut self.other {
            other.read(frame, is_continuous)?;
        }
        let file = &self.side.mesh.file;
        let mut found = if is_continuous { self.continuous() } else { self.discrete() }.in_file(file)?;
        if self.request.has_positions {
            let sides = [&self.side].into_iter().chain(&self.other);
            found.positions = sides.map(|side| [side.x_t0.clone(), side.x_t1.clone()]).collect();
        }
        Ok(found)
    }

    fn discrete(&mut self) -> Result<Found, sscc::Error> {
        let (limit, x) = (self.request.limit, &mut self.side);
        let start = Instant::now();
        let pairs = match &mut self.other {
            Some(y) => x.detector.against_at_most(&x.x_t0, &mut y.detector, &y.x_t0, limit),
            None => x.detector.discrete_at_most(&x.x_t0, limit),
        };
        let microseconds = start.elapsed().as_secs_f64() * 1e6;
        let pairs = pairs?.to_vec();
        let statistics = x.detector.statistics();
        Ok(Found {
            pairs,
            times: None,
            is_complete: statistics.complete,
            microseconds,
            statistics,
            positions: Vec::new(),
        })
    }

    fn continuous(&mut self) -> Result<Found, sscc::Error> {
        let x = &mut self.side;
        let start = Instant::now();
        let impacts = match &mut self.other {
            Some(y) => x.detector.continuous_against([&x.x_t0, &x.x_t1], &mut y.detector, [&y.x_t0, &y.x_t1]),
            None => x.detector.continuous(&x.x_t0, &x.x_t1),
        };
        let microseconds = start.elapsed().as_secs_f64() * 1e6;
        let all = impacts?;
        let kept: Vec<Impact> = earliest_impacts(all, self.request.limit);
        let is_complete = kept.len() == all.len();
        Ok(Found {
            pairs: kept.iter().map(|impact| impact.pair).collect(),
            times: Some(kept.iter().map(|impact| impact.time).collect()),
            is_complete,
            microseconds,
            statistics: x.detector.statistics(),
            positions: Vec::new(),
        })
    }
}

impl<'m, 'w> Side<'m, 'w> {
    fn new(mesh: &'m MovingMesh<'w>) -> Self {
        Self { mesh, detector: mesh.detector.clone(), x_t0: Vec::new(), x_t1: Vec::new() }
    }

    fn read(&mut self, frame: usize, is_continuous: bool) -> Result<()> {
        self.mesh.positions(frame, &mut self.x_t0)?;
        if is_continuous {
            self.mesh.positions(frame + 1, &mut self.x_t1)?;
        }
        Ok(())
    }
}
