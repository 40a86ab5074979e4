//! Time of queries through the functions of C against those of Rust, interleaved, on the spring of the demo:
//! `sscc demo --out DIR`, then `cargo bench -p sscc-c -- DIR`. A query through C also copies its pairs; a query
//! in Rust returns a slice of them.
#![allow(unsafe_code, reason = "functions of C")]
#![allow(clippy::print_stdout, clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use std::ffi::CString;
use std::hint::black_box;
use std::path::Path;
use std::ptr::{null, null_mut};
use std::time::{Duration, Instant};

use sscc::glam::DVec3;
use sscc::{Detector, Proof, Query};
use sscc_c::*;
use sscc_io::{read_certificates, read_model, read_rows};

/// Repetitions of each measurement.
const REPETITIONS: usize = 301;

/// The smallest time of a measurement: short queries are repeated within it.
const LEAST: Duration = Duration::from_micros(200);

/// Prints the medians of both, and their ratio: calls through C first, then the same in Rust.
fn compare(name: &str, mut c: impl FnMut(), mut rust: impl FnMut()) {
    let mut count = 1;
    while time(count, &mut rust) < LEAST {
        count *= 2;
    }
    let mut times = [Vec::new(), Vec::new()];
    for repetition in 0..REPETITIONS {
        // The sides alternate in being first.
        for side in [repetition % 2, 1 - repetition % 2] {
            times[side].push(if side == 0 { time(count, &mut c) } else { time(count, &mut rust) });
        }
    }
    let [c, rust] = times.map(|mut side| {
        side.sort_unstable();
        side[REPETITIONS / 2].as_secs_f64() * 1e9 / f64::from(count)
    });
    println!("{name:<34} {c:>12.1} ns {rust:>12.1} ns   ratio {:.4}", c / rust);
}

fn time(count: u32, call: &mut impl FnMut()) -> Duration {
    let start = Instant::now();
    for _ in 0..count {
        call();
    }
    start.elapsed()
}

fn text(path: &Path) -> CString {
    CString::new(path.to_str().unwrap()).unwrap()
}

fn matrix(positions: &[DVec3]) -> sscc_matrix {
    let data = positions.as_ptr().cast();
    sscc_matrix { data, rows: positions.len(), columns: 3, row_stride: 0, column_stride: 0 }
}

fn main() {
    let Some(folder) = std::env::args().skip(1).find(|argument| !argument.starts_with('-')) else {
        println!("no folder of the demo: cargo bench -p sscc-c -- DIR");
        return;
    };
    let folder = Path::new(&folder);
    let [model_path, path] = ["spring.model.safetensors", "spring.sscc.safetensors"].map(|f| folder.join(f));
    let (model, _) = read_model(&model_path).unwrap();
    let certificates = read_certificates(&path).unwrap();
    let motion = read_rows(&folder.join("spring.npy")).unwrap();
    let frames: Vec<&[f64]> = motion.iter().collect();
    let (mut query, mut detector) = (Query::new(&model, &certificates).unwrap(), Detector::new(model.mesh()));
    let mut classes = [Vec::new(), Vec::new(), Vec::new()];
    for q in &frames {
        let is_free = query.discrete(q).unwrap().is_empty();
        let is_radius = query.statistics().proof == Proof::Radius;
        classes[if is_radius { 0 } else { 1 + usize::from(!is_free) }].push(*q);
    }
    // SAFETY: arrays have the stated lengths, and handles are live.
    unsafe {
        let (mut c_model, mut c_certificates) = (null_mut(), null_mut());
        let (mut c_query, mut c_detector) = (null_mut(), null_mut());
        let done = |status| assert_eq!(status, sscc_status::Ok);
        done(sscc_model_load(text(&model_path).as_ptr(), null(), &mut c_model));
        done(sscc_certificates_load(text(&path).as_ptr(), &mut c_certificates));
        done(sscc_query_new(c_model, c_certificates, &mut c_query));
        let (rest, faces) = (model.mesh().rest_positions(), model.mesh().faces().as_flattened());
        let (data, rows) = (faces.as_ptr(), faces.len() / 3);
        let faces = sscc_index_matrix { data, rows, columns: 3, row_stride: 0, column_stride: 0 };
        done(sscc_detector_new(matrix(rest), faces, null(), &mut c_detector));
        let mut pairs = vec![sscc_pair { a: 0, b: 0 }; 1 << 16];
        let (pairs, mut count) = (pairs.as_mut_ptr(), 0);

        println!("{:<34} {:>15} {:>15}", "median of a query", "C", "Rust");
        let names = ["free by the root's radius", "free, radius reached", "colliding"];
        for (name, class) in names.into_iter().zip(&classes) {
            // The frames follow each other in each measurement, as in an animation.
            let [mut i, mut j] = [0; 2];
            compare(
                name,
                || {
                    let q = class[i % class.len()];
                    i += 1;
                    done(sscc_query_discrete(c_query, black_box(q.as_ptr()), q.len(), &mut count));
                    if count > 0 {
                        done(sscc_query_pairs(c_query, pairs, 1 << 16));
                    }
                },
                || {
                    let q = class[j % class.len()];
                    j += 1;
                    black_box(query.discrete(black_box(q)).unwrap());
                },
            );
        }
        let shapes = [classes[1][0], classes[2][0]].map(|q| model.positions(q).unwrap());
        for (name, x) in ["detector, free", "detector, colliding"].into_iter().zip(&shapes) {
            let c = || {
                done(sscc_detector_discrete(c_detector, matrix(black_box(x)), &mut count));
                done(sscc_detector_pairs(c_detector, pairs, 1 << 16));
            };
            compare(name, c, || _ = black_box(detector.discrete(black_box(x)).unwrap()));
        }
    }
}
