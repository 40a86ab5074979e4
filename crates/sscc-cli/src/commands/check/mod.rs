//! `sscc check`: answers a discrete or continuous query for every q.

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
        "--continuous: the trajectory has one row; a motion needs at least two"
    );
    if let Some(pose) = &args.pose {
        pose::check(pose, &args.model)?;
    }
    let certificates = match &args.certificates {
        Some(path) => Some(load::certificates(path, &args.model, &model, &args.options)?),
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
    let checker = Checker {
        is_continuous: args.continuous,
        limit: args.limit.map_or(if args.first { 1 } else { usize::MAX }, |limit| limit as usize),
        root_radius: certificates.as_ref().map(Certificates::root_radius),
        is_json: args.json.json,
    };
    let mut query = query.cancelled_by(&interrupt::Interrupt);
    let colliding = checker.answer_all(&mut query, &rows)?;
    if let Some(path) = &args.pose {
        pose::write(path, &model, &rows.data, query.pairs())?;
    }
    Ok(if colliding { Outcome::Finding } else { Outcome::Done })
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

/// Returns every configuration. All are validated before the first query.
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

/// Answers the queries and prints the answers.
struct Checker {
    /// Whether queries are continuous, from each row to the next.
    is_continuous: bool,
    /// Maximum number of pairs for each query.
    limit: usize,
    root_radius: Option<f64>,
    is_json: bool,
}

impl Checker {
    /// Answers every query. Returns whether any of them found a collision.
    fn answer_all(&self, query: &mut Query<'_>, rows: &Rows) -> Result<bool> {
        let mut out = Output::new();
        // On a terminal the printed lines show the progress.
        let bar = Bar::new("checking").only_if(!out.is_terminal());
        let mut summary = Summary::new(if self.is_continuous { "step" } else { "configuration" });
        let rows: Vec<&[f64]> = rows.iter().collect();
        let queries = if self.is_continuous { rows.len() - 1 } else { rows.len() };
        for index in 0..queries {
            interrupt::check()?;
            let start = Instant::now();
            let found = if self.is_continuous {
                query.continuous(rows[index], rows[index + 1]).map(<[Impact]>::to_vec)
            } else {
                query.discrete_at_most(rows[index], self.limit).map(|_| Vec::new())
            };
            let microseconds = start.elapsed().as_secs_f64() * 1e6;
            interrupt::check()?;
            let all = found?;
            let first = earliest(&all, self.limit);
            let of_first: Vec<Pair> = first.iter().map(|impact| impact.pair).collect();
            let pairs = if self.is_continuous { &of_first[..] } else { query.pairs() };
            let statistics = query.statistics();
            let answer = Answer {
                index,
                norm: query.norm(),
                colliding: !pairs.is_empty(),
                count: pairs.len(),
                complete: statistics.complete && first.len() == all.len(),
                pairs,
                times: self.is_continuous.then(|| first.iter().map(|impact| impact.time).collect()),
                microseconds,
                root_certified: statistics.root_certified,
                opened: statistics.opened,
                box_tests: statistics.box_tests,
                triangle_tests: statistics.triangle_tests,
            };
            summary.add(&answer);
            if self.is_json {
                out.json(&answer)?;
            } else if queries == 1 {
                text::single(&answer, self.root_radius).into_iter().try_for_each(|line| out.line(line))?;
            } else {
                out.line(answer.line())?;
            }
            sscc::Progress::report(&bar, index + 1, queries);
            // Further answers have no reader. The exit code is that of the answers so far.
            if out.is_closed() {
                break;
            }
        }
        drop(bar);
        if !self.is_json && queries > 1 {
            out.line(summary.line())?;
        }
        out.finish()?;
        Ok(summary.colliding > 0)
    }
}

/// Returns the `limit` earliest impacts, sorted by pair.
fn earliest(impacts: &[Impact], limit: usize) -> Vec<Impact> {
    let mut kept = impacts.to_vec();
    kept.sort_by(|a, b| a.time.total_cmp(&b.time));
    kept.truncate(limit);
    kept.sort_by_key(|impact| impact.pair);
    kept
}
