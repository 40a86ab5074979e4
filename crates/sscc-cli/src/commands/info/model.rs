//! What is known of a model.

use serde::Serialize;
use sscc::{Digest, ReducedModel, Scope};
use sscc_io::ModelInfo;

use super::surface::Surface;
use super::{form, hexadecimal, range};

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
            units: info.units,
            provenance: info.provenance,
            digest: hexadecimal(Digest::of(model, &Scope::of(model))),
        }
    }

    pub fn lines(&self) -> Vec<String> {
        let known = |text: &str| {
            if text.is_empty() { "not stated".to_owned() } else { crate::output::one_line(text) }
        };
        let mut lines = self.surface.lines();
        lines.extend([
            format!("modes          {}", self.rank),
            format!("default metric {} ({}), {}", self.metric, self.metric_form, range(&self.metric_scales)),
            format!("units          {}", known(&self.units)),
            format!("provenance     {}", known(&self.provenance)),
            format!("digest         {}", self.digest),
        ]);
        lines
    }
}
