//! Local certificates: a part of the shape is proven free by its own strain at q (beyond the paper).
//!
//! `patch` finds what a certificate covers, `residual_ellipsoid` bounds what the affine map of a patch leaves of its modes,
//! `strain_bound` searches the pair that decides, `local_certificates` holds the numbers, and `local_proof` compares them at q.

mod gap_tables;
mod local_certificates;
mod local_proof;
mod patch;
mod residual_ellipsoid;
mod strain_bound;

pub(crate) use local_certificates::LocalCertificates;
pub(crate) use local_proof::LocalProofs;
