//! What is known of certificates.

use serde::Serialize;
use sscc::Certificates;

use super::{hexadecimal, range};
use crate::output::{grouped, length};

#[derive(Serialize)]
pub struct Certified {
    digest: String,
    scheme: &'static str,
    neighbours: &'static str,
    triangles: usize,
    rank: usize,
    metric: &'static str,
    metric_scales: Vec<f64>,
    epsilon: f64,
    rest_collisions: u64,
    exceptions: usize,
    nodes: usize,
    root_radius: f64,
    global_radius: f64,
    root_pair_radii: Vec<f64>,
    levels: Vec<Level>,
}

/// The radii of one level of the hierarchy, the root's first.
#[derive(Serialize)]
struct Level {
    nodes: usize,
    min: f64,
    median: f64,
    max: f64,
    /// Share of nodes whose radius is capped at the global radius.
    capped: f64,
}

impl Level {
    fn of(radii: &[f64], limit: f64) -> Self {
        let mut sorted = radii.to_vec();
        sorted.sort_by(f64::total_cmp);
        let nodes = sorted.len();
        let capped = sorted.iter().filter(|r| **r >= limit).count() as f64 / nodes as f64;
        Self { nodes, min: sorted[0], median: sorted[nodes / 2], max: sorted[nodes - 1], capped }
    }
}

impl Certified {
    pub fn of(certificates: &Certificates) -> Self {
        let parts = certificates.parts();
        let levels = parts.hierarchy.levels();
        Self {
            digest: hexadecimal(parts.digest),
            // The only ones that a file of this version can have.
            scheme: "paper",
            neighbours: "exclude",
            triangles: parts.hierarchy.order().len(),
            rank: parts.metric.scales().len(),
            metric: parts.metric.kind().name(),
            metric_scales: parts.metric.scales().to_vec(),
            epsilon: parts.epsilon,
            rest_collisions: parts.rest_collisions,
            exceptions: 0,
            nodes: parts.node_radii.len(),
            root_radius: certificates.root_radius(),
            global_radius: parts.global_radius,
            root_pair_radii: parts.root_pair_radii.clone(),
            levels: levels
                .into_iter()
                .map(|l| Level::of(&parts.node_radii[l], parts.global_radius))
                .collect(),
        }
    }

    pub fn lines(&self) -> Vec<String> {
        let pairs: Vec<String> = self.root_pair_radii.iter().map(|r| length(*r)).collect();
        let mut lines = vec![
            format!("certificates   of {} triangles, {} modes", grouped(self.triangles as u64), self.rank),
            format!("digest         {}", self.digest),
            format!(
                "scheme         {}, epsilon {}, neighbours {}d",
                self.scheme, self.epsilon, self.neighbours
            ),
            format!("metric         {}, {}", self.metric, range(&self.metric_scales)),
            format!("at rest        {} colliding pairs", grouped(self.rest_collisions)),
            format!("root radius    {}", length(self.root_radius)),
            format!("root's pairs   {}", if pairs.is_empty() { "none".into() } else { pairs.join(", ") }),
            format!("resolved up to {}", length(self.global_radius)),
            format!(
                "{:>7} {:>9} {:>11} {:>11} {:>11} {:>8}",
                "level", "nodes", "least", "median", "largest", "capped"
            ),
        ];
        lines.extend(self.levels.iter().enumerate().map(|(i, level)| {
            let [min, median, max] = [level.min, level.median, level.max].map(length);
            let nodes = grouped(level.nodes as u64);
            format!("{i:>7} {nodes:>9} {min:>11} {median:>11} {max:>11} {:>7.1}%", 100.0 * level.capped)
        }));
        lines
    }
}
