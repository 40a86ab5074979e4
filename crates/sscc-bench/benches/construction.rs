//! Measures the time of certificates and of creating a query: `cargo bench -p sscc-bench --bench construction`, on all threads.
//!
//! `Query::new` checks the digest of the model and creates the state that queries keep. The bench prints the median of seven
//! times, and its share of the time of the certificates. Real models are taken from `SSCC_MODELS`, else from
//! `../shared/models`.
#![allow(clippy::print_stdout)]

mod models;

use std::hint::black_box;
use std::time::Instant;

use models::Result;
use sscc::{Certificates, Query};

const REPETITIONS: usize = 7;

fn main() -> Result<()> {
    println!("| model | certificates, s | `Query::new`, ms | share |");
    println!("| --- | ---: | ---: | ---: |");
    for case in models::all()? {
        let start = Instant::now();
        let certificates = Certificates::compute(&case.model, &case.options, &())?;
        let seconds = start.elapsed().as_secs_f64();
        let mut times = Vec::new();
        for _ in 0..REPETITIONS {
            let start = Instant::now();
            black_box(Query::new(&case.model, &certificates)?);
            times.push(start.elapsed().as_secs_f64());
        }
        times.sort_by(f64::total_cmp);
        let median = times[REPETITIONS / 2];
        println!("| {} | {seconds:.2} | {:.2} | {:.4} |", case.name, 1e3 * median, median / seconds);
    }
    Ok(())
}
