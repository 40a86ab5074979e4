//! Motions that the page plays.

use serde::Serialize;

use crate::Plot;

/// Bodies that move by q and as a whole.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Playback {
    /// Of the frames (s), ascending.
    pub times: Vec<f64>,
    /// What moves.
    pub bodies: Vec<Body>,
    /// For each frame the most pairs of triangles in which all bodies collide with themselves in one step between the
    /// frame before and this one (neither of both counts; 0 at the first); none where there are no such steps.
    pub pairs_since: Option<Vec<u64>>,
    /// Triangles that collide, where they are known.
    pub colliding: Option<Colliding>,
    /// How high the ground is (z).
    pub ground: Option<f64>,
    /// Name of the array with a WAV file.
    pub sound: Option<String>,
    /// What the steps cost, over the same time.
    pub costs: Option<Plot>,
}

/// A body: `R (p + U q - center) + x` is where a vertex p is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// What it is called.
    pub name: String,
    /// Which of the models it is.
    pub model: usize,
    /// Name of the array of q, frame after frame (T x r).
    pub q: String,
    /// Name of the array of x and R as a quaternion x y z w (T x 7).
    pub rigid: Option<String>,
    /// The point about which it turns.
    pub center: [f64; 3],
    /// For each frame the number of pairs of triangles in which it collides with itself in that very frame; none where
    /// they are not known.
    pub pairs: Option<Vec<u64>>,
}

/// Which triangles collide, for each frame and body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Colliding {
    /// Name of the array of where each list begins: frame after frame, in it body after body; at last the end.
    pub offsets: String,
    /// Name of the array of triangles.
    pub triangles: String,
}
