//! Models and certificates in files.

use std::ffi::CString;
use std::path::Path;
use std::ptr::{null, null_mut};

use glam::DVec3;
use sscc::{Certificates, CertifyOptions, Clearance, Modes, ReducedModel, TriMesh};
use sscc_c::*;

use crate::common::{Handles, MODE, TWO, done, made, refused};

fn c(path: &Path) -> CString {
    CString::new(path.to_str().unwrap()).unwrap()
}

// SAFETY: in all calls here texts end with 0, and handles are live.

#[test]
fn models_and_certificates_are_saved_and_loaded() {
    let all = Handles::new();
    let folder = tempfile::tempdir().unwrap();
    let [model_path, path] =
        ["two.model.safetensors", "two.sscc.safetensors"].map(|name| c(&folder.path().join(name)));
    let mut count = 0;
    unsafe {
        done(sscc_model_save(all.model, model_path.as_ptr()));
        done(sscc_certificates_save(all.certificates, path.as_ptr()));
        let model = made(|out| sscc_model_load(model_path.as_ptr(), null(), out));
        let certificates = made(|out| sscc_certificates_load(path.as_ptr(), out));
        let query = made(|out| sscc_query_new(model, certificates, out));
        done(sscc_query_discrete(query, &1.0, 1, &mut count));
        done(sscc_query_free(query));
        done(sscc_certificates_free(certificates));
        done(sscc_model_free(model));
    }
    assert_eq!(count, 1);
}

#[test]
fn a_mesh_is_loaded_with_its_modes() {
    let folder = tempfile::tempdir().unwrap();
    let [mesh, modes] = ["two.obj", "two.npy"].map(|name| folder.path().join(name));
    std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\nf 4 5 6\n")
        .unwrap();
    sscc_io::write_npy(&modes, &[18, 1], &MODE).unwrap();
    let (mesh, modes) = (c(&mesh), c(&modes));
    unsafe {
        let model = made(|out| sscc_model_load(mesh.as_ptr(), modes.as_ptr(), out));
        assert_eq!((sscc_model_rank(model), sscc_model_triangle_count(model)), (1, 2));
        done(sscc_model_free(model));
        let without = sscc_model_load(mesh.as_ptr(), null(), &mut null_mut());
        refused(without, sscc_status::File, "two.obj");
    }
}

#[test]
fn certificates_with_a_clearance_are_refused() {
    let rows = |numbers: &[f64]| numbers.chunks(3).map(DVec3::from_slice).collect::<Vec<_>>();
    let mesh = TriMesh::new(rows(&TWO), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let modes = Modes::new(1, rows(&MODE)).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let options = CertifyOptions::default().clearance(Clearance::new(0.25).unwrap());
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    assert!(certificates.root_radius() > 0.0);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("near.sscc.safetensors");
    sscc_io::write_certificates(&path, &certificates).unwrap();
    let mut loaded = null_mut();
    let status = unsafe { sscc_certificates_load(c(&path).as_ptr(), &mut loaded) };
    refused(status, sscc_status::Argument, "near.sscc.safetensors: the certificates have a clearance");
    assert!(loaded.is_null());
}

#[test]
fn invalid_files_are_refused() {
    let all = Handles::new();
    let folder = tempfile::tempdir().unwrap();
    let [missing, damaged] =
        ["none.sscc.safetensors", "bad.model.safetensors"].map(|n| folder.path().join(n));
    std::fs::write(&damaged, b"nothing").unwrap();
    let (missing, damaged, folder) = (c(&missing), c(&damaged), c(&folder.path().join("no/such.file")));
    let latin = c"caf\xe9".as_ptr();
    unsafe {
        let (mut model, mut certificates) = (null_mut(), null_mut());
        let (m, s) = (&raw mut model, &raw mut certificates);
        refused(
            sscc_model_load(missing.as_ptr(), null(), m),
            sscc_status::File,
            "none.sscc.safetensors: not found",
        );
        refused(sscc_model_load(damaged.as_ptr(), null(), m), sscc_status::File, "bad.model.safetensors");
        refused(sscc_model_load(latin, null(), m), sscc_status::Argument, "model_path is not UTF-8");
        refused(sscc_model_load(c"a.obj".as_ptr(), latin, m), sscc_status::Argument, "modes_path is not");
        refused(sscc_certificates_load(missing.as_ptr(), s), sscc_status::File, "not found");
        refused(sscc_certificates_load(damaged.as_ptr(), s), sscc_status::File, "bad.model.safetensors");
        refused(sscc_certificates_load(latin, s), sscc_status::Argument, "certificates_path is not UTF-8");
        refused(sscc_model_save(all.model, folder.as_ptr()), sscc_status::File, "such.file");
        refused(sscc_certificates_save(all.certificates, folder.as_ptr()), sscc_status::File, "such.file");
        refused(sscc_model_save(all.model, latin), sscc_status::Argument, "not UTF-8");
        refused(sscc_certificates_save(all.certificates, latin), sscc_status::Argument, "not UTF-8");
        assert!(model.is_null() && certificates.is_null());
    }
}
