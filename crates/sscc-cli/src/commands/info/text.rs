//! Text that several kinds of files share.

use sscc::Metric;
use sscc::parts::Digest;

/// Returns 32 bytes as hexadecimal digits.
pub fn hexadecimal(digest: Digest) -> String {
    digest.0.iter().map(|b| format!("{b:02x}")).collect()
}

/// Returns the form of a metric's factor: diagonal or dense.
pub fn form(metric: &Metric) -> &'static str {
    if metric.dense_factor().is_some() { "dense" } else { "diagonal" }
}

/// Returns the smallest and the largest of a metric's scales, as text.
pub fn range(scales: &[f64]) -> String {
    let min = scales.iter().copied().fold(f64::INFINITY, f64::min);
    let max = scales.iter().copied().fold(0.0, f64::max);
    format!("scales from {} to {}", crate::output::length(min), crate::output::length(max))
}
