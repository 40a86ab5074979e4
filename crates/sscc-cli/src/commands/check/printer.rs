//! Prints the answers of `sscc check`.

use std::ops::ControlFlow;

use anyhow::Result;
use sscc_tasks::DetectionAnswer;

use super::answer::Answer;
use super::data_set::FileError;
use super::text::{self, Summary};
use crate::output::{Output, note};

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
    /// Whether the run has a folder, so that its summary is printed in any case.
    pub has_folder: bool,
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
            has_folder: false,
            needs_last: false,
        }
    }

    /// Changes the noun of a query, if the first answer shows that the file is a scene.
    pub fn set_noun(&mut self, noun: &'static str) {
        (self.noun, self.summary.noun) = (noun, noun);
    }

    /// Prints the answer to one query. Breaks if further answers have no reader.
    pub fn answer(&mut self, found: &DetectionAnswer<'_>) -> Result<ControlFlow<()>> {
        let answer = Answer::new(found, self.has_files);
        self.summary.add(&answer);
        self.answers += 1;
        let is_listed = answer.is_finding() || !self.only_colliding;
        match (is_listed, self.is_json) {
            // A free answer is not printed, but the summary counts it.
            (false, _) => {}
            (true, true) => self.out.json(&answer)?,
            (true, false) if found.queries == 1 && !self.has_files => {
                let lines = text::single(&answer, self.root_radius);
                lines.into_iter().try_for_each(|line| self.out.line(line))?;
            }
            (true, false) => self.out.line(answer.line(self.noun))?,
        }
        Ok(self.next())
    }

    /// Prints the line of a file that could not be checked. Breaks if further answers have no reader.
    pub fn fail(&mut self, failed: &FileError) -> Result<ControlFlow<()>> {
        self.summary.failures += 1;
        match self.is_json {
            true => self.out.json(failed)?,
            false => self.out.line(text::failure(failed))?,
        }
        Ok(self.next())
    }

    fn next(&self) -> ControlFlow<()> {
        let is_over = self.out.is_closed() && !self.needs_last;
        if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Prints the summary of several answers; of a folder and with `--only`, also of a single one. With JSON only a
    /// folder has a summary, which is a note. Returns whether any answer so far is a finding, which decides the exit
    /// code.
    pub fn finish(mut self) -> Result<bool> {
        let is_summarized =
            self.answers + self.summary.failures > 1 || self.only_colliding || self.has_folder;
        if !self.is_json && is_summarized {
            self.out.line(self.summary.line())?;
        }
        self.out.flush()?;
        if self.is_json && self.has_folder {
            note(self.summary.line());
        }
        Ok(self.summary.findings > 0)
    }
}
