//! Tests of handles that are freed, freed twice, or of another type. The library of the tests has debug assertions, which detect that.

use std::ptr::null_mut;

use sscc_c::*;

use crate::common::{Handles, done, made, refused};

// SAFETY: with debug assertions the library does not access a freed handle.

#[test]
fn a_handle_that_was_freed_is_refused() {
    const { assert!(cfg!(debug_assertions)) };
    let all = Handles::new();
    let mut count = 9;
    unsafe {
        let query = made(|out| sscc_query_clone(all.query, out));
        done(sscc_query_free(query));
        refused(sscc_query_free(query), sscc_status::Handle, "query is no live handle: it was freed");
        refused(sscc_query_discrete(query, &0.5, 1, &mut count), sscc_status::Handle, "query");
        let kinetic = made(|out| sscc_kinetic_clone(all.kinetic, out));
        done(sscc_kinetic_free(kinetic));
        refused(sscc_kinetic_free(kinetic), sscc_status::Handle, "kinetic");
        let detector = made(|out| sscc_detector_clone(all.detector, out));
        done(sscc_detector_free(detector));
        refused(sscc_detector_free(detector), sscc_status::Handle, "detector");
        let shape = made(|out| sscc_shape_clone(all.shape, out));
        done(sscc_shape_free(shape));
        refused(sscc_shape_free(shape), sscc_status::Handle, "shape");
        refused(sscc_model_free(all.query.cast()), sscc_status::Handle, "model is no live handle");
        refused(sscc_certificates_free(all.model.cast()), sscc_status::Handle, "certificates");
        assert_eq!(sscc_model_rank(all.query.cast()), 0);
    }
    assert_eq!(count, 9);
}

#[test]
fn handles_outlive_the_objects_from_which_they_were_made() {
    let all = Handles::new();
    unsafe {
        let model = made(|out| {
            use crate::common::{FACES, MODE, TWO, faces, matrix};
            sscc_model_new(matrix(&TWO, 3), faces(&FACES), matrix(&MODE, 1), out)
        });
        let certificates =
            made(|out| sscc_certificates_compute(model, std::ptr::null(), None, None, null_mut(), out));
        let query = made(|out| sscc_query_new(model, certificates, out));
        done(sscc_model_free(model));
        done(sscc_certificates_free(certificates));
        let mut count = 0;
        done(sscc_query_discrete(query, &1.0, 1, &mut count));
        assert_eq!(count, 1);
        done(sscc_query_free(query));
    }
    drop(all);
}
