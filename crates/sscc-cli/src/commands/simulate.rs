//! `sscc simulate`: simulates a scene, and writes its motion, costs, sound and report.

use anyhow::Result;
use sscc_sim::{Outputs, Request, simulate};
use sscc_view::simulation_report;

use crate::args::Simulate;
use crate::outcome::Outcome;
use crate::output::Output;
use crate::stages::Stages;

pub fn run(args: &Simulate) -> Result<Outcome> {
    let request = Request {
        scene: args.scene.clone(),
        out: args.out.clone(),
        steps: args.steps.map(|steps| steps as usize),
        restart: args.restart,
        models: args.models.clone(),
        cache: args.cache.clone(),
        threads: args.threads.threads.map(|threads| threads as usize),
    };
    let stages = Stages::default();
    let run = simulate(&request, &stages)?;
    let mut outputs = Outputs::write(&run);
    outputs.add_report(simulation_report(&run, &stages));
    drop(stages);
    let mut out = Output::new();
    if args.json.json {
        out.json(&run.summary)?;
    } else {
        run.summary.lines().into_iter().try_for_each(|line| out.line(line))?;
        let files = outputs.files();
        files.iter().try_for_each(|file| out.line(format_args!("written: {}", file.display())))?;
    }
    out.finish()?;
    outputs.finish(run)?;
    Ok(Outcome::Done)
}
