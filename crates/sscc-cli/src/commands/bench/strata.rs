//! Which steps of a scene are measured and compared, and how much each of them counts.
//!
//! A query costs nanoseconds where the root's certificate holds and milliseconds where bodies nearly touch, and in most
//! scenes the first is by far the most frequent. So steps fall into three strata, and means are those of stratified
//! sampling (Cochran 1977, *Sampling Techniques*, chapter 5): the mean of each stratum counts by the stratum's share of
//! the whole scene, however many of its steps were drawn. Such a mean estimates the one over the whole scene without
//! bias, as far as the measured steps of a stratum represent the others.

use std::cmp::Reverse;
use std::ops::Range;

use super::random::Random;

/// Steps are measured in so many blocks, one in each of as many equal parts of the scene.
const BLOCKS: usize = 10;

const SEED: u64 = 13;

/// What a step is, all bodies together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stratum {
    /// The root's certificate proves every body free.
    RootCertified,
    /// It fails for some body, and none collides.
    RootFailed,
    /// Some body collides with itself.
    Colliding,
}

/// Number of steps of each stratum.
pub type Counts = [usize; 3];

impl Stratum {
    pub fn of(root_failed: bool, colliding: bool) -> Self {
        match (colliding, root_failed) {
            (true, _) => Self::Colliding,
            (false, true) => Self::RootFailed,
            (false, false) => Self::RootCertified,
        }
    }

    /// Number of steps of each.
    pub fn counts(steps: impl IntoIterator<Item = Self>) -> Counts {
        let mut counts = [0; 3];
        steps.into_iter().for_each(|stratum| counts[stratum as usize] += 1);
        counts
    }
}

/// The strata of some steps of a scene.
pub struct Strata {
    /// Of each step.
    of: Vec<Stratum>,
    /// Of all steps of the scene.
    scene: Counts,
}

impl Strata {
    /// `scene` counts all steps of the scene; none where the given steps are all there is.
    pub fn new(of: Vec<Stratum>, scene: Option<Counts>) -> Self {
        let scene = scene.unwrap_or_else(|| Stratum::counts(of.iter().copied()));
        Self { of, scene }
    }

    /// Steps of the whole scene.
    pub fn scene(&self) -> Counts {
        self.scene
    }

    /// Of some of the steps.
    pub fn counts(&self, steps: &[usize]) -> Counts {
        Stratum::counts(steps.iter().map(|step| self.of[*step]))
    }

    /// At most `count` of the steps, ascending: equally many of each stratum that occurs, as far as it has steps, and at
    /// least one. In most scenes the root certifies nearly all steps, and these cost nearly the same. The others differ;
    /// drawn in proportion, they would be one or two.
    pub fn draw(&self, count: usize) -> Vec<usize> {
        self.draw_by(count, &mut Random(SEED))
    }

    /// In each stratum one step in each of equally long stretches, at a random place that is the same in all of them:
    /// every step of the stratum is drawn with the same probability.
    fn draw_by(&self, count: usize, random: &mut Random) -> Vec<usize> {
        let own = |stratum: usize| -> Vec<usize> {
            (0..self.of.len()).filter(|step| self.of[*step] as usize == stratum).collect()
        };
        let mut strata: Vec<Vec<usize>> = (0..3).map(own).filter(|steps| !steps.is_empty()).collect();
        // What a small stratum cannot use is left to the larger ones.
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

    /// How much each of some steps counts in a mean over the scene. The strata that are among them count by their
    /// number of steps in the scene.
    pub fn weights(&self, steps: &[usize]) -> Vec<f64> {
        let counts = self.counts(steps);
        let weight = |step: &usize| {
            let stratum = self.of[*step] as usize;
            self.scene[stratum] as f64 / counts[stratum] as f64
        };
        steps.iter().map(weight).collect()
    }

    /// Names the strata of the scene that none of the steps is in: means leave them out.
    pub fn missing(&self) -> Option<String> {
        let counts = Stratum::counts(self.of.iter().copied());
        let names = ["the root certifies", "the root leaves open", "collide"];
        let missing: Vec<String> = (0..3)
            .filter(|stratum| counts[*stratum] == 0 && self.scene[*stratum] > 0)
            .map(|stratum| format!("none of the {} steps that {}", self.scene[stratum], names[stratum]))
            .collect();
        (!missing.is_empty()).then(|| format!("{} is measured: take more by --steps", missing.join(" and ")))
    }
}

/// The mean of values, each of which counts by its weight.
pub fn weighted_mean(values: impl IntoIterator<Item = f64>, weights: &[f64]) -> f64 {
    let sum: f64 = values.into_iter().zip(weights).map(|(value, weight)| value * weight).sum();
    sum / weights.iter().sum::<f64>()
}

/// Numbers of `wanted` of the steps of a scene, in blocks of consecutive ones, one in each of [`BLOCKS`] equal parts of
/// the scene.
///
/// All blocks begin equally far into their parts: where they meet most strata, then where they have most steps of the
/// strata that are rare (a landing may be all that is not certified, and a block has to hold enough of it to represent
/// it), and then where the strata's shares are nearest to those of the scene. If a stratum is still missing, a block is
/// moved to it within its part. Strata alone decide, never costs, and weights correct the shares of rare strata.
pub fn blocks(of: &[Stratum], wanted: usize) -> Vec<usize> {
    let wanted = wanted.min(of.len());
    let layout = Layout::new(of, BLOCKS.min(wanted), wanted);
    let count = layout.blocks.len();
    let farthest = layout.blocks.iter().map(|block| block.slack).max().unwrap_or(0);
    let shifted = (0..=farthest).map(|shift| vec![shift; count]);
    let Some(mut shifts) = shifted.max_by_key(|shifts| layout.fitness(shifts)) else { return Vec::new() };
    let moved = |shifts: &[usize]| {
        let places =
            (0..count).flat_map(|block| (0..=layout.blocks[block].slack).map(move |shift| (block, shift)));
        let at = |(block, shift): (usize, usize)| {
            let mut shifts = shifts.to_vec();
            shifts[block] = shift;
            shifts
        };
        places.map(at).max_by_key(|shifts| layout.fitness(shifts))
    };
    let present = layout.scene.iter().filter(|steps| **steps > 0).count();
    while layout.fitness(&shifts).0 < present {
        match moved(&shifts) {
            Some(better) if layout.fitness(&better).0 > layout.fitness(&shifts).0 => shifts = better,
            _ => break,
        }
    }
    layout.steps(&shifts).flatten().collect()
}

/// Where blocks may be.
struct Layout {
    blocks: Vec<Block>,
    /// Before each step, the steps of each stratum.
    before: Vec<Counts>,
    scene: Counts,
    wanted: usize,
}

struct Block {
    /// The first step of its part of the scene.
    start: usize,
    length: usize,
    /// How far it may begin behind the start.
    slack: usize,
}

impl Layout {
    fn new(of: &[Stratum], count: usize, wanted: usize) -> Self {
        let mut before = vec![[0; 3]];
        for stratum in of {
            let mut counts = before[before.len() - 1];
            counts[*stratum as usize] += 1;
            before.push(counts);
        }
        let mut longer = wanted.checked_rem(count).unwrap_or(0);
        let blocks = (0..count).map(|block| {
            let [start, end] = [block, block + 1].map(|block| block * of.len() / count);
            // Parts differ by a step where the scene cannot be divided; the longer ones have room for longer blocks.
            let length = wanted / count;
            let length = length + usize::from(longer > 0 && end - start > length);
            longer -= length - wanted / count;
            Block { start, length, slack: end - start - length }
        });
        Self { blocks: blocks.collect(), scene: before[of.len()], before, wanted }
    }

    fn steps(&self, shifts: &[usize]) -> impl Iterator<Item = Range<usize>> {
        self.blocks.iter().zip(shifts).map(|(Block { start, length, slack }, shift)| {
            let start = start + shift.min(slack);
            start..start + length
        })
    }

    /// How many strata are in the blocks; how many steps of each, up to half of an even part; and how near their shares
    /// are to those of the scene. Of equal ones the smallest shifts are best.
    fn fitness(&self, shifts: &[usize]) -> (usize, usize, Reverse<usize>, Reverse<usize>) {
        let mut counts = [0; 3];
        for steps in self.steps(shifts) {
            let [from, to] = [self.before[steps.start], self.before[steps.end]];
            (0..3).for_each(|stratum| counts[stratum] += to[stratum] - from[stratum]);
        }
        let all: usize = self.scene.iter().sum();
        let apart = (0..3).map(|h| (counts[h] * all).abs_diff(self.scene[h] * self.wanted)).sum();
        let met = counts.iter().filter(|steps| **steps > 0).count();
        let enough = self.wanted.div_ceil(2 * counts.len());
        let steps = counts.iter().map(|steps| (*steps).min(enough)).sum();
        (met, steps, Reverse(apart), Reverse(shifts.iter().sum()))
    }
}

#[cfg(test)]
mod tests {
    use super::Stratum::{Colliding, RootCertified, RootFailed};
    use super::*;

    /// Stretches of strata.
    fn scene(stretches: &[(Stratum, usize)]) -> Vec<Stratum> {
        stretches.iter().flat_map(|(stratum, steps)| vec![*stratum; *steps]).collect()
    }

    /// As of a dragon that lands early and then lies still.
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
    fn each_stratum_is_drawn_and_counts_by_its_share_of_the_scene() {
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
        // Also of some steps of a scene, where the strata have other shares.
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
        // Fewer than are wanted, and than there are strata.
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
    fn blocks_are_spread_over_the_scene() {
        let still = vec![RootCertified; 600];
        assert_eq!(blocks(&still, 20)[..4], [0, 1, 60, 61]);
        assert_eq!(blocks(&still, 3), [0, 200, 400]);
        assert_eq!(blocks(&still, 12)[..5], [0, 1, 60, 61, 120]);
        assert!(blocks(&[], 20).is_empty());
        for (steps, wanted) in
            [(600, 1), (600, 10), (600, 33), (600, 599), (600, 600), (600, 10_000), (605, 604), (609, 593)]
        {
            let chosen = blocks(&landing()[..steps], wanted);
            assert_eq!(chosen.len(), wanted.min(steps));
            assert!(chosen.windows(2).all(|pair| pair[0] < pair[1]) && chosen.iter().all(|i| *i < steps));
            // One block in each part.
            let blocks = wanted.min(10);
            for block in 0..blocks {
                let part = block * steps / blocks..(block + 1) * steps / blocks;
                assert!(chosen.iter().any(|step| part.contains(step)), "{wanted}");
            }
        }
    }

    #[test]
    fn blocks_meet_each_stratum() {
        let of = landing();
        for wanted in [20, 100, 200, 2000] {
            let steps = blocks(&of, wanted);
            let counts = Stratum::counts(steps.iter().map(|step| of[*step]));
            assert!(counts.iter().all(|steps| *steps > 0), "{wanted}: {counts:?}");
            assert!(
                Strata::new(steps.iter().map(|step| of[*step]).collect(), Some([7771, 174, 55]))
                    .missing()
                    .is_none()
            );
        }
        // A block holds most of the only landing.
        let counts = Stratum::counts(blocks(&of, 2000).iter().map(|step| of[*step]));
        assert_eq!(counts, [1800, 145, 55]);
        // Where no stratum is rare, they have the shares of the scene.
        let swing = scene(&[(RootCertified, 290), (RootFailed, 30), (Colliding, 40), (RootFailed, 30)]);
        let of: Vec<Stratum> = std::iter::repeat_n(swing, 50).flatten().collect();
        let counts = Stratum::counts(blocks(&of, 4000).iter().map(|step| of[*step]));
        let shares = Stratum::counts(of).map(|steps| steps * 4000 / (50 * 390));
        assert!((0..3).all(|h| counts[h].abs_diff(shares[h]) < 200), "{counts:?} {shares:?}");
        // Single steps at different places of their parts: no common shift meets both.
        let mut of = vec![RootCertified; 1000];
        (of[17], of[860]) = (Colliding, RootFailed);
        let steps = blocks(&of, 50);
        assert!(steps.contains(&17) && steps.contains(&860), "{steps:?}");
        assert_eq!(steps.len(), 50);
    }

    #[test]
    fn what_is_missing_is_told() {
        let strata = Strata::new(vec![RootCertified; 10], Some([700, 90, 10]));
        assert_eq!(
            strata.missing().unwrap(),
            "none of the 90 steps that the root leaves open and none of the 10 steps that collide is measured: take \
             more by --steps"
        );
        assert!(Strata::new(vec![Colliding], None).missing().is_none());
    }
}
