//! Prints records as JSON or as tables.

use anyhow::Result;
use sscc_bench::{BenchPage, Record};

use super::table::Table;
use crate::args::Bench;
use crate::output::Output;

/// Prints records, and collects the data of the report.
pub struct Printer {
    pub out: Output,
    pub is_json: bool,
    has_report: bool,
    /// The page of `--report`.
    pub page: BenchPage,
    /// Steps in which two exact methods differ.
    pub mismatches: usize,
}

impl Printer {
    pub fn new(args: &Bench) -> Self {
        Self {
            out: Output::new(),
            is_json: args.json.json,
            has_report: args.report.is_some(),
            page: BenchPage::default(),
            mismatches: 0,
        }
    }

    /// Prints records of one model: as JSON, one a line, or as one table.
    pub fn print(&mut self, records: &[Record]) -> Result<()> {
        self.keep(records);
        if self.is_json {
            records.iter().try_for_each(|record| self.out.json(record))?;
        } else {
            self.lines(Table::of(records).lines())?;
        }
        // Flushed, because the next model may take minutes.
        self.out.flush()
    }

    /// Collects records without printing them.
    pub fn keep(&mut self, records: &[Record]) {
        for record in records {
            self.page.add(record);
            self.mismatches += record.mismatches;
        }
    }

    /// Prints lines of text.
    pub fn lines(&mut self, lines: impl IntoIterator<Item = String>) -> Result<()> {
        lines.into_iter().try_for_each(|line| self.out.line(line))
    }

    /// Whether further records are useless: standard output is closed, and no report is to be written.
    pub fn is_over(&self) -> bool {
        self.out.is_closed() && !self.has_report
    }
}
