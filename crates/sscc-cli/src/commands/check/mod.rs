//! `sscc check`: does the shape collide with itself at q, and where?

mod pose;
mod text;

use std::time::Instant;

use anyhow::{Context, Result};
use serde::Serialize;
use sscc::{Certificates, Method, Query, ReducedModel};
use sscc_io::{Rows, read_rows};

use crate::args::{self, At, Check};
use crate::output::Output;
use crate::progress::Bar;
use crate::{Outcome, interrupt, load};
use text::Summary;

/// The answer for one q.
#[derive(Serialize)]
struct Answer<'a> {
    index: usize,
    norm: f64,
    colliding: bool,
    count: usize,
    complete: bool,
    pairs: &'a [(u32, u32)],
    microseconds: f64,
    root_certified: bool,
    opened: u64,
    box_tests: u64,
    triangle_tests: u64,
}

pub fn run(args: &Check) -> Result<Outcome> {
    let model = load::model(&args.model)?.model;
    let rows = coordinates(&args.at, &model)?;
    if let Some(pose) = &args.pose {
        pose::check(pose, &args.model)?;
    }
    let certificates = match &args.certificates {
        Some(path) => Some(load::certificates(path, &model, &args.options)?),
        None if args.method == args::Method::Certified => {
            let options = load::options(&model, &args.model, &args.options)?;
            eprintln!(
                "note: no --certificates given: computing them first (sscc certify keeps them in a file)"
            );
            Some(load::certify(&model, &args.model.path, &options)?)
        }
        None => None,
    };
    let method = method(args.method);
    let query = match &certificates {
        Some(certificates) => Query::with_method(&model, certificates, method)?,
        None => {
            let scope = load::scope(&model, &args.model, &args.options)?;
            Query::without_certificates(&model, scope, method)?
        }
    };
    let checking = Checking {
        limit: args.limit.map_or(if args.first { 1 } else { usize::MAX }, |limit| limit as usize),
        root_radius: certificates.as_ref().map(Certificates::root_radius),
        json: args.json.json,
    };
    let mut query = query.cancelled_by(&interrupt::Interrupt);
    let colliding = checking.answer_all(&mut query, &rows)?;
    if let Some(path) = &args.pose {
        pose::write(path, &model, &rows.data, query.pairs())?;
    }
    Ok(if colliding { Outcome::Found } else { Outcome::Done })
}

fn method(typed: args::Method) -> Method {
    match typed {
        args::Method::Certified => Method::Certified,
        args::Method::BdTree => Method::BdTree,
        args::Method::Traditional => Method::Traditional,
        args::Method::BruteForce => Method::BruteForce,
    }
}

/// Every q that was asked for; all are looked at before the first is answered.
fn coordinates(at: &At, model: &ReducedModel) -> Result<Rows> {
    match (&at.trajectory, &at.q) {
        (Some(path), _) => {
            let rows = read_rows(path)?;
            for (index, q) in rows.iter().enumerate() {
                let in_row = || format!("{}: row {index} (counted from 0)", path.display());
                model.check_coordinates(q).with_context(in_row)?;
            }
            Ok(rows)
        }
        (None, q) => {
            let q = q.clone().unwrap_or_default();
            model.check_coordinates(&q).context("--q")?;
            Ok(Rows { rows: 1, columns: q.len(), data: q })
        }
    }
}

/// How to answer.
struct Checking {
    /// Pairs for each q at the most.
    limit: usize,
    root_radius: Option<f64>,
    json: bool,
}

impl Checking {
    /// Answers every q; whether any collides.
    fn answer_all(&self, query: &mut Query<'_>, rows: &Rows) -> Result<bool> {
        let mut out = Output::new();
        // On a terminal the lines themselves show the progress.
        let bar = Bar::new("checking").only_if(!out.is_watched());
        let mut summary = Summary::default();
        for (index, q) in rows.iter().enumerate() {
            interrupt::check()?;
            let start = Instant::now();
            let found = query.discrete_at_most(q, self.limit).map(|_| ());
            let microseconds = start.elapsed().as_secs_f64() * 1e6;
            interrupt::check()?;
            found?;
            let (pairs, statistics) = (query.pairs(), query.statistics());
            let answer = Answer {
                index,
                norm: query.norm(),
                colliding: !pairs.is_empty(),
                count: pairs.len(),
                complete: statistics.complete,
                pairs,
                microseconds,
                root_certified: statistics.root_certified,
                opened: statistics.opened,
                box_tests: statistics.box_tests,
                triangle_tests: statistics.triangle_tests,
            };
            summary.add(&answer);
            if self.json {
                out.json(&answer)?;
            } else if rows.rows == 1 {
                text::single(&answer, self.root_radius).into_iter().try_for_each(|line| out.line(line))?;
            } else {
                out.line(answer.line())?;
            }
            sscc::Progress::report(&bar, index + 1, rows.rows);
        }
        drop(bar);
        if !self.json && rows.rows > 1 {
            out.line(summary.line())?;
        }
        out.finish()?;
        Ok(summary.colliding > 0)
    }
}
