//! The cost of the parts of a step in processor time, in which other programs do not count.
//!
//! Reading the processor's clock takes a system call, about 0.2 microseconds; reading the wall's clock takes a tenth of
//! that. Parts of short steps last less than either allows, so one reading of the processor's clock serves a block of
//! steps, and the parts of these steps share it in proportion to the wall's clock. That keeps the mean of each part
//! right: let a part work `c` of the block's `C` seconds, and let another program take `g` seconds at a moment that falls
//! on every moment of work alike. The part gets `(c + g) C / (C + g)` with probability `c / C`, else `c C / (C + g)`:
//! `c` in the mean. A single step may get up to a block too much or too little.

use std::time::Instant;

use cpu_time::{ProcessTime, ThreadTime};

use super::history::STEP_PARTS;

/// A block lasts at least so long (s): one reading of the processor's clock is 0.2% of it.
const BLOCK: f64 = 1e-4;

/// Two clocks that tell seconds; tests put their own in place.
pub trait Clocks {
    fn wall(&self) -> f64;
    /// Processor time of all threads that work on a step.
    fn processor(&self) -> f64;
    /// Whether one thread does all the work, so that its parts share processor time as they share the wall's.
    fn is_one_thread(&self) -> bool;
}

/// The clocks of this machine.
pub struct SystemClocks {
    begin: Instant,
    is_one_thread: bool,
}

impl SystemClocks {
    /// Of this thread, if it does all the work, else of the whole process: another simulation in it then counts as well.
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
    /// The part at work, and when it began.
    part: Option<usize>,
    since: f64,
    /// The parts of this step, before they are scaled.
    parts: [f64; STEP_PARTS.len()],
    /// By the wall's and by the processor's clock: when the block began.
    block: Option<[f64; 2]>,
}

/// The parts of a step, and its seconds by the wall's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTimes {
    /// Not yet processor time: the factor of their block, from [`StepClock::settle`], is missing.
    pub parts: [f64; STEP_PARTS.len()],
    pub wall: f64,
}

impl<C: Clocks> StepClock<C> {
    pub fn new(clocks: C) -> Self {
        Self { clocks, part: None, since: 0.0, parts: [0.0; STEP_PARTS.len()], block: None }
    }

    /// A step begins; gives when, by the wall's clock.
    pub fn begin(&mut self) -> f64 {
        if self.block.is_none() {
            // The wall's clock last: the other one's reading is no part of the block.
            let processor = self.clocks.processor();
            self.block = Some([self.clocks.wall(), processor]);
        }
        (self.part, self.parts) = (None, [0.0; STEP_PARTS.len()]);
        self.clocks.wall()
    }

    /// A part begins, or none.
    pub fn enter(&mut self, part: Option<usize>) {
        // Several threads work in some parts and one in others: there the wall's clock cannot tell the parts' shares.
        let now = if self.clocks.is_one_thread() { self.clocks.wall() } else { self.clocks.processor() };
        if let Some(part) = self.part {
            self.parts[part] += now - self.since;
        }
        (self.part, self.since) = (part, now);
    }

    /// The step that began at `begin` is over.
    pub fn end(&mut self, begin: f64) -> StepTimes {
        self.enter(None);
        StepTimes { parts: self.parts, wall: self.clocks.wall() - begin }
    }

    /// Whether the block has lasted long enough for a reading of the processor's clock.
    pub fn is_due(&self) -> bool {
        self.block.is_some_and(|[wall, _]| self.clocks.wall() - wall >= BLOCK)
    }

    /// Ends the block, and gives the factor from the parts of its steps to processor time.
    pub fn settle(&mut self) -> f64 {
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

    /// A thread that works, while others now and then take the processor from it; reading takes no time.
    #[derive(Default)]
    pub struct Scripted {
        pub wall: Cell<f64>,
        pub processor: Cell<f64>,
        pub several_threads: bool,
    }

    impl Scripted {
        /// Works for so long, on so many threads.
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

    /// A step whose first parts work for so long; before each of them another program may take the processor.
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
        let factor = clock.settle();
        assert!(is_near(factor, 1.0));
        assert!(is_near(times.parts[0], 1e-6) && is_near(times.parts[1], 3e-6) && is_near(times.wall, 4e-6));
        assert!(is_near(more.parts[0], 2e-6) && is_near(more.wall, 6e-6));
        assert_eq!((clock.is_due(), clock.settle()), (false, 1.0));
    }

    #[test]
    fn what_other_programs_take_is_no_cost() {
        // One part works for a thousand times as long as another program leaves it alone.
        let time = Scripted::default();
        let mut clock = StepClock::new(&time);
        let times = step(&mut clock, &time, &[1e-4, 3e-4], &[0.4, 0.0]);
        let factor = clock.settle();
        let sum: f64 = times.parts.iter().map(|part| part * factor).sum();
        assert!(is_near(sum, 4e-4), "{sum}");
        assert!(is_near(times.wall, 0.4004));

        // Of blocks in which it takes the processor in each part as often as that part lasts, each part's mean is right.
        let work = [1e-4, 3e-4, 6e-4];
        let mut sums = [0.0; 3];
        for block in 0..10 {
            let taken = match block {
                0 => [0.7, 0.0, 0.0],
                1..4 => [0.0, 0.7, 0.0],
                _ => [0.0, 0.0, 0.7],
            };
            let times = step(&mut clock, &time, &work, &taken);
            let factor = clock.settle();
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
        assert_eq!(clock.settle(), 1.0);
        assert!(is_near(times.parts[0], 4e-3) && is_near(times.parts[1], 1e-3), "{times:?}");
        assert!(is_near(times.wall, 0.202));
    }
}
