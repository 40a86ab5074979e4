//! Models: a mesh and its modes.
#![allow(unsafe_code, reason = "functions for C")]

use std::ffi::c_char;

use sscc::{Modes, ReducedModel, TriMesh};
use sscc_io::{ModelInfo, load_model, write_model};

use crate::handle::{Handle, borrow, free, give};
use crate::matrix::{Matrix, sscc_index_matrix, sscc_matrix};
use crate::pointers::{output, output_array, path, slice};
use crate::status::{Failure, Result, guard, sscc_status};

/// A mesh with its modes. It never changes. Certificates and queries share it, and it may be freed before them.
pub struct sscc_model {
    pub(crate) model: ReducedModel,
    info: ModelInfo,
}

impl Handle for sscc_model {
    const NAME: &'static str = "model";
}

/// Creates a model of a mesh (positions V x 3, faces F x 3) and its modes (3V x r): the shape at q is `positions + modes * q`. Its
/// metric is SSCC_METRIC_DISPLACEMENT. The arrays are copied.
///
/// Threads: any.
///
/// # Safety
/// As the header states for arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_model_new(
    positions: sscc_matrix,
    faces: sscc_index_matrix,
    modes: sscc_matrix,
    model: *mut *mut sscc_model,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(model, "model") }?;
        let mesh = unsafe { mesh(&positions, &faces) }?;
        let modes = unsafe { Matrix::any(&modes, "modes") }?;
        let vertices = mesh.rest_positions().len();
        if modes.rows != 3 * vertices {
            return Err(Failure::argument(format!(
                "modes has {} rows: it must have 3 for each of the {vertices} vertices",
                modes.rows
            )));
        }
        let modes = Modes::from_matrix(vertices, modes.columns, |row, mode| modes.get(row, mode))?;
        let model = ReducedModel::new(mesh, modes)?;
        give(sscc_model { model, info: ModelInfo::default() }, out);
        Ok(())
    })
}

/// Creates a mesh from arrays of the caller.
///
/// # Safety
/// As [`Matrix::positions`].
pub unsafe fn mesh(positions: &sscc_matrix, faces: &sscc_index_matrix) -> Result<TriMesh> {
    // SAFETY: by the caller's guarantee.
    let (positions, faces) =
        unsafe { (Matrix::positions(positions, "positions")?, Matrix::faces(faces, "faces")?) };
    let positions = positions.vectors(&mut Vec::new()).to_vec();
    Ok(TriMesh::new(positions, faces.triples())?)
}

/// Loads a model from a file of any format that the command reads: a *.model.safetensors, a glTF file with morph targets, a complete
/// .npz, or a mesh or a solid with a file of modes or a folder of target meshes. `FILE#NAME` names one of several meshes of a glTF
/// file. Paths are UTF-8; `modes_path` is NULL for files that contain modes. Warnings about the file, names of modes and default
/// weights are not returned.
///
/// Errors: SSCC_STATUS_FILE for a file that cannot be read or is malformed.
///
/// Threads: any.
///
/// # Safety
/// As the header states for texts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_model_load(
    model_path: *const c_char,
    modes_path: *const c_char,
    model: *mut *mut sscc_model,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(model, "model") }?;
        let model_path = unsafe { path(model_path, "model_path") }?;
        let modes_path =
            (!modes_path.is_null()).then(|| unsafe { path(modes_path, "modes_path") }).transpose()?;
        let (model, info) = load_model(model_path, modes_path)?;
        give(sscc_model { model, info }, out);
        Ok(())
    })
}

/// Writes a model to a *.model.safetensors file, which appears whole or not at all.
///
/// Errors: SSCC_STATUS_FILE if the file cannot be written.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles and texts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_model_save(model: *const sscc_model, model_path: *const c_char) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let sscc_model { model, info } = unsafe { borrow(model) }?;
        Ok(write_model(unsafe { path(model_path, "model_path") }?, model, info)?)
    })
}

/// Frees a model. NULL is ignored.
///
/// Threads: any, while no other call uses the model.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_model_free(model: *mut sscc_model) -> sscc_status {
    // SAFETY: by the caller's guarantee.
    guard(|| unsafe { free(model) })
}

/// Returns the number of modes r; 0 for NULL.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_model_rank(model: *const sscc_model) -> usize {
    // SAFETY: by the caller's guarantee.
    unsafe { borrow(model) }.map_or(0, |model| model.model.rank())
}

/// Returns the number of vertices V; 0 for NULL.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_model_vertex_count(model: *const sscc_model) -> usize {
    // SAFETY: by the caller's guarantee.
    unsafe { borrow(model) }.map_or(0, |model| model.model.mesh().rest_positions().len())
}

/// Returns the number of triangles F; 0 for NULL.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_model_triangle_count(model: *const sscc_model) -> usize {
    // SAFETY: by the caller's guarantee.
    unsafe { borrow(model) }.map_or(0, |model| model.model.mesh().faces().len())
}

/// Copies the faces: 3 F numbers, three vertices for each triangle, counted from 0. `count` is F.
///
/// Errors: SSCC_STATUS_ARGUMENT if `count` is not the number of triangles.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_model_faces(
    model: *const sscc_model,
    faces: *mut u32,
    count: usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let of_model = unsafe { borrow(model) }?.model.mesh().faces();
        let out = unsafe { output_array(faces, numbers(count, of_model.len(), "faces")?, "faces") }?;
        for (i, vertex) in of_model.as_flattened().iter().enumerate() {
            out.write(i, *vertex);
        }
        Ok(())
    })
}

/// Computes the positions at q (`rank` numbers), bit for bit those to which all answers refer: 3 V numbers, x, y, z of each vertex.
/// `count` is V.
///
/// Errors: SSCC_STATUS_ARGUMENT if `count` is not the number of vertices.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_model_positions(
    model: *const sscc_model,
    q: *const f64,
    rank: usize,
    positions: *mut f64,
    count: usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let model = &unsafe { borrow(model) }?.model;
        let vertices = model.mesh().rest_positions().len();
        let q = unsafe { slice(q, rank, "q") }?;
        let out = unsafe { output_array(positions, numbers(count, vertices, "positions")?, "positions") }?;
        out.check_apart(q, "q and positions")?;
        model.check_coordinates(q)?;
        for vertex in 0..vertices {
            for (axis, x) in model.position(vertex as u32, q).to_array().into_iter().enumerate() {
                out.write(3 * vertex + axis, x);
            }
        }
        Ok(())
    })
}

/// Returns the length of an array of three numbers for each element, after a check of the number of elements that the caller states.
fn numbers(count: usize, wanted: usize, name: &str) -> Result<usize> {
    if count == wanted {
        return Ok(3 * count);
    }
    Err(Failure::argument(format!("{name} has place for {count}: the model has {wanted}")))
}
