//! `sscc check`: does the shape collide with itself at q, and where?

use std::time::Instant;

use anyhow::{Context, Result};
use serde::Serialize;
use sscc::{Certificates, Method, Query, ReducedModel};
use sscc_io::{Rows, read_rows};

use crate::args::{self, At, Check};
use crate::output::{Output, counted, duration, grouped, length};
use crate::progress::Bar;
use crate::{Outcome, interrupt, load};

/// Pairs listed in text; `--json` lists all.
const LISTED: usize = 10;

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
    let (mut model, _) = load::model(&args.model)?;
    let rows = coordinates(&args.at, &model)?;
    let certificates = match &args.certificates {
        Some(path) => Some(load::certificates(path, &model, &args.options)?),
        None if args.method == args::Method::Certified => {
            let options = load::options(&model, &args.options)?;
            eprintln!(
                "note: no --certificates given: computing them first (sscc certify keeps them in a file)"
            );
            Some(load::certify(&model, &args.model.path, &options)?)
        }
        None => {
            if let Some(metric) = load::metric(&model, args.options.metric.as_deref())? {
                let (mesh, modes) = (model.mesh().clone(), model.modes().clone());
                let with_metric = ReducedModel::with_metric(mesh, modes, metric);
                model = with_metric.with_context(|| args.model.path.display().to_string())?;
            }
            None
        }
    };
    let method = method(args.method);
    let query = match &certificates {
        Some(certificates) => Query::with_method(&model, certificates, method)?,
        None => Query::without_certificates(&model, method),
    };
    let root_radius = certificates.as_ref().map(Certificates::root_radius);
    let colliding = answer_all(query, &rows, root_radius, args.json.json)?;
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

/// Answers every q; whether any collides.
fn answer_all(mut query: Query<'_>, rows: &Rows, root_radius: Option<f64>, json: bool) -> Result<bool> {
    let mut out = Output::new();
    // On a terminal the lines themselves show the progress.
    let bar = Bar::new("checking").only_if(!out.is_watched());
    let mut summary = Summary::default();
    let mut pairs = Vec::new();
    for (index, q) in rows.iter().enumerate() {
        interrupt::check()?;
        let start = Instant::now();
        let found = query.discrete(q)?;
        let microseconds = start.elapsed().as_secs_f64() * 1e6;
        pairs.clear();
        pairs.extend_from_slice(found);
        let statistics = query.statistics();
        let answer = Answer {
            index,
            norm: query.norm(),
            colliding: !pairs.is_empty(),
            count: pairs.len(),
            complete: true,
            pairs: &pairs,
            microseconds,
            root_certified: statistics.root_certified,
            opened: statistics.opened,
            box_tests: statistics.box_tests,
            triangle_tests: statistics.triangle_tests,
        };
        summary.add(&answer);
        if json {
            out.json(&answer)?;
        } else if rows.rows == 1 {
            single(&answer, root_radius).into_iter().try_for_each(|line| out.line(line))?;
        } else {
            out.line(answer.line())?;
        }
        sscc::Progress::report(&bar, index + 1, rows.rows);
    }
    drop(bar);
    if !json && rows.rows > 1 {
        out.line(summary.line())?;
    }
    out.finish()?;
    Ok(summary.colliding > 0)
}

impl Answer<'_> {
    /// One line of a trajectory.
    fn line(&self) -> String {
        let result = match self.pairs.first() {
            Some((i, j)) => format!("COLLIDING  {}, first {i} {j}", counted(self.count as u64, "pair")),
            None if self.root_certified => "free       by the root's certificate".to_owned(),
            None => "free".to_owned(),
        };
        format!(
            "{:>6}  |z| {:<10} {:>9}  {result}",
            self.index,
            length(self.norm),
            duration(self.microseconds)
        )
    }
}

/// The answer for a q alone.
fn single(answer: &Answer<'_>, root_radius: Option<f64>) -> Vec<String> {
    let norm = length(answer.norm);
    let root = root_radius.map(|r| format!(", root radius {}", length(r))).unwrap_or_default();
    let cost = format!(
        "{}: {} boxes compared, {} tested exactly",
        duration(answer.microseconds),
        grouped(answer.box_tests),
        counted(answer.triangle_tests, "triangle pair")
    );
    if answer.root_certified {
        return vec![
            format!("free: proven by the root's certificate alone (|z| = {norm}{root})"),
            duration(answer.microseconds),
        ];
    }
    if !answer.colliding {
        return vec![format!("free: proven (|z| = {norm}{root})"), cost];
    }
    let pairs = counted(answer.count as u64, "pair");
    let mut lines = vec![format!("COLLIDING: {pairs} of triangles (|z| = {norm}{root})"), cost];
    lines.extend(answer.pairs.iter().take(LISTED).map(|(i, j)| format!("{i:>8} {j:>8}")));
    if answer.count > LISTED {
        lines
            .push(format!("     ... and {} more; --json lists all", grouped((answer.count - LISTED) as u64)));
    }
    lines
}

/// What a whole trajectory comes to.
#[derive(Default)]
struct Summary {
    root_certified: usize,
    colliding: usize,
    microseconds: Vec<f64>,
}

impl Summary {
    fn add(&mut self, answer: &Answer<'_>) {
        self.root_certified += usize::from(answer.root_certified);
        self.colliding += usize::from(answer.colliding);
        self.microseconds.push(answer.microseconds);
    }

    fn line(&mut self) -> String {
        let all = self.microseconds.len();
        self.microseconds.sort_by(f64::total_cmp);
        format!(
            "{}: {} free ({} by the root's certificate alone), {} colliding; median {}",
            counted(all as u64, "configuration"),
            all - self.colliding,
            self.root_certified,
            self.colliding,
            duration(self.microseconds[all / 2])
        )
    }
}
