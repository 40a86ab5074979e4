//! Reader for containers.

use std::collections::BTreeMap;

use safetensors::tensor::Metadata;

use super::header::{self, DIGEST, DIGEST_KEY, Entry, Item, LENGTH, MAX_HEADER_BYTES, PREFIX};
use super::{Kind, Tensor};
use crate::error::cut;
use crate::{FormatError, Place};

/// Container with a valid digest, kind and version.
#[derive(Debug)]
pub struct Container<'a> {
    version: u32,
    texts: BTreeMap<String, String>,
    metadata: Metadata,
    data: &'a [u8],
}

impl<'a> Container<'a> {
    /// Parses a file of the given kind. The digest is checked first, so that a damaged file is always reported as
    /// damaged. Later versions must keep the digest, so that this version recognises them.
    ///
    /// # Errors
    /// When the file is not a container of sscc, a byte of it has changed, it is of another kind or a newer version, or
    /// its header is not in the canonical form (for example two tensors of one name).
    pub fn parse(bytes: &'a [u8], kind: Kind) -> Result<Self, FormatError> {
        let header = checked_header(bytes)?;
        let at_header = |cause: String| FormatError::new(Place::Byte(LENGTH), cause);
        // `SafeTensors::deserialize` would do this and the next step, but it adds the end of the tensors to the length
        // of the header without a check for overflow.
        let metadata: Metadata = serde_json::from_str(header)
            .map_err(|e| at_header(format!("not a safetensors header: {}", cut(&e.to_string(), 120))))?;
        let data = &bytes[LENGTH + header.len()..];
        if metadata.data_len() != data.len() {
            let cause =
                format!("the tensors take {} bytes, the file has {}", metadata.data_len(), data.len());
            return Err(at_header(cause));
        }
        let mut texts: BTreeMap<String, String> =
            metadata.metadata().iter().flatten().map(|(key, text)| (key.clone(), text.clone())).collect();
        let digest = texts.remove(DIGEST_KEY).unwrap_or_default();
        // The header has one canonical form. A header with the same content in another form may hide data: the parser
        // keeps only one of two equal names.
        if header::to_text(&digest, &texts, &entries(&metadata)?)? != header {
            return Err(at_header(
                "the header is not in canonical form: a name is repeated, or the order differs".into(),
            ));
        }
        let mut file = Self { version: 0, texts, metadata, data };
        file.version = kind.check(file.text("format")?, file.text("version")?)?;
        Ok(file)
    }

    /// Returns the version of the file's format, from 1 to the newest of its kind.
    pub fn version(&self) -> u32 {
        self.version
    }

    /// Returns a text entry.
    ///
    /// # Errors
    /// When the key does not exist.
    pub fn text(&self, key: &str) -> Result<&str, FormatError> {
        let missing = || FormatError::new(Place::Key(key.into()), "missing");
        self.texts.get(key).map(String::as_str).ok_or_else(missing)
    }

    /// Returns the names of all tensors, ascending.
    pub fn names(&self) -> Vec<String> {
        let mut names = self.metadata.offset_keys();
        names.sort();
        names
    }

    /// Checks that the file has no other tensors than these.
    ///
    /// # Errors
    /// When there is another tensor.
    pub fn only(&self, known: &[&str]) -> Result<(), FormatError> {
        match self.names().into_iter().find(|name| !known.contains(&name.as_str())) {
            Some(name) => {
                Err(FormatError::new(Place::Tensor(name), "not known in this version of the format"))
            }
            None => Ok(()),
        }
    }

    /// Returns an array of f64.
    ///
    /// # Errors
    /// When the name does not exist, or the type differs. The same holds for the other types.
    pub fn f64(&self, name: &str) -> Result<Tensor<f64>, FormatError> {
        self.tensor(name, Item::F64, f64::from_le_bytes)
    }

    /// Returns an array of u64.
    ///
    /// # Errors
    /// As [`Container::f64`].
    pub fn u64(&self, name: &str) -> Result<Tensor<u64>, FormatError> {
        self.tensor(name, Item::U64, u64::from_le_bytes)
    }

    /// Returns an array of f32.
    ///
    /// # Errors
    /// As [`Container::f64`].
    pub fn f32(&self, name: &str) -> Result<Tensor<f32>, FormatError> {
        self.tensor(name, Item::F32, f32::from_le_bytes)
    }

    /// Returns an array of u32.
    ///
    /// # Errors
    /// As [`Container::f64`].
    pub fn u32(&self, name: &str) -> Result<Tensor<u32>, FormatError> {
        self.tensor(name, Item::U32, u32::from_le_bytes)
    }

    /// Returns an array of u8.
    ///
    /// # Errors
    /// As [`Container::f64`].
    pub fn u8(&self, name: &str) -> Result<Tensor<u8>, FormatError> {
        self.tensor(name, Item::U8, u8::from_le_bytes)
    }

    fn tensor<T, const N: usize>(
        &self,
        name: &str,
        item: Item,
        decode: impl Fn([u8; N]) -> T,
    ) -> Result<Tensor<T>, FormatError> {
        let refused = |cause| FormatError::new(Place::Tensor(name.into()), cause);
        let info = self.metadata.info(name).ok_or_else(|| refused("missing".into()))?;
        if Item::from_dtype(info.dtype) != Some(item) {
            return Err(refused(format!("it has the type {}, {} was expected", info.dtype, item.name())));
        }
        // Parsing the header checked the offsets against the data, and the sizes against the shapes.
        let (begin, end) = info.data_offsets;
        let values = self.data[begin..end].as_chunks::<N>().0.iter().map(|bytes| decode(*bytes)).collect();
        Ok(Tensor { name: name.into(), shape: info.shape.clone(), values })
    }
}

/// Checks the digest, and returns the text of the header.
fn checked_header(bytes: &[u8]) -> Result<&str, FormatError> {
    let no_container = || FormatError::whole("not a file written by sscc, or its beginning is damaged");
    let (length, rest) = bytes.split_first_chunk::<LENGTH>().ok_or_else(no_container)?;
    if !rest.starts_with(PREFIX.as_bytes()) || bytes.len() < DIGEST.end {
        return Err(no_container());
    }
    if header::digest(bytes).as_bytes() != &bytes[DIGEST] {
        return Err(FormatError::whole(
            "the file is damaged: its content does not match its BLAKE3 digest; copy or create it anew",
        ));
    }
    // A valid digest does not make the content trustworthy, so the steps below check it.
    let length = u64::from_le_bytes(*length);
    let cause = match usize::try_from(length).ok().filter(|n| *n <= rest.len()) {
        Some(n) if n > MAX_HEADER_BYTES => {
            format!("the header has {n} bytes: at most {MAX_HEADER_BYTES} are allowed")
        }
        Some(n) => match std::str::from_utf8(&rest[..n]) {
            Ok(text) => return Ok(text),
            Err(_) => "the header is not UTF-8 text".into(),
        },
        None => format!("a header of {length} bytes does not fit into the file: create the file anew"),
    };
    Err(FormatError::new(Place::Byte(0), cause))
}

/// Returns the entries of the header, in the order of the file.
fn entries(metadata: &Metadata) -> Result<Vec<Entry>, FormatError> {
    let mut entries = Vec::new();
    for (name, info) in metadata.tensors() {
        let Some(item) = Item::from_dtype(info.dtype) else {
            let cause = format!("the type {} is not used by sscc", info.dtype);
            return Err(FormatError::new(Place::Tensor(name), cause));
        };
        let size = info.data_offsets.1 - info.data_offsets.0;
        entries.push(Entry { name, item, shape: info.shape.clone(), size });
    }
    header::sort(&mut entries);
    Ok(entries)
}

#[cfg(test)]
mod tests;
