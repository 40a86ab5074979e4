//! Chooses the measured steps of a scene: blocks of consecutive steps, spread over the scene.

use std::cmp::Reverse;
use std::ops::Range;

use super::strata::{Counts, Stratum};

/// Number of blocks. The scene is divided into as many equal parts, with one block in each.
const BLOCKS: usize = 10;

/// Chooses `wanted` steps of a scene, in blocks of consecutive steps, one in each of ten equal parts of the scene.
/// Returns their numbers, ascending.
///
/// All blocks begin equally far into their parts. The shift is the one with the most strata in the blocks, then with the most
/// steps of rare strata (a single landing may contain all steps that are not certified), then with shares of the strata
/// nearest to those of the scene. If a stratum is still missing, one block is shifted to it within its part. The choice
/// depends on strata only, never on costs. Weights correct the shares of rare strata.
pub fn blocks(of: &[Stratum], wanted: usize) -> Vec<usize> {
    let wanted = wanted.min(of.len());
    let layout = Layout::new(of, BLOCKS.min(wanted), wanted);
    let count = layout.blocks.len();
    let max_shift = layout.blocks.iter().map(|block| block.max_shift).max().unwrap_or(0);
    let shifted = (0..=max_shift).map(|shift| vec![shift; count]);
    let Some(mut shifts) = shifted.max_by_key(|shifts| layout.fitness(shifts)) else { return Vec::new() };
    let moved = |shifts: &[usize]| {
        let places = (0..count)
            .flat_map(|block| (0..=layout.blocks[block].max_shift).map(move |shift| (block, shift)));
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

/// Possible places of the blocks.
struct Layout {
    blocks: Vec<Block>,
    /// For each step, the number of earlier steps of each stratum.
    before: Vec<Counts>,
    scene: Counts,
    wanted: usize,
}

struct Block {
    /// The first step of its part of the scene.
    start: usize,
    length: usize,
    /// Maximum shift of the block from the start of its part.
    max_shift: usize,
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
            // Parts may differ by one step; longer parts have room for longer blocks.
            let length = wanted / count;
            let length = length + usize::from(longer > 0 && end - start > length);
            longer -= length - wanted / count;
            Block { start, length, max_shift: end - start - length }
        });
        Self { blocks: blocks.collect(), scene: before[of.len()], before, wanted }
    }

    fn steps(&self, shifts: &[usize]) -> impl Iterator<Item = Range<usize>> {
        self.blocks.iter().zip(shifts).map(|(Block { start, length, max_shift }, shift)| {
            let start = start + shift.min(max_shift);
            start..start + length
        })
    }

    /// Rates shifts: the number of strata in the blocks; the number of steps of each stratum, up to half of an even
    /// share; the difference of the shares from those of the scene; the sum of the shifts (smaller is better).
    fn fitness(&self, shifts: &[usize]) -> (usize, usize, Reverse<usize>, Reverse<usize>) {
        let mut counts = [0; 3];
        for steps in self.steps(shifts) {
            let [from, to] = [self.before[steps.start], self.before[steps.end]];
            (0..3).for_each(|stratum| counts[stratum] += to[stratum] - from[stratum]);
        }
        let all: usize = self.scene.iter().sum();
        let difference = (0..3).map(|h| (counts[h] * all).abs_diff(self.scene[h] * self.wanted)).sum();
        let present = counts.iter().filter(|steps| **steps > 0).count();
        let enough = self.wanted.div_ceil(2 * counts.len());
        let steps = counts.iter().map(|steps| (*steps).min(enough)).sum();
        (present, steps, Reverse(difference), Reverse(shifts.iter().sum()))
    }
}

/// Returns at most `count` numbers below `end`, evenly spread.
pub fn evenly_spread(end: usize, count: usize) -> impl Iterator<Item = usize> {
    let count = count.min(end);
    (0..count).map(move |i| i * end / count)
}

#[cfg(test)]
mod tests {
    use super::super::strata::Strata;
    use super::super::strata::Stratum::{Colliding, RootCertified, RootFailed};
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
    fn blocks_contain_each_stratum() {
        let of = landing();
        for wanted in [20, 100, 200, 2000] {
            let steps = blocks(&of, wanted);
            let counts = Stratum::counts(steps.iter().map(|step| of[*step]));
            assert!(counts.iter().all(|steps| *steps > 0), "{wanted}: {counts:?}");
            let strata = Strata::new(steps.iter().map(|step| of[*step]).collect(), Some([7771, 174, 55]));
            assert!(strata.missing().is_none());
        }
        // A block holds most of the only landing.
        let counts = Stratum::counts(blocks(&of, 2000).iter().map(|step| of[*step]));
        assert_eq!(counts, [1800, 145, 55]);
        // If no stratum is rare, the blocks have the shares of the scene.
        let swing = scene(&[(RootCertified, 290), (RootFailed, 30), (Colliding, 40), (RootFailed, 30)]);
        let of: Vec<Stratum> = std::iter::repeat_n(swing, 50).flatten().collect();
        let counts = Stratum::counts(blocks(&of, 4000).iter().map(|step| of[*step]));
        let shares = Stratum::counts(of).map(|steps| steps * 4000 / (50 * 390));
        assert!((0..3).all(|h| counts[h].abs_diff(shares[h]) < 200), "{counts:?} {shares:?}");
        // Single steps at different places of their parts: no common shift contains both.
        let mut of = vec![RootCertified; 1000];
        (of[17], of[860]) = (Colliding, RootFailed);
        let steps = blocks(&of, 50);
        assert!(steps.contains(&17) && steps.contains(&860), "{steps:?}");
        assert_eq!(steps.len(), 50);
    }

    #[test]
    fn numbers_are_spread_evenly() {
        let spread = |end, count| evenly_spread(end, count).collect::<Vec<_>>();
        assert_eq!(spread(10, 4), [0, 2, 5, 7]);
        assert_eq!(spread(10, 20), (0..10).collect::<Vec<_>>());
        assert!(spread(0, 3).is_empty());
    }
}
