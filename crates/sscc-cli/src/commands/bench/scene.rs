//! Scenes: simulated whole, or taken from the cache; some of their steps are measured.

use std::fs;

use anyhow::{Context, Result, bail, ensure};

use super::Session;
use super::follow::follow;
use super::measure::{Asked, Step, measure, spread};
use super::paper;
use super::report::{Report, Whole};
use super::sample::{half_diagonal, largest_displacement};
use super::scenario::PaperTable;
use super::strata::{Stratum, blocks};
use crate::output::{Output, note, one_line};
use crate::progress::Bar;
use crate::stages::Stages;
use sscc_sim::{History, PreparedScene, RunOutcome, STEP_PARTS, Scene, StateLog, run};

/// Steps that are measured, if nothing is said.
const STEPS: usize = 100;

/// States that are looked at for how far bodies are displaced.
const LOOKED_AT: usize = 100;

/// Gives the number of mismatches.
pub fn run_all(
    session: &Session<'_>,
    scenes: &[(&'static str, &'static str)],
    table: PaperTable,
    out: &mut Output,
) -> Result<usize> {
    let mut reports = Vec::new();
    for (name, text) in scenes {
        let report = one(session, name, text).with_context(|| (*name).to_owned())?;
        session.print(std::slice::from_ref(&report), out)?;
        reports.push(report);
        if session.is_over(out) {
            return Ok(mismatches(&reports));
        }
    }
    if !session.args.json.json {
        paper::lines(table, &reports).into_iter().try_for_each(|line| out.line(line))?;
    }
    Ok(mismatches(&reports))
}

fn mismatches(reports: &[Report]) -> usize {
    reports.iter().map(|report| report.mismatches).sum()
}

fn one(session: &Session<'_>, name: &str, text: &str) -> Result<Report> {
    let mut scene = Scene::parse(format!("{name}.toml").as_ref(), text)?;
    if session.args.quick {
        scene.quicken();
    }
    let prepared = PreparedScene::get(&scene, session.models.as_deref(), &session.cache, &Stages::default())?;
    let history = simulated(session, &scene, &prepared)?;
    let mut models = prepared.models.into_iter();
    let (Some(model), None) = (models.next(), models.next()) else {
        bail!("scenes of one model are measured");
    };
    let mut case = model.certified.with_paper(&session.cache, &Stages::default())?;
    let stratum = |state: usize| {
        let root_failed = history.bodies(state).any(|body| !case.is_root_certified(body.q));
        Stratum::of(root_failed, history.colliding_bodies(state) > 0)
    };
    let strata: Vec<Stratum> = (0..history.len() - 1).map(stratum).collect();
    let steps = blocks(&strata, session.args.steps.map_or(STEPS, |steps| steps as usize));
    let at = |state: usize| -> Vec<Vec<f64>> { history.bodies(state).map(|body| body.q.to_vec()).collect() };
    let step = |(n, state): (usize, &usize)| {
        let is_first = n == 0 || steps[n - 1] + 1 != *state;
        Step { before: is_first.then(|| at(state.saturating_sub(1))), q_t0: at(*state), q_t1: at(state + 1) }
    };
    let measured_steps: Vec<Step> = steps.iter().enumerate().map(step).collect();
    if session.args.quick {
        case.note =
            Some("--quick: a spring of 4,000 triangles stands in for any model, for half a second".into());
    }
    let scene_strata = Some(Stratum::counts(strata));
    let mut measured = measure(&case, &measured_steps, scene_strata, Asked::Both, &Bar::new("measuring"))?;
    measured.mismatches += follow(&case, &measured_steps, &mut measured.discrete)?;
    session.rows.add_costs(name, &measured.discrete, |step| steps[step] as f64 * scene.step);
    let farthest = spread(&(0..history.len()).collect::<Vec<_>>(), LOOKED_AT)
        .into_iter()
        .flat_map(|state| {
            history.bodies(state).map(|body| largest_displacement(&case.model, body.q)).collect::<Vec<_>>()
        })
        .fold(0.0, f64::max);
    let share = 100.0 * farthest / half_diagonal(&case.model);
    Ok(Report::new(name.into(), share, &case, &measured, scene.bodies.len(), Some(whole(&history))))
}

/// The motion of the whole scene, simulated on one thread.
fn simulated(session: &Session<'_>, scene: &Scene, prepared: &PreparedScene) -> Result<History> {
    let digest = prepared.digest(scene);
    let hash: String = digest[..8].iter().map(|byte| format!("{byte:02x}")).collect();
    let folder = session.cache.folder().join(format!("{}-{hash}.scene", scene.name));
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let simulate =
        |again| pool.install(|| run(scene, prepared, &folder, scene.steps, again, &Stages::default()));
    let RunOutcome { history, failure, .. } = match simulate(false) {
        Err(error) if StateLog::is_begun(&folder) => {
            note(format_args!("simulated anew: {}", one_line(&format!("{error:#}"))));
            simulate(true)?
        }
        ran => ran?,
    };
    match failure {
        Some(error) => Err(error.into()),
        None => {
            ensure!(history.len() > 1, "a scene of one step has nothing to measure");
            Ok(history)
        }
    }
}

/// What collides in the whole scene, and what its simulation took.
fn whole(history: &History) -> Whole {
    let steps = history.len();
    let colliding: Vec<usize> = (0..steps).map(|state| history.colliding_bodies(state)).collect();
    let mut seconds = [0.0; STEP_PARTS.len()];
    for state in 0..steps {
        seconds.iter_mut().zip(history.step(state).seconds).for_each(|(sum, part)| *sum += part);
    }
    Whole {
        steps,
        colliding_steps: colliding.iter().filter(|bodies| **bodies > 0).count(),
        body_steps: steps * history.layout().bodies(),
        colliding_body_steps: colliding.iter().sum(),
        seconds: Some(seconds),
    }
}
