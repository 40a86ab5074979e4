//! The motion of the page as a file.

use std::fmt;
use std::marker::PhantomData;

use glam::{DQuat, DVec3};
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use sscc::ReducedModel;
use sscc_io::gltf::{Track, animation_to_bytes};

use crate::ViewError;

/// Key frames of a motion at the most.
const MOST_FRAMES: usize = 100_000;

/// Their numbers q at the most.
const MOST_NUMBERS: usize = 8 << 20;

/// Key frames.
#[derive(Clone, Debug, Deserialize)]
pub struct AnimationRequest {
    /// Of each frame.
    #[serde(deserialize_with = "frames")]
    q: Vec<Vec<f64>>,
    /// Seconds.
    #[serde(deserialize_with = "frames")]
    times: Vec<f64>,
}

pub(super) fn glb(
    name: &str,
    model: &ReducedModel,
    AnimationRequest { q, times }: &AnimationRequest,
) -> Result<Vec<u8>, ViewError> {
    if q.len().saturating_mul(model.rank()) > MOST_NUMBERS {
        return Err(ViewError::Request(format!(
            "a motion has more than {MOST_NUMBERS} numbers: leave out frames"
        )));
    }
    for q in q {
        model.check_coordinates(q)?;
    }
    let track = Track {
        name: name.to_owned(),
        model: 0,
        center: DVec3::ZERO,
        positions: vec![DVec3::ZERO; q.len()],
        orientations: vec![DQuat::IDENTITY; q.len()],
        weights: q.concat(),
    };
    animation_to_bytes(&[(name, model)], times, &[track]).map_err(ViewError::Request)
}

/// A list with one entry for each frame, refused at the first that is too many.
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
                if frames.len() == MOST_FRAMES {
                    return Err(A::Error::custom(format!("a motion has more than {MOST_FRAMES} key frames")));
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
    use sscc::{Modes, TriMesh};

    use super::*;

    #[test]
    fn the_numbers_of_a_motion_are_bounded() {
        const RANK: usize = 128;
        let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
        let modes = Modes::from_matrix(3, RANK, |row, k| (row + k) as f64).unwrap();
        let model = ReducedModel::new(mesh, modes).unwrap();
        let refused = |frames: usize| {
            let request = AnimationRequest { q: vec![Vec::new(); frames], times: Vec::new() };
            glb("plate", &model, &request).unwrap_err().to_string()
        };
        let most = MOST_NUMBERS / RANK;
        assert!(refused(most + 1).contains("more than 8388608 numbers"));
        // So many may be: what is wrong then is that the rows are empty.
        assert!(!refused(most).contains("8388608"));
    }
}
