//! Figure 7 of the paper: radii grow at finer levels of the hierarchy (bunny, 30 modes).

use sscc::{Certificates, CertifyOptions};
use sscc_tasks::{ModesSpec, Recipe, Shape};
use sscc_view::{Level, levels};

use super::figure_record::FigureRecord;
use crate::error::Error;
use crate::plots::{Line, SvgPlot, YAxis};
use crate::record::Means;
use crate::setup::Setup;

/// Maximum radius, in units of the paper's global radius: so large that it caps no radius.
const REACH: f64 = 1e6;

/// Memory budget per triangle (bytes). The usual budget ends radii before their growth is seen.
const BUDGET: usize = 4096;

pub fn make(setup: &Setup<'_>) -> Result<FigureRecord, Error> {
    let model = setup.certified_model(&Recipe::new("bunny", Shape::Bunny, ModesSpec::Linear(30)))?;
    let options = CertifyOptions::default().metric(model.full.certificates.metric().clone());
    let certificates =
        Certificates::compute(&model.model, &options.budget(BUDGET).reach(REACH), setup.watch)?;
    let levels = levels(&certificates);
    let row = |level: &Level| {
        let Level { level, nodes, least, median, largest, .. } = *level;
        let (level, nodes) = (level as f64, nodes as f64);
        Means(vec![
            ("level", level),
            ("nodes", nodes),
            ("least", least),
            ("median", median),
            ("largest", largest),
        ])
    };
    let points = |value: fn(&Level) -> f64| levels.iter().map(|l| [l.level as f64, value(l)]).collect();
    let plot = SvgPlot {
        title: format!("Radii of the nodes of each level ({}, {} modes)", model.name, model.model.rank()),
        x_label: "level of the hierarchy; 0 is the root",
        y_label: "radius",
        y_axis: YAxis::Logarithmic,
        lines: vec![
            Line { label: "median", color: "#0066cc", points: points(|level| level.median) },
            Line { label: "least", color: "#cc6600", points: points(|level| level.least) },
        ],
    };
    let rows = levels.iter().map(row).collect();
    Ok(FigureRecord { scenario: "figure7", source: model.source, note: model.note, rows, svg: plot.svg() })
}
