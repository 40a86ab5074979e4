//! Reader for entries of a zip archive, with limits.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};

use zip::{CompressionMethod, ZipArchive};

use crate::allowance::Allowance;
use crate::error::{cut, quoted};
use crate::{FormatError, Place};

/// Maximum size of the decompressed entries, for archives of any size: 4 GiB.
const MAX_BYTES: u64 = 4 << 30;

/// Size of the record at the end of an archive, without its comment.
const END_RECORD_BYTES: usize = 22;

/// Size of the record before it in an archive of zip64, which has the place of the record of zip64.
const LOCATOR_BYTES: usize = 20;

/// Returns the bytes of the entries (`NAME.npy`) with accepted names, by name. Other entries are not read.
pub(super) fn entries(
    bytes: &[u8],
    wanted: impl Fn(&str) -> bool,
) -> Result<BTreeMap<String, Vec<u8>>, FormatError> {
    let whole = |e: &dyn std::fmt::Display| {
        FormatError::whole(format!("not a zip archive: {}", cut(&e.to_string(), 120)))
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| whole(&e))?;
    check_ends(bytes, &archive)?;
    // Only accepted entries count towards the limit. Bytes that two entries share count twice.
    let mut allowance = Allowance::new(bytes.len() as u64, MAX_BYTES);
    let mut found = BTreeMap::new();
    for index in 0..archive.len() {
        let mut entry = archive.by_index_raw(index).map_err(|e| whole(&e))?;
        let Ok(Some(name)) = entry.name().map(|name| name.strip_suffix(".npy").map(str::to_owned)) else {
            continue;
        };
        if !wanted(&name) {
            continue;
        }
        let refused = |cause: String| FormatError::part(place(&name), cause);
        if entry.encrypted() {
            return Err(refused("it is encrypted".into()));
        }
        if !matches!(entry.compression(), CompressionMethod::Stored | CompressionMethod::Deflated) {
            let cause =
                format!("the compression {} is not supported: save by numpy.savez", entry.compression());
            return Err(refused(cause));
        }
        let size = entry.size();
        allowance.take(size, 1).map_err(refused)?;
        drop(entry);
        let refused = |cause: String| FormatError::part(place(&name), cause);
        entry = archive.by_index(index).map_err(|e| refused(cut(&e.to_string(), 120)))?;
        let mut content = Vec::new();
        // Reading one byte beyond the declared size detects longer entries. Reading to the end verifies the checksum.
        let read = entry.by_ref().take(size.saturating_add(1)).read_to_end(&mut content);
        read.map_err(|e| refused(format!("damaged: {}", cut(&e.to_string(), 120))))?;
        if content.len() as u64 != size {
            return Err(refused(format!(
                "damaged: the entry does not have the {size} bytes that it declares"
            )));
        }
        drop(entry);
        if found.insert(name.clone(), content).is_some() {
            return Err(FormatError::part(place(&name), "the name is repeated"));
        }
    }
    Ok(found)
}

/// Returns the place of an entry, for messages.
pub(super) fn place(name: &str) -> String {
    format!("array {}", quoted(name))
}

/// Rejects bytes before and after the archive, which zip readers skip, and duplicate names, of which they keep the
/// last.
fn check_ends(bytes: &[u8], archive: &ZipArchive<Cursor<&[u8]>>) -> Result<(), FormatError> {
    let end = bytes.len().checked_sub(END_RECORD_BYTES + archive.comment().len());
    let Some(end) = end.filter(|end| bytes[*end..].starts_with(b"PK\x05\x06")) else {
        return Err(FormatError::whole("bytes follow the end of the archive"));
    };
    if archive.offset() != 0 {
        return Err(FormatError::new(Place::Byte(0), "bytes precede the archive"));
    }
    let entries = entry_count(bytes, end);
    if entries != archive.len() as u64 {
        let cause =
            format!("the archive has {} names for {entries} entries: is a name repeated?", archive.len());
        return Err(FormatError::new(Place::Byte(end), cause));
    }
    Ok(())
}

/// Returns the number of entries that an archive states. `end` is the place of the record at its end.
fn entry_count(bytes: &[u8], end: usize) -> u64 {
    let stated = u16::from_le_bytes([bytes[end + 10], bytes[end + 11]]);
    // The largest number of 16 bits means that a record of zip64 states the number, if there is one.
    let of_zip64 = || {
        let locator = bytes[..end].last_chunk::<LOCATOR_BYTES>()?.strip_prefix(b"PK\x06\x07")?;
        let at = u64::from_le_bytes(*locator[4..].first_chunk()?);
        let record = bytes.get(usize::try_from(at).ok()?..)?.strip_prefix(b"PK\x06\x06")?;
        record.get(28..)?.first_chunk().map(|count| u64::from_le_bytes(*count))
    };
    let of_zip64 = if stated == u16::MAX { of_zip64() } else { None };
    of_zip64.unwrap_or(u64::from(stated))
}
