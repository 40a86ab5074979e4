//! How jobs and their results are sealed: nothing that was damaged on its way, or that is of another model, other
//! options or another build, is taken for what it is not. (A worker that lies is not found out: workers are trusted as
//! this process is.)

use crate::Error;
use crate::certificates::build::task::Prepared;

/// The length of a key and of a seal.
const HASH: usize = 32;

/// The version of the crate and a hash of its source: another build may bound otherwise, so that results of both are
/// not to be mixed.
pub const BUILD: &str = concat!(env!("CARGO_PKG_VERSION"), " ", env!("SSCC_SOURCE"));

/// What jobs and results must have in common to be of one computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::certificates) struct Key([u8; HASH]);

impl Key {
    /// The build; model, metric, centre, rule and exceptions (the digest); epsilon; the hierarchy, whose nodes jobs
    /// name.
    pub(in crate::certificates) fn of(prepared: &Prepared) -> Self {
        let mut hasher = blake3::Hasher::new_derive_key("sscc shards 2026-11-22");
        hasher.update(&(BUILD.len() as u64).to_le_bytes()).update(BUILD.as_bytes());
        hasher.update(&prepared.digest.0);
        hasher.update(&prepared.epsilon.to_bits().to_le_bytes());
        hasher.update(&prepared.global_radius.to_bits().to_le_bytes());
        let nodes = prepared.hierarchy.nodes();
        hasher.update(&(nodes.len() as u64).to_le_bytes());
        for node in nodes {
            for number in [node.first_triangle, node.triangle_count, node.first_child, node.child_count] {
                hasher.update(&number.to_le_bytes());
            }
        }
        prepared.hierarchy.order().iter().for_each(|t| {
            hasher.update(&t.to_le_bytes());
        });
        Self(*hasher.finalize().as_bytes())
    }

    /// The bytes between the key and a hash of everything.
    pub(in crate::certificates) fn seal(&self, body: &[u8]) -> Vec<u8> {
        let mut sealed = Vec::with_capacity(body.len() + 2 * HASH);
        sealed.extend_from_slice(&self.0);
        sealed.extend_from_slice(body);
        let hash = blake3::hash(&sealed);
        sealed.extend_from_slice(hash.as_bytes());
        sealed
    }

    /// What was sealed. `what`: a job or the result of one.
    pub(in crate::certificates) fn open<'a>(&self, what: &str, sealed: &'a [u8]) -> Result<&'a [u8], Error> {
        let damaged = || Error::Shard(format!("{what} is damaged: it was cut off or changed on its way"));
        let (bytes, seal) = sealed.split_last_chunk::<HASH>().ok_or_else(damaged)?;
        let (key, body) = bytes.split_first_chunk::<HASH>().ok_or_else(damaged)?;
        if blake3::hash(bytes).as_bytes() != seal {
            return Err(damaged());
        }
        if *key != self.0 {
            return Err(Error::Shard(format!(
                "{what} is of another model, other options or another build of sscc (here {BUILD}): install the same \
                 version everywhere"
            )));
        }
        Ok(body)
    }

    /// The seal at the end of what was sealed: it names a job.
    pub(in crate::certificates) fn name(sealed: &[u8]) -> [u8; HASH] {
        sealed.last_chunk().copied().unwrap_or_default()
    }
}

/// Reads numbers, little-endian, one after the other; none where the bytes end.
pub(in crate::certificates) struct Reader<'a>(pub(in crate::certificates) &'a [u8]);

impl Reader<'_> {
    pub(in crate::certificates) fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*bytes)
    }

    pub(in crate::certificates) fn u8(&mut self) -> Option<u8> {
        self.bytes().map(u8::from_le_bytes)
    }

    pub(in crate::certificates) fn u32(&mut self) -> Option<u32> {
        self.bytes().map(u32::from_le_bytes)
    }

    pub(in crate::certificates) fn u64(&mut self) -> Option<u64> {
        self.bytes().map(u64::from_le_bytes)
    }

    /// A radius: not negative, and a number.
    pub(in crate::certificates) fn radius(&mut self) -> Option<f64> {
        self.bytes().map(f64::from_le_bytes).filter(|x| *x >= 0.0)
    }

    /// The same in single precision.
    pub(in crate::certificates) fn single(&mut self) -> Option<f32> {
        self.bytes().map(f32::from_le_bytes).filter(|x| *x >= 0.0)
    }
}
