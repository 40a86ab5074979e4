//! The digest of everything that certificates speak of.

use crate::{Metric, ReducedModel};

/// BLAKE3 of faces, f64 positions, f64 modes, the certificates' metric, and the rules under which pairs
/// count. Certificates whose digest differs from the model's would be a wrong proof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(pub [u8; 32]);

impl Digest {
    /// The digest of a model with the metric of its certificates.
    pub fn of(model: &ReducedModel, metric: &Metric) -> Self {
        let mut hasher = blake3::Hasher::new();
        let mut section = |name: &str, count: usize, bytes: &mut dyn Iterator<Item = [u8; 8]>| {
            hasher.update(name.as_bytes());
            hasher.update(&(count as u64).to_le_bytes());
            let mut buffer = Vec::with_capacity(1 << 16);
            for b in bytes {
                buffer.extend_from_slice(&b);
                if buffer.len() == buffer.capacity() {
                    hasher.update(&buffer);
                    buffer.clear();
                }
            }
            hasher.update(&buffer);
        };
        let (mesh, modes) = (model.mesh(), model.modes());
        let bits = |x: f64| x.to_bits().to_le_bytes();
        let faces = mesh.faces();
        section("faces", faces.len(), &mut faces.iter().flatten().map(|&v| u64::from(v).to_le_bytes()));
        let positions = mesh.rest_positions();
        section("positions", positions.len(), &mut positions.iter().flat_map(|p| p.to_array()).map(bits));
        section("rank", modes.rank(), &mut std::iter::empty());
        let displacements = modes.displacements();
        section("modes", displacements.len(), &mut displacements.iter().flat_map(|u| u.to_array()).map(bits));
        section("scales", metric.scales().len(), &mut metric.scales().iter().copied().map(bits));
        // The rules: pairs that share a vertex are left out, no weld, centre 0, no exceptions.
        section("exclude-adjacent", 0, &mut std::iter::empty());
        Self(*hasher.finalize().as_bytes())
    }

    /// The first eight hexadecimal digits, for messages.
    pub fn short(&self) -> String {
        self.0[..4].iter().map(|b| format!("{b:02x}")).collect()
    }
}
