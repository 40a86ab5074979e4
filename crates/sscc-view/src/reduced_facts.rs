//! The facts of a model's modes and certificates that the page shows.

use serde::Serialize;
use sscc::{Certificates, ReducedModel};
use sscc_tasks::{FreeProof, IntervalRow, LeftOut, SweepRange, free_sentence};

use crate::extremal::{Extremal, extremal};
use crate::levels::{Level, levels};

/// Facts about a model that its file may state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelDetails {
    /// Frequency of each mode (Hz); `None` where unknown.
    pub frequencies: Option<Vec<f64>>,
    /// Name of each mode; empty where unknown.
    pub mode_names: Vec<String>,
    /// Standard deviation of each entry of q, if the modes are principal components.
    pub deviations: Option<Vec<f64>>,
    /// The initial q of the page; `None` means the centre.
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
    /// The weight of each mode at which it has moved some vertex by half the diagonal of the AABB.
    limits: Vec<f64>,
    /// The ranges of the sliders, and of sweeps.
    pub(crate) ranges: Vec<[f64; 2]>,
    root_radius: f64,
    global_radius: f64,
    /// The limit of the pair tree: below it the pair tree contains every node pair that can collide. `None` if the pair
    /// tree is empty.
    resolved_up_to: Option<f64>,
    metric: &'static str,
    exceptions: usize,
    free: FreeSentences,
    nodes: usize,
    levels: Vec<Level>,
    extremal: Vec<Extremal>,
    /// The intervals of each mode about `default_q`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) intervals: Option<Vec<IntervalRow>>,
}

/// The sentences for a free shape, one for each kind of proof.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct FreeSentences {
    root: String,
    tests: String,
}

impl FreeSentences {
    fn new(certificates: &Certificates) -> Self {
        let left_out = LeftOut::of(certificates.filter());
        let root = FreeProof::Root { exceptions: certificates.exceptions().len() };
        let [root, tests] = [root, FreeProof::Tests].map(|proof| free_sentence(proof, "", &left_out));
        Self { root, tests }
    }
}

impl ReducedFacts {
    pub(crate) fn new(model: &ReducedModel, certificates: &Certificates, details: ModelDetails) -> Self {
        let metric = certificates.metric();
        let center = certificates.center();
        Self {
            rank: model.rank(),
            frequencies: details.frequencies,
            limits: model.weight_limits(),
            ranges: SweepRange::of_modes(&details.mode_names, details.deviations.as_deref())
                .ends(model, center),
            mode_names: Some(details.mode_names).filter(|names| !names.is_empty()),
            scales: metric.dense_factor().is_none().then(|| metric.scales()),
            center: center.to_vec(),
            default_q: details.default_q.unwrap_or_else(|| center.to_vec()),
            root_radius: certificates.root_radius(),
            global_radius: certificates.global_radius(),
            resolved_up_to: Some(certificates.parts().pair_tree.limit()).filter(|limit| *limit > 0.0),
            metric: metric.kind().into(),
            exceptions: certificates.exceptions().len(),
            free: FreeSentences::new(certificates),
            nodes: certificates.parts().hierarchy.nodes().len(),
            levels: levels(certificates),
            extremal: extremal(model, certificates),
            intervals: None,
        }
    }

    /// Whether the page can show all shapes that its sliders reach.
    pub(crate) fn fits(&self) -> bool {
        let farthest = self.limits.iter().fold(1.0_f64, |far, x| far.max(*x)) * MAX_SLIDER_SCALE;
        farthest <= f64::from(f32::MAX)
    }
}

/// The page may show displacements up to this multiple of its sliders' range.
const MAX_SLIDER_SCALE: f64 = 1e6;
