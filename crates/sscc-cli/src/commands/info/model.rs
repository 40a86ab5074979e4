//! What is known of a model.

use serde::Serialize;
use sscc::{Digest, ReducedModel, Scope};
use sscc_io::{Elasticity, ModelInfo};

use super::surface::Surface;
use super::{form, hexadecimal, range};
use crate::output::length;

/// Frequencies that are shown.
const SHOWN: usize = 6;

#[derive(Serialize)]
pub struct Model {
    #[serde(flatten)]
    surface: Surface,
    rank: usize,
    metric: &'static str,
    metric_form: &'static str,
    metric_scales: Vec<f64>,
    units: String,
    provenance: String,
    /// Natural frequencies of the modes (Hz, if the material is in SI units), where the stiffness is known and diagonal.
    #[serde(skip_serializing_if = "Option::is_none")]
    frequencies_hz: Option<Vec<f64>>,
    /// Whether forces of large deformations are known.
    nonlinear_forces: bool,
    /// The digest that certificates by the defaults would have.
    digest: String,
}

impl Model {
    pub fn of(model: &ReducedModel, info: ModelInfo) -> Self {
        Self {
            surface: Surface::of(model.mesh()),
            rank: model.rank(),
            metric: model.metric().kind().name(),
            metric_form: form(model.metric()),
            metric_scales: model.metric().scales(),
            frequencies_hz: info
                .elasticity
                .as_ref()
                .and_then(Elasticity::diagonal)
                .map(|all| all.iter().map(|x| x.max(0.0).sqrt() / std::f64::consts::TAU).collect()),
            nonlinear_forces: matches!(info.elasticity, Some(Elasticity::Nonlinear(_))),
            units: info.units,
            provenance: info.provenance,
            digest: hexadecimal(Digest::of(model, &Scope::of(model))),
        }
    }

    /// The frequencies, as far as a line holds them.
    fn frequencies(&self) -> String {
        let Some(all) = &self.frequencies_hz else { return "not known".into() };
        let shown: Vec<String> = all.iter().take(SHOWN).map(|f| length(*f)).collect();
        let rest = match all.last() {
            Some(last) if all.len() > SHOWN => format!(", ... {}", length(*last)),
            _ => String::new(),
        };
        let forces = if self.nonlinear_forces { "; forces of large deformations known" } else { "" };
        format!("{}{rest} Hz{forces}", shown.join(", "))
    }

    pub fn lines(&self) -> Vec<String> {
        let known = |text: &str| {
            if text.is_empty() { "not stated".to_owned() } else { crate::output::one_line(text) }
        };
        let mut lines = self.surface.lines();
        lines.extend([
            format!("modes          {}", self.rank),
            format!("default metric {} ({}), {}", self.metric, self.metric_form, range(&self.metric_scales)),
            format!("frequencies    {}", self.frequencies()),
            format!("units          {}", known(&self.units)),
            format!("provenance     {}", known(&self.provenance)),
            format!("digest         {}", self.digest),
        ]);
        lines
    }
}
