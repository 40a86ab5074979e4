//! The digest that identifies the model and scope of certificates.

use super::Scope;
use crate::filter::weld_classes;
use crate::{Neighbours, ReducedModel};

/// BLAKE3 of faces, f64 positions, f64 modes and the [`Scope`]. Certificates with another digest than the model's would
/// be a wrong proof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(pub [u8; 32]);

impl Digest {
    /// Returns the digest of a model with a scope.
    pub fn of(model: &ReducedModel, scope: &Scope) -> Self {
        let mut sections = Sections(blake3::Hasher::new());
        let (mesh, modes) = (model.mesh(), model.modes());
        sections.numbers("faces", mesh.faces().len(), mesh.faces().as_flattened().iter().copied());
        let positions = mesh.rest_positions();
        sections.reals("positions", positions.len(), positions.iter().flat_map(|p| p.to_array()));
        sections.begin("rank", modes.rank());
        let displacements = modes.displacements();
        sections.reals("modes", displacements.len(), displacements.iter().flat_map(|u| u.to_array()));
        match scope.metric.dense_factor() {
            Some(factor) => sections.reals("factor", factor.len(), factor.iter().copied()),
            None => sections.reals("scales", scope.metric.rank(), scope.metric.scales().into_iter()),
        }
        // From here on, apart from the rule for neighbours, only what differs from the default scope is hashed: files
        // of format version 1, which had no other scope, keep their digests.
        sections.begin(
            match scope.filter.neighbours {
                Neighbours::Exclude => "exclude-adjacent",
                Neighbours::IncludeOneVertex => "include-one-vertex",
                // No certificates have it; a forged file is refused by the digest, too.
                Neighbours::IncludeFolded => "include-folded",
            },
            0,
        );
        if scope.center.iter().any(|x| *x != 0.0) {
            sections.reals("center", scope.center.len(), scope.center.iter().copied());
        }
        if scope.filter.weld {
            let classes = weld_classes(model);
            sections.numbers("weld", classes.len(), classes.into_iter());
        }
        for (name, pairs) in [("ignored", scope.filter.ignored()), ("exceptions", &scope.exceptions)] {
            if !pairs.is_empty() {
                sections.numbers(name, pairs.len(), pairs.iter().flat_map(|&(i, j)| [i, j]));
            }
        }
        if let Some(groups) = scope.filter.groups() {
            let of_triangles = groups.of_triangles();
            sections.numbers("groups", of_triangles.len(), of_triangles.iter().map(|g| u32::from(*g)));
            let name = if groups.others_count() { "ignored-groups" } else { "only-groups" };
            let listed = groups.listed().flat_map(|(g, h)| [u32::from(g), u32::from(h)]);
            sections.numbers(name, groups.listed().count(), listed);
        }
        if let Some(clearance) = with_mutant!(scope.clearance, ClearanceNotHashed, None) {
            sections.reals("clearance", 1, std::iter::once(clearance.distance()));
            sections.numbers("rings", 1, std::iter::once(clearance.rings()));
        }
        Self(*sections.0.finalize().as_bytes())
    }

    /// Returns the first eight hexadecimal digits, for messages.
    pub fn short(&self) -> String {
        self.0[..4].iter().map(|b| format!("{b:02x}")).collect()
    }
}

/// Hashes named lists one after the other, each with its length, so that no two models give the same bytes.
struct Sections(blake3::Hasher);

impl Sections {
    fn begin(&mut self, name: &str, count: usize) {
        self.0.update(name.as_bytes());
        self.0.update(&(count as u64).to_le_bytes());
    }

    fn numbers(&mut self, name: &str, count: usize, numbers: impl Iterator<Item = u32>) {
        self.begin(name, count);
        self.bytes(numbers.map(|n| u64::from(n).to_le_bytes()));
    }

    fn reals(&mut self, name: &str, count: usize, reals: impl Iterator<Item = f64>) {
        self.begin(name, count);
        self.bytes(reals.map(|x| x.to_bits().to_le_bytes()));
    }

    fn bytes(&mut self, items: impl Iterator<Item = [u8; 8]>) {
        let mut buffer = Vec::with_capacity(1 << 16);
        for item in items {
            buffer.extend_from_slice(&item);
            if buffer.len() == buffer.capacity() {
                self.0.update(&buffer);
                buffer.clear();
            }
        }
        self.0.update(&buffer);
    }
}
