//! The contents of a model file.

use serde::Serialize;
use sscc::ReducedModel;
use sscc::parts::{Digest, Scope};
use sscc_io::ModelInfo;
use sscc_modes::natural_frequencies;
use sscc_solid::Elasticity;

use super::surface::Surface;
use super::text::{form, hexadecimal, range};
use crate::output::length;

/// Maximum number of frequencies, weights or deviations in the text; the JSON has all.
const MAX_SHOWN: usize = 8;

#[derive(Serialize)]
pub struct Model {
    #[serde(flatten)]
    surface: Surface,
    rank: usize,
    metric: &'static str,
    metric_form: &'static str,
    metric_scales: Vec<f64>,
    /// Whether the file has forces for large deformations; absent without a stiffness.
    #[serde(skip_serializing_if = "Option::is_none")]
    nonlinear: Option<bool>,
    /// Natural frequencies; absent without a stiffness, or if it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    frequencies_hz: Option<Vec<f64>>,
    /// The reason why a model with a stiffness has no frequencies.
    #[serde(skip)]
    no_frequencies: String,
    /// One number for each mode from a `.npz` file, such as variances; absent if the file has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    mode_weights: Option<Vec<f64>>,
    /// The standard deviation of each entry of q, for principal components; absent if the file has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    deviations: Option<Vec<f64>>,
    units: String,
    provenance: String,
    /// The digest of certificates with default options, if no pairs collide at rest: such pairs are exceptions, and a
    /// part of the digest.
    digest: String,
}

impl Model {
    pub fn of(model: &ReducedModel, info: ModelInfo) -> Self {
        let frequencies =
            info.elasticity.as_ref().map(|elasticity| natural_frequencies(elasticity.stiffness()));
        Self {
            surface: Surface::of(model.mesh()),
            rank: model.rank(),
            metric: model.metric().kind().into(),
            metric_form: form(model.metric()),
            metric_scales: model.metric().scales(),
            nonlinear: info
                .elasticity
                .as_ref()
                .map(|elasticity| matches!(elasticity, Elasticity::Nonlinear(_))),
            no_frequencies: match &frequencies {
                Some(Err(error)) => error.to_string(),
                _ => String::new(),
            },
            frequencies_hz: frequencies.and_then(Result::ok),
            mode_weights: None,
            deviations: info.deviations,
            units: info.units,
            provenance: info.provenance,
            digest: hexadecimal(Digest::of(model, &Scope::of(model))),
        }
    }

    /// Adds one number for each mode.
    pub fn with_weights(self, mode_weights: Option<Vec<f64>>) -> Self {
        Self { mode_weights, ..self }
    }

    pub fn lines(&self) -> Vec<String> {
        let stated = |text: &str| {
            if text.is_empty() { "not stated".to_owned() } else { crate::output::one_line(text) }
        };
        let mut lines = self.surface.lines();
        lines.extend([
            format!("modes          {}", self.rank),
            format!("default metric {} ({}), {}", self.metric, self.metric_form, range(&self.metric_scales)),
        ]);
        lines.extend(self.elasticity());
        if let Some(all) = &self.mode_weights {
            lines.push(format!("mode weights   {}", first(all)));
            // Archives do not state the unit of q.
            lines.push("unit of q      q_k = 1 adds the k-th mode once as stored".to_owned());
        }
        if let Some(all) = &self.deviations {
            lines.push(format!("deviations     {} (standard deviations of q)", first(all)));
        }
        lines.extend([
            format!("units          {}", stated(&self.units)),
            format!("provenance     {}", stated(&self.provenance)),
            format!("digest         {}", self.digest),
        ]);
        lines
    }

    /// Returns the line about stiffness and forces; None without a stiffness.
    fn elasticity(&self) -> Option<String> {
        let forces = if self.nonlinear? { "nonlinear" } else { "linear" };
        Some(match &self.frequencies_hz {
            Some(all) => {
                format!("frequencies    {} Hz ({forces} forces)", first(all))
            }
            None => format!("frequencies    none: {} ({forces} forces)", self.no_frequencies),
        })
    }
}

/// Returns the first of these numbers as text.
fn first(all: &[f64]) -> String {
    let shown: Vec<String> = all.iter().take(MAX_SHOWN).map(|number| length(*number)).collect();
    let more = if all.len() > MAX_SHOWN { ", ..." } else { "" };
    format!("{}{more}", shown.join(", "))
}
