//! Writer for containers.

use std::collections::BTreeMap;

use super::Kind;
use super::header::{self, DIGEST, DIGEST_KEY, Entry, Item};
use crate::{FormatError, Place};

/// Collects the tensors and text entries of a container, and writes them.
///
/// ```
/// use sscc_io::container::{MODEL, Container, ContainerWriter};
///
/// let mut writer = ContainerWriter::new(MODEL);
/// writer.text("units", "metres").f64("points", &[2, 3], &[0.0; 6]);
/// let bytes = writer.finish()?;
/// let file = Container::parse(&bytes, MODEL)?;
/// assert_eq!(file.text("units")?, "metres");
/// assert_eq!(file.f64("points")?.shape, [2, 3]);
/// # Ok::<(), sscc_io::FormatError>(())
/// ```
#[derive(Debug)]
pub struct ContainerWriter {
    texts: BTreeMap<String, String>,
    tensors: BTreeMap<String, (Item, Vec<usize>, Vec<u8>)>,
    /// First error, which [`ContainerWriter::finish`] returns.
    error: Option<FormatError>,
}

impl ContainerWriter {
    /// Creates a container of the given kind and its version, without content.
    pub fn new(kind: Kind) -> Self {
        let mut writer = Self { texts: BTreeMap::new(), tensors: BTreeMap::new(), error: None };
        writer.text("format", kind.format).text("version", &kind.version.to_string());
        writer
    }

    /// Adds a text entry.
    pub fn text(&mut self, key: &str, text: &str) -> &mut Self {
        if key == DIGEST_KEY || self.texts.insert(key.into(), text.into()).is_some() {
            self.refuse(Place::Key(key.into()), "the entry already exists".into());
        }
        self
    }

    /// Adds an array of f64 (C order).
    pub fn f64(&mut self, name: &str, shape: &[usize], values: &[f64]) -> &mut Self {
        self.tensor(name, Item::F64, shape, values.iter().flat_map(|v| v.to_le_bytes()).collect())
    }

    /// Adds an array of u64 (C order).
    pub fn u64(&mut self, name: &str, shape: &[usize], values: &[u64]) -> &mut Self {
        self.tensor(name, Item::U64, shape, values.iter().flat_map(|v| v.to_le_bytes()).collect())
    }

    /// Adds an array of f32 (C order).
    pub fn f32(&mut self, name: &str, shape: &[usize], values: &[f32]) -> &mut Self {
        self.tensor(name, Item::F32, shape, values.iter().flat_map(|v| v.to_le_bytes()).collect())
    }

    /// Adds an array of u32 (C order).
    pub fn u32(&mut self, name: &str, shape: &[usize], values: &[u32]) -> &mut Self {
        self.tensor(name, Item::U32, shape, values.iter().flat_map(|v| v.to_le_bytes()).collect())
    }

    /// Adds an array of u8 (C order).
    pub fn u8(&mut self, name: &str, shape: &[usize], values: &[u8]) -> &mut Self {
        self.tensor(name, Item::U8, shape, values.to_vec())
    }

    fn tensor(&mut self, name: &str, item: Item, shape: &[usize], data: Vec<u8>) -> &mut Self {
        let size = shape.iter().try_fold(item.size(), |size, n| size.checked_mul(*n));
        if size != Some(data.len()) {
            let cause = format!("{} values do not fill the shape {shape:?}", data.len() / item.size());
            self.refuse(Place::Tensor(name.into()), cause);
        } else if name == "__metadata__" || self.tensors.contains_key(name) {
            self.refuse(Place::Tensor(name.into()), "the name is already in use".into());
        } else {
            self.tensors.insert(name.into(), (item, shape.into(), data));
        }
        self
    }

    fn refuse(&mut self, place: Place, cause: String) {
        self.error.get_or_insert_with(|| FormatError::new(place, cause));
    }

    /// Returns the bytes of the file.
    ///
    /// # Errors
    /// When a name was used twice or is reserved, values did not fill their shape, or names, shapes and texts exceed 1
    /// MiB in all.
    pub fn finish(self) -> Result<Vec<u8>, FormatError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let mut entries: Vec<Entry> = self
            .tensors
            .iter()
            .map(|(name, (item, shape, data))| Entry {
                name: name.clone(),
                item: *item,
                shape: shape.clone(),
                size: data.len(),
            })
            .collect();
        header::sort(&mut entries);
        let text = header::to_text(&"0".repeat(64), &self.texts, &entries)?;
        let mut bytes = (text.len() as u64).to_le_bytes().to_vec();
        bytes.extend(text.bytes());
        for entry in &entries {
            bytes.extend(&self.tensors[&entry.name].2);
        }
        let digest = header::digest(&bytes);
        bytes[DIGEST].copy_from_slice(digest.as_bytes());
        Ok(bytes)
    }
}
