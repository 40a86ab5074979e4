//! Scenario `amplitudes`: the cost of queries over the displacement of the shape.

use sscc_tasks::CertifiedModel;

use super::displacement::displacement_steps;
use crate::error::Error;
use crate::measure::{Kinds, compare};
use crate::record::Record;
use crate::sampling::{directions, unit_displacements};
use crate::setup::Setup;

/// Largest displacements in percent of half the diagonal of the AABB.
const SHARES: [f64; 7] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0];

/// Measures a model at `samples` random q of each displacement. Returns one record for each displacement.
pub fn measure(
    name: &str,
    model: &CertifiedModel,
    setup: &Setup<'_>,
    samples: usize,
) -> Result<Vec<Record>, Error> {
    let unit = unit_displacements(&model.model, &directions(&model.model, samples)?);
    let record = |share: f64| {
        setup.begin_measuring();
        let comparison = compare(model, &displacement_steps(&unit, share), None, Kinds::Both, setup.watch)?;
        Ok(Record::new(format!("amplitudes/{name}"), share, model, &comparison, 1, None))
    };
    SHARES.into_iter().map(record).collect()
}
