//! `sscc audit`: attacks certificates, and reports violations and tightness; with `--exact` it proves some of their
//! entries, and has the proof checked.

use std::time::Instant;

use anyhow::Context;
use serde::Serialize;
use sscc::parts::Prover;
use sscc::{AuditOptions, Certificates, ReducedModel};
use sscc_checker::Refusal;
use sscc_io::read_whole;
use sscc_tasks::CertificateRequest;

use crate::args::Audit;
use crate::outcome::Outcome;
use crate::output::{Output, grouped};
use crate::progress::Bar;
use crate::{interrupt, load};

#[derive(Serialize)]
struct Report {
    samples: usize,
    local_samples: usize,
    violations: usize,
    root_tightness: Option<f64>,
    tightness_median: Option<f64>,
    tightness_min: Option<f64>,
}

pub fn run(args: &Audit) -> anyhow::Result<Outcome> {
    let loaded = load::model(&args.model)?;
    let model = &loaded.model;
    let request = load::request(&loaded, &args.model, &args.options)?;
    if args.exact {
        return audit_exactly(args, model, &request.read(&args.certificates, model)?);
    }
    // Certificates of a clearance are attacked with near pairs.
    let request = CertificateRequest { any_clearance: true, ..request };
    let certificates = request.read(&args.certificates, model)?;
    let options = AuditOptions::default()
        .samples(args.samples as usize)
        .seed(args.seed)
        .threads(load::threads(&args.options.threads));
    let audited = sscc::audit(model, &certificates, &options, &Bar::new("attacking"));
    interrupt::check()?;
    let found = audited.with_context(|| args.certificates.display().to_string())?;
    let mut out = Output::new();
    if args.json.json {
        out.json(&Report {
            samples: found.samples,
            local_samples: found.local_samples,
            violations: found.violations.len(),
            root_tightness: found.root_tightness,
            tightness_median: found.tightness_median,
            tightness_min: found.tightness_min,
        })?;
    } else {
        for violation in &found.violations {
            out.line(format_args!("VIOLATION: {violation}"))?;
        }
        let samples = grouped(found.samples as u64);
        match found.violations.len() {
            0 => out.line(format_args!("{samples} attacks, no violation found"))?,
            n => {
                out.line(format_args!(
                    "{samples} attacks, {n} VIOLATIONS: do not use these certificates; certify the model anew, and \
                     report the defect if this build computed them"
                ))?
            }
        }
        out.line("tightness (radius over the closest collision found; 1 is the best possible):")?;
        let root = certificates.root_radius();
        let no_root = match root {
            r if r <= 0.0 => "the radius is 0",
            r if r >= certificates.global_radius() => "the radius is capped at the global radius",
            _ => "no collision was found",
        };
        let no_others = "no collision was found for a radius that is neither 0 nor capped";
        let shown =
            |value: Option<f64>, reason: &str| value.map_or(format!("- ({reason})"), |v| format!("{v:.4}"));
        out.line(format_args!("  root     {}", shown(found.root_tightness, no_root)))?;
        out.line(format_args!("  median   {}", shown(found.tightness_median, no_others)))?;
        out.line(format_args!("  minimum  {}", shown(found.tightness_min, no_others)))?;
    }
    out.finish()?;
    Ok(if found.violations.is_empty() { Outcome::Done } else { Outcome::Finding })
}

#[derive(Serialize)]
struct ExactReport {
    entries: usize,
    proven: usize,
    seconds: f64,
    /// The reason why an entry has no proof, or why the proof does not hold; null if it holds.
    refused: Option<String>,
    /// The content that the checker left out; null if the proof does not hold.
    left_out: Option<String>,
}

/// Proves a sample of the entries of certificates, and has the proof checked in exact arithmetic.
fn audit_exactly(args: &Audit, model: &ReducedModel, certificates: &Certificates) -> anyhow::Result<Outcome> {
    let (start, named) = (Instant::now(), || args.certificates.display().to_string());
    let threads = load::threads(&args.options.threads);
    let prover = Prover::new(model, certificates).with_context(named)?;
    let numbers = prover.sample(args.samples as usize, args.seed);
    let mut proof = prover.header(numbers.len());
    let bar = Bar::new("proving");
    let witnesses = prover.prove(&numbers, Some(threads), &bar);
    interrupt::check()?;
    let outcome = match witnesses {
        Ok(witnesses) => {
            proof.extend(witnesses);
            let file = read_whole(&args.certificates)?;
            let is_cancelled = &interrupt::is_interrupted;
            match sscc_checker::check_until(&checked_model(model)?, &file, &proof, threads, is_cancelled) {
                Ok(confirmed) => Ok(confirmed.left_out),
                Err(Refusal::Proof(line)) => Err(line),
                Err(refusal @ (Refusal::Input(_) | Refusal::Cancelled)) => {
                    return Err(refusal).with_context(named);
                }
            }
        }
        Err(error) => Err(error.to_string()),
    };
    interrupt::check()?;
    let report = ExactReport {
        entries: prover.entries(),
        proven: numbers.len(),
        seconds: start.elapsed().as_secs_f64(),
        refused: outcome.clone().err(),
        left_out: outcome.ok(),
    };
    let mut out = Output::new();
    if args.json.json {
        out.json(&report)?;
    } else {
        let [proven, all] = [report.proven, report.entries].map(|count| grouped(count as u64));
        match (&report.left_out, &report.refused) {
            (_, Some(line)) => out.line(format_args!("NOT CONFIRMED: {line}"))?,
            (left_out, None) => {
                let left_out = left_out.as_deref().unwrap_or_default();
                out.line(format_args!(
                    "{proven} of {all} entries confirmed in exact arithmetic; left out: {left_out}"
                ))?;
            }
        }
    }
    out.finish()?;
    Ok(if report.refused.is_none() { Outcome::Done } else { Outcome::Finding })
}

/// Returns the model for the checker, which compares its digest with that of the certificates.
fn checked_model(model: &ReducedModel) -> anyhow::Result<sscc_checker::Model> {
    let (mesh, modes) = (model.mesh(), model.modes());
    let positions = mesh.rest_positions().iter().map(|p| p.to_array()).collect();
    let by_axis = modes.displacements().chunks_exact(modes.rank());
    let by_axis =
        by_axis.flat_map(|of_vertex| (0..3).flat_map(move |axis| of_vertex.iter().map(move |u| u[axis])));
    Ok(sscc_checker::Model::new(positions, mesh.faces().to_vec(), by_axis.collect(), modes.rank())?)
}
