//! Limits of the page.

/// Largest size of a report that `sscc view` shows (bytes).
pub const MAX_REPORT_BYTES: u64 = 256 << 20;
