//! St. Venant-Kirchhoff forces in the full space.
//!
//! With `A` the gradient of the displacement, `F = I + A`, Green's strain is `E = (A + A' + A'A) / 2`, the stress
//! `S = lambda tr(E) I + 2 mu E`, the energy the integral of `S : E / 2`, and the force on a vertex (the gradient of
//! the energy; the body pushes back with its negative) the integral of `F S g`, with `g` its shape function's
//! gradient. Linear in `A` it is linear elasticity; it turns with large rotations, as linear elasticity does not.

use glam::{DMat3, DVec3};

use super::element::{Element, Point};
use crate::{Material, Solid};

/// The stress of a symmetric strain.
pub(crate) fn stress(material: &Material, strain: DMat3) -> DMat3 {
    let trace = strain.x_axis.x + strain.y_axis.y + strain.z_axis.z;
    DMat3::from_diagonal(DVec3::splat(material.lame_lambda() * trace)) + strain * (2.0 * material.lame_mu())
}

/// The gradient of a displacement at a point.
pub(crate) fn gradient(element: &Element, point: &Point, displacements: impl Fn(u32) -> DVec3) -> DMat3 {
    let mut sum = DMat3::ZERO;
    for (vertex, g) in element.vertices.iter().zip(&point.gradients) {
        let u = displacements(*vertex);
        sum += DMat3::from_cols(u * g.x, u * g.y, u * g.z);
    }
    sum
}

/// The symmetric part.
pub(crate) fn symmetric(a: DMat3) -> DMat3 {
    (a + a.transpose()) * 0.5
}

/// The elastic energy of a displacement of all vertices, and its gradient (one force for each vertex): the oracle of
/// the reduced polynomial.
#[cfg(test)]
pub(crate) fn energy_and_forces(solid: &Solid, displacements: &[DVec3]) -> (f64, Vec<DVec3>) {
    let mut energy = 0.0;
    let forces = integrate(solid, |element, point| {
        let a = gradient(element, point, |v| displacements[v as usize]);
        let strain = symmetric(a) + a.transpose() * a * 0.5;
        let s = stress(element.material, strain);
        energy += 0.5 * point.volume * (0..3).map(|k| s.col(k).dot(strain.col(k))).sum::<f64>();
        (DMat3::IDENTITY + a) * s
    });
    (energy, forces)
}

/// The second derivative of the forces at rest along two displacements: the Hessian stiffness `H : a b`
/// (Barbic and James 2005), one vector for each vertex. Symmetric in `a` and `b`.
pub(crate) fn second_derivative(solid: &Solid, a: &[DVec3], b: &[DVec3]) -> Vec<DVec3> {
    integrate(solid, |element, point| {
        let [a, b] = [a, b].map(|u| gradient(element, point, |v| u[v as usize]));
        let [s_a, s_b] = [a, b].map(|x| stress(element.material, symmetric(x)));
        a * s_b + b * s_a + stress(element.material, symmetric(a.transpose() * b))
    })
}

/// The forces of a first Piola-Kirchhoff stress given at each point.
fn integrate(solid: &Solid, mut stress: impl FnMut(&Element, &Point) -> DMat3) -> Vec<DVec3> {
    let mut forces = vec![DVec3::ZERO; solid.vertices().len()];
    for index in 0..solid.element_count() {
        let element = solid.element(index);
        for point in element.points() {
            let p = stress(&element, point) * point.volume;
            for (vertex, g) in element.vertices.iter().zip(&point.gradients) {
                forces[*vertex as usize] += p * *g;
            }
        }
    }
    forces
}
