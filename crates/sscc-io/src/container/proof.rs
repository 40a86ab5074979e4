//! Writer for proofs of certificates: `*.proof` (docs/formats.md).

use std::path::Path;

use sscc::Progress;
use sscc::parts::Prover;

use crate::IoError;
use crate::error::FormatError;
use crate::file::WholeFile;

/// Entries that are proven before their bytes are written: they bound the memory of a long proof.
const ENTRIES_AT_ONCE: usize = 1 << 10;

/// Writes the proof of some entries, given by ascending numbers, and returns its bytes. The file appears whole, or not at all.
///
/// # Errors
/// When an entry has no proof, `progress` cancels, or the file cannot be written.
pub fn write_proof(
    path: &Path,
    prover: &Prover,
    numbers: &[usize],
    threads: Option<usize>,
    progress: &dyn Progress,
) -> Result<u64, IoError> {
    let mut file = WholeFile::create(path)?;
    let mut bytes = prover.header(numbers.len());
    let mut written = 0;
    file.write(&bytes)?;
    for (done, part) in numbers.chunks(ENTRIES_AT_ONCE).enumerate() {
        written += bytes.len() as u64;
        progress.report(done * ENTRIES_AT_ONCE, numbers.len());
        bytes = prover.prove(part, threads, progress).map_err(|error| FormatError::from(error).of(path))?;
        file.write(&bytes)?;
    }
    file.finish()?;
    Ok(written + bytes.len() as u64)
}
