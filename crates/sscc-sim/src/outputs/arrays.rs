//! Writes the motion of a simulation and its costs as arrays in `.npz` archives.

use std::path::Path;

use sscc_io::{NamedArray, write_npz};

use crate::error::Result;
use crate::run::{FinishedRun, STEP_PARTS, TraditionalCost};

/// Writes the whole motion, bit for bit.
pub fn trajectories(path: &Path, run: &FinishedRun) -> Result<()> {
    let FinishedRun { scene, prepared, history, .. } = run;
    let (states, bodies) = (history.len(), history.layout().bodies());
    let time: Vec<f64> = (0..states).map(|state| run.time(state)).collect();
    let each = |of: &dyn Fn(usize, usize, &mut Vec<f64>)| {
        let mut values = Vec::new();
        (0..states).for_each(|state| (0..bodies).for_each(|body| of(state, body, &mut values)));
        values
    };
    let positions = each(&|s, b, to| to.extend(history.body(s, b).position.to_array()));
    let orientations = each(&|s, b, to| to.extend(history.body(s, b).orientation.to_array()));
    let pairs = each(&|s, b, to| to.push(history.body(s, b).pairs as f64));
    let inter: Vec<f64> = (0..states).map(|state| history.step(state).inter_pairs as f64).collect();
    let (energy_time, energy): (Vec<f64>, Vec<f64>) = (0..states)
        .map(|state| (time[state], history.step(state).energy))
        .filter(|(_, energy)| energy.is_finite())
        .unzip();
    let model_of: Vec<f64> = scene.bodies.iter().map(|body| body.model as f64).collect();
    let centers: Vec<f64> = prepared.models.iter().flat_map(|model| model.center().to_array()).collect();
    let of_models: Vec<(String, Vec<usize>, Vec<f64>)> = scene
        .models
        .iter()
        .enumerate()
        .filter_map(|(index, model)| {
            let of = |body: &usize| scene.bodies[*body].model == index;
            let own: Vec<usize> = (0..bodies).filter(of).collect();
            let first = own.first()?;
            let mut q = Vec::new();
            for state in 0..states {
                own.iter().for_each(|body| q.extend(history.body(state, *body).q));
            }
            Some((model.array_name(), vec![states, own.len(), history.layout().rank(*first)], q))
        })
        .collect();
    let mut arrays = vec![
        NamedArray { name: "time", shape: vec![states], values: &time },
        NamedArray { name: "positions", shape: vec![states, bodies, 3], values: &positions },
        NamedArray { name: "orientations", shape: vec![states, bodies, 4], values: &orientations },
        NamedArray { name: "self_pairs", shape: vec![states, bodies], values: &pairs },
        NamedArray { name: "inter_pairs", shape: vec![states], values: &inter },
        NamedArray { name: "energy_time", shape: vec![energy.len()], values: &energy_time },
        NamedArray { name: "energy", shape: vec![energy.len()], values: &energy },
        NamedArray { name: "model_of_body", shape: vec![bodies], values: &model_of },
        NamedArray { name: "centers", shape: vec![prepared.models.len(), 3], values: &centers },
    ];
    arrays.extend(of_models.iter().map(|(name, shape, values)| NamedArray {
        name,
        shape: shape.clone(),
        values,
    }));
    Ok(write_npz(path, &arrays)?)
}

/// Writes the costs of each step, and of the traditional method at some steps.
pub fn costs(path: &Path, run: &FinishedRun) -> Result<()> {
    let FinishedRun { history, .. } = run;
    let time: Vec<f64> = (0..history.len()).map(|state| run.time(state)).collect();
    let parts: Vec<(String, Vec<f64>)> = STEP_PARTS
        .iter()
        .enumerate()
        .map(|(part, name)| {
            let of = |state| history.step(state).seconds[part];
            (format!("{name}_seconds"), (0..history.len()).map(of).collect())
        })
        .collect();
    let sampled = |of: &dyn Fn(&TraditionalCost) -> f64| run.traditional.iter().map(of).collect::<Vec<_>>();
    let at = sampled(&|cost| run.time(cost.state));
    let all = sampled(&|cost| cost.seconds);
    let awake = sampled(&|cost| cost.awake_seconds);
    let own = sampled(&|cost| history.step(cost.state).self_seconds());
    let mut arrays = vec![
        line("time", &time),
        line("traditional_time", &at),
        line("traditional_self_seconds", &all),
        line("traditional_awake_seconds", &awake),
        line("sampled_self_seconds", &own),
    ];
    arrays.extend(parts.iter().map(|(name, values)| line(name, values)));
    Ok(write_npz(path, &arrays)?)
}

/// Returns an array of one axis.
fn line<'a>(name: &'a str, values: &'a [f64]) -> NamedArray<'a> {
    NamedArray { name, shape: vec![values.len()], values }
}
