//! The motion of the page as a file.

use glam::{DQuat, DVec3};
use serde::Deserialize;
use sscc::ReducedModel;
use sscc_io::gltf::{Track, animation_to_bytes};

use crate::ViewError;

/// Key frames.
#[derive(Clone, Debug, Deserialize)]
pub struct AnimationRequest {
    /// Of each frame.
    q: Vec<Vec<f64>>,
    /// Seconds.
    times: Vec<f64>,
}

pub(super) fn glb(
    name: &str,
    model: &ReducedModel,
    AnimationRequest { q, times }: &AnimationRequest,
) -> Result<Vec<u8>, ViewError> {
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
