//! The peer parry3d-f64 as a module of Python: a deformable `TriMesh`, moved by parry's own `set_vertices`.
//!
//! parry has no call for the self-collisions of a mesh. Its BVH lists pairs of triangles whose AABBs overlap; those without a
//! common vertex are decided by parry's own test of two triangles (GJK), or by the exact one of sscc.

use numpy::{IntoPyArray, PyArray2, PyReadonlyArray2};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::partitioning::{BvhNode, BvhWorkspace};
use parry3d_f64::query::details::intersection_test_support_map_support_map;
use parry3d_f64::shape::{TriMesh, TriMeshFlags, Triangle};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A mesh of parry.
#[pyclass]
pub struct Mesh {
    mesh: TriMesh,
    workspace: BvhWorkspace,
}

#[pymethods]
impl Mesh {
    /// Makes a deformable mesh from positions (V, 3) and faces (F, 3).
    #[new]
    fn new(positions: PyReadonlyArray2<'_, f64>, faces: PyReadonlyArray2<'_, u32>) -> PyResult<Self> {
        let faces = rows(faces.as_slice()?).collect();
        let mesh = TriMesh::with_flags(vectors(&positions)?, faces, TriMeshFlags::DEFORMABLE);
        let mesh = mesh.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Self { mesh, workspace: BvhWorkspace::default() })
    }

    /// Moves the vertices: parry refits its BVH.
    fn set_vertices(&mut self, positions: PyReadonlyArray2<'_, f64>) -> PyResult<()> {
        let positions = vectors(&positions)?;
        if positions.len() != self.mesh.vertices().len() {
            return Err(PyValueError::new_err("the number of vertices must not change"));
        }
        self.mesh.set_vertices(&positions);
        Ok(())
    }

    /// All colliding pairs (n, 2), by the exact test of sscc or by parry's own.
    fn all<'py>(&mut self, py: Python<'py>, exact: bool) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let Self { mesh, workspace } = self;
        let mut pairs = Vec::new();
        mesh.bvh().traverse_bvtt_single_tree::<false>(workspace, &mut |a, b| {
            if is_contact(mesh, a, b, exact) {
                pairs.extend([a, b]);
            }
        });
        let count = pairs.len() / 2;
        let array = numpy::ndarray::Array2::from_shape_vec((count, 2), pairs);
        Ok(array.map_err(|error| PyValueError::new_err(error.to_string()))?.into_pyarray(py))
    }

    /// Whether any pair collides. parry's traversal of one BVH cannot be stopped; that of two, here the same ones, can.
    fn any(&self, exact: bool) -> bool {
        let bvh = self.mesh.bvh();
        let overlap = |a: &BvhNode, b: &BvhNode| a.intersects(b);
        bvh.leaf_pairs(bvh, overlap).any(|(a, b)| a < b && is_contact(&self.mesh, a, b, exact))
    }
}

/// Whether two triangles without a common vertex collide.
fn is_contact(mesh: &TriMesh, a: u32, b: u32, exact: bool) -> bool {
    let [f, g] = [a, b].map(|t| mesh.indices()[t as usize]);
    if f.iter().any(|v| g.contains(v)) {
        return false;
    }
    let [t, u] = [a, b].map(|t| mesh.triangle(t));
    if exact {
        let corners = |t: &Triangle| [t.a, t.b, t.c].map(|x| x.to_array().into());
        sscc::intersect_triangle_triangle(&corners(&t), &corners(&u))
    } else {
        intersection_test_support_map_support_map(&Pose::IDENTITY, &t, &u)
    }
}

fn vectors(positions: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Vector>> {
    Ok(rows(positions.as_slice()?).map(Vector::from_array).collect())
}

fn rows<T: Copy>(numbers: &[T]) -> impl Iterator<Item = [T; 3]> + '_ {
    numbers.as_chunks::<3>().0.iter().copied()
}

#[pymodule]
fn peer_parry(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Mesh>()
}
