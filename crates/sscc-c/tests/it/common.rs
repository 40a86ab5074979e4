//! Arrays and handles for tests.

use std::ffi::{CStr, c_void};
use std::ptr::{null, null_mut};

use sscc_c::*;

/// The positions of two triangles one unit apart; one mode moves the second towards the first.
pub const TWO: [f64; 18] =
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0];
pub const FACES: [u32; 6] = [0, 1, 2, 3, 4, 5];
pub const MODE: [f64; 18] = {
    let mut mode = [0.0; 18];
    mode[11] = -1.0;
    mode[14] = -1.0;
    mode[17] = -1.0;
    mode
};

/// Returns numbers without gaps as a matrix.
pub fn matrix(numbers: &[f64], columns: usize) -> sscc_matrix {
    let rows = numbers.len() / columns;
    sscc_matrix { data: numbers.as_ptr(), rows, columns, row_stride: 0, column_stride: 0 }
}

pub fn faces(numbers: &[u32]) -> sscc_index_matrix {
    let rows = numbers.len() / 3;
    sscc_index_matrix { data: numbers.as_ptr(), rows, columns: 3, row_stride: 0, column_stride: 0 }
}

/// Checks that a call succeeded.
pub fn done(status: sscc_status) {
    assert_eq!(status, sscc_status::Ok, "{}", message());
}

/// Returns the message of the last failure.
pub fn message() -> String {
    // SAFETY: the text is valid until the next failure.
    unsafe { CStr::from_ptr(sscc_error_message()) }.to_str().unwrap().to_owned()
}

/// Checks that a call is refused with a status and with a message that contains a text.
#[track_caller]
pub fn refused(status: sscc_status, wanted: sscc_status, text: &str) {
    let message = message();
    assert_eq!(status, wanted, "{message}");
    assert!(message.contains(text) && !message.contains('\n'), "{message}");
}

/// Returns the handle that a function makes.
#[track_caller]
pub fn made<T>(make: impl FnOnce(*mut *mut T) -> sscc_status) -> *mut T {
    let mut handle = null_mut();
    done(make(&mut handle));
    handle
}

/// One handle of each type, made from [`TWO`].
pub struct Handles {
    pub model: *mut sscc_model,
    pub certificates: *mut sscc_certificates,
    pub query: *mut sscc_query,
    pub kinetic: *mut sscc_kinetic,
    pub detector: *mut sscc_detector,
    pub shape: *mut sscc_shape,
}

// SAFETY: in all functions here arrays have the stated lengths, and handles are live.
impl Handles {
    pub fn new() -> Self {
        unsafe {
            let model = made(|out| sscc_model_new(matrix(&TWO, 3), faces(&FACES), matrix(&MODE, 1), out));
            let certificates =
                made(|out| sscc_certificates_compute(model, null(), None, None, null_mut::<c_void>(), out));
            Self {
                model,
                certificates,
                query: made(|out| sscc_query_new(model, certificates, out)),
                kinetic: made(|out| sscc_kinetic_new(model, certificates, out)),
                detector: made(|out| sscc_detector_new(matrix(&TWO, 3), faces(&FACES), null(), out)),
                shape: made(|out| sscc_shape_new(model, certificates, out)),
            }
        }
    }

    /// Returns the positions at q.
    pub fn positions(&self, q: f64) -> [f64; 18] {
        let mut positions = [0.0; 18];
        done(unsafe { sscc_model_positions(self.model, &q, 1, positions.as_mut_ptr(), 6) });
        positions
    }
}

impl Drop for Handles {
    fn drop(&mut self) {
        unsafe {
            done(sscc_model_free(self.model));
            done(sscc_certificates_free(self.certificates));
            done(sscc_query_free(self.query));
            done(sscc_kinetic_free(self.kinetic));
            done(sscc_detector_free(self.detector));
            done(sscc_shape_free(self.shape));
        }
    }
}

/// Returns a pose that moves by z along the third axis.
pub fn lifted(z: f64) -> sscc_pose {
    sscc_pose { rotation: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], translation: [0.0, 0.0, z] }
}
