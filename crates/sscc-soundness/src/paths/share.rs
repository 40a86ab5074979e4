//! Sizes of configurations: quick runs make fewer queries.

/// Returns the share of `count`, at least 1.
pub fn some(count: usize, share: f64) -> usize {
    ((count as f64 * share) as usize).clamp(1, count)
}
