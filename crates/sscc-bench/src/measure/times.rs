//! Times by step and method, and their means over a scene.

use super::timer::Milliseconds;
use crate::methods::COLUMNS;
use crate::sampling::{Strata, weighted_mean, weighted_median};

/// Name of kinetic queries in tables and JSON. They depend on earlier steps, so they are not an interleaved column.
const KINETIC: &str = "kinetic";

/// Milliseconds of the queries of all bodies.
#[derive(Clone, Debug)]
pub struct Times {
    /// The steps on which every method ran.
    pub compared: Vec<usize>,
    /// Times by step and column.
    pub interleaved: Milliseconds,
    /// Times of kinetic queries by step; empty if they did not run.
    pub kinetic: Vec<f64>,
}

impl Times {
    /// Returns the milliseconds of one method on the steps on which it ran; if the method has several engines, the times of
    /// the faster engine.
    pub fn of(&self, key: &str) -> Vec<(usize, f64)> {
        if key == KINETIC {
            return self.kinetic.iter().copied().enumerate().collect();
        }
        let faster = |times: &Vec<Option<f64>>| {
            let own = COLUMNS.iter().zip(times).filter(|(column, _)| column.key == key);
            own.filter_map(|(_, time)| *time).reduce(f64::min)
        };
        let steps = self.interleaved.iter().enumerate();
        steps.filter_map(|(step, times)| Some((step, faster(times)?))).collect()
    }

    /// Returns mean milliseconds over the scene, estimated from some steps, of the methods that ran on all of these.
    pub fn means(&self, steps: &[usize], strata: &Strata) -> Vec<(&'static str, f64)> {
        self.summarized(steps, strata, weighted_mean)
    }

    /// Returns median milliseconds over the scene, as [`Times::means`] does.
    pub fn medians(&self, steps: &[usize], strata: &Strata) -> Vec<(&'static str, f64)> {
        self.summarized(steps, strata, weighted_median)
    }

    /// Returns one number for each method that ran on all of these steps, from its times and their weights.
    fn summarized(
        &self,
        steps: &[usize],
        strata: &Strata,
        summary: impl Fn(Vec<f64>, &[f64]) -> f64,
    ) -> Vec<(&'static str, f64)> {
        let mut summaries: Vec<(&'static str, f64)> = Vec::new();
        if steps.is_empty() {
            return summaries;
        }
        let weights = strata.weights(steps);
        for (at, column) in COLUMNS.iter().enumerate() {
            let times: Option<Vec<f64>> = steps.iter().map(|&step| self.interleaved[step][at]).collect();
            let Some(times) = times else { continue };
            let own = summary(times, &weights);
            match summaries.iter_mut().find(|(key, _)| *key == column.key) {
                Some((_, known)) => *known = known.min(own),
                None => summaries.push((column.key, own)),
            }
        }
        if !self.kinetic.is_empty() {
            let times = steps.iter().map(|step| self.kinetic[*step]).collect();
            summaries.push((KINETIC, summary(times, &weights)));
        }
        summaries
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Stratum;

    #[test]
    fn means_are_of_the_same_steps_and_the_better_of_two_engines() {
        let row = |common: f64| {
            let mut times = 0.0;
            COLUMNS
                .iter()
                .map(|_| {
                    times += 1.0;
                    Some(common + times)
                })
                .collect::<Vec<_>>()
        };
        let mut partial = row(0.0);
        partial[0] = None;
        let kinetic = vec![1.0, 3.0, 9.0];
        let times = Times { compared: vec![0, 1], interleaved: vec![row(0.0), row(2.0), partial], kinetic };
        let strata = Strata::new(vec![Stratum::RootCertified; 3], None);
        let means = times.means(&[0, 1], &strata);
        let of =
            |means: &[(&str, f64)], key: &str| means.iter().find(|mean| mean.0 == key).map(|mean| mean.1);
        let at = COLUMNS.iter().position(|column| column.key == "parry").unwrap();
        assert_eq!((of(&means, "parry"), of(&means, COLUMNS[0].key)), (Some(at as f64 + 2.0), Some(2.0)));
        assert_eq!(of(&times.means(&[0, 2], &strata), COLUMNS[0].key), None);
        assert_eq!(of(&means, "kinetic"), Some(2.0));
        assert!(times.means(&[], &strata).is_empty() && times.medians(&[], &strata).is_empty());
        // One step represents three of the scene, the other one itself.
        let strata = Strata::new(
            vec![Stratum::RootCertified, Stratum::Colliding, Stratum::Colliding],
            Some([3, 0, 1]),
        );
        let means = times.means(&[0, 1], &strata);
        assert_eq!((of(&means, COLUMNS[0].key), of(&means, "kinetic")), (Some(1.5), Some(1.5)));
        // The median of times 1 and 3is 1, which has three quarters of the weight.
        let medians = times.medians(&[0, 1], &strata);
        assert_eq!((of(&medians, COLUMNS[0].key), of(&medians, "kinetic")), (Some(1.0), Some(1.0)));
        // The times contain each step on which the method ran, and no other.
        assert_eq!(times.of(COLUMNS[0].key), [(0, 1.0), (1, 3.0)]);
        assert_eq!(times.of("parry")[1], (1, at as f64 + 3.0));
        assert_eq!(times.of("kinetic"), [(0, 1.0), (1, 3.0), (2, 9.0)]);
    }
}
