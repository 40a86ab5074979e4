//! Tests that answers are those of the core.

use std::ffi::{CStr, c_int, c_void};
use std::ptr::{null, null_mut};

use sscc_c::*;

use crate::common::{FACES, Handles, MODE, TWO, done, faces, lifted, made, matrix};

const PAIR: sscc_pair = sscc_pair { a: 0, b: 1 };

// SAFETY: in all calls here arrays have the stated lengths, and handles are live.

#[test]
fn a_query_returns_pairs_impacts_and_proofs() {
    let all = Handles::new();
    let (mut count, mut pair) = (9, sscc_pair { a: 7, b: 7 });
    unsafe {
        done(sscc_query_discrete(all.query, &0.5, 1, &mut count));
        assert_eq!(count, 0);
        done(sscc_query_pairs(all.query, null_mut(), 0));
        let mut statistics = std::mem::zeroed();
        done(sscc_query_statistics(all.query, &mut statistics));
        let sscc_statistics { norm, proof, complete, .. } = statistics;
        assert!((norm - 0.5).abs() < 1e-9);
        assert_eq!((proof, complete), (sscc_proof::Radius, 1));
        assert!((0.5..=1.0).contains(&sscc_certificates_root_radius(all.certificates)));

        done(sscc_query_discrete(all.query, &1.0, 1, &mut count));
        done(sscc_query_pairs(all.query, &mut pair, 1));
        assert_eq!((count, pair), (1, PAIR));
        done(sscc_query_statistics(all.query, &mut statistics));
        assert_eq!(statistics.proof, sscc_proof::Search);
        done(sscc_query_discrete_at_most(all.query, &1.0, 1, 0, &mut count));
        assert_eq!(count, 0);
        done(sscc_query_statistics(all.query, &mut statistics));
        assert_eq!(statistics.complete, 0);

        pair = sscc_pair { a: 7, b: 7 };
        done(sscc_query_first(all.query, &1.0, 1, &mut pair, &mut count));
        assert_eq!((count, pair), (1, PAIR));
        done(sscc_query_first(all.query, &1.0, 1, null_mut(), &mut count));
        assert_eq!(count, 1);
        done(sscc_query_first(all.query, &3.0, 1, &mut pair, &mut count));
        assert_eq!(count, 0);

        let mut impact = sscc_impact { a: 7, b: 7, time: 7.0 };
        done(sscc_query_continuous(all.query, &0.0, &2.0, 1, &mut count));
        assert_eq!(count, 1);
        done(sscc_query_impacts(all.query, &mut impact, 1));
        done(sscc_query_pairs(all.query, &mut pair, 1));
        assert_eq!((impact.a, impact.b, pair), (0, 1, PAIR));
        assert!((impact.time - 0.5).abs() < 1e-9);

        let mut scale = 0.0;
        done(sscc_query_safe_scale(all.query, &2.0, 1, &mut scale));
        assert!((0.4..=0.5).contains(&scale), "{scale}");
    }
}

#[test]
fn a_kinetic_query_follows_a_motion() {
    let all = Handles::new();
    let mut touching = Vec::new();
    let mut count = 0;
    unsafe {
        for step in 0..32 {
            done(sscc_kinetic_discrete(all.kinetic, &(f64::from(step) / 16.0), 1, &mut count));
            if count > 0 {
                touching.push(step);
                let mut pair = sscc_pair { a: 7, b: 7 };
                done(sscc_kinetic_pairs(all.kinetic, &mut pair, 1));
                assert_eq!(pair, PAIR);
            }
        }
        assert_eq!(touching, [16]);
        done(sscc_kinetic_continuous(all.kinetic, &0.0, &2.0, 1, &mut count));
        assert_eq!(count, 1);
        let mut impact = sscc_impact { a: 7, b: 7, time: 7.0 };
        done(sscc_kinetic_impacts(all.kinetic, &mut impact, 1));
        assert!((impact.time - 0.5).abs() < 1e-9);
        let mut statistics = std::mem::zeroed();
        done(sscc_kinetic_statistics(all.kinetic, &mut statistics));
        assert!((statistics.norm - 2.0).abs() < 1e-9 && statistics.complete == 1);
    }
}

#[test]
fn a_detector_takes_positions_in_any_order_of_storage() {
    let all = Handles::new();
    let [rest, met, passed] = [0.0, 1.0, 2.0].map(|q| all.positions(q));
    // Positions by columns, and rows in structs of five numbers.
    let columns: Vec<f64> = (0..18).map(|i| met[3 * (i % 6) + i / 6]).collect();
    let by_columns =
        sscc_matrix { data: columns.as_ptr(), rows: 6, columns: 3, row_stride: 1, column_stride: 6 };
    let structs: Vec<f64> = met.chunks(3).flat_map(|x| [x[0], x[1], x[2], f64::NAN, f64::NAN]).collect();
    let in_structs =
        sscc_matrix { data: structs.as_ptr(), rows: 6, columns: 3, row_stride: 5, column_stride: 1 };
    let mut count = 0;
    unsafe {
        done(sscc_detector_discrete(all.detector, matrix(&rest, 3), &mut count));
        assert_eq!(count, 0);
        for x in [matrix(&met, 3), by_columns, in_structs] {
            let mut pair = sscc_pair { a: 7, b: 7 };
            done(sscc_detector_discrete(all.detector, x, &mut count));
            done(sscc_detector_pairs(all.detector, &mut pair, 1));
            assert_eq!((count, pair), (1, PAIR));
            pair.a = 7;
            done(sscc_detector_first(all.detector, x, &mut pair, &mut count));
            assert_eq!((count, pair), (1, PAIR));
            done(sscc_detector_discrete_at_most(all.detector, x, 0, &mut count));
            assert_eq!(count, 0);
        }
        let mut impact = sscc_impact { a: 7, b: 7, time: 7.0 };
        done(sscc_detector_continuous(all.detector, matrix(&rest, 3), matrix(&passed, 3), &mut count));
        done(sscc_detector_impacts(all.detector, &mut impact, 1));
        assert_eq!((count, impact.a, impact.b), (1, 0, 1));
        let mut statistics = std::mem::zeroed();
        done(sscc_detector_statistics(all.detector, &mut statistics));
        assert_eq!((statistics.norm, statistics.triangle_tests > 0), (0.0, true));

        // Each triangle of one mesh coincides with one of the other.
        let other = made(|out| sscc_detector_clone(all.detector, out));
        let mut pairs = [PAIR; 2];
        done(sscc_detector_against(all.detector, matrix(&rest, 3), other, matrix(&rest, 3), &mut count));
        done(sscc_detector_pairs(all.detector, pairs.as_mut_ptr(), 2));
        assert_eq!((count, pairs), (2, [sscc_pair { a: 0, b: 0 }, sscc_pair { a: 1, b: 1 }]));
        let [x, y] = [[&rest, &passed], [&rest, &rest]].map(|ends| ends.map(|x| matrix(x, 3)));
        let detector = all.detector;
        done(sscc_detector_continuous_against(detector, x[0], x[1], other, y[0], y[1], &mut count));
        assert_eq!(count, 3);
        done(sscc_detector_free(other));
    }
}

#[test]
fn shapes_in_the_world_meet() {
    let all = Handles::new();
    let mut count = 0;
    unsafe {
        let other = made(|out| sscc_shape_new(all.model, null(), out));
        let copy = made(|out| sscc_shape_clone(other, out));
        let mut bounds = std::mem::zeroed();
        done(sscc_shape_place(other, &0.0, 1, &lifted(1.0), &mut bounds));
        assert!(bounds.lower[2] <= 1.0 && bounds.upper[2] >= 2.0 && bounds.upper[2] < 2.1);
        for given in [null(), &raw const bounds] {
            done(sscc_shape_against(all.shape, other, given, &mut count));
            let mut pair = PAIR;
            done(sscc_shape_pairs(all.shape, &mut pair, 1));
            assert_eq!((count, pair), (1, sscc_pair { a: 1, b: 0 }));
        }
        done(sscc_shape_place(other, &0.0, 1, &lifted(0.5), null_mut()));
        done(sscc_shape_against(all.shape, other, null(), &mut count));
        assert_eq!(count, 0);
        // A copy has the pose of the shape.
        done(sscc_shape_place(copy, &0.0, 1, null(), null_mut()));
        done(sscc_shape_against(all.shape, copy, null(), &mut count));
        assert_eq!(count, 2);
        // The rotation is given row by row, and maps x to y.
        let mut turned = lifted(0.0);
        turned.rotation = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        done(sscc_shape_place(copy, &0.0, 1, &turned, &mut bounds));
        assert!(bounds.lower[0] < -0.9 && bounds.upper[0] < 0.1 && bounds.upper[1] > 0.9);
        done(sscc_shape_free(other));
        done(sscc_shape_free(copy));
    }
}

#[test]
fn answers_are_visited_until_the_callback_ends_it() {
    extern "C" fn add(user: *mut c_void, pair: sscc_pair) -> c_int {
        let found = unsafe { &mut *user.cast::<Vec<sscc_pair>>() };
        found.push(pair);
        c_int::from(found.len() == 3)
    }
    let all = Handles::new();
    let (mut count, mut found) = (0, Vec::<sscc_pair>::new());
    let user = (&raw mut found).cast();
    unsafe {
        done(sscc_query_discrete(all.query, &1.0, 1, &mut count));
        done(sscc_query_visit_pairs(all.query, Some(add), user));
        done(sscc_kinetic_discrete(all.kinetic, &1.0, 1, &mut count));
        done(sscc_kinetic_visit_pairs(all.kinetic, Some(add), user));
        let met = all.positions(1.0);
        done(sscc_detector_discrete(all.detector, matrix(&met, 3), &mut count));
        assert_eq!(sscc_detector_visit_pairs(all.detector, Some(add), user), sscc_status::Cancelled);
        done(sscc_shape_visit_pairs(all.shape, Some(add), user));
    }
    assert_eq!(found, [PAIR; 3]);
}

#[test]
fn each_option_has_its_effect() {
    let all = Handles::new();
    unsafe {
        let compute = |options: &sscc_certify_options| {
            made(|out| sscc_certificates_compute(all.model, options, None, None, null_mut(), out))
        };
        let mut options: sscc_certify_options = std::mem::zeroed();
        options.size = size_of_val(&options);
        let radius_of = |options: &sscc_certify_options| {
            let certificates = compute(options);
            let radius = sscc_certificates_root_radius(certificates);
            done(sscc_certificates_free(certificates));
            radius
        };
        let usual = sscc_certificates_root_radius(all.certificates);
        assert_eq!(radius_of(&options), usual);
        (options.budget, options.local_budget, options.threads) = (32, 32, 1);
        (options.max_exceptions, options.epsilon, options.reach) = (3, 0.1, 1.0);
        assert_eq!(radius_of(&options), usual);
        (options.budget, options.local_budget, options.scheme) = (0, 0, sscc_scheme::Paper as i32);
        assert_eq!(radius_of(&options), usual);
        // Another unit of |z|, and another centre.
        let scales = [10.0];
        (options.metric, options.scales, options.scales_count) =
            (sscc_metric::Scales as i32, scales.as_ptr(), 1);
        assert!((radius_of(&options) / usual - 10.0).abs() < 1e-6);
        (options.metric, options.scales, options.scales_count) = (sscc_metric::Identity as i32, null(), 0);
        assert!((radius_of(&options) / usual - 1.0).abs() < 1e-6);
        for metric in [sscc_metric::Mass, sscc_metric::Displacement, sscc_metric::Model] {
            options.metric = metric as i32;
            assert!(radius_of(&options) > 0.0);
        }
        let center = [-1.0];
        (options.center, options.center_count) = (center.as_ptr(), 1);
        let certificates = compute(&options);
        let query = made(|out| sscc_query_new(all.model, certificates, out));
        let mut statistics = std::mem::zeroed();
        done(sscc_query_discrete(query, &-1.0, 1, &mut 0));
        done(sscc_query_statistics(query, &mut statistics));
        assert_eq!(statistics.norm, 0.0);
        done(sscc_query_free(query));
        done(sscc_certificates_free(certificates));
        // The triangles collide at this centre, unless the pair is ignored, or its triangles are in one group.
        let center = [1.0];
        options.center = center.as_ptr();
        let certificates = compute(&options);
        assert_eq!(sscc_certificates_exception_count(certificates), 1);
        done(sscc_certificates_free(certificates));
        let mut filter: sscc_filter = std::mem::zeroed();
        filter.size = size_of_val(&filter);
        options.filter = &filter;
        let exceptions = |filter: &sscc_filter| {
            let certificates = compute(&sscc_certify_options { filter, ..options });
            let count = sscc_certificates_exception_count(certificates);
            done(sscc_certificates_free(certificates));
            count
        };
        assert_eq!(exceptions(&filter), 1);
        let ignored = [sscc_pair { a: 1, b: 0 }];
        (filter.ignored, filter.ignored_count) = (ignored.as_ptr(), 1);
        assert_eq!(exceptions(&filter), 0);
        filter.ignored_count = 0;
        let groups = [4_u32, 4];
        (filter.groups, filter.groups_count, filter.between_groups_only) = (groups.as_ptr(), 2, 1);
        assert_eq!(exceptions(&filter), 0);
        filter.between_groups_only = 0;
        assert_eq!(exceptions(&filter), 1);
    }
}

#[test]
fn a_filter_decides_which_neighbours_count() {
    // Two triangles with one vertex in common, the second one across the first.
    let x = [0.0, 0.0, 0.0, 2.0, -1.0, 0.0, 2.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, -1.0];
    let corner = [0, 1, 2, 0, 3, 4];
    let mut filter: sscc_filter = unsafe { std::mem::zeroed() };
    filter.size = size_of_val(&filter);
    let count = |filter: &sscc_filter| {
        let mut count = 9;
        unsafe {
            let detector = made(|out| sscc_detector_new(matrix(&x, 3), faces(&corner), filter, out));
            done(sscc_detector_discrete(detector, matrix(&x, 3), &mut count));
            done(sscc_detector_free(detector));
        }
        count
    };
    assert_eq!(count(&filter), 0);
    filter.neighbours = sscc_neighbours::IncludeOneVertex as i32;
    assert_eq!(count(&filter), 1);
    filter.neighbours = sscc_neighbours::IncludeFolded as i32;
    assert_eq!(count(&filter), 1);
    // With split vertices the triangles are adjacent only if these are welded.
    filter.neighbours = sscc_neighbours::Exclude as i32;
    let (x, split) = ([&x[..9], &x[..3], &x[9..]].concat(), [0, 1, 2, 3, 4, 5]);
    for (weld, wanted) in [(sscc_weld::Default, 1), (sscc_weld::Off, 1), (sscc_weld::On, 0)] {
        filter.weld = weld as i32;
        let mut count = 9;
        unsafe {
            let detector = made(|out| sscc_detector_new(matrix(&x, 3), faces(&split), &filter, out));
            done(sscc_detector_discrete(detector, matrix(&x, 3), &mut count));
            done(sscc_detector_free(detector));
        }
        assert_eq!(count, wanted, "{weld:?}");
    }
}

#[test]
fn a_model_returns_its_sizes_faces_and_positions() {
    let all = Handles::new();
    let mut found = [0; 6];
    unsafe {
        assert_eq!(sscc_model_rank(all.model), 1);
        assert_eq!(sscc_model_vertex_count(all.model), 6);
        assert_eq!(sscc_model_triangle_count(all.model), 2);
        done(sscc_model_faces(all.model, found.as_mut_ptr(), 2));
        // Modes given column by column result in the same model.
        let by_columns =
            sscc_matrix { data: MODE.as_ptr(), rows: 18, columns: 1, row_stride: 1, column_stride: 18 };
        let model = made(|out| sscc_model_new(matrix(&TWO, 3), faces(&FACES), by_columns, out));
        let query = made(|out| sscc_query_new(model, all.certificates, out));
        done(sscc_query_free(query));
        done(sscc_model_free(model));
        assert_eq!(CStr::from_ptr(sscc_version()).to_str(), Ok(env!("CARGO_PKG_VERSION")));
    }
    assert_eq!(found, FACES);
    assert_eq!(all.positions(0.0), TWO);
    assert_eq!(all.positions(1.0)[11], 0.0);
    assert_eq!(sscc_abi_version(), SSCC_ABI_VERSION);
}
