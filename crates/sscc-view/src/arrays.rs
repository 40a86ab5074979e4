//! Named binary arrays for the page, little-endian.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Serialize, Serializer};

/// Arrays by name. JSON holds their bytes in base64. A name consists of letters, digits and `-`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Arrays {
    arrays: BTreeMap<String, Vec<u8>>,
}

impl Arrays {
    /// Adds an array of 32-bit floats; returns its name.
    pub fn add_f32(&mut self, name: impl Into<String>, values: impl IntoIterator<Item = f32>) -> String {
        self.add_bytes(name, values.into_iter().flat_map(f32::to_le_bytes).collect())
    }

    /// Adds an array of 32-bit integers; returns its name.
    pub fn add_u32(&mut self, name: impl Into<String>, values: impl IntoIterator<Item = u32>) -> String {
        self.add_bytes(name, values.into_iter().flat_map(u32::to_le_bytes).collect())
    }

    /// Adds an array of bytes; returns its name.
    pub fn add_bytes(&mut self, name: impl Into<String>, bytes: Vec<u8>) -> String {
        let name = name.into();
        self.arrays.insert(name.clone(), bytes);
        name
    }

    /// Returns the bytes of an array; `None` if no array has this name.
    pub fn get(&self, name: &str) -> Option<&[u8]> {
        self.arrays.get(name).map(Vec::as_slice)
    }

    /// Returns the total size of all arrays (bytes).
    pub fn bytes(&self) -> usize {
        self.arrays.values().map(Vec::len).sum()
    }
}

impl Serialize for Arrays {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.arrays.iter().map(|(name, bytes)| (name, STANDARD.encode(bytes))))
    }
}
