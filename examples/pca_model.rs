//! Counts the samples of a statistical shape model that intersect themselves, and repairs one of them.
//!
//! `cargo run --release -p sscc-examples --example pca_model [MODEL.npz]`
#![allow(clippy::print_stdout)]

use std::env;
use std::error::Error;
use std::f64::consts::TAU;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use sscc::{Certificates, CertifyOptions, Query};
use sscc_examples::{exit_code, mouths_npz};
use sscc_io::{LoadOptions, load_model_with};

const SAMPLES: usize = 2000;

fn main() -> ExitCode {
    exit_code(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?; // for the mouths; removed at the end
    let file = match env::args_os().nth(1) {
        Some(file) => PathBuf::from(file),
        None => mouths_npz(folder.path())?,
    };

    // The file has mean, components and faces under the names that PCA and body models use.
    let loaded = load_model_with(&file, &LoadOptions::default())?;
    let model = loaded.model;
    println!(
        "{}: {} triangles, {} components",
        loaded.info.provenance,
        model.mesh().faces().len(),
        model.rank()
    );
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
    println!("the mean itself has {} colliding pairs", certificates.rest_collisions());

    // A sample has independent normal coefficients, scaled by the standard deviations of q if the file has variances
    // (`explained_variance`).
    let deviations = loaded.info.deviations.clone().unwrap_or_else(|| vec![1.0; model.rank()]);
    let mut random = Random(1);
    let mut sample = || deviations.iter().map(|deviation| deviation * random.normal()).collect();
    let samples: Vec<Vec<f64>> = (0..SAMPLES).map(|_| sample()).collect();

    // A batch uses all cores. The answers do not depend on the number of threads.
    let mut query = Query::new(&model, &certificates)?;
    let start = Instant::now();
    let answers = query.batch(&samples, None, &())?;
    let seconds = start.elapsed().as_secs_f64();
    let bad: Vec<usize> = (0..SAMPLES).filter(|i| !answers[*i].pairs.is_empty()).collect();
    let quick = answers.iter().filter(|answer| answer.statistics.root_certified).count();
    println!("{SAMPLES} samples in {seconds:.3} s, {quick} of them answered by one comparison");
    println!(
        "{} of them intersect themselves: {:.1} %",
        bad.len(),
        100.0 * bad.len() as f64 / SAMPLES as f64
    );

    let Some(&i) = bad.first() else { return Ok(()) };
    let q = &samples[i];
    println!("sample {i}: {} pairs of triangles collide", answers[i].pairs.len());

    // The sample is scaled towards the mean until it and all shapes between are proven free.
    let scale = query.safe_scale(q)?;
    let repaired: Vec<f64> = q.iter().map(|x| scale * x).collect();
    println!("  safe_scale keeps {:.1} % of it: {} pairs", 100.0 * scale, query.count(&repaired)?);

    // It is scaled further, into the root's ellipsoid, where one comparison proves it free. This takes nanoseconds.
    if let Some(clamped) = certificates.clamp(q)? {
        let pairs = query.count(&clamped)?;
        println!(
            "  clamp keeps {:.1} %: {pairs} pairs",
            100.0 * query.statistics().norm / answers[i].statistics.norm
        );
    }
    Ok(())
}

/// A generator of pseudo-random numbers, the same in every run.
struct Random(u64);

impl Random {
    /// Returns a number that is uniformly distributed in (0, 1].
    fn uniform(&mut self) -> f64 {
        ((sscc::parts::next_bits(&mut self.0) >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a normally distributed number with mean 0 and deviation 1 (Box and Muller).
    fn normal(&mut self) -> f64 {
        (-2.0 * libm::log(self.uniform())).sqrt() * libm::cos(TAU * self.uniform())
    }
}
