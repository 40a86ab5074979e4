//! Reduced forces of a body under given modes.
//!
//! Under `u = U q` Green's strain at a point is `E = sum_k L_k q_k + sum_{i<=j} Q_ij q_i q_j`, so the energy, the
//! integral of `E : C : E / 2`, is half the square of `X (q, q q)`: `X` holds the strains of all points, each times
//! the root of its volume and of `C`. One symmetric product `X'X` has all coefficients.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, Par};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use sscc::{Modes, Progress};
use sscc_solid::{Element, Material, ReducedForces, Solid, Stiffness, monomials};

use super::stvk::{gradient, symmetric};
use crate::ModesError;
use crate::cancel::check_cancelled;

/// Components of a symmetric strain, off-diagonal ones times the root of 2 (Mandel): their square sum is `E : E`.
const COMPONENTS: usize = 6;

/// Number of elements whose strains are multiplied at once: for cubes about 3,000 rows, which fit into the cache.
const BATCH: usize = 64;

/// Maximum number of integration points of an element.
const MAX_POINTS: usize = 14;

/// Number of partial sums. Fixed, so that the result is the same for any number of threads.
const SUMS: usize = 8;

/// Returns the reduced forces `U' f(U q)` of a solid under modes of its vertices.
///
/// # Errors
/// When cancelled, or a coefficient is beyond [`sscc::limits`].
pub(crate) fn reduced_forces(
    solid: &Solid,
    modes: &Modes,
    progress: &dyn Progress,
) -> Result<ReducedForces, ModesError> {
    let r = modes.rank();
    let columns = r + monomials::count(r, 2);
    let batches = solid.element_count().div_ceil(BATCH);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let sums: Vec<Mat<f64>> = (0..SUMS)
        .into_par_iter()
        .map(|sum| {
            let mut gram = Mat::<f64>::zeros(columns, columns);
            let mut strains = Mat::<f64>::zeros(COMPONENTS * MAX_POINTS * BATCH, columns);
            for batch in (sum..batches).step_by(SUMS) {
                if progress.is_cancelled() {
                    break;
                }
                let elements = batch * BATCH..((batch + 1) * BATCH).min(solid.element_count());
                let mut rows = 0;
                for index in elements {
                    rows = add_strains(&solid.element(index), modes, &mut strains, rows);
                }
                let x = strains.as_ref().subrows(0, rows);
                matmul(
                    gram.as_mut(),
                    BlockStructure::TriangularLower,
                    Accum::Add,
                    x.transpose(),
                    BlockStructure::Rectangular,
                    x,
                    BlockStructure::Rectangular,
                    1.0,
                    Par::Seq,
                );
                let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
                progress.report(done, batches);
            }
            gram
        })
        .collect();
    check_cancelled(progress)?;
    let mut gram = Mat::<f64>::zeros(columns, columns);
    sums.iter().for_each(|sum| gram += sum);
    differentiate(r, &gram)
}

/// Writes the strains of an element's points below the given row; returns the next free row.
fn add_strains(element: &Element, modes: &Modes, strains: &mut Mat<f64>, mut row: usize) -> usize {
    let r = modes.rank();
    let at_corners = |k: usize| -> Vec<DVec3> {
        element.vertices.iter().map(|v| modes.displacements()[*v as usize * r + k]).collect()
    };
    let fields: Vec<Vec<DVec3>> = (0..r).map(at_corners).collect();
    for point in element.points() {
        let gradients: Vec<DMat3> = fields.iter().map(|u| gradient(point, u)).collect();
        let root = point.volume.sqrt();
        let mut column = 0;
        let mut put = |strain: DMat3| {
            for (i, value) in rooted(element.material, strain).into_iter().enumerate() {
                strains[(row + i, column)] = root * value;
            }
            column += 1;
        };
        gradients.iter().for_each(|a| put(symmetric(*a)));
        for i in 0..r {
            let left = gradients[i].transpose();
            put(left * gradients[i] * 0.5);
            (i + 1..r).for_each(|j| put(symmetric(left * gradients[j])));
        }
        row += COMPONENTS;
    }
    row
}

/// Returns the root of the elasticity tensor `C` applied to a strain: the sum of squares is `E : C : E`.
fn rooted(material: &Material, strain: DMat3) -> [f64; COMPONENTS] {
    // C is 2 mu on strains without trace, and 2 mu + 3 lambda on the others.
    let shear = (2.0 * material.lame_mu()).sqrt();
    let bulk = (2.0 * material.lame_mu() + 3.0 * material.lame_lambda()).sqrt();
    let [x, y, z] = [strain.x_axis, strain.y_axis, strain.z_axis];
    let mean = (bulk - shear) * (x.x + y.y + z.z) / 3.0;
    let off = shear * std::f64::consts::SQRT_2;
    [shear * x.x + mean, shear * y.y + mean, shear * z.z + mean, off * y.z, off * x.z, off * x.y]
}

/// Differentiates the energy, half of the quadratic form `gram` (lower triangle).
fn differentiate(r: usize, gram: &Mat<f64>) -> Result<ReducedForces, ModesError> {
    let pairs = monomials::all(r, 2);
    let at = |i: usize, j: usize| gram[(i.max(j), i.min(j))];
    let linear = (0..r * r).map(|k| at(k / r, k % r)).collect();

    // Energies of degree 3 and 4 by monomial.
    let mut third = vec![0.0; monomials::count(r, 3)];
    let mut fourth = vec![0.0; monomials::count(r, 4)];
    for (a, pair) in pairs.iter().enumerate() {
        for i in 0..r {
            third[monomials::place(r, &sorted([i, pair[0], pair[1]]))] += at(r + a, i);
        }
        for (b, other) in pairs[..=a].iter().enumerate() {
            let both = if a == b { 0.5 } else { 1.0 };
            fourth[monomials::place(r, &sorted([pair[0], pair[1], other[0], other[1]]))] +=
                both * at(r + a, r + b);
        }
    }
    let times = |i: usize, all: &[usize]| all.iter().filter(|k| **k == i).count() as f64;
    let mut quadratic = Vec::with_capacity(r * third.len());
    let mut cubic = Vec::with_capacity(r * monomials::count(r, 3));
    let triples = monomials::all(r, 3);
    for i in 0..r {
        quadratic.extend(pairs.iter().map(|m| {
            let all = sorted([i, m[0], m[1]]);
            times(i, &all) * third[monomials::place(r, &all)]
        }));
        cubic.extend(triples.iter().map(|m| {
            let all = sorted([i, m[0], m[1], m[2]]);
            times(i, &all) * fourth[monomials::place(r, &all)]
        }));
    }
    Ok(ReducedForces::new(Stiffness::new(r, linear)?, quadratic, cubic)?)
}

fn sorted<const N: usize>(mut indices: [usize; N]) -> [usize; N] {
    indices.sort_unstable();
    indices
}
