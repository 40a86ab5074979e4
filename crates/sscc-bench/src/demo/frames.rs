//! Checks every frame by three methods, and compares their answers.

use std::hint::black_box;
use std::time::Instant;

use sscc::{Certificates, Error, Method, Progress, Proof, Query, ReducedModel};
use sscc_io::Rows;

/// Number of repetitions of a root-certified query, which takes less time than a reading of the clock.
const REPETITIONS: u32 = 1000;

/// The answers of one method, frame by frame.
pub struct Answers {
    /// Colliding pairs.
    pub pairs: Vec<Vec<(u32, u32)>>,
    /// Whether the root's radius proved the shape free (one comparison).
    pub root_certified: Vec<bool>,
    /// Time of a query.
    pub microseconds: Vec<f64>,
}

/// The answers of all methods.
pub struct Frames {
    /// Answers of queries with certificates.
    pub certified: Answers,
    /// Answers of queries without certificates, with BD-tree AABBs.
    pub bd_tree: Answers,
    /// Answers of queries with a refit of all AABBs.
    pub traditional: Answers,
}

impl Frames {
    /// Checks every frame by each method, one method after the other, on one thread.
    ///
    /// # Errors
    /// When the certificates or a frame do not fit the model, or `progress` cancels.
    pub fn check(
        model: &ReducedModel,
        certificates: &Certificates,
        frames: &Rows,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let answers = |method| {
            let query = Query::with_method(model, certificates, method)?;
            Answers::of(query, frames, progress)
        };
        Ok(Self {
            certified: answers(Method::Certified)?,
            bd_tree: answers(Method::BdTree)?,
            traditional: answers(Method::Traditional)?,
        })
    }

    /// Returns the number of frames for which two methods differ.
    pub fn mismatches(&self) -> usize {
        let (a, b, c) = (&self.certified.pairs, &self.bd_tree.pairs, &self.traditional.pairs);
        (0..a.len()).filter(|&i| a[i] != c[i] || b[i] != c[i]).count()
    }
}

impl Answers {
    fn of(mut query: Query, frames: &Rows, progress: &dyn Progress) -> Result<Self, Error> {
        let mut answers = Self { pairs: Vec::new(), root_certified: Vec::new(), microseconds: Vec::new() };
        for (index, q) in frames.iter().enumerate() {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let start = Instant::now();
            let pairs = query.discrete(q)?.to_vec();
            let mut seconds = start.elapsed().as_secs_f64();
            let root_certified = query.statistics().proof == Proof::Radius;
            if root_certified {
                let start = Instant::now();
                for _ in 0..REPETITIONS {
                    black_box(query.discrete(black_box(q))?);
                }
                seconds = start.elapsed().as_secs_f64() / f64::from(REPETITIONS);
            }
            answers.pairs.push(pairs);
            answers.root_certified.push(root_certified);
            answers.microseconds.push(seconds * 1e6);
            progress.report(index + 1, frames.rows);
        }
        Ok(answers)
    }
}
