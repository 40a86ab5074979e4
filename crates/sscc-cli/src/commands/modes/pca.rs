//! Principal components of an animation.

use anyhow::{Context, Result, ensure};
use serde::Serialize;
use sscc_io::read_frames;
use sscc_modes::pca_modes;

use super::{Made, name};
use crate::args;
use crate::progress::Bar;

/// What is known of principal components.
#[derive(Clone, Serialize)]
pub struct Components {
    pub frames: usize,
    /// The share of the variance that all modes together explain.
    pub explained: f64,
    pub deviations: Vec<f64>,
}

pub fn make(args: &args::Modes) -> Result<Made> {
    let shown = args.source.display();
    ensure!(
        args.fix.is_none() && args.material.is_none() && args.resolution.is_none(),
        "--fix, --material and --resolution: principal components know no solid; leave them out"
    );
    ensure!(
        !args.source.is_file(),
        "{shown}: is a file; principal components are those of a folder of meshes, the frames"
    );
    let frames = read_frames(&args.source)?;
    let rank = args.rank.map(|rank| rank as usize);
    let bar = Bar::new("modes");
    let pca = pca_modes(&frames.mesh, &frames.positions, rank, &bar).with_context(|| shown.to_string())?;
    drop(bar);
    let count = frames.paths.len();
    let components =
        Components { frames: count, explained: pca.shares.iter().sum(), deviations: pca.deviations };
    Ok(Made {
        is_split: false,
        mesh: pca.mesh,
        modes: pca.modes,
        metric: None,
        elasticity: None,
        elements: None,
        degrees_of_freedom: None,
        frequencies: None,
        components: Some(components),
        provenance: format!("mean and principal components of {count} meshes in {}", name(args)),
    })
}
