//! The recording of several bodies as the data of the page.

use glam::DVec3;
use sscc_sim::LeftOut;

use super::recorded_body::RecordedBody;
use crate::{Arrays, Body, Clock, Contacts, Curves, ModelScene, Playback, Track};

/// Frames per second of a recording without times.
const FRAMES_PER_SECOND: f64 = 30.0;

/// A finished recording.
pub(super) struct Recording {
    pub center: DVec3,
    pub bodies: Vec<RecordedBody>,
    /// Time of each frame (s), of animations.
    pub times: Option<Vec<f64>>,
    pub frames: usize,
    pub is_continuous: bool,
    /// Whether the pairs are those of the first body with the second one.
    pub is_between: bool,
    /// The pairs that were not tested.
    pub left_out: LeftOut,
}

impl Recording {
    /// Whether the times ascend, so that the page can play by them.
    pub fn is_timed(&self) -> bool {
        self.times.as_ref().is_some_and(|times| times.windows(2).all(|pair| pair[0] < pair[1]))
    }

    /// The times by which the page plays (s).
    pub fn playback_times(&self) -> Vec<f64> {
        match &self.times {
            Some(times) if self.is_timed() => times.clone(),
            _ => (0..self.frames).map(|frame| frame as f64 / FRAMES_PER_SECOND).collect(),
        }
    }

    /// The number of pairs of each frame, over all bodies.
    pub fn counts(&self) -> Vec<u64> {
        let of_frame = |frame| self.bodies.iter().map(|body| body.pairs.of(frame).len() as u64).sum();
        (0..self.frames).map(of_frame).collect()
    }

    /// Returns the models and the playback, and adds their arrays.
    pub fn scene(&self, arrays: &mut Arrays) -> (Vec<ModelScene>, Playback) {
        let model = |(index, body): (usize, &RecordedBody)| {
            let first = &body.positions[..3 * body.vertices];
            // An empty mesh has no AABB.
            let bounds = if body.vertices == 0 { Default::default() } else { body.bounds };
            ModelScene::of_mesh(index, &body.name, &body.faces, first, bounds, arrays)
        };
        let models = self.bodies.iter().enumerate().map(model).collect();
        let body = |(index, body): (usize, &RecordedBody)| {
            let counts = || (0..self.frames).map(|frame| body.pairs.of(frame).len() as u64).collect();
            Body {
                name: body.name.clone(),
                model: index,
                track: Track::Positions(
                    arrays.add_f32(format!("track-{index}"), body.positions.iter().copied()),
                ),
                rigid: None,
                center: self.center.to_array(),
                pairs: (index == 0 || !self.is_between).then(counts),
            }
        };
        let playback = Playback {
            times: self.playback_times(),
            clock: if self.is_timed() { Clock::FrameAndTime } else { Clock::Frame },
            bodies: self.bodies.iter().enumerate().map(body).collect(),
            pairs_since: None,
            apart: self.left_out.apart(),
            colliding: None,
            contacts: Some(self.contacts(arrays)),
            curves: Some(self.curves(arrays)),
            ground: None,
            sound: None,
            costs: None,
        };
        (models, playback)
    }

    fn contacts(&self, arrays: &mut Arrays) -> Contacts {
        let (mut offsets, mut pairs, mut times) = (vec![0], Vec::new(), Vec::new());
        for frame in 0..self.frames {
            for body in &self.bodies {
                pairs.extend(body.pairs.of(frame).as_flattened());
                if self.is_continuous {
                    times.extend(&body.impacts[body.pairs.range(frame)]);
                }
                offsets.push((pairs.len() / 2) as u32);
            }
        }
        Contacts {
            offsets: arrays.add_u32("contact-offsets", offsets),
            pairs: arrays.add_u32("contact-pairs", pairs),
            times: self.is_continuous.then(|| arrays.add_f32("contact-times", times)),
            is_between: self.is_between,
        }
    }

    fn curves(&self, arrays: &mut Arrays) -> Curves {
        let (mut offsets, mut segments) = (vec![0], Vec::new());
        for frame in 0..self.frames {
            self.bodies.iter().for_each(|body| segments.extend(body.segments.of(frame).as_flattened()));
            offsets.push((segments.len() / 6) as u32);
        }
        Curves {
            offsets: arrays.add_u32("curve-offsets", offsets),
            segments: arrays.add_f32("curve-segments", segments),
        }
    }
}
