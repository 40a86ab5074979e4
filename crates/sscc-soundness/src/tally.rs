//! Counters of answers and of failures of a path.

use std::collections::BTreeMap;

/// Maximum number of failures that are kept as messages. All failures are counted.
const MOST_MESSAGES: usize = 20;

/// The counters of a path.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Number of answers compared.
    pub done: u64,
    /// How often each inner path was reached.
    pub reached: BTreeMap<String, u64>,
    /// Number of failures in which colliding pairs were reported as free.
    pub false_negatives: u64,
    /// Number of failures in which listed pairs do not collide, and of other wrong answers.
    pub wrong: u64,
    /// Messages of the first failures.
    pub messages: Vec<String>,
}

impl Tally {
    /// Counts a compared answer.
    pub fn answer(&mut self) {
        self.done += 1;
    }

    /// Counts an inner path.
    pub fn reach(&mut self, path: &str) {
        self.reach_by(path, 1);
    }

    /// Counts an inner path several times.
    pub fn reach_by(&mut self, path: &str, count: u64) {
        match self.reached.get_mut(path) {
            Some(sum) => *sum += count,
            None => _ = self.reached.insert(path.to_owned(), count),
        }
    }

    /// Counts an inner path if a condition holds.
    pub fn reach_if(&mut self, is_reached: bool, path: &str) {
        if is_reached {
            self.reach(path);
        }
    }

    /// Records a missed collision.
    pub fn false_negative(&mut self, message: impl FnOnce() -> String) {
        self.false_negatives += 1;
        self.keep(message);
    }

    /// Records a wrong answer of any other kind.
    pub fn wrong(&mut self, message: impl FnOnce() -> String) {
        self.wrong += 1;
        self.keep(message);
    }

    fn keep(&mut self, message: impl FnOnce() -> String) {
        if self.messages.len() < MOST_MESSAGES {
            self.messages.push(message());
        }
    }

    /// Compares sorted lists of pairs.
    pub fn compare<P: PartialEq + std::fmt::Debug>(
        &mut self,
        found: &[P],
        exact: &[P],
        place: impl Fn() -> String,
    ) {
        self.answer();
        self.reach_if(!exact.is_empty(), "colliding");
        if found == exact {
            return;
        }
        let missing: Vec<&P> = exact.iter().filter(|pair| !found.contains(pair)).collect();
        let extra: Vec<&P> = found.iter().filter(|pair| !exact.contains(pair)).collect();
        if !missing.is_empty() {
            self.false_negative(|| format!("{}: {} missing: {:?}", place(), missing.len(), first(&missing)));
        }
        if !extra.is_empty() || missing.is_empty() {
            self.wrong(|| format!("{}: {} wrong or out of order: {:?}", place(), extra.len(), first(&extra)));
        }
    }

    /// Adds the counters of another configuration.
    pub fn add(&mut self, other: Self) {
        self.done += other.done;
        self.false_negatives += other.false_negatives;
        self.wrong += other.wrong;
        other.reached.iter().for_each(|(path, count)| self.reach_by(path, *count));
        other.messages.into_iter().for_each(|message| self.keep(|| message));
    }

    /// Whether no failure was counted.
    pub fn is_clean(&self) -> bool {
        self.false_negatives == 0 && self.wrong == 0
    }
}

fn first<T>(list: &[T]) -> &[T] {
    &list[..list.len().min(4)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_and_extra_pairs_are_counted_separately() {
        let mut tally = Tally::default();
        tally.compare(&[1, 2], &[1, 2], String::new);
        assert!(tally.is_clean());
        tally.compare(&[1], &[1, 2], String::new);
        tally.compare(&[1, 3], &[1], String::new);
        tally.compare(&[2, 1], &[1, 2], String::new);
        assert_eq!((tally.done, tally.false_negatives, tally.wrong), (4, 1, 2));
        assert_eq!(tally.messages.len(), 3);
        let mut sum = Tally::default();
        sum.add(tally);
        assert_eq!((sum.done, sum.reached["colliding"], sum.messages.len()), (4, 4, 3));
    }
}
