//! `sscc check`: does the shape collide with itself at q, and where?

mod answer;
mod pose;
mod text;

use std::time::Instant;

use anyhow::{Context, Result, ensure};
use sscc::{Certificates, Impact, Method, Pair, Query, ReducedModel};
use sscc_io::{Rows, read_rows};

use crate::args::{self, At, Check};
use crate::outcome::Outcome;
use crate::output::Output;
use crate::progress::Bar;
use crate::{interrupt, load};
use answer::Answer;
use text::Summary;

pub fn run(args: &Check) -> Result<Outcome> {
    let model = load::model(&args.model)?.model;
    let rows = coordinates(&args.at, &model)?;
    ensure!(
        !args.continuous || rows.rows > 1,
        "--continuous: the trajectory has one row; it takes two to move from one to the next"
    );
    if let Some(pose) = &args.pose {
        pose::check(pose, &args.model)?;
    }
    let certificates = match &args.certificates {
        Some(path) => Some(load::certificates(path, &model, &args.options)?),
        None if args.method == args::Method::Certified => {
            Some(load::certificates_now(&model, &args.model, &args.options)?)
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
        continuous: args.continuous,
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
        args::Method::NormalCones => Method::NormalCones,
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
    /// Whether the questions are about the ways between rows.
    continuous: bool,
    /// Pairs for each q at the most.
    limit: usize,
    root_radius: Option<f64>,
    json: bool,
}

impl Checking {
    /// Answers every question; whether anything collides.
    fn answer_all(&self, query: &mut Query<'_>, rows: &Rows) -> Result<bool> {
        let mut out = Output::new();
        // On a terminal the lines themselves show the progress.
        let bar = Bar::new("checking").only_if(!out.is_watched());
        let mut summary = Summary::new(if self.continuous { "step" } else { "configuration" });
        let rows: Vec<&[f64]> = rows.iter().collect();
        let questions = if self.continuous { rows.len() - 1 } else { rows.len() };
        for index in 0..questions {
            interrupt::check()?;
            let start = Instant::now();
            let found = if self.continuous {
                query.continuous(rows[index], rows[index + 1]).map(<[Impact]>::to_vec)
            } else {
                query.discrete_at_most(rows[index], self.limit).map(|_| Vec::new())
            };
            let microseconds = start.elapsed().as_secs_f64() * 1e6;
            interrupt::check()?;
            let all = found?;
            let first = earliest(&all, self.limit);
            let of_first: Vec<Pair> = first.iter().map(|impact| impact.pair).collect();
            let pairs = if self.continuous { &of_first[..] } else { query.pairs() };
            let statistics = query.statistics();
            let answer = Answer {
                index,
                norm: query.norm(),
                colliding: !pairs.is_empty(),
                count: pairs.len(),
                complete: statistics.complete && first.len() == all.len(),
                pairs,
                times: self.continuous.then(|| first.iter().map(|impact| impact.time).collect()),
                microseconds,
                root_certified: statistics.root_certified,
                opened: statistics.opened,
                box_tests: statistics.box_tests,
                triangle_tests: statistics.triangle_tests,
            };
            summary.add(&answer);
            if self.json {
                out.json(&answer)?;
            } else if questions == 1 {
                text::single(&answer, self.root_radius).into_iter().try_for_each(|line| out.line(line))?;
            } else {
                out.line(answer.line())?;
            }
            sscc::Progress::report(&bar, index + 1, questions);
            // Nobody reads the other answers: the exit code is that of those so far.
            if out.is_closed() {
                break;
            }
        }
        drop(bar);
        if !self.json && questions > 1 {
            out.line(summary.line())?;
        }
        out.finish()?;
        Ok(summary.colliding > 0)
    }
}

/// The first so many to meet, sorted by pair.
fn earliest(impacts: &[Impact], limit: usize) -> Vec<Impact> {
    let mut kept = impacts.to_vec();
    kept.sort_by(|a, b| a.time.total_cmp(&b.time));
    kept.truncate(limit);
    kept.sort_by_key(|impact| impact.pair);
    kept
}
