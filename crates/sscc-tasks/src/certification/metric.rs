//! Metrics by name or from files.

use std::path::Path;

use sscc::parts::check_metric;
use sscc::{Metric, MetricKind, ReducedModel};
use sscc_io::{Message, Setting, read_matrix};

use crate::TaskError;
use crate::error::{At, Result};

/// Returns the metric of a model by its name (`displacement`, `mass`, `identity`, `energy`), or from a file of weights
/// or a dense matrix.
pub(super) fn metric(model: &ReducedModel, typed: &Path) -> Result<Metric> {
    let metric = match typed.to_str() {
        Some("displacement") => Metric::displacement(model.mesh(), model.modes())?,
        Some("mass") => Metric::mass(model.mesh(), model.modes())?,
        Some("identity") => Metric::identity(model.rank()),
        Some("energy") if model.metric().kind() == MetricKind::Energy => model.metric().clone(),
        Some("energy") => {
            let own = model.metric().kind();
            let cause = format!(
                "the model's own metric is {own}, not energy; make a model with its stiffness by sscc modes "
            );
            let cause = Message::from(cause) + Setting::Kind + " linear or nonlinear, or give a file";
            return Err(TaskError::refused(Setting::Metric + " energy", cause));
        }
        _ => from_file(model, typed)?,
    };
    // The metric is checked here, because later errors cannot name the setting.
    check_metric(&metric, model.mesh(), model.modes()).at(|| Setting::Metric + " " + typed.display())?;
    Ok(metric)
}

fn from_file(model: &ReducedModel, file: &Path) -> Result<Metric> {
    let place =
        || Setting::Metric + " is none of energy, displacement, mass and identity, so it must be a file";
    let numbers = read_matrix(file).at(place)?;
    let rank = model.rank();
    let refused = |cause: String| Err(TaskError::refused(file.display(), cause));
    let made = match (numbers.rows, numbers.columns) {
        (1, n) | (n, 1) if n == rank => Metric::from_weights(MetricKind::Given, &numbers.data),
        (n, m) if (n, m) == (rank, rank) => Metric::from_matrix(MetricKind::Given, rank, &numbers.data),
        (1, n) | (n, 1) => {
            let matrix = if n == rank * rank { " (a dense matrix must be a .npy)" } else { "" };
            return refused(format!("the metric has {n} weights, the model has {rank} modes{matrix}"));
        }
        (n, m) => return refused(format!("the metric is {n} x {m}, the model has {rank} modes")),
    };
    made.in_file(file)
}
