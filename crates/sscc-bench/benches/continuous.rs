//! Measures continuous queries beside discrete ones: `cargo bench -p sscc-bench --bench continuous` (paper, Table 2).
//!
//! Each model moves along trajectories about the rest pose, `z_k(t) = a_k sin(w_k t) / k` with random a, w and phase.
//! They are scaled so that the largest displacement of a vertex is a few percent of half the AABB's diagonal. One step
//! is 1/60 of a period of about one. All methods run on the same steps, on one thread, and must list the same pairs.
//! Arguments name the models; without arguments all are measured. Real models are taken from `SSCC_MODELS`, else from
//! `../shared/models`.
#![allow(clippy::print_stdout)]

mod models;

use std::time::Instant;

use models::Result;
use sscc::{Certificates, Method, Query, ReducedModel};

/// Largest displacements, in percent of half the diagonal of the AABB.
const SHARES: [f64; 3] = [1.0, 5.0, 20.0];

const TRAJECTORIES: usize = 5;
const STEPS: usize = 8;

fn main() -> Result<()> {
    println!(
        "| model | share | colliding | pairs | discrete: traditional, ms | certified | continuous: traditional | bdtree | certified | \
         traditional continuous / discrete | certified speed-up, discrete | continuous | tested |"
    );
    println!("| --- {} |", "| --- ".repeat(12));
    let wanted: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    for case in models::all()? {
        if wanted.is_empty() || wanted.iter().any(|name| name == case.name) {
            let certificates = Certificates::compute(&case.model, &case.options, &())?;
            for share in SHARES {
                measure(&case, &certificates, share)?;
            }
        }
    }
    Ok(())
}

fn measure(case: &models::Case, certificates: &Certificates, share: f64) -> Result<()> {
    let model = &case.model;
    let query = |method| Query::with_method(model, certificates, method);
    let mut traditional = query(Method::Traditional)?;
    let (mut bd_tree, mut certified) = (query(Method::BdTree)?, query(Method::Certified)?);
    let mut random = sscc_bench::Random(7);
    let (mut seconds, mut colliding, mut pairs, mut tests) = ([0.0; 5], 0, 0, 0);
    for _ in 0..TRAJECTORIES {
        let waves: Vec<[f64; 3]> =
            (0..model.rank()).map(|_| [random.normal(), 1.0 + random.uniform(), random.uniform()]).collect();
        let at = |t: f64| {
            let wave = |(k, [a, w, phase]): (usize, &[f64; 3])| {
                a * libm::sin(std::f64::consts::TAU * (w * t + phase)) / (k + 1) as f64
            };
            model.metric().unscaled(&waves.iter().enumerate().map(wave).collect::<Vec<_>>())
        };
        let steps: Vec<Vec<f64>> =
            (0..=STEPS).map(|i| at(i as f64 / 60.0)).collect::<std::result::Result<_, sscc::Error>>()?;
        let scale = share / 100.0 / displacement(model, &steps)?;
        let steps: Vec<Vec<f64>> = steps.iter().map(|q| q.iter().map(|x| x * scale).collect()).collect();
        for ends in steps.windows(2) {
            let [q_t0, q_t1] = [&ends[0], &ends[1]];
            let mut timed = |slot: usize, run: &mut dyn FnMut() -> Result<()>| -> Result<()> {
                let start = Instant::now();
                run()?;
                seconds[slot] += start.elapsed().as_secs_f64();
                Ok(())
            };
            timed(0, &mut || Ok(traditional.discrete(q_t1).map(|_| ())?))?;
            timed(1, &mut || Ok(certified.discrete(q_t1).map(|_| ())?))?;
            timed(2, &mut || Ok(traditional.continuous(q_t0, q_t1).map(|_| ())?))?;
            timed(3, &mut || Ok(bd_tree.continuous(q_t0, q_t1).map(|_| ())?))?;
            timed(4, &mut || Ok(certified.continuous(q_t0, q_t1).map(|_| ())?))?;
            let expected = traditional.pairs();
            let equal = bd_tree.pairs() == expected && certified.pairs() == expected;
            assert!(equal, "{}: methods differ from {q_t0:?} to {q_t1:?}", case.name);
            colliding += usize::from(!expected.is_empty());
            pairs += expected.len();
            tests += traditional.statistics().triangle_tests;
        }
    }
    let count = (TRAJECTORIES * STEPS) as f64;
    let ms = seconds.map(|s| s * 1e3 / count);
    println!(
        "| {} | {share}% | {colliding} of {count} | {:.0} | {:.2} | {:.5} | {:.2} | {:.2} | {:.5} | {:.2} | {:.1} | {:.1} | {:.0} |",
        case.name,
        pairs as f64 / count,
        ms[0],
        ms[1],
        ms[2],
        ms[3],
        ms[4],
        ms[2] / ms[0],
        ms[0] / ms[1],
        ms[2] / ms[4],
        tests as f64 / count,
    );
    Ok(())
}

/// Returns the largest displacement of a vertex at some of the q, in units of half the diagonal of the AABB.
fn displacement(model: &ReducedModel, steps: &[Vec<f64>]) -> Result<f64> {
    let rest = model.mesh().rest_positions();
    let (lower, upper) = rest.iter().fold((rest[0], rest[0]), |(l, u), p| (l.min(*p), u.max(*p)));
    let mut largest = 0.0_f64;
    for q in steps {
        for (x, p) in model.positions(q)?.iter().zip(rest) {
            largest = largest.max(x.distance(*p));
        }
    }
    Ok(largest / ((upper - lower).length() / 2.0))
}
