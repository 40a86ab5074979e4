//! The paths of the campaign, each with the minimum number of answers that a campaign compares. A seed determines a
//! configuration, which is a model, or some thousand pairs of triangles.

mod continuous;
mod discrete;
mod frames;
mod kinetic;
mod lines;
mod moving_pairs;
mod posed;
mod share;
mod triangle_pairs;

use crate::random::Random;
use crate::tally::Tally;

/// A path.
pub struct Path {
    /// Its name, on the command line and in the record.
    pub name: &'static str,
    /// Number of answers to compare.
    pub wanted: u64,
    /// The inner paths that the campaign must reach.
    pub inner: &'static [&'static str],
    /// Runs one configuration. The last argument is its size as a share of the full size, at most 1.
    pub run: fn(&mut Random, &mut Tally, f64),
}

const SEARCHES: &[&str] = &[
    "proof by local",
    "proof by search",
    "nodes by local",
    "boxes",
    "tests",
    "colliding",
    "within the tree",
    "exceptions",
];

/// All paths.
pub const PATHS: [Path; 12] = [
    Path {
        name: "triangle-pairs",
        wanted: 5_000_000,
        inner: &["colliding", "touching", "shared vertex", "no area", "extreme scale"],
        run: triangle_pairs::run,
    },
    Path {
        name: "moving-pairs",
        wanted: 5_000_000,
        inner: &["colliding", "proven free", "impact checked", "no area"],
        run: moving_pairs::run,
    },
    Path { name: "discrete", wanted: 2_000_000, inner: SEARCHES, run: discrete::run_rest },
    Path {
        name: "kinetic",
        wanted: 1_000_000,
        inner: &["active pairs", "proof by local", "colliding", "swept"],
        run: kinetic::run,
    },
    Path {
        name: "continuous",
        wanted: 500_000,
        inner: &["proof by local", "proof by search", "colliding", "pairs attacked", "impact checked"],
        run: continuous::run,
    },
    Path { name: "centres", wanted: 200_000, inner: SEARCHES, run: discrete::run_centers },
    Path { name: "dense-metrics", wanted: 200_000, inner: SEARCHES, run: discrete::run_dense },
    Path {
        name: "safe-scales",
        wanted: 100_000,
        inner: &["positive", "colliding beyond"],
        run: lines::run_scales,
    },
    Path {
        name: "sweeps",
        wanted: 100_000,
        inner: &["hit", "free", "colliding at start"],
        run: lines::run_sweeps,
    },
    Path {
        name: "resolves",
        wanted: 100_000,
        inner: &["resolved", "already free"],
        run: lines::run_resolves,
    },
    Path { name: "posed", wanted: 100_000, inner: &["colliding", "two meshes", "swept"], run: posed::run },
    Path { name: "frames", wanted: 100_000, inner: &["colliding", "swept"], run: frames::run },
];

/// Returns the path of that name.
pub fn find(name: &str) -> Option<&'static Path> {
    PATHS.iter().find(|path| path.name == name)
}
