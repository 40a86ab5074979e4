//! Plot of the scenario `growth`.

use super::growth::{GROWTH_RANK, GrowthRecord};
use crate::plots::{Line, SvgPlot, YAxis};
use crate::record::Record;

/// A line of the plot.
struct GrowthLine {
    value: fn(&Record) -> Option<f64>,
    label: &'static str,
    color: &'static str,
}

const LINES: [GrowthLine; 4] = [
    GrowthLine { value: |record| record.discrete_ms.get("parry"), label: "parry (ms)", color: "#777777" },
    GrowthLine {
        value: |record| record.discrete_ms.get("traditional"),
        label: "traditional (ms)",
        color: "#cc6600",
    },
    GrowthLine { value: |record| record.discrete_ms.get("full"), label: "certified (ms)", color: "#0066cc" },
    GrowthLine { value: |record| Some(record.certify_seconds), label: "certificates (s)", color: "#009966" },
];

impl GrowthRecord {
    /// Returns the plot as an SVG element: milliseconds of a query and seconds of certificates over the number of
    /// triangles, all logarithmic.
    pub fn svg(&self) -> String {
        let records: Vec<&Record> = self.sizes.iter().filter(|record| record.rank == GROWTH_RANK).collect();
        let line = |GrowthLine { value, label, color }: &GrowthLine| {
            let point = |record: &&Record| Some([(record.triangles as f64).log10(), value(record)?]);
            Line { label, color, points: records.iter().filter_map(point).collect() }
        };
        let plot = SvgPlot {
            title: "Growth with the number of triangles".into(),
            x_label: "number of triangles, as a power of ten",
            y_label: "ms, s",
            y_axis: YAxis::Logarithmic,
            lines: LINES.iter().map(line).collect(),
        };
        plot.svg()
    }
}
