//! Scenes: bodies that swing, whole for what collides, some steps of it for the times.

use anyhow::Result;
use sscc::{Progress, Query};

use super::Session;
use super::case::Case;
use super::measure::{Asked, Step, measure, spread};
use super::report::{Report, Whole};
use super::scenario::Scene;
use super::vibration::{SCENE_STEPS, Swing, Vibration};
use crate::interrupt::Interrupt;
use crate::output::Output;
use crate::progress::Bar;

/// Steps that are measured, if nothing is said.
const STEPS: usize = 100;

/// Steps are measured in so many blocks, spread evenly over the scene.
const BLOCKS: usize = 10;

/// Gives the number of mismatches.
pub fn run(session: &Session<'_>, scenes: &[Scene], out: &mut Output) -> Result<usize> {
    let wanted = session.args.steps.map_or(STEPS, |steps| steps as usize);
    let mut mismatches = 0;
    for scene in scenes {
        let case = Case::get(&scene.recipe, session)?;
        let Vibration { bodies, share } = Vibration::new(&case, scene.objects)?;
        let bodies: Vec<Vec<Vec<f64>>> = bodies.iter().map(Swing::scene).collect();
        let whole = whole(&case, &bodies)?;
        let at = |i: usize| -> Vec<Vec<f64>> { bodies.iter().map(|body| body[i].clone()).collect() };
        let steps = blocks(SCENE_STEPS, wanted).into_iter();
        let steps: Vec<Step> = steps.map(|i| Step { q_t0: at(i), q_t1: at(i + 1) }).collect();
        let measured = measure(&case, &steps, Asked::Both, &Bar::new("measuring"))?;
        mismatches += measured.mismatches;
        let report = Report::new(scene.name.into(), share, &case, &measured, scene.objects, Some(whole));
        session.print(&[report], out)?;
    }
    Ok(mismatches)
}

/// Numbers of `wanted` of the steps, in blocks.
fn blocks(steps: usize, wanted: usize) -> Vec<usize> {
    let wanted = wanted.min(steps);
    let count = BLOCKS.min(wanted);
    let starts = spread(&(0..steps).collect::<Vec<_>>(), count);
    let length = |block: usize| wanted / count + usize::from(block < wanted % count);
    starts.into_iter().enumerate().flat_map(|(block, start)| start..start + length(block)).collect()
}

/// What collides in the whole scene.
fn whole(case: &Case, bodies: &[Vec<Vec<f64>>]) -> Result<Whole> {
    let query = Query::new(&case.model, &case.full.certificates)?;
    let bar = Bar::new("simulating");
    let mut colliding = vec![0; SCENE_STEPS];
    for (index, body) in bodies.iter().enumerate() {
        let answers = query.batch(&body[..SCENE_STEPS], None, &Interrupt)?;
        for (bodies, answer) in colliding.iter_mut().zip(answers) {
            *bodies += usize::from(!answer.pairs.is_empty());
        }
        bar.report(index + 1, bodies.len());
    }
    Ok(Whole {
        steps: SCENE_STEPS,
        colliding_steps: colliding.iter().filter(|bodies| **bodies > 0).count(),
        body_steps: SCENE_STEPS * bodies.len(),
        colliding_body_steps: colliding.iter().sum(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_cover_the_scene() {
        assert_eq!(blocks(600, 20)[..4], [0, 1, 60, 61]);
        assert_eq!(blocks(600, 3), [0, 200, 400]);
        assert_eq!(blocks(600, 12)[..5], [0, 1, 60, 61, 120]);
        for wanted in [1, 10, 33, 599, 600, 10_000] {
            let steps = blocks(600, wanted);
            assert_eq!(steps.len(), wanted.min(600));
            assert!(steps.windows(2).all(|pair| pair[0] < pair[1]) && steps.iter().all(|i| *i < 600));
        }
    }
}
