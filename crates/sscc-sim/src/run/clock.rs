//! Clock that measures the parts of a step in processor time, which excludes other programs.
//!
//! Reading the processor clock takes a system call, which is too slow for the parts of short steps. One reading of the
//! processor clock therefore serves a block of steps, and the parts of these steps share it in proportion to the wall
//! clock (docs/notes/measuring.md#processor-time). The mean of each part is unbiased: let a part work `c` of the
//! block's `C` seconds, and let another program take `g` seconds at a uniformly distributed moment of the work. The
//! part gets `(c + g) C / (C + g)` with probability `c / C`, else `c C / (C + g)`; the mean is `c`. The error of a
//! single step is at most one block.

use std::time::Instant;

use cpu_time::{ProcessTime, ThreadTime};

use super::history::STEP_PARTS;

/// Minimum duration of a block (s). One reading of the processor clock takes 0.2% of it.
const MIN_BLOCK: f64 = 1e-4;

/// Wall clock and processor clock, in seconds. Tests have their own implementation.
pub trait Clocks {
    /// Returns the wall-clock time (s).
    fn wall(&self) -> f64;
    /// Returns the processor time of all threads that work on a step (s).
    fn processor(&self) -> f64;
    /// Whether one thread does all the work. The parts then share processor time in proportion to wall-clock time.
    fn is_one_thread(&self) -> bool;
}

/// The clocks of this machine.
pub struct SystemClocks {
    begin: Instant,
    is_one_thread: bool,
}

impl SystemClocks {
    /// Creates clocks of this thread if it does all the work, else of the whole process. The latter include other
    /// simulations in the process.
    pub fn new(is_one_thread: bool) -> Self {
        Self { begin: Instant::now(), is_one_thread }
    }
}

impl Clocks for SystemClocks {
    fn wall(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    fn processor(&self) -> f64 {
        let time = if self.is_one_thread {
            ThreadTime::now().as_duration()
        } else {
            ProcessTime::now().as_duration()
        };
        time.as_secs_f64()
    }

    fn is_one_thread(&self) -> bool {
        self.is_one_thread
    }
}

/// Times the parts of steps, block by block.
pub struct StepClock<C> {
    clocks: C,
    /// The current part, and the time at which it began.
    part: Option<usize>,
    since: f64,
    /// The parts of this step, before they are scaled.
    parts: [f64; STEP_PARTS.len()],
    /// Wall-clock and processor time at which the block began.
    block: Option<[f64; 2]>,
}

/// Times of the parts of a step, and its wall-clock time (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTimes {
    /// Times of the parts, to be multiplied by the factor of their block, from [`StepClock::end_block`].
    pub parts: [f64; STEP_PARTS.len()],
    pub wall: f64,
}

impl<C: Clocks> StepClock<C> {
    pub fn new(clocks: C) -> Self {
        Self { clocks, part: None, since: 0.0, parts: [0.0; STEP_PARTS.len()], block: None }
    }

    /// Begins a step. Returns its wall-clock time.
    pub fn begin(&mut self) -> f64 {
        if self.block.is_none() {
            // The wall clock is read last, so that the block excludes the reading of the processor clock.
            let processor = self.clocks.processor();
            self.block = Some([self.clocks.wall(), processor]);
        }
        (self.part, self.parts) = (None, [0.0; STEP_PARTS.len()]);
        self.clocks.wall()
    }

    /// Begins a part; None ends the current part.
    pub fn enter(&mut self, part: Option<usize>) {
        // With several threads, some parts run on one thread: wall-clock time is then not proportional to processor
        // time.
        let now = if self.clocks.is_one_thread() { self.clocks.wall() } else { self.clocks.processor() };
        if let Some(part) = self.part {
            self.parts[part] += now - self.since;
        }
        (self.part, self.since) = (part, now);
    }

    /// Ends the step that began at `begin`.
    pub fn end(&mut self, begin: f64) -> StepTimes {
        self.enter(None);
        StepTimes { parts: self.parts, wall: self.clocks.wall() - begin }
    }

    /// Whether the block has lasted long enough for a reading of the processor's clock.
    pub fn is_due(&self) -> bool {
        self.block.is_some_and(|[wall, _]| self.clocks.wall() - wall >= MIN_BLOCK)
    }

    /// Ends the block. Returns the factor from the times of the parts to processor time.
    pub fn end_block(&mut self) -> f64 {
        let Some([wall, processor]) = self.block.take() else { return 1.0 };
        if !self.clocks.is_one_thread() {
            return 1.0;
        }
        let wall = self.clocks.wall() - wall;
        if wall > 0.0 { (self.clocks.processor() - processor) / wall } else { 1.0 }
    }
}

#[cfg(test)]
pub mod tests {
    use std::cell::Cell;

    use super::*;

    /// Clocks of a thread that other programs interrupt at times. Reading the clocks takes no time.
    #[derive(Default)]
    pub struct Scripted {
        pub wall: Cell<f64>,
        pub processor: Cell<f64>,
        pub several_threads: bool,
    }

    impl Scripted {
        /// Works for some seconds on some threads.
        fn work(&self, seconds: f64, threads: f64) {
            self.wall.set(self.wall.get() + seconds);
            self.processor.set(self.processor.get() + seconds * threads);
        }

        fn wait(&self, seconds: f64) {
            self.wall.set(self.wall.get() + seconds);
        }
    }

    impl Clocks for &Scripted {
        fn wall(&self) -> f64 {
            self.wall.get()
        }

        fn processor(&self) -> f64 {
            self.processor.get()
        }

        fn is_one_thread(&self) -> bool {
            !self.several_threads
        }
    }

    /// Runs a step whose first parts work for the seconds of `work`. Before each part, another program takes the seconds of
    /// `taken`.
    fn step(clock: &mut StepClock<&Scripted>, time: &Scripted, work: &[f64], taken: &[f64]) -> StepTimes {
        let begin = clock.begin();
        for (part, (work, taken)) in work.iter().zip(taken).enumerate() {
            clock.enter(Some(part));
            time.wait(*taken);
            time.work(*work, 1.0);
        }
        clock.end(begin)
    }

    fn is_near(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-9 * b.abs()
    }

    #[test]
    fn an_idle_machine_gives_each_part_its_own_time() {
        let time = Scripted::default();
        let mut clock = StepClock::new(&time);
        let times = step(&mut clock, &time, &[1e-6, 3e-6], &[0.0; 2]);
        assert!(!clock.is_due());
        // Between two steps nothing is timed.
        time.work(5e-4, 1.0);
        let more = step(&mut clock, &time, &[2e-6, 4e-6], &[0.0; 2]);
        assert!(clock.is_due());
        let factor = clock.end_block();
        assert!(is_near(factor, 1.0));
        assert!(is_near(times.parts[0], 1e-6) && is_near(times.parts[1], 3e-6) && is_near(times.wall, 4e-6));
        assert!(is_near(more.parts[0], 2e-6) && is_near(more.wall, 6e-6));
        assert_eq!((clock.is_due(), clock.end_block()), (false, 1.0));
    }

    #[test]
    fn time_of_other_programs_is_no_cost() {
        // Another program takes a thousand times as long as the step works.
        let time = Scripted::default();
        let mut clock = StepClock::new(&time);
        let times = step(&mut clock, &time, &[1e-4, 3e-4], &[0.4, 0.0]);
        let factor = clock.end_block();
        let sum: f64 = times.parts.iter().map(|part| part * factor).sum();
        assert!(is_near(sum, 4e-4), "{sum}");
        assert!(is_near(times.wall, 0.4004));

        // The other program takes the processor in each part with a frequency proportional to the part's duration. The
        // mean of each part is then right.
        let work = [1e-4, 3e-4, 6e-4];
        let mut sums = [0.0; 3];
        for block in 0..10 {
            let taken = match block {
                0 => [0.7, 0.0, 0.0],
                1..4 => [0.0, 0.7, 0.0],
                _ => [0.0, 0.0, 0.7],
            };
            let times = step(&mut clock, &time, &work, &taken);
            let factor = clock.end_block();
            (0..3).for_each(|part| sums[part] += times.parts[part] * factor / 10.0);
        }
        assert!((0..3).all(|part| is_near(sums[part], work[part])), "{sums:?}");
    }

    #[test]
    fn all_threads_count_where_several_work() {
        let time = Scripted { several_threads: true, ..Scripted::default() };
        let mut clock = StepClock::new(&time);
        let begin = clock.begin();
        clock.enter(Some(0));
        time.work(1e-3, 4.0);
        time.wait(0.2);
        clock.enter(Some(1));
        time.work(1e-3, 1.0);
        let times = clock.end(begin);
        assert_eq!(clock.end_block(), 1.0);
        assert!(is_near(times.parts[0], 4e-3) && is_near(times.parts[1], 1e-3), "{times:?}");
        assert!(is_near(times.wall, 0.202));
    }
}
