//! Prints the answers of `sscc check`.

use std::ops::ControlFlow;

use anyhow::Result;
use sscc_sim::DetectionAnswer;

use super::answer::Answer;
use super::text::{self, Summary};
use crate::output::Output;

/// Prints answers as text or JSON, and a summary.
pub struct Printer {
    out: Output,
    summary: Summary,
    is_json: bool,
    root_radius: Option<f64>,
    noun: &'static str,
    answers: usize,
    /// Whether free answers are not printed.
    pub only_colliding: bool,
    /// Whether the run has several files.
    pub has_files: bool,
    /// Whether the last answer is needed even if no one reads the output.
    pub needs_last: bool,
}

impl Printer {
    /// `noun` names a query.
    pub fn new(noun: &'static str, is_json: bool, root_radius: Option<f64>) -> Self {
        Self {
            out: Output::new(),
            summary: Summary::new(noun),
            is_json,
            root_radius,
            noun,
            answers: 0,
            only_colliding: false,
            has_files: false,
            needs_last: false,
        }
    }

    /// Prints the answer to one query. Breaks if further answers have no reader.
    pub fn answer(&mut self, found: &DetectionAnswer<'_>) -> Result<ControlFlow<()>> {
        let answer = Answer::new(found, self.has_files);
        self.summary.add(&answer);
        self.answers += 1;
        let is_listed = answer.colliding || !self.only_colliding;
        match (is_listed, self.is_json) {
            // The summary counts it.
            (false, _) => {}
            (true, true) => self.out.json(&answer)?,
            (true, false) if found.queries == 1 && !self.has_files => {
                let lines = text::single(&answer, self.root_radius);
                lines.into_iter().try_for_each(|line| self.out.line(line))?;
            }
            (true, false) => self.out.line(answer.line(self.noun))?,
        }
        let is_over = self.out.is_closed() && !self.needs_last;
        Ok(if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }

    /// Prints the summary of several answers. Returns whether any of them has a collision: the exit code is that of the
    /// answers so far.
    pub fn finish(mut self) -> Result<bool> {
        if !self.is_json && (self.answers > 1 || self.only_colliding) {
            self.out.line(self.summary.line())?;
        }
        self.out.finish()?;
        Ok(self.summary.colliding > 0)
    }
}
