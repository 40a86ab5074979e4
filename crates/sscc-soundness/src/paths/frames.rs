//! Frames of a mesh without certificates, by the detector: discrete queries, and continuous ones from one frame to the next.

use sscc::glam::DVec3;
use sscc::{ContactFilter, Detector, Neighbours};

use super::continuous;
use super::share::some;
use crate::exact::Point;
use crate::exact::work;
use crate::models::{Extremes, Model};
use crate::oracle::{Bounds, Oracle};
use crate::random::Random;
use crate::setup::{direction, mesh_of};
use crate::tally::Tally;

/// Runs some frames of one mesh.
pub fn run(random: &mut Random, tally: &mut Tally, share: f64) {
    let extremes = if random.one_in(2) { Extremes::All } else { Extremes::Shape };
    let least = random.of(&[100, 300, 700]);
    let model = Model::random(random, least, extremes);
    let Ok(mesh) = mesh_of(&model) else {
        tally.reach("refused models");
        return;
    };
    let with_one_vertex = random.one_in(3);
    let neighbours = if with_one_vertex { Neighbours::IncludeOneVertex } else { Neighbours::Exclude };
    // Vertices that are welded at rest may move apart. This has no effect only if neighbours are excluded.
    let weld = !with_one_vertex && !random.one_in(6);
    let Ok(mut detector) = Detector::with_filter(&mesh, &ContactFilter::new(neighbours).weld(weld)) else {
        tally.wrong(|| format!("{}: its own mesh is refused", model.name));
        return;
    };
    let mut oracle = Oracle::new(&model.faces, model.points.len(), with_one_vertex);
    if weld {
        oracle = oracle.welded(&model.points, &vec![[0.0; 3]; model.points.len()]);
    }
    let size = Bounds::of(&model.points).size();
    let share = share * if oracle.pairs(&model.points).len() < 400 { 1.0 } else { 0.05 };
    let mut last = model.points.clone();
    for _ in 0..some(240, share) {
        if work::is_spent() {
            break;
        }
        let frame = next(random, &model, size, &last);
        let vectors = |points: &[Point]| points.iter().map(|p| DVec3::from_array(*p)).collect::<Vec<_>>();
        let place = || format!("{}: frame {frame:?}", model.name);
        match detector.discrete(&vectors(&frame)) {
            Ok(found) => tally.compare(found, &oracle.pairs(&frame), place),
            Err(error) => {
                tally.reach("refused frames");
                if is_within_range(&frame) {
                    tally.wrong(|| format!("{}: {error}", place()));
                }
                continue;
            }
        }
        if random.one_in(3) {
            // Both ends had a discrete answer before, or are the rest pose.
            match detector.continuous(&vectors(&last), &vectors(&frame)) {
                Ok(impacts) => {
                    let impacts = impacts.to_vec();
                    tally.reach("swept");
                    let is_whole = !with_one_vertex;
                    if is_whole {
                        continuous::check(random, tally, &oracle, [&last, &frame], &impacts, &model.name);
                    }
                }
                Err(error) => tally.wrong(|| format!("{}: swept: {error}", place())),
            }
        }
        last = frame;
    }
}

fn is_within_range(frame: &[Point]) -> bool {
    frame.iter().flatten().all(|x| x.abs() <= 0.5 * sscc::limits::LARGEST)
}

/// Returns the next frame: from the modes, with noise, or with a small step.
fn next(random: &mut Random, model: &Model, size: f64, last: &[Point]) -> Vec<Point> {
    let step = size * random.power(-6.0, -0.3);
    let y: Vec<f64> = direction(random, model).iter().map(|y| y * step).collect();
    let mut frame = model.positions(&y);
    match random.below(4) {
        0 => {
            let noise = size * random.power(-12.0, -2.0);
            frame.iter_mut().for_each(|p| {
                let by = random.point();
                *p = std::array::from_fn(|c| p[c] + noise * by[c]);
            });
        }
        1 => {
            let share = random.power(-6.0, 0.0);
            frame.iter_mut().zip(last).for_each(|(p, old)| {
                *p = std::array::from_fn(|c| old[c] + share * (p[c] - old[c]));
            });
        }
        _ => {}
    }
    frame
}
