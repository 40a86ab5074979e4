//! Motions of the page as binary glTF files.
//!
//! The morph targets are the modes that move, scaled to the range of their motion. One more target, with the constant
//! weight 1, has the lower ends of all ranges. So all weights are in [0, 1], and a program that clamps weights to this
//! interval (Blender does, except in the first key frame) shows every vertex at its position.

use std::fmt;
use std::marker::PhantomData;

use glam::{DQuat, DVec3};
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use sscc::{Modes, ReducedModel};
use sscc_io::gltf::{NamedModel, Track, animation_to_bytes};

use crate::ViewError;

/// Largest number of key frames of a motion.
const MAX_FRAMES: usize = 100_000;

/// Largest number of entries of q in all key frames of a motion.
const MAX_NUMBERS: usize = 8 << 20;

/// A motion as key frames.
#[derive(Clone, Debug, Deserialize)]
pub struct AnimationRequest {
    /// The q of each key frame.
    #[serde(deserialize_with = "frames")]
    q: Vec<Vec<f64>>,
    /// The time of each key frame (s).
    #[serde(deserialize_with = "frames")]
    times: Vec<f64>,
}

/// Returns a motion as a binary glTF file.
pub(super) fn glb(
    name: &str,
    model: &ReducedModel,
    AnimationRequest { q, times }: &AnimationRequest,
) -> Result<Vec<u8>, ViewError> {
    if q.len().saturating_mul(model.rank()) > MAX_NUMBERS {
        return Err(ViewError::Request(format!(
            "the motion has more than {MAX_NUMBERS} numbers: omit frames"
        )));
    }
    for q in q {
        model.check_coordinates(q)?;
    }
    let (moved, weights) = bounded(model, q)?;
    let track = Track {
        name: name.to_owned(),
        model: 0,
        center: DVec3::ZERO,
        positions: vec![DVec3::ZERO; q.len()],
        orientations: vec![DQuat::IDENTITY; q.len()],
        weights,
    };
    animation_to_bytes(&[NamedModel { name, model: &moved }], times, &[track]).map_err(ViewError::Request)
}

/// Returns a model whose modes are the morph targets, and their weights in [0, 1] (frames x targets).
fn bounded(model: &ReducedModel, q: &[Vec<f64>]) -> Result<(ReducedModel, Vec<f64>), ViewError> {
    let extreme = |k: usize, pick: fn(f64, f64) -> f64| q.iter().map(|q| q[k]).reduce(pick).unwrap_or(0.0);
    let ranges: Vec<[f64; 2]> =
        (0..model.rank()).map(|k| [extreme(k, f64::min), extreme(k, f64::max)]).collect();
    let moving: Vec<usize> = (0..model.rank()).filter(|k| ranges[*k][0] < ranges[*k][1]).collect();
    let of_vertex = |u: &[DVec3]| -> Vec<DVec3> {
        let begin = u.iter().zip(&ranges).map(|(u, [low, _])| *u * *low).sum();
        let targets = moving.iter().map(|&k| u[k] * (ranges[k][1] - ranges[k][0]));
        std::iter::once(begin).chain(targets).collect()
    };
    let displacements = model.modes().displacements().chunks_exact(model.rank()).flat_map(of_vertex);
    let modes = Modes::new(moving.len() + 1, displacements.collect())?;
    let share = |q: f64, [low, high]: [f64; 2]| ((q - low) / (high - low)).clamp(0.0, 1.0);
    let weights = q
        .iter()
        .flat_map(|q| std::iter::once(1.0).chain(moving.iter().map(|&k| share(q[k], ranges[k]))))
        .collect();
    Ok((ReducedModel::new(model.mesh().clone(), modes)?, weights))
}

/// Reads a list with one entry for each key frame. Stops with an error at the first entry beyond the limit.
fn frames<'de, D: Deserializer<'de>, T: Deserialize<'de>>(from: D) -> Result<Vec<T>, D::Error> {
    struct Frames<T>(PhantomData<T>);

    impl<'de, T: Deserialize<'de>> Visitor<'de> for Frames<T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a list with one entry for each key frame")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Vec<T>, A::Error> {
            let mut frames = Vec::new();
            while let Some(frame) = entries.next_element()? {
                if frames.len() == MAX_FRAMES {
                    return Err(A::Error::custom(format!(
                        "the motion has more than {MAX_FRAMES} key frames"
                    )));
                }
                frames.push(frame);
            }
            Ok(frames)
        }
    }

    from.deserialize_seq(Frames(PhantomData))
}

#[cfg(test)]
mod tests {
    use sscc::TriMesh;

    use super::*;

    #[test]
    fn the_size_of_a_motion_is_limited() {
        const RANK: usize = 128;
        let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
        let modes = Modes::from_matrix(3, RANK, |row, k| (row + k) as f64).unwrap();
        let model = ReducedModel::new(mesh, modes).unwrap();
        let refused = |frames: usize| {
            let request = AnimationRequest { q: vec![Vec::new(); frames], times: Vec::new() };
            glb("plate", &model, &request).unwrap_err().to_string()
        };
        let max = MAX_NUMBERS / RANK;
        assert!(refused(max + 1).contains("more than 8388608 numbers"));
        // This number is allowed: the error is then that the rows are empty.
        assert!(!refused(max).contains("8388608"));
    }
}
