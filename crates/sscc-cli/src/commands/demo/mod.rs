//! `sscc demo`: certifies and checks the embedded spring, in a few seconds and without input files.

mod report;
mod save;

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, ensure};
use sscc::CertifyOptions;
use sscc_bench::demo::{Frames, demo_animation};
use sscc_modes::mode_frequencies;
use sscc_modes::shapes::elastic_spring;
use sscc_tasks::make_folder;
use sscc_view::Animation;

use crate::args::{Demo, Threads};
use crate::load;
use crate::outcome::Outcome;
use crate::output::Output;
use crate::progress::Bar;
use report::Report;

/// Frames per second.
const RATE: f64 = 30.0;

pub fn run(args: &Demo) -> anyhow::Result<Outcome> {
    if let Some(folder) = &args.out {
        make_folder(folder)?;
    }
    let start = Instant::now();
    let spring = elastic_spring(&Bar::new("modes")).context("the embedded spring")?;
    let modes_seconds = start.elapsed().as_secs_f64();
    let model = &spring.model;

    let threads = load::threads(&Threads { threads: None });
    let start = Instant::now();
    let options = CertifyOptions::default().threads(threads);
    let certificates = load::certify(model, Path::new("the embedded spring"), &options)?;
    let seconds = [modes_seconds, start.elapsed().as_secs_f64()];

    let animation = demo_animation(model, certificates.root_radius());
    let frames = Frames::check(model, &certificates, &animation, &Bar::new("checking"))?;
    let report = Report::new(model, &certificates, &frames, seconds, threads);
    let mut out = Output::new();
    if args.json.json {
        out.json(&report)?;
    } else {
        report.lines().into_iter().try_for_each(|line| out.line(line))?;
    }
    if let Some(folder) = &args.out {
        let page = Animation {
            title: "A double-helix spring, shaken with growing amplitude",
            name: "spring",
            model,
            certificates: &certificates,
            frequencies: mode_frequencies(spring.elasticity.stiffness()),
            rate: RATE,
            q: &animation.data,
            pairs: &frames.certified.pairs,
            costs: vec![
                ("traditional", &frames.traditional.microseconds),
                ("BD-tree", &frames.bd_tree.microseconds),
                ("certified", &frames.certified.microseconds),
            ],
            summary: report.table(),
        };
        let page = page.report()?;
        save::save(folder, spring, &certificates, &animation, &page)?;
        if !args.json.json {
            save::next_commands(folder).into_iter().try_for_each(|line| out.line(line))?;
        }
    } else if !args.json.json {
        out.line("")?;
        out.line(
            "Next: sscc demo --out DIR also writes the spring's files, as input for the other commands.",
        )?;
    }
    out.finish()?;
    ensure!(
        report.mismatches == 0,
        "the methods differ in {} frames: this is a defect of sscc; please report it with this command and its output",
        report.mismatches
    );
    Ok(Outcome::Done)
}
