//! Options of certificates as users state them: only some of them, and with names of files. Certificates are computed by
//! these options, or read from a file that must agree with them.

mod certificate_request;
mod matching;
mod metric;

pub use certificate_request::{CertificateRequest, Scheme};
