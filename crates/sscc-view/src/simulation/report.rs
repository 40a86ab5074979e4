//! Reports of simulations: the page with the recorded motion, as one HTML file.

use sscc::Progress;
use sscc_modes::mode_frequencies;
use sscc_sim::FinishedRun;
use sscc_tasks::text::one_line;

use super::playback::playback;
use super::plots::{energy, sound};
use crate::{Arrays, MAX_REPORT_BYTES, ModelDetails, ModelScene, Report, Scene, ViewError};

/// Returns the report of a simulation as one HTML file. Omits the colliding triangles if `progress` cancels, and the shapes
/// with their motion if they would make it larger than [`MAX_REPORT_BYTES`].
///
/// # Errors
/// If a number of a model exceeds the range of the page.
pub fn simulation_report(run: &FinishedRun, progress: &dyn Progress) -> Result<String, ViewError> {
    let mut arrays = Arrays::default();
    let mut scene = Scene::new(&run.scene.name);
    for (index, model) in run.prepared.models.iter().enumerate() {
        let certified = &model.certified;
        let details = ModelDetails {
            frequencies: mode_frequencies(certified.elasticity.stiffness()),
            ..ModelDetails::default()
        };
        let (name, certificates) = (&certified.name, &certified.full.certificates);
        let made = ModelScene::new(index, name, &certified.model, certificates, details, &mut arrays);
        let named = |error| ViewError::Model { name: name.clone(), error: Box::new(error) };
        scene.models.push(made.map_err(named)?);
    }
    let stopped = run.failure.iter().map(|error| ("stopped early", error));
    let failures =
        stopped.chain(run.unmeasured.iter().map(|error| ("traditional method not measured", error)));
    let failures = failures.map(|(what, error)| (what.to_owned(), one_line(&error.to_string())));
    scene.summary = failures.chain(run.summary.table()).collect();
    scene.plots.push(energy(run));
    if run.scene.sound.is_some() {
        scene.plots.push(sound(run));
    }
    let (playback, notes) = playback(run, progress, &mut arrays)?;
    scene.playback = playback;
    scene.summary.extend(notes.into_iter().map(|note| ("note".to_owned(), note)));
    Ok(html_within(Report { scene, arrays, checks: None }, MAX_REPORT_BYTES)?)
}

/// Returns the report as one HTML file of at most `max` bytes: where the shapes and their motion would make it larger, without
/// them.
fn html_within(mut report: Report, max: u64) -> serde_json::Result<String> {
    // The arrays are most of a large report. In base64 three bytes are four letters.
    if report.arrays.bytes() as u64 / 3 * 4 <= max {
        let html = report.html()?;
        if html.len() as u64 <= max {
            return Ok(html);
        }
    }
    leave_out_shapes(&mut report);
    report.html()
}

/// Leaves out the shapes and their motion; the plots stay.
fn leave_out_shapes(Report { scene, arrays, .. }: &mut Report) {
    scene.models.clear();
    if let Some(costs) = scene.playback.take().and_then(|playback| playback.costs) {
        scene.plots.insert(0, costs);
    }
    *arrays = Arrays::default();
    let note = format!(
        "the report omits the shapes and their motion: with them it would be larger than {} MiB",
        MAX_REPORT_BYTES >> 20
    );
    scene.summary.push(("note".to_owned(), note));
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::{Axis, Body, Clock, Playback, Plot, Track};

    /// Returns a report with one mesh that moves in two frames, and with two plots.
    fn report() -> Report {
        let (mut scene, mut arrays) = (Scene::new("scene"), Arrays::default());
        let positions = vec![0.5; 3000];
        let bounds = (DVec3::ZERO, DVec3::ONE);
        scene.models.push(ModelScene::of_mesh(0, "mesh", &[0, 1, 2], &positions, bounds, &mut arrays));
        let plot = |title: &str| Plot {
            title: title.to_owned(),
            x: Axis::linear("time (s)"),
            y: Axis::linear("J"),
            series: Vec::new(),
        };
        scene.plots.push(plot("Energy"));
        scene.playback = Some(Playback {
            times: vec![0.0, 1.0],
            clock: Clock::Time,
            bodies: vec![Body {
                name: "mesh".to_owned(),
                model: 0,
                track: Track::Q(arrays.add_f32("q-0", [0.0, 1.0])),
                rigid: None,
                center: [0.0; 3],
                pairs: None,
            }],
            pairs_since: None,
            apart: String::new(),
            colliding: None,
            contacts: None,
            curves: None,
            ground: None,
            sound: None,
            costs: Some(plot("Cost over time")),
        });
        Report { scene, arrays, checks: None }
    }

    #[test]
    fn shapes_that_make_a_report_too_large_are_omitted() {
        let whole = report().html().unwrap();
        let size = whole.len() as u64;
        assert_eq!(html_within(report(), size).unwrap(), whole);
        let mut without = report();
        leave_out_shapes(&mut without);
        // The file is too large, or its arrays alone are.
        for max in [size - 1, 1000] {
            assert_eq!(html_within(report(), max).unwrap(), without.html().unwrap());
        }
        let Report { scene, arrays, .. } = without;
        assert!(scene.models.is_empty() && scene.playback.is_none() && arrays.bytes() == 0);
        let titles: Vec<&str> = scene.plots.iter().map(|plot| plot.title.as_str()).collect();
        assert_eq!(titles, ["Cost over time", "Energy"]);
        let note = "the report omits the shapes and their motion: with them it would be larger than 256 MiB";
        assert_eq!(scene.summary, [("note".to_owned(), note.to_owned())]);
    }
}
