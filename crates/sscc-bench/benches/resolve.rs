//! Measures `Query::resolve` on real models: `cargo bench -p sscc-bench --bench resolve`. `-- 1000` sets the number of
//! samples of each row (default: 20).
//!
//! A sample is a random direction in q-space (`z_k = N(0,1)`) about a free centre, scaled to a multiple of the scale at
//! which the shape first collides; multiples are enlarged by 10% until the shape does collide there. Each row states the share of samples
//! that were resolved. For these it states the distance from q, over the distance of a step back along the ray by
//! `safe_scale` and to the last free q on the ray. Brute force confirms every answer. Real models are taken from
//! `SSCC_MODELS`, else from `../shared/models`.
#![allow(clippy::print_stdout)]

mod models;

use std::time::Instant;

use models::Result;
use sscc::{Certificates, CertifyOptions, Method, Query, ReducedModel, ResolveOptions};

/// Multiples of the scale at which the shape first collides.
const MULTIPLES: [f64; 3] = [1.1, 1.5, 2.0];

fn main() -> Result<()> {
    let samples = std::env::args().filter_map(|arg| arg.parse().ok()).next().unwrap_or(20);
    println!(
        "| model | scale over that of first contact | resolved | distance over that of safe_scale: 10% | median | 90% | \
         over the last free q on the ray: median | 90% | ms: median | 90% | most |"
    );
    println!("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    let Some(folder) = sscc_testing::models("the bench of resolve") else { return Ok(()) };
    let (letter, modes) = (folder.join("vega_A/A.obj"), folder.join("vega_A/A.URendering.float"));
    let letter = sscc_io::load_model(&letter, Some(&modes))?.0;
    let options = CertifyOptions::default().budget(0).local_budget(0);
    measure("vega_A", &letter, &options, samples)?;
    if let Some((face, _)) = models::face()? {
        let mut open = vec![0.0; face.rank()];
        open[0] = 1.0;
        measure("ict_face", &face, &options.center(open), samples)?;
    }
    Ok(())
}

fn measure(name: &str, model: &ReducedModel, options: &CertifyOptions, samples: usize) -> Result<()> {
    let certificates = Certificates::compute(model, options, &())?;
    assert!(certificates.exceptions().is_empty() && certificates.root_radius() > 0.0);
    let scope = &certificates.parts().scope;
    let mut query = Query::new(model, &certificates)?;
    let mut oracle = Query::without_certificates(model, scope.clone(), Method::BruteForce)?;
    for multiple in MULTIPLES {
        let mut random = sscc_bench::Random(1);
        let (mut resolved, mut ratios, mut ray_ratios, mut times) = (0, Vec::new(), Vec::new(), Vec::new());
        for _ in 0..samples {
            let z: Vec<f64> = (0..model.rank()).map(|_| random.normal()).collect();
            let dir = scope.metric.unscaled(&z)?;
            let at = |t: f64| -> Vec<f64> { scope.center.iter().zip(&dir).map(|(c, d)| c + t * d).collect() };
            let mut scale = certificates.root_radius() / certificates.norm(&at(1.0))?;
            let mut contact = None;
            while contact.is_none() {
                contact = query.time_of_impact(&at(0.0), &at(scale))?;
                scale *= 2.0;
            }
            let mut scale = contact.unwrap_or_default() * scale / 2.0 * multiple;
            while query.first(&at(scale))?.is_none() {
                scale *= 1.1;
            }
            let q = at(scale);
            let stepped_back = certificates.norm(&q)? * (1.0 - query.safe_scale(&q)?.min(1.0));
            let start = Instant::now();
            let found = query.resolve(&q, &ResolveOptions::default())?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
            let Some(free) = found.q else { continue };
            resolved += 1;
            assert!(oracle.first(&free)?.is_none(), "{name}: {free:?} is not free");
            ratios.push(found.change / stepped_back);
            ray_ratios.push(found.change / found.safe_scale_change);
        }
        let at = |values: &mut Vec<f64>, share: f64| {
            values.sort_by(f64::total_cmp);
            values.get((share * values.len().saturating_sub(1) as f64) as usize).copied().unwrap_or(f64::NAN)
        };
        println!(
            "| {name} | {multiple} | {:.1}% | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.0} | {:.0} | {:.0} |",
            100.0 * resolved as f64 / samples as f64,
            at(&mut ratios, 0.1),
            at(&mut ratios, 0.5),
            at(&mut ratios, 0.9),
            at(&mut ray_ratios, 0.5),
            at(&mut ray_ratios, 0.9),
            at(&mut times, 0.5),
            at(&mut times, 0.9),
            at(&mut times, 1.0),
        );
    }
    Ok(())
}
