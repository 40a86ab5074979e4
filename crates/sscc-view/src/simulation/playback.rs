//! The recorded motion of a simulation, for its report.

use std::ops::Range;

use sscc::{Error, Progress, Query};
use sscc_io::gltf::key_frames;
use sscc_io::{WavFormat, wav_to_bytes};
use sscc_sim::{FinishedRun, History, SoundTrack};
use sscc_tasks::LeftOut;

use super::plots::costs;
use crate::{Arrays, Body, Clock, Colliding, Playback, Track};

/// Largest size of all frames (bytes). Longer motions have fewer frames per second.
const MAX_MOTION_BYTES: usize = 24 << 20;

/// Largest size of the sound (bytes): five minutes at 44,100 samples per second.
const MAX_SOUND_BYTES: usize = 28 << 20;

/// Largest number of frames with self-collisions, over all bodies, for which colliding triangles are computed.
const MAX_COLLIDING_FRAMES: usize = 4000;

/// Largest number of colliding triangles in all frames.
const MAX_TRIANGLES: usize = 2 << 20;

/// Returns the motion, or None if no frame is in the range of the page, and notes on omitted data.
pub fn playback(
    run: &FinishedRun,
    progress: &dyn Progress,
    arrays: &mut Arrays,
) -> Result<(Option<Playback>, Vec<String>), Error> {
    let FinishedRun { scene, prepared, history, .. } = run;
    let mut notes = Vec::new();
    let bodies = scene.bodies.len();
    let width: usize = (0..bodies).map(|body| 4 * (history.layout().rank(body) + 7)).sum();
    let max_frames = (MAX_MOTION_BYTES / width).max(2) as f64;
    let duration = run.time(history.len());
    let rate = scene.frames_per_second.min(max_frames / duration);
    if rate < scene.frames_per_second {
        notes.push(format!(
            "the report has {rate:.1} frames per second instead of {}",
            scene.frames_per_second
        ));
    }
    let mut frames = key_frames(history.len(), scene.step, rate);
    // A motion that diverges ends at the last frame in the range of the page.
    let fits = |state: &usize| {
        let mut bodies = history.bodies(*state);
        bodies.all(|body| body.q.iter().chain(&body.position.to_array()).all(|x| x.abs() < 1e30))
    };
    let shown = frames.iter().take_while(|state| fits(state)).count();
    frames.truncate(shown);
    if frames.is_empty() {
        return Ok((None, notes));
    }
    let tracks = (0..bodies).map(|body| {
        let at = || frames.iter().map(|state| history.body(*state, body));
        let spec = &scene.bodies[body];
        let q = at().flat_map(|facts| facts.q).map(|x| *x as f32);
        let rigid = at().flat_map(|facts| {
            let mut numbers = [0.0; 7];
            numbers[..3].copy_from_slice(&facts.position.to_array());
            numbers[3..].copy_from_slice(&facts.orientation.to_array());
            numbers.map(|x| x as f32)
        });
        Body {
            name: format!("{} {body}", prepared.models[spec.model].certified.name),
            model: spec.model,
            track: Track::Q(arrays.add_f32(format!("q-{body}"), q)),
            rigid: Some(arrays.add_f32(format!("rigid-{body}"), rigid)),
            center: prepared.models[spec.model].center().to_array(),
            pairs: Some(at().map(|facts| facts.pairs as u64).collect()),
        }
    });
    let tracks = tracks.collect();
    let (colliding, note) = colliding(run, &frames, progress, arrays)?;
    notes.extend(note);
    let (sound, note) = sound(run, arrays);
    notes.extend(note);
    let filters = prepared.models.iter().map(|model| model.certified.full.certificates.filter());
    let left_out = filters.fold(LeftOut::default(), |all, filter| all.and(&LeftOut::of(filter)));
    let playback = Playback {
        times: frames.iter().map(|state| run.time(*state)).collect(),
        bodies: tracks,
        pairs_since: Some(pairs_since(history, &frames)),
        apart: left_out.apart(),
        clock: Clock::Time,
        colliding,
        contacts: None,
        curves: None,
        ground: scene.ground.map(|ground| ground.height),
        sound,
        costs: Some(costs(run)),
    };
    Ok((Some(playback), notes))
}

/// Returns for each frame the number of self-colliding pairs of all bodies, as the maximum over the states strictly between the
/// previous frame and this one. The frames themselves miss contacts shorter than a frame.
fn pairs_since(history: &History, frames: &[usize]) -> Vec<u64> {
    let largest =
        |states: Range<usize>| states.map(|state| history.self_pairs(state) as u64).max().unwrap_or(0);
    let between = frames.windows(2).map(|pair| largest(pair[0] + 1..pair[1]));
    [0].into_iter().chain(between).take(frames.len()).collect()
}

/// Returns the colliding triangles of each frame, body by body; `None` and a note if there are too many.
fn colliding(
    run: &FinishedRun,
    frames: &[usize],
    progress: &dyn Progress,
    arrays: &mut Arrays,
) -> Result<(Option<Colliding>, Option<String>), Error> {
    let FinishedRun { scene, prepared, history, .. } = run;
    let facts = || frames.iter().flat_map(|state| history.bodies(*state));
    let count = facts().filter(|body| body.pairs > 0).count();
    let omitted = |why: String| Ok((None, Some(format!("the report omits colliding triangles: {why}"))));
    if count > MAX_COLLIDING_FRAMES {
        return omitted(format!("bodies collide with themselves in {count} frames"));
    }
    let mut queries = Vec::new();
    for model in &prepared.models {
        queries.push(Query::new(&model.certified.model, &model.certified.full.certificates)?);
    }
    let (mut offsets, mut triangles): (Vec<u32>, Vec<u32>) = (vec![0], Vec::new());
    let specs = scene.bodies.iter().cycle();
    for (facts, spec) in facts().zip(specs) {
        if facts.pairs > 0 {
            if progress.is_cancelled() {
                return omitted("the computation was interrupted".into());
            }
            let start = triangles.len();
            let pairs = queries[spec.model].discrete(facts.q)?;
            let mut own: Vec<u32> = pairs.iter().flat_map(|(i, j)| [*i, *j]).collect();
            own.sort_unstable();
            own.dedup();
            triangles.extend(own);
            if triangles.len() > MAX_TRIANGLES {
                return omitted(format!("there are more than {start}"));
            }
        }
        offsets.push(triangles.len() as u32);
    }
    let colliding = Colliding {
        offsets: arrays.add_u32("colliding-offsets", offsets),
        triangles: arrays.add_u32("colliding-triangles", triangles),
    };
    Ok((Some(colliding), None))
}

/// Returns the sound as a WAV file in an array, as loud as `sound.wav`; `None` and a note if it is too long.
fn sound(run: &FinishedRun, arrays: &mut Arrays) -> (Option<String>, Option<String>) {
    let Some(sound) = SoundTrack::of(run) else { return (None, None) };
    if 2 * sound.samples.len() > MAX_SOUND_BYTES {
        return (None, Some("the report omits the sound because it is too long: see sound.wav".into()));
    }
    match wav_to_bytes(sound.rate, &sound.normalized(), WavFormat::Pcm16) {
        Ok(bytes) => (Some(arrays.add_bytes("sound", bytes)), None),
        Err(why) => (None, Some(format!("the report omits the sound: {why}"))),
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use sscc_sim::{BodyRecord, StateLayout, StepRecord};

    use super::*;

    #[test]
    fn pairs_since_a_frame_exclude_both_frames() {
        let pairs = [[0, 0], [7, 0], [3, 5], [0, 0], [4, 0], [0, 2], [0, 0], [0, 9]];
        let (layout, mut numbers) = (StateLayout::new([0, 0]), Vec::new());
        for state in pairs {
            let bodies = state.map(|pairs| BodyRecord {
                pairs,
                position: DVec3::ZERO,
                orientation: DQuat::IDENTITY,
                q: &[],
            });
            layout.push(StepRecord::default(), bodies, &mut numbers);
        }
        let history = History::new(layout, numbers);
        // States 1 and 2 are between the first two frames, none is between 3 and 4, and state 4 is itself a frame.
        assert_eq!(pairs_since(&history, &[0, 3, 4, 6, 7]), [0, 8, 0, 2, 0]);
        assert_eq!(pairs_since(&history, &[0, 7]), [0, 8]);
        assert_eq!(pairs_since(&history, &[0]), [0]);
    }
}
