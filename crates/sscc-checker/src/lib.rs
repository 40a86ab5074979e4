//! Checks proofs of certificates in exact arithmetic. It shares no code with the program that computes them, and trusts
//! nothing that they or a proof say: `docs/guarantees.md`, "The checker", has the statement that it confirms.
//!
//! `entries` lists what must be proven, from the certificates alone. `proof` reads the witnesses and has them checked by
//! `node_maps`, `corners` and `affine`. `scaled` bounds the rounding of computed positions.

mod affine;
mod certificates;
mod container;
mod corners;
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
pub use refusal::Refusal;

use certificates::Certificates;
use container::Container;
use proof::{Check, Proof};
use scaled::ScaledModel;
use scope::{CountedPairs, Scope};

/// What was confirmed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Confirmed {
    /// The entries into which all pairs of triangles are divided.
    pub entries: usize,
    /// Those that were proven: all of them, or a sample.
    pub proven: usize,
}

/// Checks a proof. `certificates`, `proof`: the bytes of the files.
///
/// # Errors
/// [`Refusal::Input`] where a file is damaged, of another model, or of a kind that is not checked; [`Refusal::Proof`] where the
/// proof does not hold.
pub fn check(model: &Model, certificates: &[u8], proof: &[u8], threads: usize) -> Result<Confirmed, Refusal> {
    let named = |name: &'static str| {
        move |refusal: Refusal| match refusal {
            Refusal::Input(line) => Refusal::Input(format!("{name}: {line}")),
            Refusal::Proof(line) => Refusal::Proof(format!("{name}: {line}")),
        }
    };
    let of_certificates = named("certificates");
    let file = Container::parse(certificates, "sscc.certificates", 8).map_err(of_certificates)?;
    let scope = Scope::read(&file, model).map_err(of_certificates)?;
    let certificates = Certificates::read(&file, model.faces.len()).map_err(of_certificates)?;
    let counted = CountedPairs::new(model, &scope);
    if model.digest(&scope, &counted.classes) != certificates.digest {
        return Err(Refusal::Input(
            "certificates: they are of another model or scope: the digests differ".into(),
        ));
    }
    exceptions::check(model, &scope, &counted).map_err(of_certificates)?;
    let scaled = ScaledModel::new(model, &scope).map_err(of_certificates)?;
    let entries = entries::entries(&certificates).map_err(of_certificates)?;
    let of_proof = named("proof");
    let proof = Proof::parse(proof).map_err(of_proof)?;
    if proof.digest != certificates.digest || proof.entries != entries.len() as u64 {
        return Err(Refusal::Input("proof: it is of other certificates".into()));
    }
    let check = Check { certificates: &certificates, counted: &counted, scaled: &scaled, model };
    check.run(&proof, &entries, threads).map_err(of_proof)?;
    Ok(Confirmed { entries: entries.len(), proven: proof.proven.len() })
}
