//! Seals of jobs and results: bytes that were damaged on their way, or belong to another model, other options or another
//! build, are refused.
//!
//! A seal is the key of the computation, before the bytes, and a hash of key and bytes, after them. It protects from
//! mistakes, not from a malicious worker: workers are trusted as this process is.

use crate::Error;
use crate::certificates::build::Preparation;

/// The length of a key and of a hash.
pub(super) const HASH: usize = 32;

/// The version of the crate and a hash of its source. Two builds may compute different bounds, so their results must not
/// be mixed.
pub const BUILD: &str = concat!(env!("CARGO_PKG_VERSION"), " ", env!("SSCC_SOURCE"));

/// A hash of everything that the jobs and results of one computation have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Key([u8; HASH]);

impl Key {
    /// Computes the key of a computation from build, digest (model and scope), epsilon, global radius, farthest radius,
    /// and the hierarchy, whose nodes jobs name.
    pub(super) fn of(preparation: &Preparation) -> Self {
        let mut hasher = blake3::Hasher::new_derive_key("sscc shards 2026-11-22");
        hasher.update(&(BUILD.len() as u64).to_le_bytes()).update(BUILD.as_bytes());
        hasher.update(&preparation.digest.0);
        hasher.update(&preparation.epsilon.to_bits().to_le_bytes());
        hasher.update(&preparation.global_radius.to_bits().to_le_bytes());
        hasher.update(&preparation.farthest.to_bits().to_le_bytes());
        let nodes = preparation.hierarchy.nodes();
        hasher.update(&(nodes.len() as u64).to_le_bytes());
        for node in nodes {
            for number in [node.first_triangle, node.triangle_count, node.first_child, node.child_count] {
                hasher.update(&number.to_le_bytes());
            }
        }
        preparation.hierarchy.order().iter().for_each(|t| {
            hasher.update(&t.to_le_bytes());
        });
        Self(*hasher.finalize().as_bytes())
    }

    /// Returns the bytes between the key and a hash of both.
    pub(super) fn seal(&self, body: &[u8]) -> Vec<u8> {
        let mut sealed = Vec::with_capacity(body.len() + 2 * HASH);
        sealed.extend_from_slice(&self.0);
        sealed.extend_from_slice(body);
        let hash = blake3::hash(&sealed);
        sealed.extend_from_slice(hash.as_bytes());
        sealed
    }

    /// Returns the bytes that were sealed. `what` names them in errors: "a job" or "a result".
    pub(super) fn open<'a>(&self, what: &str, sealed: &'a [u8]) -> Result<&'a [u8], Error> {
        let damaged = || {
            Error::Shard(format!("{what} is damaged: it was truncated or changed in transfer; send it again"))
        };
        let (bytes, seal) = sealed.split_last_chunk::<HASH>().ok_or_else(damaged)?;
        let (key, body) = bytes.split_first_chunk::<HASH>().ok_or_else(damaged)?;
        if blake3::hash(bytes).as_bytes() != seal {
            return Err(damaged());
        }
        if *key != self.0 {
            return Err(Error::Shard(format!(
                "{what} belongs to another model, other options or another build of sscc (this process has {BUILD}): \
                 use the same model, options and version on all machines"
            )));
        }
        Ok(body)
    }

    /// Returns the hash at the end of a sealed job, which is its name.
    pub(super) fn name(sealed: &[u8]) -> [u8; HASH] {
        sealed.last_chunk().copied().unwrap_or_default()
    }
}
