//! Times of native queries on one thread, in the order and with the copies of `tests/time.mjs`, which compares them with those of the
//! package: `cargo bench -p sscc-wasm -- MODEL CERTIFICATES MOTION REPEATS` prints the smallest time of each q as JSON (microseconds).
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

use sscc::Query;
use sscc_io::{read_certificates, read_model, read_rows};

/// Queries of a q in one measurement, because clocks of JavaScript are coarse.
const QUERIES: u32 = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> =
        std::env::args_os().skip(1).filter(|word| word != "--bench").map(PathBuf::from).collect();
    let [model, certificates, motion, repeats] = &arguments[..] else {
        // `cargo bench` of all crates gives no files.
        return Ok(());
    };
    let repeats: u32 = repeats.to_string_lossy().parse()?;
    let model = read_model(model)?.0;
    let rows = read_rows(motion)?;
    let mut query = Query::new(&model, &read_certificates(certificates)?)?;
    let mut least = vec![f64::INFINITY; rows.rows];
    for _ in 0..repeats {
        for (q, least) in rows.iter().zip(&mut least) {
            let start = Instant::now();
            for _ in 0..QUERIES {
                black_box(query.discrete(black_box(q))?.to_vec());
            }
            *least = least.min(start.elapsed().as_secs_f64() * 1e6 / f64::from(QUERIES));
        }
    }
    println!("{least:?}");
    Ok(())
}
