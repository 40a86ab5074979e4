//! Structs and constants of answers, and types of callbacks. They never change; later versions add new ones.

use std::ffi::{c_int, c_void};

use sscc::{Impact, Pair, Proof, Statistics};

/// Two triangles, counted from 0. For one mesh the lower number is first, for two meshes the triangle of the first mesh.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct sscc_pair {
    /// The first triangle.
    pub a: u32,
    /// The second triangle.
    pub b: u32,
}

/// Two triangles that collide during a motion.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct sscc_impact {
    /// The first triangle.
    pub a: u32,
    /// The second triangle.
    pub b: u32,
    /// The time of impact, from 0 to 1, never later than the true one.
    pub time: f64,
}

/// The kind of proof of an answer, apart from exceptions.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum sscc_proof {
    /// A traversal of the hierarchy.
    Search = 0,
    /// The root's radius: one comparison.
    Radius = 1,
    /// The root's local certificate: the strain of the whole shape.
    Local = 2,
}

/// The cost of the last answer of a query, a kinetic query or a detector, and the kind of its proof.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct sscc_statistics {
    /// |z| about the centre, rounded up, in the metric of the certificates; for a continuous answer the larger one of
    /// start and end; 0 for a detector.
    pub norm: f64,
    /// Nodes and node pairs that were opened.
    pub opened: u64,
    /// Pairs of boxes that were compared.
    pub box_tests: u64,
    /// Pairs of triangles that were tested exactly.
    pub triangle_tests: u64,
    /// The kind of proof of the answer.
    pub proof: sscc_proof,
    /// 1 if all colliding pairs were found, 0 if a limit or an error stopped the search.
    pub complete: i32,
}

/// An axis-aligned box.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct sscc_box {
    /// The smallest coordinates.
    pub lower: [f64; 3],
    /// The largest coordinates.
    pub upper: [f64; 3],
}

/// The pose of a shape: `rotation * x + translation`. The matrix need not be a rotation.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct sscc_pose {
    /// A 3 x 3 matrix, row by row.
    pub rotation: [f64; 9],
    /// The translation.
    pub translation: [f64; 3],
}

/// Receives the progress of a long computation: `done` of `total` steps are finished. It returns another value than 0 to cancel.
///
/// Threads of the library call it, never two at a time. It must not throw, and must not free or use the handles of the
/// computation.
pub type sscc_progress_fn = Option<extern "C" fn(user: *mut c_void, done: usize, total: usize) -> c_int>;

/// Returns another value than 0 to cancel. It is called often, so it should be fast. A computation calls it from
/// threads of the library, never from two at a time; a query, a kinetic query or a detector calls it from the thread of
/// the call. It must not throw, and must not free the handles of the computation or of the call.
pub type sscc_cancel_fn = Option<extern "C" fn(user: *mut c_void) -> c_int>;

/// Receives one pair of an answer. It returns another value than 0 to end the visit. It must not throw.
pub type sscc_visit_fn = Option<extern "C" fn(user: *mut c_void, pair: sscc_pair) -> c_int>;

impl From<Pair> for sscc_pair {
    #[inline]
    fn from((a, b): Pair) -> Self {
        Self { a, b }
    }
}

impl From<Impact> for sscc_impact {
    #[inline]
    fn from(Impact { pair: (a, b), time }: Impact) -> Self {
        Self { a, b, time }
    }
}

impl From<Statistics> for sscc_statistics {
    fn from(statistics: Statistics) -> Self {
        let proof = match statistics.proof {
            Proof::Radius => sscc_proof::Radius,
            Proof::Local => sscc_proof::Local,
            Proof::Search => sscc_proof::Search,
        };
        let Statistics { norm, opened, box_tests, triangle_tests, complete, .. } = statistics;
        Self { norm, opened, box_tests, triangle_tests, proof, complete: i32::from(complete) }
    }
}
