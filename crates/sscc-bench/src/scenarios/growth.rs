//! Scenario `growth`: the cost of certificates and queries over the number of triangles.

use serde::Serialize;
use sscc_tasks::{ModesSpec, Recipe, SPRING_RINGS, Shape};

use super::displacement::displacement_steps;
use crate::error::Error;
use crate::measure::{Kinds, compare};
use crate::record::{Means, Record};
use crate::sampling::{directions, unit_displacements};
use crate::setup::Setup;

/// Number of modes of the springs to which exponents are fitted.
pub const GROWTH_RANK: usize = 20;

/// The largest displacement in percent of half the diagonal of the AABB.
const SHARE: f64 = 5.0;

/// The embedded spring in one of its sizes.
#[derive(Clone, Copy, Debug)]
pub struct GrowthSize {
    /// Its name.
    pub name: &'static str,
    /// Factor on the default number of rings and on the vertices of each ring, in halves.
    halves: usize,
    rank: usize,
}

/// All sizes, the smallest first.
pub const GROWTH_SIZES: [GrowthSize; 6] = [
    GrowthSize { name: "spring-4k", halves: 1, rank: GROWTH_RANK },
    GrowthSize { name: "spring-16k", halves: 2, rank: GROWTH_RANK },
    GrowthSize { name: "spring-64k", halves: 4, rank: GROWTH_RANK },
    GrowthSize { name: "spring-256k", halves: 8, rank: GROWTH_RANK },
    GrowthSize { name: "spring-1m", halves: 16, rank: GROWTH_RANK },
    GrowthSize { name: "spring-1m-r30", halves: 16, rank: 30 },
];

impl GrowthSize {
    /// Default number of samples of each size.
    pub const SAMPLES: usize = 20;

    /// Measures this size at a number of samples.
    ///
    /// # Errors
    /// When the cache cannot be written to, or the work is cancelled.
    pub fn measure(&self, setup: &Setup<'_>, samples: usize) -> Result<Record, Error> {
        let [rings, around] = SPRING_RINGS.map(|default| default * self.halves / 2);
        let recipe = Recipe::new(self.name, Shape::Spring { rings, around }, ModesSpec::Linear(self.rank));
        let model = setup.certified_model(&recipe)?;
        let unit = unit_displacements(&model.model, &directions(&model.model, samples)?);
        setup.begin_measuring();
        let comparison =
            compare(&model, &displacement_steps(&unit, SHARE), None, Kinds::Discrete, setup.watch)?;
        Ok(Record::new(format!("growth/{}", self.name), SHARE, &model, &comparison, 1, None))
    }
}

/// Records of all measured sizes, and the exponents of growth.
#[derive(Clone, Debug, Serialize)]
pub struct GrowthRecord {
    scenario: &'static str,
    /// Steps in which two exact methods differ.
    pub mismatches: usize,
    /// A record for each size.
    pub sizes: Vec<Record>,
    /// Exponents, fitted to the sizes of [`GROWTH_RANK`] modes.
    pub exponents: Exponents,
    machine: String,
}

/// Exponents of growth with the number of triangles; None for a single size.
#[derive(Clone, Debug, Serialize)]
pub struct Exponents {
    /// Exponent of the time to compute certificates.
    pub certify_seconds: Option<f64>,
    /// Exponent of the peak memory during this time.
    pub certify_peak_bytes: Option<f64>,
    /// Exponent of the time of a query, by method.
    pub discrete_ms: Means<Option<f64>>,
}

impl GrowthRecord {
    /// Creates the record of some sizes, and fits exponents.
    pub fn new(sizes: Vec<Record>) -> Self {
        Self {
            scenario: "growth",
            mismatches: sizes.iter().map(|record| record.mismatches).sum(),
            exponents: Exponents::of(&sizes),
            sizes,
            machine: sscc_tasks::machine_description(),
        }
    }
}

impl Exponents {
    fn of(records: &[Record]) -> Self {
        let of = |value: &dyn Fn(&Record) -> Option<f64>| {
            let fitted = records.iter().filter(|record| record.rank == GROWTH_RANK);
            exponent(&fitted.filter_map(|r| Some([r.triangles as f64, value(r)?])).collect::<Vec<_>>())
        };
        let keys = records.first().map(|record| record.discrete_ms.0.iter().map(|(key, _)| *key));
        let of_column = |key: &'static str| (key, of(&|record: &Record| record.discrete_ms.get(key)));
        Self {
            certify_seconds: of(&|record| Some(record.certify_seconds)),
            certify_peak_bytes: of(&|record| record.certify_peak_bytes.map(|bytes| bytes as f64)),
            discrete_ms: Means(keys.into_iter().flatten().map(of_column).collect()),
        }
    }
}

/// Returns the slope of a line through logarithms (least squares); None for fewer than two different sizes.
fn exponent(points: &[[f64; 2]]) -> Option<f64> {
    let logs: Vec<[f64; 2]> = points.iter().map(|point| point.map(libm::log)).collect();
    let mean = |at: usize| logs.iter().map(|log| log[at]).sum::<f64>() / logs.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let variance: f64 = logs.iter().map(|log| (log[0] - x) * (log[0] - x)).sum();
    let covariance: f64 = logs.iter().map(|log| (log[0] - x) * (log[1] - y)).sum();
    (variance > 0.0).then(|| covariance / variance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_slopes() {
        let points = [1.0, 4.0, 16.0].map(|n: f64| [n, 3.0 * n * n.sqrt()]);
        assert!((exponent(&points).unwrap() - 1.5).abs() < 1e-12);
        assert_eq!(exponent(&points[..1]), None);
        assert_eq!(exponent(&[]), None);
    }
}
