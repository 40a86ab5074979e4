//! Lines about models and bodies before a simulation begins: sizes, collisions at rest, and the effect of shakes.

use sscc::{Modes, ReducedModel};
use sscc_dynamics::{Damping, LinearOscillator};
use sscc_modes::{diagonalize, natural_frequencies};
use sscc_solid::Stiffness;
use sscc_tasks::text::{counted, length, size_and_mass};
use sscc_tasks::{ModesSpec, Recipe, Shape, Watch, check_cancelled, longest_side};

use super::prepared::{PreparedModel, PreparedScene};
use crate::error::{At, Result};
use crate::scenes::{Scene, Shake};

/// Time of the free vibration that a line describes (s).
const FIRST: f64 = 1.0;

/// Returns the lines of a scene. The cost does not depend on its number of steps.
///
/// # Errors
/// When a shake does not fit its model, or `watch` cancels.
pub fn announcement(scene: &Scene, prepared: &PreparedScene, watch: &dyn Watch) -> Result<Vec<String>> {
    let mut lines = Vec::new();
    for (spec, model) in scene.models.iter().zip(&prepared.models) {
        let name = &model.certified.name;
        if matches!(spec.recipe.shape, Shape::File(_) | Shape::Embedded { .. } | Shape::Model(_)) {
            lines.push(format!("{name}: {}", facts(&spec.recipe, model)?));
        }
        match model.certified.full.certificates.rest_collisions() {
            0 => {}
            count => {
                let pairs = counted(count, "pair");
                lines.push(format!("{name}: {pairs} of triangles collide at rest; they make no contact"));
            }
        }
    }
    let mut shaken: Vec<(usize, &Shake, Vec<usize>)> = Vec::new();
    for (number, body) in scene.bodies.iter().enumerate().filter(|(_, body)| !body.shake.values.is_empty()) {
        match shaken.iter_mut().find(|(model, shake, _)| (*model, *shake) == (body.model, &body.shake)) {
            Some((_, _, bodies)) => bodies.push(number),
            None => shaken.push((body.model, &body.shake, vec![number])),
        }
    }
    for (model, shake, bodies) in shaken {
        check_cancelled(watch)?;
        let PreparedModel { certified, shape, .. } = &prepared.models[model];
        let rates = shake.rates(shape.reach())?;
        let seconds = FIRST.min(scene.steps as f64 * scene.step);
        let damping = scene.models[model].damping;
        let stiffness = shape.elasticity().stiffness();
        let farthest = farthest(shape.model(), stiffness, &rates, damping, seconds)?;
        let energy: f64 = rates.iter().map(|v| v * v / 2.0).sum();
        let share = 100.0 * farthest / longest_side(shape.model().mesh().rest_positions());
        let who = match bodies[..] {
            [one] => format!("body {one}"),
            _ => format!("{} bodies from {}", bodies.len(), bodies[0]),
        };
        lines.push(format!(
            "{who} ({}): shake gives {} J; alone it moves vertices by at most {} m in the first {} s ({}% of \
             the longest side)",
            certified.name,
            length(energy),
            length(farthest),
            length(seconds),
            length(share)
        ));
    }
    Ok(lines)
}

/// Returns size, mass and first frequency of a model, by which a user notices wrong units.
fn facts(recipe: &Recipe, model: &PreparedModel) -> Result<String> {
    let side = longest_side(model.shape.model().mesh().rest_positions());
    let stiffness = model.shape.elasticity().stiffness();
    let first = natural_frequencies(stiffness)?.into_iter().fold(f64::INFINITY, f64::min);
    // The files of a held body may state no mass.
    let is_known = !(model.is_held() && matches!(recipe.modes, ModesSpec::Given));
    Ok(size_and_mass(side, is_known.then(|| model.shape.mass().mass), first))
}

/// Returns an upper bound of the displacement of a vertex by the free vibration that begins with these rates, with the
/// stiffness at rest.
fn farthest(
    model: &ReducedModel,
    stiffness: &Stiffness,
    rates: &[f64],
    damping: Damping,
    seconds: f64,
) -> Result<f64> {
    if stiffness.is_diagonal() {
        let eigenvalues: Vec<f64> = stiffness.diagonal().collect();
        return of_vibrations(model.modes(), &eigenvalues, rates, damping, seconds);
    }
    let found = diagonalize(model.modes(), stiffness)?;
    let rank = rates.len();
    let rotated: Vec<f64> =
        (0..rank).map(|k| (0..rank).map(|i| found.rotation[i * rank + k] * rates[i]).sum()).collect();
    of_vibrations(&found.modes, &found.eigenvalues, &rotated, damping, seconds)
}

fn of_vibrations(
    modes: &Modes,
    eigenvalues: &[f64],
    rates: &[f64],
    damping: Damping,
    seconds: f64,
) -> Result<f64> {
    // Checks all eigenvalues, so that an error names the mode.
    LinearOscillator::new(eigenvalues, damping, seconds).at(|| "shake")?;
    let mut peaks = Vec::with_capacity(rates.len());
    for (eigenvalue, rate) in eigenvalues.iter().zip(rates) {
        let time = peak_time(*eigenvalue, damping.of(*eigenvalue)).min(seconds);
        // A single step is exact, however long it is.
        let oscillator = LinearOscillator::new(&[*eigenvalue], damping, time).at(|| "shake")?;
        let (mut q, mut v) = ([0.0], [*rate]);
        oscillator.advance(&mut q, &mut v, &[0.0]);
        peaks.push(q[0].abs());
    }
    let displacement =
        |of: &[glam::DVec3]| -> f64 { of.iter().zip(&peaks).map(|(u, peak)| u.length() * peak).sum() };
    Ok(modes.displacements().chunks_exact(rates.len()).map(displacement).fold(0.0, f64::max))
}

/// Returns the time (s) at which the free vibration from q = 0 is farthest from there; infinite if it moves away for
/// ever. No later peak is higher.
fn peak_time(eigenvalue: f64, damping: f64) -> f64 {
    let a = damping / 2.0;
    let d = eigenvalue - a * a;
    let root = d.abs().sqrt();
    if d > 0.0 {
        libm::atan2(root, a) / root
    } else if d < 0.0 {
        libm::atanh(root / a) / root
    } else {
        1.0 / a
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn the_peak_is_the_largest_displacement_of_short_steps() {
        let modes = Modes::new(1, vec![DVec3::ZERO, DVec3::Y, DVec3::ZERO]).unwrap();
        // Underdamped, critically damped and overdamped modes, and modes without stiffness.
        let cases =
            [(100.0, 0.0), (100.0, 3.0), (100.0, 20.0), (100.0, 50.0), (1e-9, 1e3), (0.0, 3.0), (0.0, 0.0)];
        for (eigenvalue, mass) in cases {
            let damping = Damping { mass, stiffness: 0.0 };
            for seconds in [0.01, 1.0] {
                let found = of_vibrations(&modes, &[eigenvalue], &[-0.1], damping, seconds).unwrap();
                let oscillator = LinearOscillator::new(&[eigenvalue], damping, seconds / 1e4).unwrap();
                let (mut q, mut v, mut largest) = ([0.0], [-0.1], 0.0_f64);
                for _ in 0..10_000 {
                    oscillator.advance(&mut q, &mut v, &[0.0]);
                    largest = largest.max(q[0].abs());
                }
                let case = (eigenvalue, mass, seconds);
                assert!((found / largest - 1.0).abs() < 1e-6, "{case:?}: {found}, not {largest}");
            }
        }
    }

    #[test]
    fn the_displacement_is_the_peak_of_the_vibration() {
        // One vertex moves by 2 along x for a unit of the mode of 3 Hz.
        let u = [DVec3::ZERO, 2.0 * DVec3::X, DVec3::ZERO];
        let (modes, rate) = (Modes::new(1, u.to_vec()).unwrap(), 6.0 * std::f64::consts::PI);
        let of = |damping: f64, seconds: f64| {
            let damping = Damping { mass: damping, stiffness: 0.0 };
            of_vibrations(&modes, &[rate * rate], &[0.1], damping, seconds).unwrap()
        };
        assert!((of(0.0, 1.0) / (0.2 / rate) - 1.0).abs() < 1e-6);
        assert!(of(20.0, 1.0) < 0.7 * of(0.0, 1.0));
        // The time is a quarter of that of the peak.
        let early = 0.2 / rate * (rate * 0.01).sin();
        assert!((of(0.0, 0.01) / early - 1.0).abs() < 1e-6);
    }

    #[test]
    fn coupled_modes_are_separated() {
        // Two vertices on two coupled springs: rates along the eigenvector of eigenvalue 1.
        let mut u = vec![DVec3::ZERO; 6];
        (u[0], u[3]) = (DVec3::X, DVec3::X);
        let mesh =
            sscc::TriMesh::new([0.0, 1.0, 2.0].map(|x| DVec3::new(x, x * x, 0.0)).to_vec(), vec![[0, 1, 2]]);
        let model = ReducedModel::new(mesh.unwrap(), Modes::new(2, u).unwrap()).unwrap();
        let stiffness = Stiffness::new(2, vec![2.0, -1.0, -1.0, 2.0]).unwrap();
        let found = farthest(&model, &stiffness, &[0.1, 0.1], Damping::default(), 10.0).unwrap();
        assert!((found - 0.1).abs() < 1e-6, "{found}");
    }
}
