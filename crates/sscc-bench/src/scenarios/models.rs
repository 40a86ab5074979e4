//! Scenarios that measure models by name: bunny, dragon and springs.

use sscc_tasks::{ModesSpec, Recipe, Shape};

use super::{amplitudes, mixed, norms};
use crate::error::Error;
use crate::record::Record;
use crate::setup::Setup;

/// Motions of the models of a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelsScenario {
    /// Random q of growing displacement.
    Amplitudes,
    /// All modes swing at once.
    Mixed,
    /// Random q of growing `|z|`.
    Norms,
}

/// A model with linear modes.
#[derive(Clone, Debug)]
pub struct BenchModel {
    /// Its name.
    pub name: &'static str,
    shape: Shape,
    rank: usize,
}

const BUNNY: BenchModel = BenchModel { name: "bunny", shape: Shape::Bunny, rank: 30 };
const DRAGON: BenchModel = BenchModel { name: "dragon", shape: Shape::Dragon, rank: 30 };
const SPRING: BenchModel = BenchModel { name: "spring", shape: Shape::SPRING, rank: 20 };
const SPRING8: BenchModel = BenchModel { name: "spring8", shape: Shape::SPRING, rank: 8 };

impl ModelsScenario {
    /// Returns the models, in the order in which they are measured.
    pub fn models(self) -> &'static [BenchModel] {
        match self {
            Self::Amplitudes | Self::Norms => &[BUNNY, DRAGON, SPRING],
            Self::Mixed => &[SPRING8, SPRING, BUNNY, DRAGON],
        }
    }

    /// Returns the default number of samples of each record.
    pub fn default_samples(self) -> usize {
        match self {
            Self::Amplitudes => 64,
            Self::Mixed => 200,
            Self::Norms => 50,
        }
    }

    /// Measures a model at `samples` samples for each record.
    ///
    /// # Errors
    /// When the model cannot be read or made, the cache cannot be written to, or the work is cancelled.
    pub fn measure(
        self,
        model: &BenchModel,
        setup: &Setup<'_>,
        samples: usize,
    ) -> Result<Vec<Record>, Error> {
        let recipe = Recipe::new(model.name, model.shape.clone(), ModesSpec::Linear(model.rank));
        let certified = setup.certified_model(&recipe)?;
        match self {
            Self::Amplitudes => amplitudes::measure(model.name, &certified, setup, samples),
            Self::Mixed => mixed::measure(model.name, &certified, setup, samples),
            Self::Norms => norms::measure(model.name, &certified, setup, samples),
        }
    }
}
