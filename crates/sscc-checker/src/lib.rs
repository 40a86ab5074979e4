//! Checks proofs of certificates in exact arithmetic. It shares no code with the program that computes certificates, and trusts
//! neither certificates nor proofs. `docs/guarantees.md`, "The checker", has the statement that it confirms.
//!
//! `entries` lists the statements that must be proven, from the certificates alone. `proof` reads the witnesses, which `node_maps`,
//! `directions` and `affine` check. `points` has the inequality of all witnesses, and `scaled` bounds the rounding of computed positions.

mod affine;
mod certificates;
mod container;
mod counted;
mod digest;
mod directions;
mod dyadic;
mod entries;
mod exceptions;
mod files;
mod model;
mod node_maps;
mod points;
mod proof;
mod refusal;
mod scaled;
mod scope;

use std::fmt;

pub use files::read;
pub use model::Model;
pub use refusal::{IsCancelled, Refusal, Result};

use certificates::Certificates;
use counted::CountedPairs;
use proof::Proof;
use refusal::require;
use scope::Scope;

/// The result of a check that confirmed the radii of pairs that count.
#[derive(Clone, Debug, PartialEq)]
pub struct Confirmed {
    /// The number of entries into which all pairs of triangles are divided.
    pub entries: usize,
    /// The number of entries that were proven, at least 1: all of them, or a sample.
    pub proven: usize,
    /// The number of all entries with a positive radius. The others state nothing, so their proof is empty.
    pub positive: usize,
    /// The number of entries with a positive radius that were proven.
    pub proven_positive: usize,
    /// The root's radius, below which the whole shape is free if all entries were proven.
    pub root_radius: f64,
    /// The parts that were not checked, as text: numbers of pairs, groups of triangles, local certificates.
    pub left_out: String,
}

impl Confirmed {
    /// Checks that the proof was not a sample.
    ///
    /// # Errors
    /// When not all entries were proven: the author of the proof chose the sample.
    pub fn of_all_entries(self) -> Result<Self> {
        let Self { entries, proven, .. } = &self;
        let cause =
            format!("proof: it has {proven} of {entries} entries: samples are accepted on request alone");
        if proven == entries { Ok(self) } else { Err(Refusal::Proof(cause)) }
    }

    /// Checks that the proof states something: that it has all entries, or a sample with an entry of a positive radius. The author of the
    /// proof chose the entries of a sample, so it says nothing about the others.
    ///
    /// # Errors
    /// When the proof is a sample of entries of radius 0.
    pub fn of_sample(self) -> Result<Self> {
        let Self { entries, proven, .. } = &self;
        let cause = format!("proof: its {proven} of {entries} entries have radius 0, and state nothing");
        if proven == entries || self.proven_positive > 0 { Ok(self) } else { Err(Refusal::Proof(cause)) }
    }
}

impl fmt::Display for Confirmed {
    /// Writes one line. It begins with "confirmed:" if all entries were proven, and with "confirmed a sample:" if not.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { entries, proven, positive, proven_positive, root_radius, left_out } = self;
        if proven == entries {
            write!(f, "confirmed: {proven} of {entries} entries, {positive} with a positive radius; ")?;
            write!(f, "root's radius {root_radius:?}")?;
        } else {
            write!(f, "confirmed a sample: {proven} of {entries} entries, {proven_positive} of {positive} ")?;
            write!(f, "with a positive radius, chosen by the author of the proof; ")?;
            write!(f, "nothing is known of the others")?;
        }
        write!(f, "; left out: {left_out}")
    }
}

/// Checks a proof as [`check_until`], without cancellation.
///
/// # Errors
/// As [`check_until`].
pub fn check(model: &Model, certificates: &[u8], proof: &[u8], threads: usize) -> Result<Confirmed> {
    check_until(model, certificates, proof, threads, &|| false)
}

/// Checks a proof, on this number of threads (at least 1), until the caller cancels. `certificates`, `proof`: the bytes of the files.
///
/// The result may be that of a sample, whose entries the author of the proof chose: call [`Confirmed::of_all_entries`].
///
/// # Errors
/// [`Refusal::Input`] if the certificates are damaged, of another model, or of a kind that is not checked, or the file of the
/// proof is no proof or of other certificates; [`Refusal::Proof`] if a radius, the hierarchy, the pair tree or an exception of the
/// certificates is invalid, or the proof has no entry, is damaged or does not hold; [`Refusal::Cancelled`] if the caller cancels.
pub fn check_until(
    model: &Model,
    certificates: &[u8],
    proof: &[u8],
    threads: usize,
    is_cancelled: &IsCancelled<'_>,
) -> Result<Confirmed> {
    let of_certificates = |refusal: Refusal| refusal.of("certificates");
    let of_proof = |refusal: Refusal| refusal.of("proof");
    let file = container::Container::parse(certificates, "sscc.certificates", 8).map_err(of_certificates)?;
    let scope = Scope::read(&file, model).map_err(of_certificates)?;
    let certificates = Certificates::read(&file, model.faces.len()).map_err(of_certificates)?;
    // Files that do not belong together are refused before work that takes longer than reading them.
    let proof = Proof::parse(proof, &certificates, model.rank).map_err(of_proof)?;
    let counted = CountedPairs::new(model, &scope, &certificates);
    let is_of_model = digest::digest(&counted) == certificates.digest;
    require(is_of_model, "certificates: of another model or scope: the digests differ")?;
    let entries = entries::entries(&certificates).map_err(of_certificates)?;
    require(proof.entries == entries.len() as u64, "proof: of other certificates")?;
    exceptions::check(&counted, is_cancelled).map_err(of_certificates)?;
    let scaled = scaled::ScaledModel::new(model, &scope, is_cancelled).map_err(of_certificates)?;
    proof.check(&entries, &counted, &scaled, threads, is_cancelled).map_err(of_proof)?;
    let is_positive = |index: usize| entries[index].radius > 0.0;
    let local = if file.has("local_nodes") { "local certificates" } else { "no local certificates" };
    Ok(Confirmed {
        entries: entries.len(),
        proven: proof.proven.len(),
        positive: (0..entries.len()).filter(|index| is_positive(*index)).count(),
        proven_positive: proof.proven.iter().filter(|(index, _)| is_positive(*index)).count(),
        root_radius: certificates.node_radii[0],
        left_out: format!("{}, {local}", scope.left_out()),
    })
}
