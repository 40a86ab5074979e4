//! Measures steps of a scene, which is simulated whole or read from the cache.

use sscc_sim::{History, PreparedScene, RunOutcome, STEP_PARTS, Scene, StateLog, run};
use sscc_tasks::text::one_line;
use sscc_tasks::{CertifiedModel, make_folder};
use sscc_view::Plot;

use crate::error::Error;
use crate::measure::{Kinds, Step, compare, time_kinetic};
use crate::plots::{Line, SvgPlot, YAxis, cost_over_time, stacked};
use crate::record::{Record, SceneTotals};
use crate::sampling::{Counts, Stratum, blocks, evenly_spread, half_diagonal, largest_displacement};
use crate::setup::Setup;

/// Number of states among which the largest displacement is searched.
const DISPLACEMENTS: usize = 100;

/// Colours of the lines of a plot.
const COLORS: [&str; 3] = ["#cc6600", "#0066cc", "#009966"];

/// Default number of measured steps of a scene.
pub const SCENE_STEPS: usize = 100;

/// Measurement of a scene.
pub struct SceneMeasurement {
    /// Its record.
    pub record: Record,
    /// The cost of its steps.
    pub costs: Plot,
}

/// Measures some steps of a scene of one model, given by its name and the text of its file.
///
/// # Errors
/// When the scene cannot be simulated, has several models or one step only, or the work is cancelled.
pub fn measure_scene(
    setup: &Setup<'_>,
    name: &str,
    text: &str,
    steps: usize,
) -> Result<SceneMeasurement, Error> {
    let mut scene = Scene::parse(format!("{name}.toml").as_ref(), text)?;
    scene.penetrate();
    if setup.is_quick {
        scene.quicken();
    }
    let prepared = PreparedScene::get(&scene, setup.models, setup.cache, setup.watch)?;
    let history = simulate(setup, &scene, &prepared)?;
    let [model] = <[_; 1]>::try_from(prepared.models)
        .map_err(|models| Error::SeveralModels { models: models.len() })?;
    let mut model = model.certified.with_paper(setup.cache, setup.watch)?;
    if setup.is_quick {
        model.note =
            Some("--quick: a spring of 4,000 triangles replaces the model, for a fifth of a second".into());
    }
    let strata = strata(&model, &history);
    let numbers = blocks(&strata, steps);
    let steps = measured_steps(&history, &numbers);
    setup.begin_measuring();
    let scene_strata: Counts = Stratum::counts(strata);
    let mut comparison = compare(&model, &steps, Some(scene_strata), Kinds::Both, setup.watch)?;
    let kinetic = time_kinetic(&model, &steps, setup.watch)?;
    comparison.mismatches += kinetic.mismatches;
    comparison.discrete.kinetic = kinetic.milliseconds;
    let costs = cost_over_time(name, &comparison.discrete, |step| numbers[step] as f64 * scene.step);
    let share = 100.0 * max_displacement(&model, &history) / half_diagonal(&model.model);
    let (objects, totals) = (scene.bodies.len(), Some(totals(&history)));
    let record = Record::new(name.into(), share, &model, &comparison, objects, totals);
    Ok(SceneMeasurement { record, costs })
}

/// Returns a plot of the costs of scenes, as SVG: the cost of each step over time, as in the paper's Figure 12.
pub fn plot_scenes(costs: &[Plot]) -> String {
    stacked(&costs.iter().map(svg_plot).collect::<Vec<_>>())
}

fn svg_plot(plot: &Plot) -> SvgPlot<'_> {
    let lines = plot.series.iter().zip(COLORS);
    let lines = lines.map(|(series, color)| {
        let points = series.x.iter().zip(&series.y).map(|(x, y)| [*x, *y]).collect();
        Line { label: &series.name, color, points }
    });
    SvgPlot {
        title: plot.title.clone(),
        x_label: &plot.x.label,
        y_label: &plot.y.label,
        y_axis: YAxis::Logarithmic,
        lines: lines.collect(),
    }
}

/// Returns the motion of the whole scene, simulated on one thread or read from the cache.
fn simulate(setup: &Setup<'_>, scene: &Scene, prepared: &PreparedScene) -> Result<History, Error> {
    let digest = prepared.digest(scene);
    let hash: String = digest[..8].iter().map(|byte| format!("{byte:02x}")).collect();
    let folder = setup.cache.folder().join(format!("{}-{hash}.scene", scene.name));
    make_folder(&folder)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let run_on_pool =
        |again| pool.install(|| run(scene, prepared, &folder, scene.steps, again, &[], setup.watch));
    let RunOutcome { history, failure, .. } = match run_on_pool(false) {
        Err(error) if StateLog::is_begun(&folder) => {
            let cause = error.message().with_names(|setting| setup.watch.name(setting));
            setup.watch.note(&format!("simulated again: {}", one_line(&cause)));
            run_on_pool(true)?
        }
        outcome => outcome?,
    };
    match failure {
        Some(error) => Err(error.into()),
        None if history.len() > 1 => Ok(history),
        None => Err(Error::NoMotion),
    }
}

/// Returns the stratum of each step.
fn strata(model: &CertifiedModel, history: &History) -> Vec<Stratum> {
    let stratum = |state: usize| {
        let root_failed = history.bodies(state).any(|body| !model.is_root_certified(body.q));
        Stratum::of(root_failed, history.colliding_bodies(state) > 0)
    };
    (0..history.len() - 1).map(stratum).collect()
}

/// Returns the steps of these numbers, which must be ascending.
fn measured_steps(history: &History, numbers: &[usize]) -> Vec<Step> {
    let at = |state: usize| -> Vec<Vec<f64>> { history.bodies(state).map(|body| body.q.to_vec()).collect() };
    let step = |(n, state): (usize, &usize)| {
        let is_first = n == 0 || numbers[n - 1] + 1 != *state;
        Step { before: is_first.then(|| at(state.saturating_sub(1))), q_t0: at(*state), q_t1: at(state + 1) }
    };
    numbers.iter().enumerate().map(step).collect()
}

/// Returns the largest displacement of a vertex in the scene (model unit).
fn max_displacement(model: &CertifiedModel, history: &History) -> f64 {
    let bodies = evenly_spread(history.len(), DISPLACEMENTS).flat_map(|state| history.bodies(state));
    bodies.map(|body| largest_displacement(&model.model, body.q)).fold(0.0, f64::max)
}

/// Returns the counts of collisions in the whole scene, and the cost of its simulation.
fn totals(history: &History) -> SceneTotals {
    let steps = history.len();
    let colliding: Vec<usize> = (0..steps).map(|state| history.colliding_bodies(state)).collect();
    let mut seconds = [0.0; STEP_PARTS.len()];
    for state in 0..steps {
        seconds.iter_mut().zip(history.step(state).seconds).for_each(|(sum, part)| *sum += part);
    }
    SceneTotals {
        steps,
        colliding_steps: colliding.iter().filter(|bodies| **bodies > 0).count(),
        body_steps: steps * history.layout().bodies(),
        colliding_body_steps: colliding.iter().sum(),
        seconds: Some(seconds),
    }
}
