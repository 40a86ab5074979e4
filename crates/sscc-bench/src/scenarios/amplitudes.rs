//! Scenario `amplitudes`: the cost of queries over the displacement of the shape.

use sscc_sim::{ModesSpec, Recipe, Shape};

use super::displacement::displacement_steps;
use crate::error::Error;
use crate::measure::{Kinds, compare};
use crate::record::Record;
use crate::sampling::{directions, unit_displacements};
use crate::setup::Setup;

/// Largest displacements in percent of half the diagonal of the AABB.
const SHARES: [f64; 7] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0];

/// A model of the scenario.
pub struct AmplitudesModel {
    /// Its name.
    pub name: &'static str,
    shape: Shape,
    rank: usize,
}

/// The models, in the order in which they are measured.
pub fn amplitudes_models() -> [AmplitudesModel; 3] {
    [("bunny", Shape::Bunny, 30), ("dragon", Shape::Dragon, 30), ("spring", Shape::SPRING, 20)]
        .map(|(name, shape, rank)| AmplitudesModel { name, shape, rank })
}

impl AmplitudesModel {
    /// Default number of samples at each displacement.
    pub const SAMPLES: usize = 64;

    /// Measures the model at a number of samples of each displacement. Returns one record for each displacement.
    ///
    /// # Errors
    /// When the model cannot be read or made, the cache cannot be written to, or the work is cancelled.
    pub fn measure(self, setup: &Setup<'_>, samples: usize) -> Result<Vec<Record>, Error> {
        let recipe = Recipe::new(self.name, self.shape, ModesSpec::Linear(self.rank));
        let model = setup.certified_model(&recipe)?;
        let unit = unit_displacements(&model.model, &directions(&model.model, samples));
        let record = |share: f64| {
            setup.begin_measuring();
            let comparison =
                compare(&model, &displacement_steps(&unit, share), None, Kinds::Both, setup.watch)?;
            Ok(Record::new(format!("amplitudes/{}", self.name), share, &model, &comparison, 1, None))
        };
        SHARES.into_iter().map(record).collect()
    }
}
