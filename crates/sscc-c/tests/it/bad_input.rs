//! Tests of the status and message with which each function refuses pointers, arrays and numbers.

use std::ptr::{null, null_mut};

use sscc_c::sscc_status::*;
use sscc_c::*;

use crate::common::{FACES, Handles, MODE, TWO, done, faces, lifted, matrix, message, refused};

// SAFETY: all calls here are refused before an invalid argument is used, or have valid arguments.

/// Returns a pointer that is not a multiple of the size of a number.
fn misaligned<T>(array: &[T]) -> *const T {
    array.as_ptr().cast::<u8>().wrapping_add(1).cast()
}

#[test]
fn null_handles_are_refused() {
    let all = Handles::new();
    let x = matrix(&TWO, 3);
    let mut count = 9;
    let n = &raw mut count;
    let q = &0.5;
    let mut statistics = unsafe { std::mem::zeroed() };
    let mut handles = (null_mut(), null_mut(), null_mut(), null_mut());
    #[rustfmt::skip]
    let calls = unsafe {[
        ("model", sscc_model_save(null(), c"x".as_ptr())),
        ("model", sscc_model_faces(null(), null_mut(), 0)),
        ("model", sscc_model_positions(null(), q, 1, null_mut(), 0)),
        ("model", sscc_certificates_compute(null(), null(), None, None, null_mut(), &mut null_mut())),
        ("certificates", sscc_certificates_save(null(), c"x".as_ptr())),
        ("model", sscc_query_new(null(), all.certificates, &mut handles.0)),
        ("certificates", sscc_query_new(all.model, null(), &mut handles.0)),
        ("query", sscc_query_clone(null(), &mut handles.0)),
        ("query", sscc_query_set_cancel(null_mut(), None, null_mut())),
        ("query", sscc_query_discrete(null_mut(), q, 1, n)),
        ("query", sscc_query_discrete_at_most(null_mut(), q, 1, 1, n)),
        ("query", sscc_query_first(null_mut(), q, 1, null_mut(), n)),
        ("query", sscc_query_continuous(null_mut(), q, q, 1, n)),
        ("query", sscc_query_safe_scale(null_mut(), q, 1, &mut 0.0)),
        ("query", sscc_query_pairs(null(), null_mut(), 0)),
        ("query", sscc_query_impacts(null(), null_mut(), 0)),
        ("query", sscc_query_visit_pairs(null(), None, null_mut())),
        ("query", sscc_query_statistics(null(), &mut statistics)),
        ("model", sscc_kinetic_new(null(), all.certificates, &mut handles.1)),
        ("certificates", sscc_kinetic_new(all.model, null(), &mut handles.1)),
        ("kinetic", sscc_kinetic_clone(null(), &mut handles.1)),
        ("kinetic", sscc_kinetic_set_cancel(null_mut(), None, null_mut())),
        ("kinetic", sscc_kinetic_discrete(null_mut(), q, 1, n)),
        ("kinetic", sscc_kinetic_continuous(null_mut(), q, q, 1, n)),
        ("kinetic", sscc_kinetic_pairs(null(), null_mut(), 0)),
        ("kinetic", sscc_kinetic_impacts(null(), null_mut(), 0)),
        ("kinetic", sscc_kinetic_visit_pairs(null(), None, null_mut())),
        ("kinetic", sscc_kinetic_statistics(null(), &mut statistics)),
        ("detector", sscc_detector_clone(null(), &mut handles.2)),
        ("detector", sscc_detector_set_cancel(null_mut(), None, null_mut())),
        ("detector", sscc_detector_discrete(null_mut(), x, n)),
        ("detector", sscc_detector_discrete_at_most(null_mut(), x, 1, n)),
        ("detector", sscc_detector_first(null_mut(), x, null_mut(), n)),
        ("detector", sscc_detector_continuous(null_mut(), x, x, n)),
        ("detector", sscc_detector_against(null_mut(), x, all.detector, x, n)),
        ("detector", sscc_detector_against(all.detector, x, null_mut(), x, n)),
        ("detector", sscc_detector_against(null_mut(), x, null_mut(), x, n)),
        ("detector", sscc_detector_continuous_against(null_mut(), x, x, all.detector, x, x, n)),
        ("detector", sscc_detector_continuous_against(all.detector, x, x, null_mut(), x, x, n)),
        ("detector", sscc_detector_pairs(null(), null_mut(), 0)),
        ("detector", sscc_detector_impacts(null(), null_mut(), 0)),
        ("detector", sscc_detector_visit_pairs(null(), None, null_mut())),
        ("detector", sscc_detector_statistics(null(), &mut statistics)),
        ("model", sscc_shape_new(null(), all.certificates, &mut handles.3)),
        ("shape", sscc_shape_clone(null(), &mut handles.3)),
        ("shape", sscc_shape_place(null_mut(), q, 1, null(), null_mut())),
        ("shape", sscc_shape_against(null_mut(), all.shape, null(), n)),
        ("shape", sscc_shape_against(all.shape, null_mut(), null(), n)),
        ("shape", sscc_shape_pairs(null(), null_mut(), 0)),
        ("shape", sscc_shape_visit_pairs(null(), None, null_mut())),
    ]};
    for (i, (_, status)) in calls.iter().enumerate() {
        assert_eq!(*status, Null, "call {i}");
    }
    // Messages name the argument that is NULL; the last message is still available.
    assert_eq!(message(), format!("{} is NULL", calls.last().unwrap().0));
    assert_eq!((count, handles), (9, (null_mut(), null_mut(), null_mut(), null_mut())));
    unsafe {
        refused(sscc_query_discrete(null_mut(), q, 1, n), Null, "query is NULL");
        assert_eq!(sscc_model_rank(null()) + sscc_model_vertex_count(null()), 0);
        assert_eq!(sscc_model_triangle_count(null()) + sscc_certificates_exception_count(null()), 0);
        assert_eq!(sscc_certificates_root_radius(null()), 0.0);
        done(sscc_model_free(null_mut()));
        done(sscc_certificates_free(null_mut()));
        done(sscc_query_free(null_mut()));
        done(sscc_kinetic_free(null_mut()));
        done(sscc_detector_free(null_mut()));
        done(sscc_shape_free(null_mut()));
    }
}

#[test]
fn null_outputs_paths_and_callbacks_are_refused() {
    let all = Handles::new();
    let (x, f, q) = (matrix(&TWO, 3), faces(&FACES), &0.5);
    unsafe {
        refused(sscc_model_new(x, f, matrix(&MODE, 1), null_mut()), Null, "model is NULL");
        refused(sscc_model_load(c"x.obj".as_ptr(), null(), null_mut()), Null, "model is NULL");
        refused(sscc_model_load(null(), null(), &mut null_mut()), Null, "model_path is NULL");
        refused(sscc_model_save(all.model, null()), Null, "model_path is NULL");
        let computed = sscc_certificates_compute(all.model, null(), None, None, null_mut(), null_mut());
        refused(computed, Null, "certificates is NULL");
        refused(sscc_certificates_load(c"x".as_ptr(), null_mut()), Null, "certificates is NULL");
        refused(sscc_certificates_load(null(), &mut null_mut()), Null, "certificates_path is NULL");
        refused(sscc_certificates_save(all.certificates, null()), Null, "certificates_path is NULL");
        refused(sscc_query_new(all.model, all.certificates, null_mut()), Null, "query is NULL");
        refused(sscc_query_clone(all.query, null_mut()), Null, "copy is NULL");
        refused(sscc_query_discrete(all.query, q, 1, null_mut()), Null, "count is NULL");
        refused(sscc_query_discrete_at_most(all.query, q, 1, 1, null_mut()), Null, "count is NULL");
        refused(sscc_query_first(all.query, q, 1, null_mut(), null_mut()), Null, "count is NULL");
        refused(sscc_query_continuous(all.query, q, q, 1, null_mut()), Null, "count is NULL");
        refused(sscc_query_safe_scale(all.query, q, 1, null_mut()), Null, "scale is NULL");
        refused(sscc_query_statistics(all.query, null_mut()), Null, "statistics is NULL");
        refused(sscc_query_visit_pairs(all.query, None, null_mut()), Null, "visit is NULL");
        refused(sscc_kinetic_new(all.model, all.certificates, null_mut()), Null, "kinetic is NULL");
        refused(sscc_kinetic_clone(all.kinetic, null_mut()), Null, "copy is NULL");
        refused(sscc_kinetic_discrete(all.kinetic, q, 1, null_mut()), Null, "count is NULL");
        refused(sscc_kinetic_continuous(all.kinetic, q, q, 1, null_mut()), Null, "count is NULL");
        refused(sscc_kinetic_statistics(all.kinetic, null_mut()), Null, "statistics is NULL");
        refused(sscc_kinetic_visit_pairs(all.kinetic, None, null_mut()), Null, "visit is NULL");
        refused(sscc_detector_new(x, f, null(), null_mut()), Null, "detector is NULL");
        refused(sscc_detector_clone(all.detector, null_mut()), Null, "copy is NULL");
        refused(sscc_detector_discrete(all.detector, x, null_mut()), Null, "count is NULL");
        refused(sscc_detector_discrete_at_most(all.detector, x, 1, null_mut()), Null, "count is NULL");
        refused(sscc_detector_first(all.detector, x, null_mut(), null_mut()), Null, "count is NULL");
        refused(sscc_detector_continuous(all.detector, x, x, null_mut()), Null, "count is NULL");
        let mut other = null_mut();
        done(sscc_detector_clone(all.detector, &mut other));
        refused(sscc_detector_against(all.detector, x, other, x, null_mut()), Null, "count is NULL");
        let status = sscc_detector_continuous_against(all.detector, x, x, other, x, x, null_mut());
        refused(status, Null, "count is NULL");
        done(sscc_detector_free(other));
        refused(sscc_detector_statistics(all.detector, null_mut()), Null, "statistics is NULL");
        refused(sscc_detector_visit_pairs(all.detector, None, null_mut()), Null, "visit is NULL");
        refused(sscc_shape_new(all.model, null(), null_mut()), Null, "shape is NULL");
        refused(sscc_shape_clone(all.shape, null_mut()), Null, "copy is NULL");
        refused(sscc_shape_visit_pairs(all.shape, None, null_mut()), Null, "visit is NULL");
        let mut copy = null_mut();
        done(sscc_shape_clone(all.shape, &mut copy));
        refused(sscc_shape_against(all.shape, copy, null(), null_mut()), Null, "count is NULL");
        done(sscc_shape_free(copy));
        refused(sscc_shape_place(all.shape, null(), 1, null(), null_mut()), Null, "q is NULL");
    }
}

#[test]
fn invalid_matrices_are_refused() {
    let (x, f, u) = (matrix(&TWO, 3), faces(&FACES), matrix(&MODE, 1));
    let mut model = null_mut();
    let out = &raw mut model;
    let check = |x, f, u, status, text: &str| {
        refused(unsafe { sscc_model_new(x, f, u, out) }, status, text);
        // Detectors take the same mesh.
        if text.contains("positions") || text.contains("faces") {
            let made = unsafe { sscc_detector_new(x, f, null(), &mut null_mut()) };
            refused(made, status, text);
        }
    };
    check(sscc_matrix { data: null(), ..x }, f, u, Null, "positions is NULL");
    check(x, sscc_index_matrix { data: null(), ..f }, u, Null, "faces is NULL");
    check(x, f, sscc_matrix { data: null(), ..u }, Null, "modes is NULL");
    check(sscc_matrix { data: misaligned(&TWO), rows: 5, ..x }, f, u, Misaligned, "a multiple of 8");
    check(x, sscc_index_matrix { data: misaligned(&FACES), rows: 1, ..f }, u, Misaligned, "of 4");
    check(x, f, sscc_matrix { data: misaligned(&MODE), rows: 17, ..u }, Misaligned, "modes is misaligned");
    check(
        sscc_matrix { rows: 9, columns: 2, ..x },
        f,
        u,
        Argument,
        "positions has 2 columns: it must have 3",
    );
    check(x, sscc_index_matrix { rows: 3, columns: 2, ..f }, u, Argument, "faces has 2 columns");
    check(x, f, matrix(&MODE[..17], 1), Argument, "modes has 17 rows: it must have 3 for each of the 6");
    check(sscc_matrix { rows: usize::MAX, ..x }, f, u, Argument, "positions is larger than memory");
    check(sscc_matrix { rows: usize::MAX / 8, ..x }, f, u, Argument, "positions has length");
    // By the strides 2 and 9 rows and columns are interleaved without overlap.
    for (row_stride, column_stride) in [(2, 1), (1, 5), (3, 0), (0, 1), (1, 1), (2, 2), (2, 9)] {
        let x = sscc_matrix { row_stride, column_stride, ..x };
        let strides = format!("{row_stride} and {column_stride}");
        let text = format!("positions: elements overlap or are interleaved by the strides {strides}: each");
        check(x, f, u, Overlap, &text);
    }
    let mut far = FACES;
    far[4] = 6;
    check(x, faces(&far), u, Argument, "names vertex 6, but there are 6");
    check(x, faces(&[]), u, Argument, "no triangles");
    check(matrix(&[], 3), faces(&[]), matrix(&[], 1), Argument, "no triangles");
    check(x, f, sscc_matrix { rows: 18, columns: 0, ..u }, Argument, "rank 0");
    for number in [f64::NAN, f64::INFINITY, 1e70] {
        let mut numbers = TWO;
        numbers[7] = number;
        check(matrix(&numbers, 3), f, u, Argument, "vertex 2");
        check(x, f, matrix(&numbers, 1), Argument, "mode 0 of vertex 2");
    }
    assert!(model.is_null());
}

#[test]
fn queries_refuse_invalid_arrays() {
    let all = Handles::new();
    let numbers = [0.5; 4];
    let (mut count, q) = (9, numbers.as_ptr());
    let odd = misaligned(&numbers);
    let n = &raw mut count;
    unsafe {
        for (q, rank, status, text) in [
            (null(), 1, Null, "is NULL"),
            (odd, 1, Misaligned, "is misaligned: its address must be a multiple of 8"),
            (q, 2, Argument, "q has 2 entries, the model has 1 modes"),
            (q, 0, Argument, "q has 0 entries"),
            (null(), 0, Argument, "q has 0 entries"),
            (q, usize::MAX, Argument, "more than memory"),
            (&raw const NOT_A_NUMBER, 1, Argument, "NaN"),
        ] {
            refused(sscc_query_discrete(all.query, q, rank, n), status, text);
            refused(sscc_query_discrete_at_most(all.query, q, rank, 1, n), status, text);
            refused(sscc_query_first(all.query, q, rank, null_mut(), n), status, text);
            refused(sscc_query_continuous(all.query, q, q, rank, n), status, text);
            refused(sscc_query_safe_scale(all.query, q, rank, &mut 0.0), status, text);
            refused(sscc_kinetic_discrete(all.kinetic, q, rank, n), status, text);
            refused(sscc_kinetic_continuous(all.kinetic, q, q, rank, n), status, text);
            refused(sscc_shape_place(all.shape, q, rank, null(), null_mut()), status, text);
            let mut positions = [0.0; 18];
            refused(sscc_model_positions(all.model, q, rank, positions.as_mut_ptr(), 6), status, text);
        }
        refused(sscc_query_continuous(all.query, q, null(), 1, n), Null, "q_t1 is NULL");
        refused(sscc_kinetic_continuous(all.kinetic, q, odd, 1, n), Misaligned, "q_t1 is misaligned");
        refused(
            sscc_query_discrete(all.query, q, 1, odd.cast_mut().cast()),
            Misaligned,
            "count is misaligned",
        );
        refused(
            sscc_query_first(all.query, q, 1, odd.cast_mut().cast(), n),
            Misaligned,
            "pair is misaligned",
        );
        assert_eq!(count, 9);
        // A refused query has no answer.
        done(sscc_query_discrete(all.query, &1.0, 1, n));
        refused(sscc_query_discrete(all.query, q, 2, n), Argument, "entries");
        done(sscc_query_pairs(all.query, null_mut(), 0));
    }
}

static NOT_A_NUMBER: f64 = f64::NAN;

#[test]
fn detectors_and_shapes_refuse_invalid_arrays() {
    let all = Handles::new();
    let x = matrix(&TWO, 3);
    let (mut count, mut other, mut copy) = (9, null_mut(), null_mut());
    let n = &raw mut count;
    let detector = all.detector;
    unsafe {
        done(sscc_detector_clone(detector, &mut other));
        let mut far = TWO;
        far[4] = f64::INFINITY;
        for (y, status, text) in [
            (sscc_matrix { data: null(), ..x }, Null, "is NULL"),
            (sscc_matrix { data: misaligned(&TWO), rows: 5, ..x }, Misaligned, "is misaligned"),
            (sscc_matrix { rows: 5, ..x }, Argument, "there are 5 positions, but the mesh has 6 vertices"),
            (sscc_matrix { rows: 0, ..x }, Argument, "there are 0 positions"),
            (sscc_matrix { rows: 9, columns: 2, ..x }, Argument, "columns"),
            (sscc_matrix { row_stride: 2, column_stride: 1, ..x }, Overlap, "overlap"),
            (matrix(&far, 3), Argument, "vertex 1"),
        ] {
            refused(sscc_detector_discrete(detector, y, n), status, text);
            refused(sscc_detector_discrete_at_most(detector, y, 1, n), status, text);
            refused(sscc_detector_first(detector, y, null_mut(), n), status, text);
            refused(sscc_detector_continuous(detector, y, x, n), status, text);
            refused(sscc_detector_continuous(detector, x, y, n), status, text);
            refused(sscc_detector_against(detector, y, other, x, n), status, text);
            refused(sscc_detector_against(detector, x, other, y, n), status, text);
            for i in 0..4 {
                let mut at = [x; 4];
                at[i] = y;
                let [x0, x1, y0, y1] = at;
                let status_of = sscc_detector_continuous_against(detector, x0, x1, other, y0, y1, n);
                refused(status_of, status, text);
            }
        }
        refused(sscc_detector_against(detector, x, detector, x, n), Overlap, "are the same: use a copy");
        let status = sscc_detector_continuous_against(detector, x, x, detector, x, x, n);
        refused(status, Overlap, "are the same");
        done(sscc_detector_free(other));

        done(sscc_shape_clone(all.shape, &mut copy));
        refused(sscc_shape_against(all.shape, all.shape, null(), n), Overlap, "are the same");
        let odd = misaligned(&[0.0; 20]);
        refused(sscc_shape_against(all.shape, copy, odd.cast(), n), Misaligned, "bounds is misaligned");
        let bounds = sscc_box { lower: [0.0; 3], upper: [f64::NAN; 3] };
        refused(sscc_shape_against(all.shape, copy, &bounds, n), Argument, "bounds are not finite");
        refused(sscc_shape_place(copy, &0.0, 1, odd.cast(), null_mut()), Misaligned, "pose is misaligned");
        let bounds = odd.cast_mut().cast();
        refused(sscc_shape_place(copy, &0.0, 1, null(), bounds), Misaligned, "bounds is misaligned");
        refused(sscc_shape_place(copy, &0.0, 1, &lifted(f64::NAN), null_mut()), Argument, "2^200");
        done(sscc_shape_free(copy));
    }
    assert_eq!(count, 9);
}

/// Checks that each of these calls is refused and leaves no pairs, although the call before it had an answer with pairs.
fn leave_no_pairs(
    answer: &dyn Fn() -> sscc_status,
    pairs: &dyn Fn() -> sscc_status,
    calls: &[&dyn Fn() -> sscc_status],
) {
    for (i, call) in calls.iter().enumerate() {
        done(answer());
        assert_eq!(pairs(), Capacity, "call {i}");
        assert_ne!(call(), sscc_status::Ok, "call {i}");
        done(pairs());
    }
}

#[test]
fn a_refused_call_leaves_no_pairs() {
    let all = Handles::new();
    let (query, kinetic, detector, shape) = (all.query, all.kinetic, all.detector, all.shape);
    let (q, met) = (&1.0, all.positions(1.0));
    let (x, none) = (matrix(&met, 3), null_mut());
    let (mut count, mut other, mut copy) = (0, null_mut(), null_mut());
    let n = &raw mut count;
    unsafe {
        leave_no_pairs(
            &|| sscc_query_discrete(query, q, 1, n),
            &|| sscc_query_pairs(query, null_mut(), 0),
            &[
                &|| sscc_query_discrete(query, q, 1, none),
                &|| sscc_query_discrete_at_most(query, q, 1, 1, none),
                &|| sscc_query_first(query, q, 1, null_mut(), none),
                &|| sscc_query_continuous(query, q, q, 1, none),
                &|| sscc_query_safe_scale(query, q, 1, null_mut()),
            ],
        );
        leave_no_pairs(
            &|| sscc_kinetic_discrete(kinetic, q, 1, n),
            &|| sscc_kinetic_pairs(kinetic, null_mut(), 0),
            &[&|| sscc_kinetic_discrete(kinetic, q, 1, none), &|| {
                sscc_kinetic_continuous(kinetic, q, q, 1, none)
            }],
        );
        done(sscc_detector_clone(detector, &mut other));
        leave_no_pairs(
            &|| sscc_detector_discrete(detector, x, n),
            &|| sscc_detector_pairs(detector, null_mut(), 0),
            &[
                &|| sscc_detector_discrete(detector, x, none),
                &|| sscc_detector_discrete_at_most(detector, x, 1, none),
                &|| sscc_detector_first(detector, x, null_mut(), none),
                &|| sscc_detector_continuous(detector, x, x, none),
                &|| sscc_detector_against(detector, x, other, x, none),
                &|| sscc_detector_against(detector, x, detector, x, n),
                &|| sscc_detector_continuous_against(detector, x, x, other, x, x, none),
                &|| sscc_detector_continuous_against(detector, x, x, detector, x, x, n),
            ],
        );
        done(sscc_detector_free(other));
        done(sscc_shape_clone(shape, &mut copy));
        leave_no_pairs(
            &|| sscc_shape_against(shape, copy, null(), n),
            &|| sscc_shape_pairs(shape, null_mut(), 0),
            &[
                &|| sscc_shape_against(shape, copy, null(), none),
                &|| sscc_shape_against(shape, shape, null(), n),
                &|| sscc_shape_place(shape, null(), 1, null(), null_mut()),
            ],
        );
        done(sscc_shape_free(copy));
    }
}

#[test]
fn invalid_arrays_for_answers_are_refused() {
    let all = Handles::new();
    let mut count = 0;
    let (mut pairs, mut impacts) =
        ([sscc_pair { a: 7, b: 7 }; 2], [sscc_impact { a: 7, b: 7, time: 7.0 }; 2]);
    let (p, i) = (pairs.as_mut_ptr(), impacts.as_mut_ptr());
    let (odd_p, odd_i) = (misaligned(&pairs).cast_mut(), misaligned(&impacts).cast_mut());
    let small = "the answer has 1 entries, the array has place for 0";
    let x = all.positions(2.0);
    unsafe {
        done(sscc_query_continuous(all.query, &0.0, &2.0, 1, &mut count));
        done(sscc_kinetic_continuous(all.kinetic, &0.0, &2.0, 1, &mut count));
        done(sscc_detector_continuous(all.detector, matrix(&TWO, 3), matrix(&x, 3), &mut count));
        let mut copy = null_mut();
        done(sscc_shape_clone(all.shape, &mut copy));
        done(sscc_shape_place(copy, &0.0, 1, &lifted(1.0), null_mut()));
        done(sscc_shape_against(all.shape, copy, null(), &mut count));
        done(sscc_shape_free(copy));
        for status in [
            sscc_query_pairs(all.query, p, 0),
            sscc_query_impacts(all.query, i, 0),
            sscc_kinetic_pairs(all.kinetic, p, 0),
            sscc_kinetic_impacts(all.kinetic, i, 0),
            sscc_detector_pairs(all.detector, p, 0),
            sscc_detector_impacts(all.detector, i, 0),
            sscc_shape_pairs(all.shape, p, 0),
        ] {
            refused(status, Capacity, small);
        }
        for (status, wanted) in [
            (sscc_query_pairs(all.query, null_mut(), 1), Null),
            (sscc_query_impacts(all.query, null_mut(), 1), Null),
            (sscc_kinetic_pairs(all.kinetic, null_mut(), 1), Null),
            (sscc_kinetic_impacts(all.kinetic, null_mut(), 1), Null),
            (sscc_detector_pairs(all.detector, null_mut(), 1), Null),
            (sscc_detector_impacts(all.detector, null_mut(), 1), Null),
            (sscc_shape_pairs(all.shape, null_mut(), 1), Null),
            (sscc_query_pairs(all.query, odd_p, 1), Misaligned),
            (sscc_query_impacts(all.query, odd_i, 1), Misaligned),
            (sscc_kinetic_pairs(all.kinetic, odd_p, 1), Misaligned),
            (sscc_kinetic_impacts(all.kinetic, odd_i, 1), Misaligned),
            (sscc_detector_pairs(all.detector, odd_p, 1), Misaligned),
            (sscc_detector_impacts(all.detector, odd_i, 1), Misaligned),
            (sscc_shape_pairs(all.shape, odd_p, 1), Misaligned),
            (sscc_query_pairs(all.query, p, usize::MAX), Argument),
        ] {
            assert_eq!(status, wanted);
        }
        // The array may be larger than the answer.
        done(sscc_query_pairs(all.query, p, 2));
    }
    assert_eq!((pairs[1].a, impacts[0].a), (7, 7));
}

#[test]
fn functions_of_a_model_refuse_invalid_arrays() {
    let all = Handles::new();
    let mut vertices = [0; 6];
    let mut memory = [0.5; 19];
    unsafe {
        let f = vertices.as_mut_ptr();
        refused(sscc_model_faces(all.model, f, 1), Argument, "faces has place for 1: the model has 2");
        refused(sscc_model_faces(all.model, null_mut(), 2), Null, "faces is NULL");
        refused(sscc_model_faces(all.model, misaligned(&vertices).cast_mut(), 2), Misaligned, "faces");
        let x = memory.as_mut_ptr();
        let q = [0.5];
        let model = all.model;
        refused(sscc_model_positions(model, q.as_ptr(), 1, x, 5), Argument, "positions has place for 5");
        refused(sscc_model_positions(model, q.as_ptr(), 1, null_mut(), 6), Null, "positions is NULL");
        let odd = misaligned(&memory).cast_mut();
        refused(sscc_model_positions(model, q.as_ptr(), 1, odd, 6), Misaligned, "positions is misaligned");
        for within in [0, 9, 17] {
            let status = sscc_model_positions(model, x.add(within), 1, x, 6);
            refused(status, Overlap, "q and positions overlap");
        }
        // Adjacent arrays do not overlap.
        done(sscc_model_positions(model, x.add(18), 1, x, 6));
    }
}

#[test]
fn invalid_options_are_refused() {
    let all = Handles::new();
    let mut default: sscc_certify_options = unsafe { std::mem::zeroed() };
    default.size = size_of_val(&default);
    let mut filter: sscc_filter = unsafe { std::mem::zeroed() };
    filter.size = size_of_val(&filter);
    let check = |options: sscc_certify_options, text: &str| {
        let mut made = null_mut();
        let status =
            unsafe { sscc_certificates_compute(all.model, &options, None, None, null_mut(), &mut made) };
        refused(status, Argument, text);
        assert!(made.is_null());
    };
    let numbers = [1.0, -1.0];
    let data = numbers.as_ptr();
    let scales = sscc_metric::Scales as i32;
    check(sscc_certify_options { size: 0, ..default }, "options.size is 0: set it to sizeof");
    check(sscc_certify_options { size: 12, ..default }, "options.size is 12");
    check(sscc_certify_options { size: 1 << 20, ..default }, "options.size is 1048576");
    check(sscc_certify_options { epsilon: 1.0, ..default }, "epsilon is 1");
    check(sscc_certify_options { epsilon: f64::NAN, ..default }, "epsilon is NaN");
    check(sscc_certify_options { reach: 0.5, ..default }, "reach is 0.5");
    check(sscc_certify_options { scheme: 2, ..default }, "options.scheme is 2: that is none of its values");
    check(sscc_certify_options { scheme: 1, budget: 8, ..default }, "leave both budgets 0");
    check(sscc_certify_options { metric: -1, ..default }, "options.metric is -1");
    check(sscc_certify_options { metric: 5, ..default }, "options.metric is 5");
    check(
        sscc_certify_options { metric: scales, ..default },
        "options.scales has 0 entries, the model has 1 modes",
    );
    check(sscc_certify_options { scales: data, scales_count: 1, ..default }, "SSCC_METRIC_SCALES");
    let negative = sscc_certify_options { metric: scales, scales: &numbers[1], scales_count: 1, ..default };
    check(negative, "metric weight 0 (counted from 0) is -1");
    let two = sscc_certify_options { metric: scales, scales: data, scales_count: 2, ..default };
    check(two, "options.scales has 2 entries");
    check(sscc_certify_options { ignore_rest: 7, ..default }, "options.ignore_rest is 7");
    check(sscc_certify_options { center: data, center_count: 2, ..default }, "q has 2 entries");
    check(sscc_certify_options { center: &NOT_A_NUMBER, center_count: 1, ..default }, "NaN");
    let with = |filter: &sscc_filter, text| check(sscc_certify_options { filter, ..default }, text);
    with(&sscc_filter { size: 1, ..filter }, "filter.size is 1");
    with(&sscc_filter { weld: 3, ..filter }, "filter.weld is 3");
    with(&sscc_filter { neighbours: 3, ..filter }, "filter.neighbours is 3");
    with(&sscc_filter { neighbours: 2, ..filter }, "include-folded");
    with(&sscc_filter { between_groups_only: -1, ..filter }, "filter.between_groups_only is -1");
    with(&sscc_filter { between_groups_only: 1, ..filter }, "between_groups_only needs filter.groups");
    with(&sscc_filter { reserved: 1, ..filter }, "filter.reserved is 1: it must be 0");
    let ignored = [sscc_pair { a: 0, b: 2 }];
    with(
        &sscc_filter { ignored: ignored.as_ptr(), ignored_count: 1, ..filter },
        "names triangle 2, but there are 2",
    );
    let groups = [0, 1, 70_000];
    with(&sscc_filter { groups: groups.as_ptr(), groups_count: 3, ..filter }, "group 70000");
    // The groups are refused because they are of another mesh.
    let three = sscc_filter { groups: groups.as_ptr(), groups_count: 1, between_groups_only: 1, ..filter };
    with(&three, "groups");
    unsafe {
        let x = matrix(&TWO, 3);
        let made = sscc_detector_new(x, faces(&FACES), &sscc_filter { weld: 9, ..filter }, &mut null_mut());
        refused(made, Argument, "filter.weld is 9");
        let made = sscc_detector_new(x, faces(&FACES), &three, &mut null_mut());
        refused(made, Argument, "groups");
        let made = sscc_detector_new(x, faces(&FACES), misaligned(&[filter, filter]), &mut null_mut());
        refused(made, Misaligned, "filter is misaligned");
        let options = misaligned(&[default, default]);
        let made = sscc_certificates_compute(all.model, options, None, None, null_mut(), &mut null_mut());
        refused(made, Misaligned, "options is misaligned");
        let null_pairs = sscc_filter { ignored_count: 1, ..filter };
        refused(sscc_detector_new(x, faces(&FACES), &null_pairs, &mut null_mut()), Null, "filter.ignored");
        let null_groups = sscc_filter { groups_count: 2, ..filter };
        refused(
            sscc_detector_new(x, faces(&FACES), &null_groups, &mut null_mut()),
            Null,
            "filter.groups is NULL",
        );
        let options = sscc_certify_options { center_count: 1, ..default };
        let made = sscc_certificates_compute(all.model, &options, None, None, null_mut(), &mut null_mut());
        refused(made, Null, "options.center is NULL");
        let mut folded = null_mut();
        let folds = sscc_filter { neighbours: 2, ..filter };
        done(sscc_detector_new(x, faces(&FACES), &folds, &mut folded));
        refused(sscc_detector_continuous(folded, x, x, &mut 0), Argument, "include-folded");
        done(sscc_detector_free(folded));
    }
}

#[test]
fn structs_of_other_versions_are_accepted_unless_an_unknown_field_is_set() {
    #[repr(C)]
    struct Longer {
        filter: sscc_filter,
        next: u64,
    }
    let (x, f) = (matrix(&TWO, 3), faces(&FACES));
    let mut longer: Longer = unsafe { std::mem::zeroed() };
    longer.filter.size = size_of::<Longer>();
    let make = |filter: *const sscc_filter| unsafe {
        let mut detector = null_mut();
        let status = sscc_detector_new(x, f, filter, &mut detector);
        assert_eq!(status == Ok, !detector.is_null());
        done(sscc_detector_free(detector));
        status
    };
    // A later version whose new fields are 0, a version that set one, and an earlier one with fewer fields.
    done(make((&raw const longer).cast()));
    longer.next = 1;
    refused(
        make((&raw const longer).cast()),
        Argument,
        "fields that this version of the library does not know",
    );
    let sizes = [size_of::<usize>(), size_of_val(&[0_usize; 3])];
    for size in sizes {
        let shorter = [size, 0, 0];
        done(make(shorter.as_ptr().cast()));
    }
}

#[test]
fn certificates_of_another_model_are_refused() {
    let all = Handles::new();
    let mut mode = MODE;
    mode[0] = 0.25;
    unsafe {
        let mut model = null_mut();
        done(sscc_model_new(matrix(&TWO, 3), faces(&FACES), matrix(&mode, 1), &mut model));
        let certificates = all.certificates;
        refused(sscc_query_new(model, certificates, &mut null_mut()), OtherModel, "of another model");
        refused(sscc_kinetic_new(model, certificates, &mut null_mut()), OtherModel, "of another model");
        refused(sscc_shape_new(model, certificates, &mut null_mut()), OtherModel, "of another model");
        done(sscc_model_free(model));
    }
}
