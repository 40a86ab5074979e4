//! Parser for binary glTF (GLB): a header, a JSON chunk and an optional binary chunk.

use crate::{FormatError, Place};

/// A glTF file in either form.
pub(super) struct Chunks<'a> {
    pub json: &'a [u8],
    /// Data of the first buffer.
    pub binary: Option<&'a [u8]>,
}

const MAGIC: &[u8] = b"glTF";
const JSON: &[u8; 4] = b"JSON";
const BINARY: &[u8; 4] = b"BIN\0";

/// Size of the header: magic, version and length of the file.
const HEADER: usize = 12;

/// Splits a GLB into its chunks. Any other file counts as JSON.
pub(super) fn split(bytes: &[u8]) -> Result<Chunks<'_>, FormatError> {
    let at = |byte, cause: String| FormatError::new(Place::Byte(byte), cause);
    if !bytes.starts_with(MAGIC) {
        return Ok(Chunks { json: bytes, binary: None });
    }
    let cut = |at_byte| at(at_byte, "the file ends within a header: is it cut off?".into());
    let (_, version, length) = header(bytes).ok_or_else(|| cut(bytes.len()))?;
    if version != 2 {
        let cause = format!("version {version} of GLB is not supported: save the file as glTF 2.0");
        return Err(at(4, cause));
    }
    if length != bytes.len() as u64 {
        let cause =
            format!("the header declares {length} bytes, the file has {}: is it cut off?", bytes.len());
        return Err(at(8, cause));
    }
    let mut chunks: [Option<&[u8]>; 2] = [None; 2];
    let mut next = HEADER;
    let mut number = 0;
    while next < bytes.len() {
        let header = bytes[next..].first_chunk::<8>().ok_or_else(|| cut(next))?;
        let [a, b, c, d, kind @ ..] = *header;
        let size = u32::from_le_bytes([a, b, c, d]) as usize;
        let begin = next + header.len();
        let Some(chunk) = bytes[begin..].get(..size) else {
            let cause = format!("a chunk of {size} bytes does not fit into the file");
            return Err(at(next, cause));
        };
        // JSON is the first chunk, binary data the second; readers must skip other chunks.
        match (number, &kind) {
            (0, JSON) | (1, BINARY) => chunks[number] = Some(chunk),
            (0, _) => return Err(at(next, "the first chunk is not JSON".into())),
            (_, JSON | BINARY) => return Err(at(next, "the chunk is repeated or out of order".into())),
            _ => {}
        }
        number += 1;
        next = begin + size;
    }
    let [Some(json), binary] = chunks else {
        return Err(at(HEADER, "the file has no JSON chunk".into()));
    };
    Ok(Chunks { json, binary })
}

fn header(bytes: &[u8]) -> Option<(u32, u32, u64)> {
    let [magic, version, length] = *bytes.first_chunk::<HEADER>()?.as_chunks::<4>().0 else { return None };
    let [magic, version, length] = [magic, version, length].map(u32::from_le_bytes);
    Some((magic, version, length.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u32, chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, chunk) in chunks {
            body.extend((chunk.len() as u32).to_le_bytes());
            body.extend(*kind);
            body.extend(*chunk);
        }
        let length = (HEADER + body.len()) as u32;
        [MAGIC, &version.to_le_bytes(), &length.to_le_bytes(), &body].concat()
    }

    fn message(bytes: &[u8]) -> String {
        split(bytes).err().unwrap().to_string()
    }

    #[test]
    fn chunks_are_split() {
        let bytes = file(2, &[(JSON, b"{}  "), (BINARY, b"1234"), (b"MORE", b"abcd")]);
        let chunks = split(&bytes).unwrap();
        assert_eq!((chunks.json, chunks.binary), (&b"{}  "[..], Some(&b"1234"[..])));
        assert_eq!(split(&file(2, &[(JSON, b"{}")])).unwrap().binary, None);
        assert_eq!(split(b"{}").unwrap().json, b"{}");
    }

    #[test]
    fn errors_name_the_place() {
        assert!(message(&file(1, &[(JSON, b"{}")])).contains("version 1 of GLB is not supported"));
        assert!(message(&file(2, &[(BINARY, b"{}")])).contains("the first chunk is not JSON"));
        assert!(
            message(&file(2, &[(JSON, b"{}"), (JSON, b"{}")])).starts_with("byte 22: the chunk is repeated")
        );
        assert!(message(&file(2, &[])).contains("no JSON chunk"));
        let good = file(2, &[(JSON, b"{}  "), (BINARY, b"1234")]);
        for len in 4..good.len() {
            assert!(split(&good[..len]).is_err(), "{len}");
        }
        assert!(message(&[&good[..], b"\0"].concat()).contains("declares 36 bytes, the file has 37"));
        let mut huge = good;
        huge[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!(message(&huge), "byte 12: a chunk of 4294967295 bytes does not fit into the file");
    }
}
