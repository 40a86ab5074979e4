//! The contents of a certificate file.

use serde::Serialize;
use sscc::Certificates;
use sscc::parts::GroupTable;
use sscc_view::levels;

use super::text::{form, hexadecimal, range};
use crate::output::{counted, grouped, length};

#[derive(Serialize)]
pub struct CertificatesInfo {
    digest: String,
    scheme: &'static str,
    neighbours: &'static str,
    weld: bool,
    triangles: usize,
    rank: usize,
    metric: &'static str,
    metric_form: &'static str,
    metric_scales: Vec<f64>,
    epsilon: f64,
    rest_collisions: u64,
    exceptions: usize,
    ignored: usize,
    /// The clearance that triangles keep below the radii; absent for radii of collisions.
    #[serde(skip_serializing_if = "Option::is_none")]
    clearance: Option<f64>,
    /// The number of rings within which pairs do not count; absent without a clearance.
    #[serde(skip_serializing_if = "Option::is_none")]
    rings: Option<u32>,
    /// Number of groups of triangles; 0 if all pairs of groups count.
    groups: usize,
    center: Vec<f64>,
    nodes: usize,
    root_radius: f64,
    global_radius: f64,
    root_pair_radii: Vec<f64>,
    pairs: usize,
    pair_limit: f64,
    pair_bytes: usize,
    local_certificates: usize,
    local_bytes: usize,
    levels: Vec<Level>,
}

/// The radii of one level of the hierarchy. The levels are listed from the root.
#[derive(Serialize)]
struct Level {
    nodes: usize,
    min: f64,
    median: f64,
    max: f64,
    /// Fraction of the nodes whose radius is capped at the global radius.
    capped: f64,
}

impl CertificatesInfo {
    pub fn of(certificates: &Certificates) -> Self {
        let parts = certificates.parts();
        let tree = &parts.pair_tree;
        let level = |level: sscc_view::Level| {
            let sscc_view::Level { nodes, least, median, largest, capped, .. } = level;
            Level { nodes, min: least, median, max: largest, capped }
        };
        Self {
            digest: hexadecimal(parts.digest),
            scheme: if tree.limit() > 0.0 || !parts.local.nodes.is_empty() { "full" } else { "paper" },
            neighbours: parts.scope.filter.neighbours.into(),
            weld: parts.scope.filter.weld,
            triangles: parts.hierarchy.order().len(),
            rank: parts.scope.metric.rank(),
            metric: parts.scope.metric.kind().into(),
            metric_form: form(&parts.scope.metric),
            metric_scales: parts.scope.metric.scales(),
            epsilon: parts.epsilon,
            rest_collisions: parts.rest_collisions,
            exceptions: parts.scope.exceptions.len(),
            ignored: parts.scope.filter.ignored().len(),
            clearance: parts.scope.clearance.map(|clearance| clearance.distance()),
            rings: parts.scope.clearance.map(|clearance| clearance.rings()),
            groups: parts.scope.filter.groups().map_or(0, |groups| GroupTable::from(&**groups).count),
            center: parts.scope.center.clone(),
            nodes: parts.node_radii.len(),
            root_radius: certificates.root_radius(),
            global_radius: parts.global_radius,
            root_pair_radii: parts.root_pair_radii.clone(),
            pairs: parts.root_pair_radii.len() + tree.len(),
            pair_limit: tree.limit(),
            pair_bytes: tree.bytes(),
            local_certificates: parts.local.nodes.len(),
            local_bytes: parts.local.bytes(),
            levels: levels(certificates).into_iter().map(level).collect(),
        }
    }

    pub fn lines(&self) -> Vec<String> {
        let pairs: Vec<String> = self.root_pair_radii.iter().map(|r| length(*r)).collect();
        let mut lines = vec![
            format!("certificates   of {} triangles, {} modes", grouped(self.triangles as u64), self.rank),
            format!("digest         {}", self.digest),
            format!("scheme         {}, epsilon {}", self.scheme, self.epsilon),
            format!(
                "neighbours     {}{}",
                self.neighbours,
                if self.weld { ", equal vertices welded" } else { "" }
            ),
            format!("metric         {} ({}), {}", self.metric, self.metric_form, range(&self.metric_scales)),
            format!(
                "center         {}",
                if self.center.iter().all(|x| *x == 0.0) {
                    "q = 0, the rest pose"
                } else {
                    "another q (see --json)"
                }
            ),
            format!(
                "at rest        {} colliding; exceptions {}, ignored {}",
                counted(self.rest_collisions, "pair"),
                self.exceptions,
                self.ignored
            ),
            format!("root radius    {}", length(self.root_radius)),
            format!("root pairs     {}", if pairs.is_empty() { "none".into() } else { pairs.join(", ") }),
            format!("global radius  {}", length(self.global_radius)),
            match self.pair_bytes {
                _ if self.pair_limit == 0.0 => "node pairs     those of the root's children only".to_owned(),
                bytes => format!(
                    "node pairs     {} in all, complete up to {} ({} bytes)",
                    grouped(self.pairs as u64),
                    length(self.pair_limit),
                    grouped(bytes as u64)
                ),
            },
            match self.local_certificates {
                0 => "local          no certificates".to_owned(),
                n => format!(
                    "local          {} ({:.1} bytes a triangle)",
                    counted(n as u64, "certificate"),
                    self.local_bytes as f64 / self.triangles as f64
                ),
            },
            format!(
                "{:>7} {:>9} {:>11} {:>11} {:>11} {:>8}",
                "level", "nodes", "min", "median", "max", "capped"
            ),
        ];
        if self.groups > 0 {
            let groups = counted(self.groups as u64, "group");
            lines.insert(4, format!("groups         {groups} of triangles, of which not all pairs count"));
        }
        if let (Some(clearance), Some(rings)) = (self.clearance, self.rings) {
            let rings = counted(u64::from(rings.max(1)), "ring");
            lines.insert(
                4,
                format!("clearance      {}, beyond {rings}; nothing about collisions", length(clearance)),
            );
        }
        lines.extend(self.levels.iter().enumerate().map(|(i, level)| {
            let [min, median, max] = [level.min, level.median, level.max].map(length);
            let nodes = grouped(level.nodes as u64);
            format!("{i:>7} {nodes:>9} {min:>11} {median:>11} {max:>11} {:>7.1}%", 100.0 * level.capped)
        }));
        lines
    }
}
