//! Writer for proofs of certificates: `*.proof` (docs/formats.md).

use std::path::Path;

use sscc::parts::Prover;
use sscc::{Error, Progress};

use crate::IoError;
use crate::error::FormatError;
use crate::file::WholeFile;

/// Number of entries that are proven before their bytes are written; it bounds the memory of a long proof.
const ENTRIES_AT_ONCE: usize = 1 << 10;

/// A proof that is written beside its target. Dropping it removes it.
pub struct ProofFile {
    file: WholeFile,
    bytes: u64,
}

impl ProofFile {
    /// Replaces the target, and returns the length of the proof in bytes.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(self) -> Result<u64, IoError> {
        self.file.finish()?;
        Ok(self.bytes)
    }
}

/// Writes the proof of some entries, given by ascending numbers. The file appears whole when it is finished, or not at all.
///
/// # Errors
/// When an entry has no proof, `progress` cancels, or the file cannot be written.
pub fn write_proof(
    path: &Path,
    prover: &Prover,
    numbers: &[usize],
    threads: Option<usize>,
    progress: &dyn Progress,
) -> Result<ProofFile, IoError> {
    let mut file = WholeFile::create(path)?;
    let mut bytes = prover.header(numbers.len());
    let mut written = 0;
    file.write(&bytes)?;
    for (done, part) in numbers.chunks(ENTRIES_AT_ONCE).enumerate() {
        written += bytes.len() as u64;
        progress.report(done * ENTRIES_AT_ONCE, numbers.len());
        bytes = prover.prove(part, threads, progress).map_err(|error| unproven(path, error))?;
        file.write(&bytes)?;
    }
    Ok(ProofFile { file, bytes: written + bytes.len() as u64 })
}

/// Returns the error for an entry without a proof: a defect, because certificates are proven right after they are computed.
fn unproven(path: &Path, error: Error) -> IoError {
    match error {
        Error::Unproven(cause) => {
            IoError::request(path, format!("{cause}. This is a defect of sscc: please report it"))
        }
        other => FormatError::from(other).of(path),
    }
}
