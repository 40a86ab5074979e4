//! Scenario `norms`: the cost of queries over `|z|`, and the kinds of proof that certify the shape there.

use sscc::Query;
use sscc::parts::ProvenShares;
use sscc_tasks::CertifiedModel;

use super::displacement::displacement_steps;
use crate::error::Error;
use crate::measure::{Kinds, compare};
use crate::plots::{Line, SvgPlot, YAxis, stacked};
use crate::record::{Means, Record};
use crate::sampling::{directions, half_diagonal, largest_displacement, scaled};
use crate::setup::Setup;

/// `|z|` over the root's radius.
const TIMES_ROOT: [f64; 13] = [0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0];

/// Measures `samples` random q of each `|z|`. Returns one record for each of [`TIMES_ROOT`].
pub fn measure(
    name: &str,
    model: &CertifiedModel,
    setup: &Setup<'_>,
    samples: usize,
) -> Result<Vec<Record>, Error> {
    let certificates = &model.full.certificates;
    let unit = |q: &Vec<f64>| -> Result<Vec<f64>, sscc::Error> {
        Ok(scaled(q, certificates.root_radius() / certificates.norm(q)?))
    };
    let units: Vec<Vec<f64>> =
        directions(&model.model, samples)?.iter().map(unit).collect::<Result<_, _>>()?;
    let record = |times_root: f64| {
        setup.begin_measuring();
        let steps = displacement_steps(&units, 100.0 * times_root);
        let comparison = compare(model, &steps, None, Kinds::Discrete, setup.watch)?;
        let states = units.iter().map(|q| scaled(q, times_root));
        let (mut largest, mut shares) = (0.0_f64, Vec::new());
        let mut query = Query::new(&model.model, certificates)?;
        for (q, collides) in states.zip(&comparison.colliding) {
            largest = largest.max(largest_displacement(&model.model, &q));
            if !collides {
                shares.push(ProvenShares::of(&mut query, &q)?);
            }
        }
        let share = 100.0 * largest / half_diagonal(&model.model);
        let record = Record::new(format!("norms/{name}"), share, model, &comparison, 1, None);
        Ok(Record { times_root: Some(times_root), proven_shares: means(&shares), ..record })
    };
    TIMES_ROOT.into_iter().map(record).collect()
}

/// A kind of proof of [`ProvenShares`], with the name that the key `proof` has in answers.
struct Kind {
    name: &'static str,
    share: fn(&ProvenShares) -> f64,
    color: &'static str,
}

const KINDS: [Kind; 3] = [
    Kind { name: "radius", share: |shares| shares.radius, color: "#009966" },
    Kind { name: "local", share: |shares| shares.local, color: "#0066cc" },
    Kind { name: "search", share: |shares| shares.search, color: "#cc6600" },
];

/// Returns the mean share of each kind; empty if there are no shares.
fn means(shares: &[ProvenShares]) -> Means {
    let mean = |kind: &Kind| shares.iter().map(kind.share).sum::<f64>() / shares.len() as f64;
    Means(KINDS.iter().filter(|_| !shares.is_empty()).map(|kind| (kind.name, mean(kind))).collect())
}

/// Methods of the plot: key, label and colour.
const METHODS: [(&str, &str, &str); 3] = [
    ("parry", "parry", "#777777"),
    ("traditional", "traditional method", "#cc6600"),
    ("full", "certified", "#0066cc"),
];

/// Returns a plot of the records of all models, as SVG: for each model the mean time of a query in free states over `|z|`,
/// and the share of the triangles by kind of proof.
pub fn plot_norms(records: &[Record]) -> String {
    let over = |record: &Record, y: Option<f64>| Some([record.times_root?.log2(), y?]);
    let mut plots = Vec::new();
    for group in records.chunk_by(|a, b| a.scenario == b.scenario) {
        let title = format!("{}, {} modes", group[0].scenario, group[0].rank);
        let time = |key: &str| group.iter().filter_map(|r| over(r, r.free_ms.get(key))).collect();
        let share = |kind: &str| {
            group.iter().filter_map(|r| over(r, Some(100.0 * r.proven_shares.get(kind)?))).collect()
        };
        let lines = METHODS.iter().map(|(key, label, color)| Line { label, color, points: time(key) });
        let x_label = "|z| over the root's radius, as a power of two";
        let y_label = "ms, free states";
        plots.push(SvgPlot {
            title: title.clone(),
            x_label,
            y_label,
            y_axis: YAxis::Logarithmic,
            lines: lines.collect(),
        });
        let lines =
            KINDS.iter().map(|Kind { name, color, .. }| Line { label: name, color, points: share(name) });
        let y_label = "% of the triangles";
        plots.push(SvgPlot { title, x_label, y_label, y_axis: YAxis::Linear, lines: lines.collect() });
    }
    stacked(&plots)
}
