//! The table of the demo.

use serde::Serialize;
use sscc::{Certificates, ReducedModel};
use sscc_bench::demo::Frames;

use crate::output::{counted, duration, grouped, length};

#[derive(Serialize)]
pub struct Report {
    triangles: usize,
    rank: usize,
    modes_seconds: f64,
    certify_seconds: f64,
    threads: usize,
    root_radius: f64,
    global_radius: f64,
    pub mismatches: usize,
    pairs: usize,
    frames: Vec<Group>,
}

/// Frames of one kind, with mean times of one query.
#[derive(Serialize)]
struct Group {
    group: &'static str,
    frames: usize,
    certified_microseconds: f64,
    bdtree_microseconds: f64,
    traditional_microseconds: f64,
}

impl Report {
    pub fn new(
        model: &ReducedModel,
        certificates: &Certificates,
        frames: &Frames,
        [modes_seconds, certify_seconds]: [f64; 2],
        threads: usize,
    ) -> Self {
        let root = |i: usize| frames.certified.root_certified[i];
        let free = |i: usize| frames.traditional.pairs[i].is_empty();
        Self {
            triangles: model.mesh().faces().len(),
            rank: model.rank(),
            modes_seconds,
            certify_seconds,
            threads,
            root_radius: certificates.root_radius(),
            global_radius: certificates.global_radius(),
            mismatches: frames.mismatches(),
            pairs: frames.traditional.pairs.iter().map(Vec::len).sum(),
            frames: vec![
                Group::new("free by the root's certificate", frames, root),
                Group::new("free, root's certificate fails", frames, |i| free(i) && !root(i)),
                Group::new("colliding", frames, |i| !free(i)),
                Group::new("all", frames, |_| true),
            ],
        }
    }

    /// Returns the report as text.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![
            format!(
                "A double-helix spring: {} triangles; its {} lowest vibration modes, computed in {:.2} s.",
                grouped(self.triangles as u64),
                self.rank,
                self.modes_seconds
            ),
            format!(
                "Certified once, in {:.2} s on {}. Root radius {}: below it the whole spring is free.",
                self.certify_seconds,
                counted(self.threads as u64, "thread"),
                length(self.root_radius)
            ),
            String::new(),
            format!(
                "Shaken with growing amplitude, {} frames; mean time of one query on one thread:",
                self.all().frames
            ),
            String::new(),
            format!(
                "  {:<32}{:>6}{:>13}{:>13}{:>13}{:>12}",
                "", "frames", "sscc", "BD-tree", "traditional", "speed-up"
            ),
        ];
        lines.extend(self.frames.iter().map(Group::line));
        lines.push(String::new());
        lines.push(match self.mismatches {
            0 => {
                format!("All methods list the same {} colliding triangle pairs.", grouped(self.pairs as u64))
            }
            n => format!("DEFECT: the methods differ in {n} frames."),
        });
        lines.push(
            "Traditional: refits all AABBs for every q. BD-tree: updates only the AABBs that a traversal visits."
                .into(),
        );
        lines
    }

    /// Returns the rows of the table on the page: labels and values.
    pub fn table(&self) -> Vec<(String, String)> {
        let row = |label: &str, value: String| (label.to_owned(), value);
        let mut rows = vec![
            row(
                "modes",
                format!("{} lowest vibration modes, computed in {:.2} s", self.rank, self.modes_seconds),
            ),
            row(
                "certificates",
                format!(
                    "computed in {:.2} s on {}",
                    self.certify_seconds,
                    counted(self.threads as u64, "thread")
                ),
            ),
        ];
        rows.extend(self.frames.iter().filter(|group| group.frames > 0).map(|group| {
            let [ours, theirs] = [group.certified_microseconds, group.traditional_microseconds].map(duration);
            let frames = counted(group.frames as u64, "frame");
            row(group.group, format!("{frames}: {ours}, traditional {theirs}"))
        }));
        rows
    }

    fn all(&self) -> &Group {
        &self.frames[self.frames.len() - 1]
    }
}

impl Group {
    fn new(group: &'static str, frames: &Frames, belongs: impl Fn(usize) -> bool) -> Self {
        let members: Vec<usize> = (0..frames.traditional.pairs.len()).filter(|i| belongs(*i)).collect();
        let mean =
            |times: &[f64]| members.iter().map(|&i| times[i]).sum::<f64>() / members.len().max(1) as f64;
        Self {
            group,
            frames: members.len(),
            certified_microseconds: mean(&frames.certified.microseconds),
            bdtree_microseconds: mean(&frames.bd_tree.microseconds),
            traditional_microseconds: mean(&frames.traditional.microseconds),
        }
    }

    fn line(&self) -> String {
        if self.frames == 0 {
            return format!("  {:<32}{:>6}", self.group, 0);
        }
        let speed_up = self.traditional_microseconds / self.certified_microseconds;
        let times = [self.certified_microseconds, self.bdtree_microseconds, self.traditional_microseconds];
        let [certified, bd_tree, traditional] = times.map(duration);
        let speed_up = match speed_up {
            s if s < 100.0 => format!("{s:.1} x"),
            s => format!("{} x", grouped(s.round() as u64)),
        };
        format!(
            "  {:<32}{:>6}{certified:>13}{bd_tree:>13}{traditional:>13}{speed_up:>12}",
            self.group, self.frames
        )
    }
}
