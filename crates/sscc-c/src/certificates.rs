//! Certificates of models.
#![allow(unsafe_code, reason = "functions for C")]

use std::ffi::{c_char, c_void};

use sscc::{Certificates, Error};
use sscc_io::{read_certificates, write_certificates};

use crate::callbacks::Reporter;
use crate::handle::{Handle, borrow, free, give};
use crate::model::sscc_model;
use crate::options::{certify_options, sscc_certify_options};
use crate::pointers::{output, path};
use crate::status::{Failure, guard, sscc_status};
use crate::types::{sscc_cancel_fn, sscc_progress_fn};

/// Certificates of a model. They never change. Queries share them, and they may be freed before the queries.
pub struct sscc_certificates(pub(crate) Certificates);

impl Handle for sscc_certificates {
    const NAME: &'static str = "certificates";
}

/// Computes certificates of a model. `options` is NULL for the defaults. `progress` and `cancel` may be NULL; both receive `user`.
/// If one of them cancels, the status is SSCC_STATUS_CANCELLED, and there are no certificates.
///
/// Errors: SSCC_STATUS_TOO_MANY if more than 16,777,216 pairs collide at rest or at the centre, or if there are too many pairs
/// within `ignore_rings`.
///
/// Threads: any. The computation starts its own threads.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_certificates_compute(
    model: *const sscc_model,
    options: *const sscc_certify_options,
    progress: sscc_progress_fn,
    cancel: sscc_cancel_fn,
    user: *mut c_void,
    certificates: *mut *mut sscc_certificates,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(certificates, "certificates") }?;
        let model = &unsafe { borrow(model) }?.model;
        let options = unsafe { certify_options(options, model) }?;
        let reporter = Reporter::new(progress, cancel, user);
        let certificates = Certificates::compute(model, &options, &reporter)?;
        if reporter.has_cancelled() {
            return Err(Failure::cancelled());
        }
        give(sscc_certificates(certificates), out);
        Ok(())
    })
}

/// Loads certificates from a *.sscc.safetensors file. The creation of a query checks whether they are of its model.
///
/// Errors: SSCC_STATUS_FILE for a file that cannot be read or is malformed; SSCC_STATUS_ARGUMENT for certificates with a clearance,
/// which prove nothing about collisions.
///
/// Threads: any.
///
/// # Safety
/// As the header states for texts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_certificates_load(
    certificates_path: *const c_char,
    certificates: *mut *mut sscc_certificates,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(certificates, "certificates") }?;
        let path = unsafe { path(certificates_path, "certificates_path") }?;
        let certificates = read_certificates(path)?;
        if certificates.clearance().is_some() {
            let message = format!("{}: {}", path.display(), Error::ClearanceCertificates);
            return Err(Failure::argument(message));
        }
        give(sscc_certificates(certificates), out);
        Ok(())
    })
}

/// Writes certificates to a *.sscc.safetensors file, which appears whole or not at all. Its bytes are those that the command writes.
///
/// Errors: SSCC_STATUS_FILE if the file cannot be written.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles and texts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_certificates_save(
    certificates: *const sscc_certificates,
    certificates_path: *const c_char,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let certificates = &unsafe { borrow(certificates) }?.0;
        Ok(write_certificates(unsafe { path(certificates_path, "certificates_path") }?, certificates)?)
    })
}

/// Frees certificates. NULL is ignored.
///
/// Threads: any, while no other call uses the certificates.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_certificates_free(certificates: *mut sscc_certificates) -> sscc_status {
    // SAFETY: by the caller's guarantee.
    guard(|| unsafe { free(certificates) })
}

/// Returns the root's radius: if |z| of q is below it, the shape is free at q, apart from exceptions. If it is infinite,
/// that holds at every q. 0 for NULL.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_certificates_root_radius(certificates: *const sscc_certificates) -> f64 {
    // SAFETY: by the caller's guarantee.
    unsafe { borrow(certificates) }.map_or(0.0, |certificates| certificates.0.root_radius())
}

/// Returns the number of exceptions: pairs that collide at the centre, and that every query tests. 0 for NULL.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_certificates_exception_count(certificates: *const sscc_certificates) -> usize {
    // SAFETY: by the caller's guarantee.
    unsafe { borrow(certificates) }.map_or(0, |certificates| certificates.0.exceptions().len())
}
