//! Figure 9 of the paper: the root's radius of the spring over the number of modes, under two metrics.
//!
//! Both metrics are scaled so that the first mode's weight is 1. The root's radius is then the largest deformation
//! along the first mode alone that is proven free.

use sscc::{Certificates, CertifyOptions, Metric, Modes, ReducedModel};
use sscc_tasks::{ModesSpec, Recipe, Shape};

use super::figure_record::FigureRecord;
use super::mode_displacements::largest_displacements;
use crate::error::Error;
use crate::plots::{Line, SvgPlot, YAxis};
use crate::record::Means;
use crate::setup::Setup;

/// Numbers of modes; the last one is the largest.
const RANKS: [usize; 5] = [5, 10, 20, 40, 80];

pub fn make(setup: &Setup<'_>) -> Result<FigureRecord, Error> {
    let most = RANKS[RANKS.len() - 1];
    let model = setup.certified_model(&Recipe::new("spring-80", Shape::SPRING, ModesSpec::Linear(most)))?;
    let all = model.model.modes();
    let first = largest_displacements(&model.model)[0];
    // The model's own metric is the energy metric.
    let scales = model.model.metric().scales();
    let mut rows = Vec::new();
    for rank in RANKS.into_iter().filter(|rank| *rank <= all.rank()) {
        let columns = all.displacements().chunks(all.rank()).flat_map(|of_vertex| &of_vertex[..rank]);
        let modes = Modes::new(rank, columns.copied().collect())?;
        let truncated = ReducedModel::new(model.model.mesh().clone(), modes)?;
        let millimetres = |metric: Metric| -> Result<f64, Error> {
            let scale = metric.scales()[0];
            let options = CertifyOptions::default().metric(metric);
            let certificates = Certificates::compute(&truncated, &options, setup.watch)?;
            Ok(1e3 * first * certificates.root_radius() / scale)
        };
        let displacement = millimetres(truncated.metric().clone())?;
        let energy = millimetres(Metric::from_scales(model.model.metric().kind(), scales[..rank].to_vec())?)?;
        rows.push(Means(vec![
            ("modes", rank as f64),
            ("displacement_mm", displacement),
            ("energy_mm", energy),
        ]));
    }
    let points =
        |key: &str| rows.iter().filter_map(|row| Some([row.get("modes")?.log2(), row.get(key)?])).collect();
    let plot = SvgPlot {
        title: "Spring: proven free along the first mode, up to".into(),
        x_label: "number of modes, as a power of two",
        y_label: "mm",
        y_axis: YAxis::Linear,
        lines: vec![
            Line { label: "energy metric", color: "#0066cc", points: points("energy_mm") },
            Line { label: "displacement metric", color: "#cc6600", points: points("displacement_mm") },
        ],
    };
    Ok(FigureRecord { scenario: "figure9", source: model.source, note: model.note, svg: plot.svg(), rows })
}
