//! `sscc check`: answers a discrete or continuous query for every q of a model, or every frame of a mesh.

mod answer;
mod data_set;
mod frames_out;
mod meshes;
mod printer;
mod shapes;
mod soup_hint;
mod text;

use std::slice;

use anyhow::{Context, Result, bail, ensure};
use sscc::parts::Scope;
use sscc::{Certificates, Method, Query};
use sscc_io::{LoadedModel, Rows, Setting, read_rows};
use sscc_tasks::{CertificateRequest, DetectionAnswer, RowQueries, check_rows, read_configuration};

use crate::args::{At, Check};
use crate::outcome::Outcome;
use crate::progress::Bar;
use crate::{interrupt, load};
use printer::Printer;
use soup_hint::SoupHint;

pub fn run(args: &Check) -> Result<Outcome> {
    let is_at_q = args.at.q.is_some() || args.at.trajectory.is_some();
    let colliding = if is_at_q { check_model(args)? } else { meshes::check(args)? };
    Ok(if colliding { Outcome::Finding } else { Outcome::Done })
}

/// Answers a query for every q. Returns whether any of them found a collision.
fn check_model(args: &Check) -> Result<bool> {
    if let Some(second) = args.meshes.first() {
        bail!("{}: --q and --trajectory take one model: leave it out", second.display());
    }
    // Distances are computed from positions, without certificates unless certificates with a clearance are given.
    let is_certified = args.certificates.is_some();
    let default = if args.clearance.is_some() && !is_certified { Method::BdTree } else { Method::Certified };
    let method = args.method.unwrap_or(default);
    let loaded = load::model(&args.model)?;
    let rows = coordinates(&args.at, &loaded)?;
    let model = &loaded.model;
    ensure!(
        !args.continuous || rows.rows > 1,
        "--continuous: the trajectory has one row; a motion needs at least two"
    );
    shapes::check(args, slice::from_ref(&args.model.path))?;
    let clearance = args.clearance()?;
    let request = CertificateRequest { clearance, ..load::request(&loaded, &args.model, &args.options)? };
    let certificates = match &args.certificates {
        Some(path) => Some(request.read(path, model)?),
        None if method == Method::Certified => {
            Some(load::certificates_now(&loaded, &args.model, &args.options)?)
        }
        None => None,
    };
    let query = match &certificates {
        Some(certificates) => Query::with_method(model, certificates, method)?,
        None => Query::without_certificates(model, request.scope(model)?, method)?,
    };
    let noun = if args.continuous { "step" } else { "configuration" };
    let root_radius = certificates.as_ref().map(Certificates::root_radius);
    let mut printer = Printer::new(noun, args.json.json, root_radius);
    let mut query = query.cancelled_by(interrupt::token().clone());
    let bar = Bar::new("checking").beside_output();
    printer.only_colliding = args.only.is_colliding();
    printer.needs_last = args.curves.is_some();
    let mut hint = SoupHint::default();
    // Models of some files are welded without a flag, and a user who has decided needs no hint.
    let is_welded = request.weld.is_some() || Scope::of_query(&query).filter.weld;
    let take = |found: &DetectionAnswer<'_>| {
        if !is_welded {
            hint.add(found);
        }
        shapes::write_placed_curves(args.curves.as_deref(), found, &loaded)?;
        printer.answer(found)
    };
    let requests = RowQueries {
        model,
        rows: &rows,
        is_continuous: args.continuous,
        limit: args.max_pairs(),
        clearance,
        is_certified,
        threads: Some(load::threads(&args.options.threads)),
        contacts: shapes::contacts(args),
    };
    check_rows(&mut query, &requests, &bar, take)?;
    drop(bar);
    if let Some(path) = &args.pose {
        let mut positions = model.positions(&rows.data).with_context(|| path.display().to_string())?;
        if let Some(placement) = loaded.placement()? {
            placement.place(0, &mut positions).with_context(|| path.display().to_string())?;
        }
        shapes::write_pose(path, model.mesh(), &positions, query.pairs())?;
    }
    let colliding = printer.finish()?;
    hint.print(&args.model.path);
    Ok(colliding)
}

/// Returns every configuration. All are validated before the first query.
pub fn coordinates(at: &At, loaded: &LoadedModel) -> Result<Rows> {
    match (&at.trajectory, &at.q) {
        (Some(path), _) => {
            let rows = read_rows(path)?;
            for (index, q) in rows.iter().enumerate() {
                let in_row = || format!("{}: row {index} (counted from 0)", path.display());
                loaded.model.check_coordinates(q).with_context(in_row)?;
            }
            Ok(rows)
        }
        (None, q) => {
            let q = read_configuration(Setting::Q, q.as_deref().unwrap_or_default(), loaded)?;
            Ok(Rows { rows: 1, columns: q.len(), data: q })
        }
    }
}
