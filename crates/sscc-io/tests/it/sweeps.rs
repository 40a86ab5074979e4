//! Sweeps of real blendshapes, against exact queries at many weights.

use sscc::{Certificates, CertifyOptions, KineticQuery, ModeRange, Query, ReducedModel, Sweep, SweepOutcome};
use sscc_io::{LoadOptions, load_model, load_model_with};
use sscc_testing::{cases, models};

/// Checks that queries find no collision from the start up to `first_free`, and that the brackets are narrow. Kinetic queries
/// answer most weights, because they are fast for weights close to each other.
fn check(model: &ReducedModel, certificates: &Certificates, q: &[f64], sweeps: &[Sweep], weights: usize) {
    let mut kinetic = KineticQuery::new(model, certificates).unwrap();
    let mut query = Query::new(model, certificates).unwrap();
    for sweep in sweeps {
        let at = |w: f64| {
            let mut q = q.to_vec();
            q[sweep.mode] = w;
            q
        };
        let Some(free) = sweep.first_free else {
            assert_eq!((sweep.outcome, sweep.first_hit), (SweepOutcome::CollidingAtStart, Some(sweep.from)));
            continue;
        };
        for i in 0..=weights {
            let w = sweep.from + (free - sweep.from) * (i as f64 / weights as f64);
            assert_eq!(kinetic.discrete(&at(w)).unwrap(), [], "mode {} at {w}", sweep.mode);
        }
        assert_eq!(query.discrete(&at(free)).unwrap(), [], "{sweep:?}");
        match (sweep.outcome, sweep.first_hit) {
            (SweepOutcome::Free, None) => assert_eq!(free, sweep.to),
            (SweepOutcome::Hit | SweepOutcome::WithinTolerance, Some(hit)) => {
                let is_exact = sweep.outcome == SweepOutcome::Hit;
                assert!(!is_exact || query.discrete(&at(hit)).unwrap() == sweep.pairs, "{sweep:?}");
                assert!(
                    !sweep.pairs.is_empty() && (hit - free).abs() <= 1e-9 * (sweep.to - sweep.from).abs()
                );
            }
            _ => panic!("{sweep:?}"),
        }
    }
}

fn certify(model: &ReducedModel, ignore_rest: bool, center: Option<Vec<f64>>) -> Certificates {
    let options = CertifyOptions::default().ignore_rest(ignore_rest.then_some(0)).center(center).budget(0);
    Certificates::compute(model, &options, &()).unwrap()
}

#[test]
fn morph_targets_of_gltf_files() {
    let Some(folder) = models("morph_targets_of_gltf_files") else { return };
    for (file, mesh) in [
        ("AnimatedMorphSphere.gltf", None),
        ("MorphStressTest.gltf", None),
        ("RobotExpressive.glb", Some("Head")),
    ] {
        let path = folder.join("morph").join(file);
        let loaded = load_model_with(&path, &LoadOptions::new(None, mesh)).unwrap();
        let model = &loaded.model;
        let certificates = certify(model, true, None);
        let query = Query::new(model, &certificates).unwrap();
        let q = vec![0.0; model.rank()];
        for ([low, high], hits) in [([0.0, 1.0], false), ([-3.0, 3.0], true)] {
            let ranges: Vec<_> = (0..model.rank()).map(|mode| ModeRange { mode, low, high }).collect();
            let sweeps = query.sweep_modes(&q, &ranges, None, &()).unwrap();
            assert_eq!(sweeps.len(), if hits { 2 } else { 1 } * model.rank());
            check(model, &certificates, &q, &sweeps, cases(10_000).max(4000) / 20);
        }
    }
}

#[test]
fn expressions_of_a_face() {
    let Some(folder) = models("expressions_of_a_face") else { return };
    let path = folder.join("ict_face/ict_face_neutral.obj");
    let modes = folder.join("ict_face/ict_face_expressions30.U.float");
    let (model, _) = load_model(&path, Some(&modes)).unwrap();
    let count = cases(32).min(30);
    let ranges: Vec<_> = (0..count).map(|mode| ModeRange { mode, low: 0.0, high: 1.0 }).collect();
    let weights = cases(10_000) / 25;
    // The pairs of closed lips and lids are ignored.
    let rest = vec![0.0; 30];
    let certificates = certify(&model, true, None);
    let query = Query::new(&model, &certificates).unwrap();
    let sweeps = query.sweep_modes(&rest, &ranges, None, &()).unwrap();
    check(&model, &certificates, &rest, &sweeps, weights);
    let hits = sweeps.iter().filter(|sweep| sweep.first_hit.is_some()).count();
    assert!(hits > 0);
    // The centre is the open mouth, which is free.
    let mut open = rest.clone();
    open[0] = 1.0;
    let certificates = certify(&model, false, Some(open.clone()));
    let query = Query::new(&model, &certificates).unwrap();
    let sweeps = query.sweep_modes(&open, &ranges, None, &()).unwrap();
    assert!(sweeps[0].to == 0.0 && sweeps[0].first_hit.is_some_and(|hit| hit > 0.0), "{:?}", sweeps[0]);
    check(&model, &certificates, &open, &sweeps, weights);
    // At rest the face collides.
    let all = certify(&model, false, None);
    let sweep = Query::new(&model, &all).unwrap().sweep(&rest, 0, 1.0).unwrap();
    assert_eq!((sweep.outcome, sweep.pairs.len()), (SweepOutcome::CollidingAtStart, 124));
}
