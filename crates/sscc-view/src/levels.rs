//! Statistics of the radii on each level of the hierarchy (paper, Figure 7).

use serde::Serialize;
use sscc::Certificates;

/// The radii of one level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// The level; 0 is the root.
    pub level: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// The smallest radius.
    pub least: f64,
    /// The median radius.
    pub median: f64,
    /// The largest radius.
    pub largest: f64,
    /// Share of the nodes whose radius is the global radius.
    pub capped: f64,
}

/// Returns the statistics of all levels, the root's first.
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
