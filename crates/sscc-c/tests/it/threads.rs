//! Tests of 32 threads that share a model and certificates; each has its own handles.

use std::ptr::{null, null_mut};
use std::thread;

use sscc_c::*;

use crate::common::{done, made, matrix, message, refused};

/// A zigzag strip of 400 triangles, bent by modes whose displacements grow along it.
pub struct Strip {
    pub model: *mut sscc_model,
    pub certificates: *mut sscc_certificates,
    indices: Vec<u32>,
    vertices: usize,
}

// SAFETY: models and certificates may be used by any number of threads; in all calls arrays have the stated lengths.
unsafe impl Sync for Strip {}

impl Strip {
    pub fn new() -> Self {
        let n = 200_usize;
        let vertices = 2 * n + 2;
        let rest: Vec<f64> = (0..vertices)
            .flat_map(|i| [(i / 2) as f64, (i % 2) as f64, 0.1 * ((i / 2) % 3) as f64])
            .collect();
        let indices: Vec<u32> = (0..2 * n as u32).flat_map(|i| [i, i + 1, i + 2]).collect();
        let modes: Vec<f64> = (0..3 * vertices)
            .flat_map(|row| {
                let along = (row / 3 / 2) as f64 / n as f64;
                [0, 1, 2].map(|k| if row % 3 == k { along.powi(k as i32 + 1) } else { 0.0 })
            })
            .collect();
        // In the last mode, along x, the strip is folded back onto itself.
        let modes: Vec<f64> = (0..3 * vertices)
            .flat_map(|row| {
                let along = (row / 3 / 2) as f64 / n as f64;
                [modes[3 * row], modes[3 * row + 1], if row % 3 == 0 { along * along } else { 0.0 }]
            })
            .collect();
        unsafe {
            let model = made(|out| {
                sscc_model_new(matrix(&rest, 3), crate::common::faces(&indices), matrix(&modes, 3), out)
            });
            let certificates =
                made(|out| sscc_certificates_compute(model, null(), None, None, null_mut(), out));
            Self { model, certificates, indices, vertices }
        }
    }

    pub fn faces(&self) -> sscc_index_matrix {
        crate::common::faces(&self.indices)
    }

    /// Returns the positions at which the last mode has this weight.
    pub fn positions(&self, weight: f64) -> Vec<f64> {
        let mut positions = vec![0.0; 3 * self.vertices];
        let q = [0.0, 0.0, weight];
        done(unsafe {
            sscc_model_positions(self.model, q.as_ptr(), 3, positions.as_mut_ptr(), self.vertices)
        });
        positions
    }
}

impl Drop for Strip {
    fn drop(&mut self) {
        unsafe {
            done(sscc_model_free(self.model));
            done(sscc_certificates_free(self.certificates));
        }
    }
}

#[test]
fn threads_get_the_same_answers() {
    let strip = Strip::new();
    let weights: Vec<f64> = (0..12).map(|i| -40.0 * f64::from(i)).collect();
    let answers = |strip: &Strip| -> Vec<Vec<sscc_pair>> {
        unsafe {
            let query = made(|out| sscc_query_new(strip.model, strip.certificates, out));
            let rest = strip.positions(0.0);
            let detector = made(|out| sscc_detector_new(matrix(&rest, 3), strip.faces(), null(), out));
            let of = |weight: f64| {
                let (mut count, q, x) = (0, [0.0, 0.0, weight], strip.positions(weight));
                done(sscc_query_discrete(query, q.as_ptr(), 3, &mut count));
                let mut pairs = vec![sscc_pair { a: 0, b: 0 }; count];
                done(sscc_query_pairs(query, pairs.as_mut_ptr(), count));
                done(sscc_detector_discrete(detector, matrix(&x, 3), &mut count));
                let mut again = vec![sscc_pair { a: 0, b: 0 }; count];
                done(sscc_detector_pairs(detector, again.as_mut_ptr(), count));
                assert_eq!(pairs, again);
                pairs
            };
            let all = weights.iter().copied().map(of).collect();
            done(sscc_query_free(query));
            done(sscc_detector_free(detector));
            all
        }
    };
    let wanted = answers(&strip);
    assert!(wanted[0].is_empty() && wanted.iter().any(|pairs| pairs.len() > 20));
    thread::scope(|scope| {
        for thread in 0..32 {
            let (strip, wanted, answers) = (&strip, &wanted, &answers);
            scope.spawn(move || {
                // Each thread has only the message of its own failures.
                assert_eq!(message(), "");
                let q = vec![0.0; thread + 4];
                let mut count = 0;
                let query = unsafe { made(|out| sscc_query_new(strip.model, strip.certificates, out)) };
                let status = unsafe { sscc_query_discrete(query, q.as_ptr(), q.len(), &mut count) };
                done(unsafe { sscc_query_free(query) });
                assert_eq!(&answers(strip), wanted);
                refused(status, sscc_status::Argument, &format!("q has {} entries", thread + 4));
            });
        }
    });
}
