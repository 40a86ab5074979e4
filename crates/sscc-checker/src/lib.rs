//! Checks proofs of certificates in exact arithmetic. It shares no code with the program that computes certificates, and trusts
//! neither certificates nor proofs. `docs/guarantees.md`, "The checker", has the statement that it confirms.
//!
//! `entries` lists the statements that must be proven, from the certificates alone. `proof` reads the witnesses, which `node_maps`,
//! `corners` and `affine` check. `scaled` bounds the rounding of computed positions.

mod affine;
mod certificates;
mod container;
mod corners;
mod digest;
mod dyadic;
mod entries;
mod exceptions;
mod files;
mod inequality;
mod model;
mod node_maps;
mod proof;
mod refusal;
mod scaled;
mod scope;

pub use files::read;
pub use model::Model;
pub use refusal::{IsCancelled, Refusal};

use certificates::Certificates;
use proof::{Check, Proof};
use refusal::require;
use scope::{CountedPairs, Scope};

/// The result of a check that confirmed the radii of pairs that count.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Confirmed {
    /// The number of entries into which all pairs of triangles are divided.
    pub entries: usize,
    /// The number of entries that were proven: all of them, or a sample.
    pub proven: usize,
    /// The parts that were not checked, as text: numbers of pairs, groups of triangles, local certificates.
    pub left_out: String,
}

impl Confirmed {
    /// Checks that the proof was not a sample.
    ///
    /// # Errors
    /// When not all entries were proven: the author of the proof chose the sample.
    pub fn of_all_entries(self) -> Result<Self, Refusal> {
        let Self { entries, proven, .. } = &self;
        let cause =
            format!("proof: it has {proven} of {entries} entries: samples are accepted on request alone");
        if proven == entries { Ok(self) } else { Err(Refusal::Proof(cause)) }
    }
}

/// Checks a proof as [`check_until`], without cancellation.
///
/// # Errors
/// As [`check_until`].
pub fn check(model: &Model, certificates: &[u8], proof: &[u8], threads: usize) -> Result<Confirmed, Refusal> {
    check_until(model, certificates, proof, threads, &|| false)
}

/// Checks a proof, on this number of threads (at least 1), until the caller cancels. `certificates`, `proof`: the bytes of the files.
///
/// # Errors
/// [`Refusal::Input`] if the certificates are damaged, of another model, or of a kind that is not checked, or the file of the
/// proof is no proof or of other certificates; [`Refusal::Proof`] if the hierarchy, the pair tree or an exception of the certificates is
/// invalid, or the proof is damaged or does not hold; [`Refusal::Cancelled`] if the caller cancels.
pub fn check_until(
    model: &Model,
    certificates: &[u8],
    proof: &[u8],
    threads: usize,
    is_cancelled: &IsCancelled<'_>,
) -> Result<Confirmed, Refusal> {
    let of_certificates = |refusal: Refusal| refusal.of("certificates");
    let of_proof = |refusal: Refusal| refusal.of("proof");
    let file = container::Container::parse(certificates, "sscc.certificates", 8).map_err(of_certificates)?;
    let scope = Scope::read(&file, model).map_err(of_certificates)?;
    let certificates = Certificates::read(&file, model.faces.len()).map_err(of_certificates)?;
    let counted = CountedPairs::new(model, &scope);
    let is_of_model = digest::digest(model, &scope, &counted.classes) == certificates.digest;
    require(is_of_model, "certificates: of another model or scope: the digests differ")?;
    exceptions::check(model, &scope, &counted, is_cancelled).map_err(of_certificates)?;
    let scaled = scaled::ScaledModel::new(model, &scope, is_cancelled).map_err(of_certificates)?;
    let entries = entries::entries(&certificates).map_err(of_certificates)?;
    let proof = Proof::parse(proof).map_err(of_proof)?;
    let is_theirs = proof.digest == certificates.digest && proof.entries == entries.len() as u64;
    require(is_theirs, "proof: of other certificates")?;
    let check =
        Check { certificates: &certificates, counted: &counted, scaled: &scaled, model, is_cancelled };
    check.run(&proof, &entries, threads).map_err(of_proof)?;
    let groups = if scope.groups.is_some() { "pairs of groups" } else { "no groups" };
    let local = if file.has("local_nodes") { "local certificates" } else { "no local certificates" };
    let [exceptions, ignored] = [&scope.exceptions, &scope.ignored].map(Vec::len);
    let left_out = format!("{exceptions} exceptions, {ignored} ignored pairs, {groups}, {local}");
    Ok(Confirmed { entries: entries.len(), proven: proof.proven.len(), left_out })
}
