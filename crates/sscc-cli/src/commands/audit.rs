//! `sscc audit`: attacks certificates, and reports violations and tightness.

use anyhow::Context;
use serde::Serialize;
use sscc::AuditOptions;
use sscc_sim::CertificateRequest;

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
    // Those of a clearance are attacked with near pairs.
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
