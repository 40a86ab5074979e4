//! Energy against displacement: how the root's certificate shrinks as modes are added, under both metrics (paper,
//! Figure 9).

use std::path::Path;

use anyhow::{Context, Result, bail};
use sscc::{CertifyOptions, Metric, MetricKind, Modes, ReducedModel};
use sscc_io::LoadedModel;
use sscc_view::{Axis, Plot, Series};

use crate::load;

/// The numbers of modes: these, as far as there are, and all.
const RANKS: [usize; 6] = [1, 5, 10, 20, 40, 80];

/// For each number of modes and both metrics the largest deformation along the first mode alone that the root proves
/// free: the displacement of the vertex that moves farthest.
pub fn compare(loaded: &LoadedModel, path: &Path) -> Result<Plot> {
    let model = &loaded.model;
    let energy = model.metric();
    let form = if energy.dense_factor().is_some() { "dense" } else { "diagonal" };
    if (energy.kind(), form) != (MetricKind::Energy, "diagonal") {
        bail!(
            "--compare-metrics: {}: the model's own metric is {} ({form}), not a diagonal energy metric; make a model \
             with its stiffness by sscc modes --kind linear or nonlinear",
            path.display(),
            energy.kind().name()
        );
    }
    let rank = model.rank();
    let mut ranks: Vec<usize> = RANKS.into_iter().filter(|r| *r < rank).chain([rank]).collect();
    ranks.dedup();
    let all = model.modes().displacements();
    let farthest = all.iter().step_by(rank).map(|u| u.length()).fold(0.0, f64::max);
    let (mut by_energy, mut by_displacement) = (Vec::new(), Vec::new());
    for count in ranks {
        let modes = all.chunks_exact(rank).flat_map(|of_vertex| &of_vertex[..count]).copied().collect();
        let first = ReducedModel::new(model.mesh().clone(), Modes::new(count, modes)?)?;
        let root = |metric: Metric| -> Result<[f64; 2]> {
            let scale = metric.scales()[0];
            let options = CertifyOptions { metric: Some(metric), budget: 0, ..CertifyOptions::default() };
            let certificates = load::certify(&first, path, &options)?;
            Ok([count as f64, farthest * certificates.root_radius() / scale])
        };
        by_displacement.push(root(first.metric().clone())?);
        let scales = energy.scales()[..count].to_vec();
        let energy = Metric::from_scales(MetricKind::Energy, scales).context("the energy metric")?;
        by_energy.push(root(energy)?);
    }
    let unit = match loaded.info.units.as_str() {
        "" => String::new(),
        unit => format!(" ({unit})"),
    };
    Ok(Plot {
        title: "Proven free along the first mode".into(),
        x: Axis::logarithmic("modes"),
        y: Axis::linear(format!("largest displacement{unit}")),
        series: vec![
            Series::new("energy metric", by_energy),
            Series::new("displacement metric", by_displacement),
        ],
    })
}
