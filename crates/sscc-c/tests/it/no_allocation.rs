//! Tests that repeated answers allocate nothing.

use std::ffi::{c_int, c_void};
use std::ptr::{null, null_mut};

use sscc_c::*;

use crate::common::{done, lifted, made, matrix};
use crate::threads::Strip;

extern "C" fn look(_user: *mut c_void, _pair: sscc_pair) -> c_int {
    0
}

// SAFETY: in all calls here arrays have the stated lengths, and handles are live.

#[test]
fn repeated_answers_allocate_nothing() {
    let strip = Strip::new();
    let frames = [0.0, -200.0, 20.0].map(|x| strip.positions(x));
    // Positions in structs of four numbers, which are copied.
    let wide: Vec<f64> = frames[1].chunks(3).flat_map(|x| [x[0], x[1], x[2], 0.0]).collect();
    let rows = wide.len() / 4;
    let wide = sscc_matrix { data: wide.as_ptr(), rows, columns: 3, row_stride: 4, column_stride: 1 };
    let mut pairs = vec![sscc_pair { a: 0, b: 0 }; 1 << 16];
    let mut impacts = vec![sscc_impact { a: 0, b: 0, time: 0.0 }; 1 << 16];
    unsafe {
        let query = made(|out| sscc_query_new(strip.model, strip.certificates, out));
        let kinetic = made(|out| sscc_kinetic_new(strip.model, strip.certificates, out));
        let rest = matrix(&frames[0], 3);
        let detector = made(|out| sscc_detector_new(rest, strip.faces(), null(), out));
        let other = made(|out| sscc_detector_clone(detector, out));
        let shape = made(|out| sscc_shape_new(strip.model, strip.certificates, out));
        let second = made(|out| sscc_shape_clone(shape, out));
        let (mut n, mut found) = (0, 0);
        let (p, i) = (pairs.as_mut_ptr(), impacts.as_mut_ptr());
        let mut answer = || {
            for x in [1e-9, -200.0, 20.0, -201.0] {
                let q = [0.0, 0.0, x];
                let (q, zero) = (q.as_ptr(), [0.0; 3].as_ptr());
                done(sscc_query_discrete(query, q, 3, &mut n));
                found += n;
                done(sscc_query_pairs(query, p, 1 << 16));
                done(sscc_query_visit_pairs(query, Some(look), null_mut()));
                done(sscc_query_first(query, q, 3, p, &mut n));
                done(sscc_query_continuous(query, zero, q, 3, &mut n));
                done(sscc_query_impacts(query, i, 1 << 16));
                done(sscc_kinetic_discrete(kinetic, q, 3, &mut n));
                done(sscc_kinetic_pairs(kinetic, p, 1 << 16));
                done(sscc_shape_place(shape, q, 3, &lifted(0.01), null_mut()));
                done(sscc_shape_against(shape, second, null(), &mut n));
                done(sscc_shape_pairs(shape, p, 1 << 16));
            }
            for x in [matrix(&frames[1], 3), wide, matrix(&frames[2], 3)] {
                done(sscc_detector_discrete(detector, x, &mut n));
                found += n;
                done(sscc_detector_pairs(detector, p, 1 << 16));
                done(sscc_detector_continuous(detector, rest, x, &mut n));
                done(sscc_detector_impacts(detector, i, 1 << 16));
                done(sscc_detector_against(detector, x, other, rest, &mut n));
            }
        };
        // Answers twice, because a kinetic query has other regions after another q.
        answer();
        answer();
        let counted = allocation_counter::measure(&mut answer);
        assert_eq!(counted.count_total, 0);
        assert!(found > 100, "{found}");
        done(sscc_query_free(query));
        done(sscc_kinetic_free(kinetic));
        done(sscc_detector_free(detector));
        done(sscc_detector_free(other));
        done(sscc_shape_free(shape));
        done(sscc_shape_free(second));
    }
}
