//! Recorded motions, which the page plays.

use serde::Serialize;

use crate::Plot;

/// The recorded motion of bodies, each with a deformation q and a rigid motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Playback {
    /// Times of the frames (s), ascending.
    pub times: Vec<f64>,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// For each frame the number of self-colliding triangle pairs of all bodies, as the maximum over the steps strictly
    /// between the previous frame and this one; 0 for the first frame. `None` if the motion has no such steps.
    pub pairs_since: Option<Vec<u64>>,
    /// The colliding triangles, where known.
    pub colliding: Option<Colliding>,
    /// Height of the ground (z).
    pub ground: Option<f64>,
    /// Name of the array with the sound as a WAV file.
    pub sound: Option<String>,
    /// Cost of the steps over the same time.
    pub costs: Option<Plot>,
}

/// The motion of a body. A vertex p is at `R (p + U q - center) + x`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Name of the body.
    pub name: String,
    /// Index of its model in the scene.
    pub model: usize,
    /// Name of the array of q (frames x r).
    pub q: String,
    /// Name of the array of x and of R as a quaternion x y z w (frames x 7).
    pub rigid: Option<String>,
    /// The point about which the body turns.
    pub center: [f64; 3],
    /// For each frame the number of self-colliding triangle pairs in that frame; `None` if unknown.
    pub pairs: Option<Vec<u64>>,
}

/// Colliding triangles of each frame and body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Colliding {
    /// Name of the array of offsets into `triangles`: one for each list, ordered by frame, then by body, and the end.
    pub offsets: String,
    /// Name of the array of triangle numbers.
    pub triangles: String,
}
