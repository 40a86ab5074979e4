//! Runs many kinetic queries in one process: memory does not grow, and answers equal those of the traditional method.
//! `cargo bench -p sscc-bench --bench endurance [-- STEPS]` (1,000,000 by default).
//!
//! The embedded spring of 20 modes swings with up to 2.5 times its root's radius, in small steps. Every 1,000,000 steps the pairs are
//! compared, and the peak memory since the last comparison (Linux) must be at most [`GROWTH`] above the peak before the first
//! comparison.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::time::Instant;

use sscc::{Certificates, CertifyOptions, KineticQuery, Method, Query};
use sscc_modes::shapes::elastic_spring;
use sscc_tasks::PeakMemory;

/// Number of configurations in one period.
const PERIOD: usize = 100_000;

/// Steps between two comparisons; not a multiple of the period.
const BETWEEN: usize = 1_000_003;

/// Maximum growth of memory after the first comparison, in bytes.
const GROWTH: u64 = 16 << 20;

fn main() -> Result<(), Box<dyn Error>> {
    let steps = std::env::args().skip(1).find(|text| !text.starts_with('-'));
    let steps: usize = steps.map_or(Ok(1_000_000), |text| text.parse())?;
    let model = elastic_spring(&())?.model;
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
    let mut kinetic = KineticQuery::new(&model, &certificates)?;
    let mut traditional = Query::with_method(&model, &certificates, Method::Traditional)?;

    let at = |i: usize| {
        let t = std::f64::consts::TAU * i as f64 / PERIOD as f64;
        let wave = |k: usize| libm::sin((k + 1) as f64 * t + k as f64) / (k + 1) as f64;
        model.metric().unscaled(&(0..model.rank()).map(wave).collect::<Vec<_>>())
    };
    let states = (0..PERIOD).map(at).collect::<Result<Vec<_>, _>>()?;
    let largest =
        states.iter().map(|q| certificates.norm(q)).try_fold(0.0, |m, n| n.map(|n| f64::max(m, n)))?;
    let scale = 2.5 * certificates.root_radius() / largest;
    let states: Vec<Vec<f64>> = states.iter().map(|q| q.iter().map(|x| x * scale).collect()).collect();

    let begin = Instant::now();
    let (mut colliding, mut compared, mut first) = (0_u64, 0_u64, None);
    let mut peak = PeakMemory::start();
    for step in 0..steps {
        let q = &states[step % PERIOD];
        colliding += u64::from(!kinetic.discrete(q)?.is_empty());
        if step % BETWEEN == BETWEEN / 2 {
            assert_eq!(kinetic.pairs(), traditional.discrete(q)?, "step {step}");
            compared += 1;
            let memory = peak.and_then(PeakMemory::bytes);
            peak = PeakMemory::start();
            first = first.or(memory);
            assert!(memory <= first.map(|bytes| bytes + GROWTH), "{first:?} bytes, then {memory:?} bytes");
            println!(
                "{step} steps, {colliding} colliding, {:.0} s, {memory:?} bytes",
                begin.elapsed().as_secs_f64()
            );
        }
    }
    let microseconds = 1e6 * begin.elapsed().as_secs_f64() / steps as f64;
    println!(
        "{steps} steps, {microseconds:.3} us each, {colliding} colliding; {compared} compared, all equal; {first:?} bytes"
    );
    Ok(())
}
