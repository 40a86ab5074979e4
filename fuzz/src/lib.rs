//! Code that all fuzz targets share: bounds of time and memory, errors of one line, containers with correct digests.

pub mod arrays;
pub mod numbers;
pub mod questions;

use std::fmt::Display;
use std::time::Duration;

use cpu_time::ThreadTime;
use sscc::TriMesh;
use sscc::glam::DVec3;

/// Maximum memory of an input: a constant (bytes) and a factor on the size of the input.
const MEMORY: (u64, u64) = (8 << 20, 2048);

/// Maximum processor time of an input of at most [`MAX_BYTES`]. Coverage and checks make code several times slower.
const TIME: Duration = Duration::from_secs(4);

/// Longer inputs are skipped.
pub const MAX_BYTES: usize = 1 << 16;

/// Runs a target with an input, and asserts the bounds.
///
/// # Panics
/// When the input takes more memory or time than the bounds.
pub fn bounded(bytes: &[u8], attack: impl FnOnce(&[u8])) {
    if bytes.len() > MAX_BYTES {
        return;
    }
    let start = ThreadTime::now();
    let used = allocation_counter::measure(|| attack(bytes));
    let (base, factor) = MEMORY;
    let allowed = base + factor * bytes.len() as u64;
    assert!(used.bytes_max <= allowed, "{} bytes take {} bytes of memory", bytes.len(), used.bytes_max);
    let time = start.elapsed();
    assert!(time < TIME, "{} bytes take {time:?}", bytes.len());
}

/// Returns the value; for an error checks that its message is one line and not too long, and returns None.
///
/// # Panics
/// When the message has several lines, or is empty or long.
pub fn one_line<T, E: Display>(result: Result<T, E>) -> Option<T> {
    let error = match result {
        Ok(value) => return Some(value),
        Err(error) => error,
    };
    let message = error.to_string();
    let is_line = !message.is_empty() && !message.contains(['\n', '\r']) && message.len() < 2000;
    assert!(is_line, "the error is not one line: {message:?}");
    None
}

/// Returns a container with the correct digest of its bytes. With a wrong digest nearly every input would end at the check of
/// the digest.
pub fn sealed(bytes: &[u8]) -> Vec<u8> {
    const START: usize = 8 + r#"{"__metadata__":{"blake3":""#.len();
    let mut sealed = bytes.to_vec();
    let Some(digest) = sealed.get_mut(START..START + 64) else { return sealed };
    digest.fill(b'0');
    let mut hasher = blake3::Hasher::new();
    hasher.update(&sealed[..START]).update(&sealed[START + 64..]);
    let text = hasher.finalize().to_hex();
    sealed[START..START + 64].copy_from_slice(text.as_bytes());
    sealed
}

/// Returns a mesh for readers that need one.
///
/// # Panics
/// Never.
pub fn two_triangles() -> TriMesh {
    let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).expect("two triangles")
}
