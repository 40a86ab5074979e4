//! How radii grow down the hierarchy (paper, Figure 7).

use serde::Serialize;
use sscc::Certificates;

/// The radii of one level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// 0 for the root's.
    pub level: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// The smallest radius.
    pub least: f64,
    /// The middle one.
    pub median: f64,
    /// The largest.
    pub largest: f64,
    /// Share of the nodes whose radius ends at the global one.
    pub capped: f64,
}

/// All levels, the root's first.
pub fn levels(certificates: &Certificates) -> Vec<Level> {
    let parts = certificates.parts();
    let of = |(level, nodes): (usize, std::ops::Range<usize>)| {
        let mut radii = parts.node_radii[nodes].to_vec();
        radii.sort_by(f64::total_cmp);
        let capped = radii.iter().filter(|radius| **radius >= parts.global_radius).count();
        Level {
            level,
            nodes: radii.len(),
            least: radii[0],
            median: radii[radii.len() / 2],
            largest: radii[radii.len() - 1],
            capped: capped as f64 / radii.len() as f64,
        }
    };
    parts.hierarchy.levels().into_iter().enumerate().map(of).collect()
}
