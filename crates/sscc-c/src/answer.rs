//! The last answer of a handle, in memory that later answers reuse.

use std::ffi::c_void;

use sscc::{Impact, Pair};

use crate::pointers::OutputArray;
use crate::status::{Failure, Result, sscc_status};
use crate::types::{sscc_impact, sscc_pair, sscc_visit_fn};

/// The last answer of a handle.
#[derive(Clone, Default)]
pub struct Answer {
    pairs: Vec<sscc_pair>,
    impacts: Vec<sscc_impact>,
}

impl Answer {
    /// Clears the answer, before the next one is computed.
    #[inline(always)]
    pub fn forget(&mut self) {
        self.pairs.clear();
        self.impacts.clear();
    }

    /// Stores pairs, after [`Self::forget`], and returns their number.
    #[inline(always)]
    pub fn set_pairs(&mut self, pairs: &[Pair]) -> usize {
        if !pairs.is_empty() {
            self.add(pairs);
        }
        pairs.len()
    }

    /// Copies pairs. It is not inlined, because an answer without pairs takes nanoseconds and does not call it.
    #[inline(never)]
    fn add(&mut self, pairs: &[Pair]) {
        self.pairs.extend(pairs.iter().copied().map(sscc_pair::from));
    }

    /// Stores impacts and their pairs, after [`Self::forget`], and returns their number.
    pub fn set_impacts(&mut self, impacts: &[Impact]) -> usize {
        self.pairs.extend(impacts.iter().map(|impact| sscc_pair::from(impact.pair)));
        self.impacts.extend(impacts.iter().copied().map(sscc_impact::from));
        impacts.len()
    }

    /// Stores at most one pair, after [`Self::forget`], and returns the number of pairs.
    pub fn set_first(&mut self, pair: Option<Pair>) -> usize {
        self.set_pairs(pair.as_slice())
    }

    /// Copies the pairs.
    ///
    /// # Errors
    /// When the array is too small; then nothing is copied.
    pub fn copy_pairs(&self, out: &OutputArray<sscc_pair>) -> Result<()> {
        copy(&self.pairs, out)
    }

    /// Copies the impacts.
    ///
    /// # Errors
    /// As for [`Self::copy_pairs`].
    pub fn copy_impacts(&self, out: &OutputArray<sscc_impact>) -> Result<()> {
        copy(&self.impacts, out)
    }

    /// Calls back with each pair, in order.
    ///
    /// # Errors
    /// When the function is NULL, or it ends the visit.
    pub fn visit(&self, visit: sscc_visit_fn, user: *mut c_void) -> Result<()> {
        let Some(visit) = visit else { return Err(Failure::new(sscc_status::Null, "visit is NULL")) };
        let is_ended = self.pairs.iter().any(|pair| visit(user, *pair) != 0);
        if is_ended { Err(Failure::cancelled()) } else { Ok(()) }
    }
}

fn copy<T: Copy>(from: &[T], out: &OutputArray<T>) -> Result<()> {
    if from.len() > out.length() {
        let message =
            format!("the answer has {} entries, the array has place for {}", from.len(), out.length());
        return Err(Failure::new(sscc_status::Capacity, message));
    }
    for (i, value) in from.iter().enumerate() {
        out.write(i, *value);
    }
    Ok(())
}
