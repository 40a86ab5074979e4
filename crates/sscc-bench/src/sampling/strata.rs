//! Strata of the steps of a scene: the choice of compared steps, and their weights.
//!
//! A query costs nanoseconds where the root's certificate holds and milliseconds where bodies nearly touch. In most
//! scenes the first case is by far the most frequent. Steps are therefore divided into three strata, and means are
//! those of stratified sampling (Cochran 1977, *Sampling Techniques*, chapter 5): the mean of each stratum is weighted
//! by the stratum's share of the whole scene, for any number of drawn steps. Such a mean is an unbiased estimate of the
//! mean over the whole scene if the measured steps of a stratum represent the others. Experiment:
//! docs/notes/measuring.md#strata.

use crate::random::Random;

const SEED: u64 = 13;

/// Stratum of a step, all bodies together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stratum {
    /// The root's certificate proves every body free.
    RootCertified,
    /// The root's certificate fails for some body, and no body collides with itself.
    RootFailed,
    /// Some body collides with itself.
    Colliding,
}

/// Number of steps of each stratum.
pub type Counts = [usize; 3];

impl Stratum {
    /// Returns the stratum of a step, given whether some body's root certificate fails and whether some body collides.
    pub fn of(root_failed: bool, colliding: bool) -> Self {
        match (colliding, root_failed) {
            (true, _) => Self::Colliding,
            (false, true) => Self::RootFailed,
            (false, false) => Self::RootCertified,
        }
    }

    /// Returns the number of steps of each stratum.
    pub fn counts(steps: impl IntoIterator<Item = Self>) -> Counts {
        let mut counts = [0; 3];
        steps.into_iter().for_each(|stratum| counts[stratum as usize] += 1);
        counts
    }
}

/// The strata of some steps of a scene.
#[derive(Clone, Debug)]
pub struct Strata {
    /// Stratum of each step.
    of: Vec<Stratum>,
    /// Counts of all steps of the scene.
    scene: Counts,
}

impl Strata {
    /// Creates the strata of some steps. `scene` counts all steps of the scene; None if the given steps are the whole
    /// scene.
    pub fn new(of: Vec<Stratum>, scene: Option<Counts>) -> Self {
        let scene = scene.unwrap_or_else(|| Stratum::counts(of.iter().copied()));
        Self { of, scene }
    }

    /// Returns the counts of the whole scene.
    pub fn scene(&self) -> Counts {
        self.scene
    }

    /// Returns the counts of some of the steps.
    pub fn counts(&self, steps: &[usize]) -> Counts {
        Stratum::counts(steps.iter().map(|step| self.of[*step]))
    }

    /// Draws at most `count` of the steps. Returns them ascending: equally many of each stratum that occurs, or all steps of
    /// a smaller stratum, and at least one. In most scenes the root certifies nearly all steps, which cost nearly the same. A
    /// proportional draw would contain only one or two of the other steps, whose costs differ.
    pub fn draw(&self, count: usize) -> Vec<usize> {
        self.draw_by(count, &mut Random(SEED))
    }

    /// Draws with this generator. Each stratum is divided into stretches of equal length, and one step is drawn in
    /// each, at a random place that is the same in all stretches. Every step of a stratum thus has the same
    /// probability.
    fn draw_by(&self, count: usize, random: &mut Random) -> Vec<usize> {
        let own = |stratum: usize| -> Vec<usize> {
            (0..self.of.len()).filter(|step| self.of[*step] as usize == stratum).collect()
        };
        let mut strata: Vec<Vec<usize>> = (0..3).map(own).filter(|steps| !steps.is_empty()).collect();
        // Larger strata get the share of the draw that a small stratum cannot fill.
        strata.sort_by_key(Vec::len);
        let mut drawn = Vec::new();
        for (at, steps) in strata.iter().enumerate() {
            let count = (count - drawn.len()).div_ceil(strata.len() - at).min(steps.len());
            let place = random.uniform();
            let stretch = steps.len() as f64 / count.max(1) as f64;
            let step = |i: usize| steps[(((i as f64 + place) * stretch) as usize).min(steps.len() - 1)];
            drawn.extend((0..count).map(step));
        }
        drawn.sort_unstable();
        drawn
    }

    /// Returns the weight of each of some steps in a mean over the scene. Each stratum among them is weighted by its
    /// number of steps in the scene.
    pub fn weights(&self, steps: &[usize]) -> Vec<f64> {
        let counts = self.counts(steps);
        let weight = |step: &usize| {
            let stratum = self.of[*step] as usize;
            self.scene[stratum] as f64 / counts[stratum] as f64
        };
        steps.iter().map(weight).collect()
    }

    /// Returns a note that names the strata of the scene without a measured step; means exclude them. None if no stratum is
    /// missing.
    pub fn missing(&self) -> Option<String> {
        let counts = Stratum::counts(self.of.iter().copied());
        let names =
            ["the root's certificate proves free", "are free where the root's certificate fails", "collide"];
        let missing: Vec<String> = (0..3)
            .filter(|stratum| counts[*stratum] == 0 && self.scene[*stratum] > 0)
            .map(|stratum| format!("none of the {} steps that {}", self.scene[stratum], names[stratum]))
            .collect();
        (!missing.is_empty())
            .then(|| format!("{} is measured: choose more with --steps", missing.join(" and ")))
    }
}

/// Returns the weighted mean of values.
pub fn weighted_mean(values: impl IntoIterator<Item = f64>, weights: &[f64]) -> f64 {
    let sum: f64 = values.into_iter().zip(weights).map(|(value, weight)| value * weight).sum();
    sum / weights.iter().sum::<f64>()
}

/// Returns the weighted median of values: the smallest value such that it and all smaller ones have half of the weight.
pub fn weighted_median(values: impl IntoIterator<Item = f64>, weights: &[f64]) -> f64 {
    let mut values: Vec<(f64, f64)> = values.into_iter().zip(weights.iter().copied()).collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = weights.iter().sum::<f64>() / 2.0;
    let mut below = 0.0;
    let median = values.iter().find(|(_, weight)| {
        below += weight;
        below >= half
    });
    median.or(values.last()).map_or(f64::NAN, |(value, _)| *value)
}

#[cfg(test)]
mod tests {
    use super::Stratum::{Colliding, RootCertified, RootFailed};
    use super::*;

    /// Returns the strata of consecutive stretches of steps.
    fn scene(stretches: &[(Stratum, usize)]) -> Vec<Stratum> {
        stretches.iter().flat_map(|(stratum, steps)| vec![*stratum; *steps]).collect()
    }

    /// Returns the strata of a dragon that lands early and then lies still.
    fn landing() -> Vec<Stratum> {
        scene(&[
            (RootCertified, 310),
            (RootFailed, 90),
            (Colliding, 55),
            (RootFailed, 84),
            (RootCertified, 7461),
        ])
    }

    #[test]
    fn each_stratum_is_drawn_and_weighted_by_its_share_of_the_scene() {
        let strata = Strata::new(landing(), None);
        let drawn = strata.draw(20);
        assert_eq!((drawn.len(), strata.counts(&drawn)), (20, [6, 7, 7]));
        assert!(drawn.windows(2).all(|pair| pair[0] < pair[1]));
        let weights = strata.weights(&drawn);
        assert!((weights.iter().sum::<f64>() - 8000.0).abs() < 1e-9);
        // Where costs are the same within each stratum, the mean is that of the scene.
        let cost = |step: &usize| [1e-5, 8.0, 9.0][strata.of[*step] as usize];
        let whole = (0..8000).map(|step| cost(&step)).sum::<f64>() / 8000.0;
        let mean = weighted_mean(drawn.iter().map(cost), &weights);
        assert!((mean / whole - 1.0).abs() < 1e-12, "{mean} {whole}");
        // The same holds for a part of a scene, in which the strata have other shares.
        let some: Vec<usize> = (300..600).collect();
        let strata = Strata::new(some.iter().map(|step| strata.of[*step]).collect(), Some(strata.scene()));
        let drawn = strata.draw(20);
        let mean = weighted_mean(drawn.iter().map(|step| cost(&some[*step])), &strata.weights(&drawn));
        assert!((mean / whole - 1.0).abs() < 1e-12, "{mean} {whole}");
        let all: Vec<usize> = (0..300).collect();
        let mean = weighted_mean(some.iter().map(cost), &strata.weights(&all));
        assert!((mean / whole - 1.0).abs() < 1e-12, "{mean} {whole}");
    }

    #[test]
    fn a_stratum_of_one_step_is_drawn() {
        let of = scene(&[(RootCertified, 500), (Colliding, 1), (RootCertified, 300), (RootFailed, 2)]);
        let strata = Strata::new(of, None);
        let drawn = strata.draw(20);
        assert_eq!(strata.counts(&drawn), [17, 2, 1]);
        let weight = |step: usize| strata.weights(&drawn)[drawn.binary_search(&step).unwrap()];
        assert_eq!((weight(500), weight(801)), (1.0, 1.0));
        // Draws of fewer steps than strata, and from fewer steps than requested.
        assert_eq!(strata.counts(&strata.draw(3)), [1, 1, 1]);
        assert_eq!(strata.counts(&strata.draw(2)), [0, 1, 1]);
        let few = Strata::new(scene(&[(Colliding, 2), (RootFailed, 3)]), None);
        assert_eq!((few.draw(20), few.weights(&few.draw(20))), ((0..5).collect(), vec![1.0; 5]));
        assert!(Strata::new(Vec::new(), None).draw(20).is_empty());
    }

    #[test]
    fn means_are_unbiased() {
        // Costs that grow within each stratum, so that it matters which steps are drawn.
        let strata = Strata::new(landing(), None);
        let cost = |step: usize| (1.0 + step as f64) * [1e-4, 1.0, 3.0][strata.of[step] as usize];
        let whole = (0..8000).map(cost).sum::<f64>() / 8000.0;
        let mut sum = 0.0;
        let mut random = Random(1);
        for _ in 0..4000 {
            let drawn = strata.draw_by(20, &mut random);
            sum += weighted_mean(drawn.iter().map(|step| cost(*step)), &strata.weights(&drawn));
        }
        assert!((sum / 4000.0 / whole - 1.0).abs() < 1e-3, "{} {whole}", sum / 4000.0);
    }

    #[test]
    fn missing_strata_are_named() {
        let strata = Strata::new(vec![RootCertified; 10], Some([700, 90, 10]));
        assert_eq!(
            strata.missing().unwrap(),
            "none of the 90 steps that are free where the root's certificate fails and none of the 10 steps that collide \
             is measured: choose more with --steps"
        );
        assert!(Strata::new(vec![Colliding], None).missing().is_none());
    }

    #[test]
    fn medians_have_half_of_the_weight() {
        assert_eq!(weighted_median([3.0, 1.0, 2.0], &[1.0, 1.0, 1.0]), 2.0);
        assert_eq!(weighted_median([3.0, 1.0, 2.0], &[5.0, 1.0, 1.0]), 3.0);
        assert_eq!(weighted_median([3.0, 1.0], &[1.0, 1.0]), 1.0);
        assert!(weighted_median([], &[]).is_nan());
    }
}
