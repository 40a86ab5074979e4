//! `sscc check`: answers a discrete or continuous query for every q of a model, or every frame of a mesh.

mod answer;
mod meshes;
mod pose;
mod printer;
mod text;

use anyhow::{Context, Result, bail, ensure};
use sscc::{Certificates, Method, Query, ReducedModel};
use sscc_io::{Rows, read_rows};
use sscc_sim::{DetectionAnswer, check_rows};

use crate::args::{self, At, Check};
use crate::outcome::Outcome;
use crate::progress::Bar;
use crate::{interrupt, load};
use printer::Printer;

pub fn run(args: &Check) -> Result<Outcome> {
    let is_at_q = args.at.q.is_some() || args.at.trajectory.is_some();
    let colliding = if is_at_q { check_model(args)? } else { meshes::check(args)? };
    Ok(if colliding { Outcome::Finding } else { Outcome::Done })
}

/// Returns the maximum number of pairs for each query.
fn limit(args: &Check) -> usize {
    args.limit.map_or(if args.first { 1 } else { usize::MAX }, |limit| limit as usize)
}

/// Answers a query for every q. Returns whether any of them found a collision.
fn check_model(args: &Check) -> Result<bool> {
    if let Some(second) = args.meshes.first() {
        bail!("{}: --q and --trajectory take one model: leave it out", second.display());
    }
    let typed_method = args.method.unwrap_or(args::Method::Certified);
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
        None if typed_method == args::Method::Certified => {
            Some(load::certificates_now(&model, &args.model, &args.options)?)
        }
        None => None,
    };
    let method = method(typed_method);
    let query = match &certificates {
        Some(certificates) => Query::with_method(&model, certificates, method)?,
        None => {
            let scope = load::scope(&model, &args.model, &args.options)?;
            Query::without_certificates(&model, scope, method)?
        }
    };
    let noun = if args.continuous { "step" } else { "configuration" };
    let root_radius = certificates.as_ref().map(Certificates::root_radius);
    let mut printer = Printer::new(noun, args.json.json, root_radius);
    let mut query = query.cancelled_by(&interrupt::Interrupt);
    let bar = Bar::new("checking").beside_output();
    let take = |found: &DetectionAnswer<'_>| printer.answer(found);
    check_rows(&mut query, model.mesh(), &rows, args.continuous, limit(args), &bar, take)?;
    drop(bar);
    if let Some(path) = &args.pose {
        let positions = model.positions(&rows.data).with_context(|| path.display().to_string())?;
        pose::write(path, model.mesh(), &positions, query.pairs())?;
    }
    printer.finish()
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
