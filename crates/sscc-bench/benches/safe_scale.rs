//! Measures the safe scale relative to the scale at the root's radius: `cargo bench -p sscc-bench --bench safe_scale`.
//!
//! For each model the bench takes 1,000 random directions (`z_i = N(0,1) / i`, or `z_i = N(0,1)`), and prints this
//! ratio and its time. Traditional queries just below the safe scale and at random smaller scales must list no pairs.
//! Real models are taken from `SSCC_MODELS`, else from `../shared/models`.
#![allow(clippy::print_stdout)]

mod models;

use std::time::Instant;

use models::Result;
use sscc::{Certificates, Method, Query};

const DIRECTIONS: usize = 1000;

fn main() -> Result<()> {
    println!(
        "| model | farther than the root: 10% | median | 90% | collides within 2% beyond | ms | traditional, ms |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for model in models::all()? {
        let certificates = Certificates::compute(&model.model, &model.options, &())?;
        measure(&model, &certificates)?;
    }
    Ok(())
}

fn measure(model: &models::Case, certificates: &Certificates) -> Result<()> {
    let scope = &certificates.parts().scope;
    let mut query = Query::new(&model.model, certificates)?;
    let mut traditional = Query::with_method(&model.model, certificates, Method::Traditional)?;
    let mut random = sscc_bench::Random(1);
    let (mut gains, mut times, mut others, mut tight) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for direction in 0..DIRECTIONS {
        let decay = (direction % 2) as i32;
        let z: Vec<f64> =
            (0..model.model.rank()).map(|k| random.normal() / (1.0 + k as f64).powi(decay)).collect();
        let dir = scope.metric.unscaled(&z)?;
        let at = |t: f64| -> Vec<f64> { scope.center.iter().zip(&dir).map(|(c, d)| c + t * d).collect() };
        let start = Instant::now();
        let scale = query.safe_scale(&at(1.0))?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
        let root = certificates.root_radius() / query.statistics().norm;
        assert!(scale >= root * (1.0 - 1e-12), "{}: {scale} is below the root's {root}", model.name);
        gains.push(scale / root);
        for share in [1.0 - 1e-12, random.uniform()] {
            let q = at(scale * share);
            let start = Instant::now();
            let pairs = traditional.discrete(&q)?;
            others.push(start.elapsed().as_secs_f64() * 1e3);
            assert!(pairs.is_empty(), "{}: {pairs:?} collide at {share} of {scale}, q = {q:?}", model.name);
        }
        tight += usize::from(traditional.first(&at(scale * 1.02))?.is_some());
    }
    let at = |values: &mut Vec<f64>, share: f64| {
        values.sort_by(f64::total_cmp);
        values[(share * (values.len() - 1) as f64) as usize]
    };
    println!(
        "| {} | {:.2} x | {:.2} x | {:.2} x | {:.0}% | {:.1} | {:.1} |",
        model.name,
        at(&mut gains, 0.1),
        at(&mut gains, 0.5),
        at(&mut gains, 0.9),
        100.0 * tight as f64 / DIRECTIONS as f64,
        at(&mut times, 0.5),
        at(&mut others, 0.5)
    );
    Ok(())
}
