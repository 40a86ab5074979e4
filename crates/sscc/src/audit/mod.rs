//! Audits of certificates: attempts to refute every claim they make.
//!
//! Exact collision tests alone decide whether a claim is refuted, never the bounds that made it. The tests:
//! - Configurations q just inside radii, in random directions and in those of known collisions ([`attack`]).
//! - Configurations at which local certificates only just hold ([`local_attack`]).
//! - The true minimum of `|z|`, searched for critical pairs of triangles ([`minimum_search`]), which also measures
//!   how tight radii are ([`tightness`]).
//! - Answers of certified queries, continuous ones too, compared with the traditional method, itself compared with brute
//!   force ([`compare`]). With a clearance these are answers about near pairs ([`compare_near`]).
//!
//! Each collision found is compared with all radii that cover it ([`claims`]): of nodes, of node pairs, and the limit of the
//! pair tree where it lacks a pair.

mod attack;
mod claims;
mod compare;
mod compare_near;
mod local_attack;
mod minimum_search;
mod options;
mod point_pairs;
mod random;
mod tightness;

use crate::parallel::on_threads;
use crate::{Certificates, Error, Progress, ReducedModel};

pub use options::AuditOptions;

/// The results of an audit.
#[derive(Clone, Debug, PartialEq)]
pub struct AuditReport {
    /// Number of attacks made, each at one configuration or two. 0 if nothing is claimed: every radius of a node or a pair is 0, and
    /// there are no local certificates.
    pub samples: usize,
    /// The number of these attacks that were on local certificates: about half if there are any, all if every radius of a node
    /// or a pair is 0.
    pub local_samples: usize,
    /// A line for each configuration that refutes a claim, and for each difference between the answers of two methods.
    /// Empty for sound certificates. Of more than 2^22 attacks, some lines may be missing.
    pub violations: Vec<String>,
    /// The root's radius over the smallest `|z|` found at which the model collides. None if the radius is 0 or capped, or no
    /// collision was found.
    pub root_tightness: Option<f64>,
    /// The median of the same quotient over the root, its pairs of children, and samples of nodes and of the pair tree. Radii
    /// that are 0 or capped are left out.
    pub tightness_median: Option<f64>,
    /// The smallest of these quotients.
    pub tightness_min: Option<f64>,
}

/// Attacks the certificates of a model.
///
/// ```
/// # use glam::DVec3;
/// use sscc::{AuditOptions, Certificates, CertifyOptions, Modes, ReducedModel, TriMesh, audit};
///
/// # fn main() -> Result<(), sscc::Error> {
/// # let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
/// # let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
/// # let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 })?;
/// # let model = ReducedModel::new(mesh, modes)?;
/// # let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
/// let options = AuditOptions::default().samples(100);
/// let report = audit(&model, &certificates, &options, &())?;
/// assert!(report.samples > 0 && report.violations.is_empty());
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// If the certificates are of another model, this thread's arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]),
/// a comparison finds more near pairs than an answer may have, a configuration of a comparison moves vertices beyond
/// [`limits::LARGEST`](crate::limits::LARGEST), or `progress` cancels.
pub fn audit(
    model: &ReducedModel,
    certificates: &Certificates,
    options: &AuditOptions,
    progress: &dyn Progress,
) -> Result<AuditReport, Error> {
    certificates.check_model(model)?;
    let run = || {
        let parts = certificates.parts();
        let scope = &*parts.scope;
        let (filter, rings) = &scope.counted_pairs(model)?;
        let (scaled, clearance) = (&scope.scaled_model(model), scope.clearance);
        let minimum = &minimum_search::MinimumSearch { model, scope, scaled, filter, rings, clearance };
        let claims = &claims::Claims::new(parts);
        let tightness = tightness::measure(certificates, claims, minimum, options.seed, progress);
        let collisions = &tightness.collisions;
        let attack = attack::Attack { model, certificates, claims, minimum, collisions, options, progress };
        let mut violations = tightness.violations;
        let attacks = attack.run()?;
        violations.extend(attacks.violations);
        let comparison = compare::Comparison { model, certificates, claims, minimum, options, progress };
        violations.extend(match clearance {
            Some(clearance) => comparison.run_near(&clearance)?,
            None => comparison.run()?,
        });
        let mut quotients = tightness.quotients;
        quotients.sort_by(f64::total_cmp);
        Ok(AuditReport {
            samples: attacks.samples,
            local_samples: attacks.local_samples,
            violations,
            root_tightness: tightness.root,
            tightness_median: (!quotients.is_empty()).then(|| quotients[quotients.len() / 2]),
            tightness_min: quotients.first().copied(),
        })
    };
    let report = on_threads(options.threads, run);
    if progress.is_cancelled() { Err(Error::Cancelled) } else { report }
}
