//! The facts of a model's modes and certificates that the page shows.

use serde::Serialize;
use sscc::{Certificates, ReducedModel};

use crate::extremal::{Extremal, extremal};
use crate::levels::{Level, levels};

/// Facts about a model that its file may state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelDetails {
    /// Frequency of each mode (Hz); `None` where unknown.
    pub frequencies: Option<Vec<f64>>,
    /// Name of each mode; empty where unknown.
    pub mode_names: Vec<String>,
    /// The initial q of the page; `None`: the centre.
    pub default_q: Option<Vec<f64>>,
}

/// Modes and certificates of a model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ReducedFacts {
    rank: usize,
    frequencies: Option<Vec<f64>>,
    mode_names: Option<Vec<String>>,
    /// `z_k = scales[k] (q_k - center_k)`, where the metric is diagonal.
    scales: Option<Vec<f64>>,
    center: Vec<f64>,
    default_q: Vec<f64>,
    limits: Vec<f64>,
    ranges: Vec<[f64; 2]>,
    root_radius: f64,
    global_radius: f64,
    /// The limit of the pair tree: below it the pair tree contains every node pair that can collide. `None` if the pair
    /// tree is empty.
    resolved_up_to: Option<f64>,
    metric: &'static str,
    exceptions: usize,
    nodes: usize,
    levels: Vec<Level>,
    extremal: Vec<Extremal>,
}

impl ReducedFacts {
    /// `diagonal`: length of the diagonal of the AABB at rest.
    pub(crate) fn new(
        model: &ReducedModel,
        certificates: &Certificates,
        details: ModelDetails,
        diagonal: f64,
    ) -> Self {
        let metric = certificates.metric();
        let (limits, center) = (limits(model, diagonal), certificates.center());
        Self {
            rank: model.rank(),
            frequencies: details.frequencies,
            ranges: ranges(&limits, center, &details.mode_names),
            mode_names: Some(details.mode_names).filter(|names| !names.is_empty()),
            scales: metric.dense_factor().is_none().then(|| metric.scales()),
            center: center.to_vec(),
            default_q: details.default_q.unwrap_or_else(|| center.to_vec()),
            limits,
            root_radius: certificates.root_radius(),
            global_radius: certificates.global_radius(),
            resolved_up_to: Some(certificates.parts().pair_tree.limit()).filter(|limit| *limit > 0.0),
            metric: metric.kind().name(),
            exceptions: certificates.exceptions().len(),
            nodes: certificates.hierarchy().nodes().len(),
            levels: levels(certificates),
            extremal: extremal(certificates),
        }
    }

    /// Whether the page can show all that its sliders reach.
    pub(crate) fn fits(&self) -> bool {
        let farthest = self.limits.iter().fold(1.0_f64, |far, x| far.max(*x)) * MAX_SLIDER_SCALE;
        farthest <= f64::from(f32::MAX)
    }
}

/// The ranges of the sliders: 0 to 1 for morph targets, whose modes have names; else as far as the limits on both sides of the
/// centre.
fn ranges(limits: &[f64], center: &[f64], mode_names: &[String]) -> Vec<[f64; 2]> {
    let range = |(limit, center): (&f64, &f64)| match mode_names.is_empty() {
        true => [center - limit, center + limit],
        false => [0.0, 1.0],
    };
    limits.iter().zip(center).map(range).collect()
}

/// For each mode the weight at which the vertex that moves farthest has moved by half the diagonal of the AABB. It is 1 for a mode without displacement.
fn limits(model: &ReducedModel, diagonal: f64) -> Vec<f64> {
    let mut fastest = vec![0.0_f64; model.rank()];
    for (i, u) in model.modes().displacements().iter().enumerate() {
        let fastest = &mut fastest[i % model.rank()];
        *fastest = fastest.max(u.length());
    }
    let limit = |fastest: f64| 0.5 * diagonal / fastest;
    fastest.into_iter().map(limit).map(|x| if x.is_finite() && x > 0.0 { x } else { 1.0 }).collect()
}

/// The page may show displacements up to this multiple of its sliders' range.
const MAX_SLIDER_SCALE: f64 = 1e6;
