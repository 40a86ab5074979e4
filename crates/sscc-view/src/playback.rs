//! Recorded motions, which the page plays.

use serde::Serialize;

use crate::Plot;

/// The recorded motion of bodies.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Playback {
    /// Times of the frames (s), ascending.
    pub times: Vec<f64>,
    /// The name of a frame on the page.
    pub clock: Clock,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// For each frame the number of self-colliding triangle pairs of all bodies, as the maximum over the steps strictly
    /// between the previous frame and this one; 0 for the first frame. `None` if the motion has no such steps.
    pub pairs_since: Option<Vec<u64>>,
    /// The pairs that were not tested, for the end of a sentence: ", apart from ..."; empty if all pairs were tested.
    pub apart: String,
    /// The colliding triangles, where known.
    pub colliding: Option<Colliding>,
    /// The colliding pairs, where known; the page then needs no `colliding`.
    pub contacts: Option<Contacts>,
    /// The curves in which surfaces intersect, where known.
    pub curves: Option<Curves>,
    /// Height of the ground (z).
    pub ground: Option<f64>,
    /// Name of the array with the sound as a WAV file.
    pub sound: Option<String>,
    /// Cost of the steps over the same time.
    pub costs: Option<Plot>,
}

/// Name of a frame on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// The frame's time.
    Time,
    /// The frame's number: the times only set the speed.
    Frame,
    /// The frame's number and its time.
    FrameAndTime,
}

/// The motion of a body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Name of the body.
    pub name: String,
    /// Index of its model in the scene.
    pub model: usize,
    /// Its deformation.
    #[serde(flatten)]
    pub track: Track,
    /// Name of the array of x and of R as a quaternion x y z w (frames x 7).
    pub rigid: Option<String>,
    /// The point about which the body rotates. For given positions it is the origin of the page's coordinates, the same for
    /// all bodies.
    pub center: [f64; 3],
    /// For each frame the number of colliding triangle pairs in that frame; for a continuous check, in the step after it.
    /// `None` if unknown, or if another body counts them.
    pub pairs: Option<Vec<u64>>,
}

/// The deformation of a body.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Track {
    /// Name of the array of q (frames x r). A vertex p is at `R (p + U q - center) + x`.
    Q(String),
    /// Name of the array of positions relative to `center` (frames x vertices x 3).
    Positions(String),
}

/// Colliding triangles of each frame and body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Colliding {
    /// Name of the array of offsets into `triangles`: one for each list, ordered by frame, then by body, and the end.
    pub offsets: String,
    /// Name of the array of triangle numbers.
    pub triangles: String,
}

/// Colliding pairs of each frame and body; for a continuous check, of the step after each frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contacts {
    /// Name of the array of offsets into `pairs`: one for each list, ordered by frame, then by body, and the end.
    pub offsets: String,
    /// Name of the array of pairs: two triangle numbers each.
    pub pairs: String,
    /// Name of the array of times of impact (0 to 1), one for each pair, of a continuous check.
    pub times: Option<String>,
    /// Name of the array of the body of the second triangle of each pair, where some are pairs of different bodies.
    pub seconds: Option<String>,
    /// Whether the second triangle of each pair belongs to the second body. Otherwise, and without `seconds`, it belongs to the
    /// body of the list.
    pub is_between: bool,
}

/// The curves in which surfaces intersect, as segments.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curves {
    /// Name of the array of offsets into `segments`: one for each frame, and the end.
    pub offsets: String,
    /// Name of the array of segments: two points each, relative to the bodies' `center`.
    pub segments: String,
}
