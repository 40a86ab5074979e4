//! Keys of files in the cache.

use std::fmt::{self, Display};

use sscc::{ReducedModel, TriMesh};

/// Hash of all inputs of a cached file and of the version of this program.
pub struct Key(blake3::Hasher);

impl Key {
    /// Begins the key of a file of this kind.
    pub fn new(kind: &str) -> Self {
        Self(blake3::Hasher::new()).text(kind).text(env!("CARGO_PKG_VERSION"))
    }

    /// Adds a text.
    pub fn text(mut self, text: &str) -> Self {
        self.0.update(&(text.len() as u64).to_le_bytes()).update(text.as_bytes());
        self
    }

    /// Adds a mesh.
    pub fn mesh(mut self, mesh: &TriMesh) -> Self {
        self.0.update(&(mesh.faces().len() as u64).to_le_bytes());
        for v in mesh.faces().as_flattened() {
            self.0.update(&v.to_le_bytes());
        }
        for x in mesh.rest_positions().iter().flat_map(|p| p.to_array()) {
            self.0.update(&x.to_le_bytes());
        }
        self
    }

    /// Adds a model with the default scope of its certificates. Callers add other options as text.
    pub fn model(self, model: &ReducedModel) -> Self {
        let digest = sscc::parts::Digest::of(model, &sscc::parts::Scope::of(model));
        self.text(&format!("{digest:?}"))
    }
}

impl Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.finalize().to_hex()[..16])
    }
}
