//! Header of a container, in its canonical form.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::fmt::Write;

use safetensors::Dtype;

use crate::FormatError;

/// Start of every header. The 64 digits of the digest follow, always at the same offset.
pub(super) const PREFIX: &str = r#"{"__metadata__":{"blake3":""#;

/// Number of bytes of the length before the header.
pub(super) const LENGTH: usize = 8;

/// Range of the digest in the file.
pub(super) const DIGEST: std::ops::Range<usize> = LENGTH + PREFIX.len()..LENGTH + PREFIX.len() + 64;

/// Key of the digest.
pub(super) const DIGEST_KEY: &str = "blake3";

/// Maximum size of a header for reader and writer: parsed JSON takes many times the memory of its text.
pub(super) const MAX_HEADER_BYTES: usize = 1 << 20;

/// Number types of tensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Item {
    F64,
    U64,
    F32,
    U32,
    U8,
}

impl Item {
    pub fn name(self) -> &'static str {
        match self {
            Self::F64 => "F64",
            Self::U64 => "U64",
            Self::F32 => "F32",
            Self::U32 => "U32",
            Self::U8 => "U8",
        }
    }

    pub fn size(self) -> usize {
        match self {
            Self::F64 | Self::U64 => 8,
            Self::F32 | Self::U32 => 4,
            Self::U8 => 1,
        }
    }

    pub fn from_dtype(dtype: Dtype) -> Option<Self> {
        Some(match dtype {
            Dtype::F64 => Self::F64,
            Dtype::U64 => Self::U64,
            Dtype::F32 => Self::F32,
            Dtype::U32 => Self::U32,
            Dtype::U8 => Self::U8,
            _ => return None,
        })
    }
}

/// Entry of the header for one tensor, without its offset.
pub(super) struct Entry {
    pub name: String,
    pub item: Item,
    pub shape: Vec<usize>,
    /// Number of bytes of its data.
    pub size: usize,
}

/// Sorts entries: large number types first, so that all are aligned, then by name.
pub(super) fn sort(entries: &mut [Entry]) {
    entries.sort_by(|a, b| (Reverse(a.item.size()), &a.name).cmp(&(Reverse(b.item.size()), &b.name)));
}

/// Returns the header of these entries (sorted) and text entries, padded to a multiple of 8.
pub(super) fn to_text(
    digest: &str,
    texts: &BTreeMap<String, String>,
    entries: &[Entry],
) -> Result<String, FormatError> {
    let json = |text: &str| serde_json::to_string(text).map_err(|e| FormatError::whole(e.to_string()));
    let mut header = format!("{PREFIX}{digest}\"");
    for (key, text) in texts {
        header += &format!(",{}:{}", json(key)?, json(text)?);
    }
    header.push('}');
    let mut begin = 0;
    for Entry { name, item, shape, size } in entries {
        let axes: Vec<String> = shape.iter().map(ToString::to_string).collect();
        let (name, item, axes, end) = (json(name)?, item.name(), axes.join(","), begin + size);
        // Writing to a String never fails.
        let _ =
            write!(header, r#",{name}:{{"dtype":"{item}","shape":[{axes}],"data_offsets":[{begin},{end}]}}"#);
        begin = end;
    }
    header.push('}');
    let padded = header.len().next_multiple_of(8);
    header.extend(std::iter::repeat_n(' ', padded - header.len()));
    if header.len() > MAX_HEADER_BYTES {
        return Err(FormatError::whole(format!(
            "the header has {} bytes: at most {MAX_HEADER_BYTES} are allowed",
            header.len()
        )));
    }
    Ok(header)
}

/// Returns the digest of a file: its BLAKE3 with the digits of the digest replaced by zeros.
///
/// The file must contain [`DIGEST`].
pub(super) fn digest(bytes: &[u8]) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&bytes[..DIGEST.start]);
    hasher.update(&[b'0'; 64]);
    hasher.update(&bytes[DIGEST.end..]);
    hasher.finalize().to_hex().to_string()
}
