//! The recording of several bodies as the data of the page.

use glam::DVec3;
use sscc_tasks::LeftOut;

use super::node_pairs::{NodePairs, of_frame};
use super::recorded_body::RecordedBody;
use crate::{Arrays, Body, Clock, Contacts, Curves, ModelScene, Playback, Track};

/// Frames per second of a recording without times.
const FRAMES_PER_SECOND: f64 = 30.0;

/// A finished recording.
pub(super) struct Recording {
    pub center: DVec3,
    pub bodies: Vec<RecordedBody>,
    /// Time of each frame (s), for animations.
    pub times: Option<Vec<f64>>,
    pub frames: usize,
    pub is_continuous: bool,
    /// Whether each pair has one triangle of the first body and one of the second.
    pub is_between: bool,
    /// The pairs of different bodies, for a scene.
    pub node_pairs: Vec<NodePairs>,
    /// The pairs that were not tested.
    pub left_out: LeftOut,
}

impl Recording {
    /// Whether the times ascend, so that the page can play by them.
    pub fn is_timed(&self) -> bool {
        self.times.as_ref().is_some_and(|times| times.windows(2).all(|pair| pair[0] < pair[1]))
    }

    /// Returns the times by which the page plays (s).
    pub fn playback_times(&self) -> Vec<f64> {
        match &self.times {
            Some(times) if self.is_timed() => times.clone(),
            _ => (0..self.frames).map(|frame| frame as f64 / FRAMES_PER_SECOND).collect(),
        }
    }

    /// Returns the number of pairs of each frame, over all bodies.
    pub fn counts(&self) -> Vec<u64> {
        let of_frame = |frame| (0..self.bodies.len()).map(|body| self.pairs_of(body, frame)).sum();
        (0..self.frames).map(of_frame).collect()
    }

    /// Returns the number of pairs of a body in a frame, with itself and with later bodies.
    fn pairs_of(&self, body: usize, frame: usize) -> u64 {
        let between = of_frame(&self.node_pairs, frame).iter().filter(|pairs| pairs.bodies[0] == body);
        let between: usize = between.map(|pairs| pairs.pairs.len()).sum();
        (self.bodies[body].pairs.of(frame).len() + between) as u64
    }

    /// Whether a body collides in a frame, with itself or with another one.
    pub fn collides(&self, body: usize, frame: usize) -> bool {
        let is_in = |pairs: &NodePairs| pairs.bodies.contains(&body);
        !self.bodies[body].pairs.of(frame).is_empty() || of_frame(&self.node_pairs, frame).iter().any(is_in)
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
            let counts = || (0..self.frames).map(|frame| self.pairs_of(index, frame)).collect();
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
        let mut seconds = Vec::new();
        for frame in 0..self.frames {
            for (number, body) in self.bodies.iter().enumerate() {
                pairs.extend(body.pairs.of(frame).as_flattened());
                if self.is_continuous {
                    times.extend(&body.impacts[body.pairs.range(frame)]);
                }
                seconds.resize(pairs.len() / 2, number as u32);
                let between = of_frame(&self.node_pairs, frame).iter();
                for found in between.filter(|found| found.bodies[0] == number) {
                    pairs.extend(found.pairs.iter().flat_map(|(i, j)| [*i, *j]));
                    times.extend(&found.impacts);
                    seconds.resize(pairs.len() / 2, found.bodies[1] as u32);
                }
                offsets.push((pairs.len() / 2) as u32);
            }
        }
        let has_others = !self.node_pairs.is_empty();
        Contacts {
            offsets: arrays.add_u32("contact-offsets", offsets),
            pairs: arrays.add_u32("contact-pairs", pairs),
            times: self.is_continuous.then(|| arrays.add_f32("contact-times", times)),
            seconds: has_others.then(|| arrays.add_u32("contact-seconds", seconds)),
            is_between: self.is_between,
        }
    }

    fn curves(&self, arrays: &mut Arrays) -> Curves {
        let (mut offsets, mut segments) = (vec![0], Vec::new());
        for frame in 0..self.frames {
            self.bodies.iter().for_each(|body| segments.extend(body.segments.of(frame).as_flattened()));
            let between = of_frame(&self.node_pairs, frame).iter();
            between.for_each(|found| segments.extend(found.segments.as_flattened()));
            offsets.push((segments.len() / 6) as u32);
        }
        Curves {
            offsets: arrays.add_u32("curve-offsets", offsets),
            segments: arrays.add_f32("curve-segments", segments),
        }
    }
}
