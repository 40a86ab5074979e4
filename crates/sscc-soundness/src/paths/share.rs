//! Shares of a configuration: quick runs ask for less.

/// How many of `count` a share asks for.
pub fn some(count: usize, share: f64) -> usize {
    ((count as f64 * share) as usize).clamp(1, count)
}
