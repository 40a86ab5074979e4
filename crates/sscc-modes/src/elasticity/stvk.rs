//! St. Venant-Kirchhoff forces in the full space.
//!
//! With `A` the gradient of the displacement, `F = I + A`, Green's strain is `E = (A + A' + A'A) / 2`, the stress
//! `S = lambda tr(E) I + 2 mu E`, and the energy the integral of `S : E / 2`. The force on a vertex is the gradient of
//! the energy, the integral of `F S g` with the gradient `g` of its shape function; the body exerts its negative. The
//! part linear in `A` is linear elasticity. Unlike linear elasticity, these forces rotate with the body.

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use sscc_solid::{IntegrationPoint, Material, Solid};

/// Number of pairs per task; each task visits all elements.
const PAIRS_PER_TASK: usize = 8;

/// Returns the stress of a symmetric strain.
pub(crate) fn stress(material: &Material, strain: DMat3) -> DMat3 {
    let trace = strain.x_axis.x + strain.y_axis.y + strain.z_axis.z;
    DMat3::from_diagonal(DVec3::splat(material.lame_lambda() * trace)) + strain * (2.0 * material.lame_mu())
}

/// Returns the displacement gradient at a point from the displacements of its element's vertices.
pub(crate) fn gradient(point: &IntegrationPoint, displacements: &[DVec3]) -> DMat3 {
    let mut sum = DMat3::ZERO;
    for (u, g) in displacements.iter().zip(&point.gradients) {
        sum += DMat3::from_cols(*u * g.x, *u * g.y, *u * g.z);
    }
    sum
}

/// Returns the symmetric part.
pub(crate) fn symmetric(a: DMat3) -> DMat3 {
    (a + a.transpose()) * 0.5
}

/// Returns the elastic energy of displacements of all vertices, and its gradient (one force for each vertex): an oracle
/// for the reduced polynomial.
#[cfg(test)]
pub(crate) fn energy_and_forces(solid: &Solid, displacements: &[DVec3]) -> (f64, Vec<DVec3>) {
    let (mut energy, mut forces) = (0.0, vec![DVec3::ZERO; solid.vertices().len()]);
    for index in 0..solid.element_count() {
        let element = solid.element(index);
        let corners: Vec<DVec3> = element.vertices.iter().map(|v| displacements[*v as usize]).collect();
        let mut own = [DVec3::ZERO; 10];
        for point in element.points() {
            let a = gradient(point, &corners);
            let strain = symmetric(a) + a.transpose() * a * 0.5;
            let s = stress(element.material, strain);
            energy += 0.5 * point.volume * (0..3).map(|k| s.col(k).dot(strain.col(k))).sum::<f64>();
            add_forces(point, (DMat3::IDENTITY + a) * s, &mut own);
        }
        element.vertices.iter().zip(own).for_each(|(v, f)| forces[*v as usize] += f);
    }
    (energy, forces)
}

/// Returns the second derivatives of the forces at rest along pairs of displacements: the Hessian stiffness `H : a b`
/// (Barbic and James 2005), one vector for each vertex and pair. Symmetric in `a` and `b`.
pub(crate) fn second_derivatives(
    solid: &Solid,
    fields: &[Vec<DVec3>],
    pairs: &[(usize, usize)],
) -> Vec<Vec<DVec3>> {
    let of_pairs = |pairs: &[(usize, usize)]| {
        let mut forces = vec![vec![DVec3::ZERO; solid.vertices().len()]; pairs.len()];
        let used = |k: &usize| pairs.iter().any(|(i, j)| i == k || j == k);
        let used: Vec<usize> = (0..fields.len()).filter(used).collect();
        let mut at_corners = vec![[DVec3::ZERO; 10]; fields.len()];
        let mut at_point = vec![(DMat3::ZERO, DMat3::ZERO); fields.len()];
        for index in 0..solid.element_count() {
            let element = solid.element(index);
            let mut own = [[DVec3::ZERO; 10]; PAIRS_PER_TASK];
            for k in &used {
                let corners = at_corners[*k].iter_mut().zip(element.vertices);
                corners.for_each(|(u, v)| *u = fields[*k][*v as usize]);
            }
            for point in element.points() {
                for k in &used {
                    let a = gradient(point, &at_corners[*k][..element.vertices.len()]);
                    at_point[*k] = (a, stress(element.material, symmetric(a)));
                }
                for ((i, j), own) in pairs.iter().zip(&mut own) {
                    let ((a, s_a), (b, s_b)) = (at_point[*i], at_point[*j]);
                    let both = stress(element.material, symmetric(a.transpose() * b));
                    add_forces(point, a * s_b + b * s_a + both, own);
                }
            }
            for (forces, own) in forces.iter_mut().zip(own) {
                element.vertices.iter().zip(own).for_each(|(v, f)| forces[*v as usize] += f);
            }
        }
        forces
    };
    // The sums of each pair are in the order of the elements, for any number of threads.
    pairs.par_chunks(PAIRS_PER_TASK).flat_map_iter(of_pairs).collect()
}

/// Adds the forces of a first Piola-Kirchhoff stress at a point to those of its element's vertices.
fn add_forces(point: &IntegrationPoint, stress: DMat3, forces: &mut [DVec3; 10]) {
    let stress = stress * point.volume;
    forces.iter_mut().zip(&point.gradients).for_each(|(f, g)| *f += stress * *g);
}
