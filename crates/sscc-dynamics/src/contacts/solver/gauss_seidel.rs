//! Projected Gauss-Seidel over the constraints of one island.

use glam::DVec3;
use pulp::{Simd, WithSimd};

use super::contact_rows::ContactRows;
use super::correction::Correction;
use super::friction_cone::{limit_friction, stop_sliding};
use crate::contacts::islands::Island;

/// Maximum number of iterations.
const MAX_ITERATIONS: usize = 200;

/// An active constraint: its number and its island.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Active {
    pub island: Island,
    pub number: u32,
}

/// The constraints of an island, with their initial impulses. Their rows have the numbers from `first`.
pub(crate) struct GaussSeidel<'s> {
    pub list: &'s mut [Correction],
    pub island: &'s [Active],
    pub first: usize,
    pub rows: &'s mut ContactRows,
    /// Iterations end when no constraint changes the velocity between its two points by more than this.
    pub tolerance: f64,
}

impl WithSimd for GaussSeidel<'_> {
    type Output = ();

    /// Computes the impulses of all constraints.
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        for n in 0..self.island.len() {
            let one = &self.list[self.island[n].number as usize];
            let impulse = one.impulse();
            if impulse != DVec3::ZERO {
                let along = self.rows.axes(self.first + n).map(|axis| axis.dot(impulse));
                self.rows.push_along_axes(simd, self.first + n, along);
            }
        }
        for iteration in 0..MAX_ITERATIONS {
            let mut max_change = 0.0_f64;
            for n in 0..self.island.len() {
                // Symmetric Gauss-Seidel: the order alternates.
                let n = if iteration % 2 == 0 { n } else { self.island.len() - 1 - n };
                max_change = max_change.max(self.update(simd, n));
            }
            if max_change <= self.tolerance {
                break;
            }
        }
    }
}

impl GaussSeidel<'_> {
    /// Updates the impulse of one constraint. Returns the change of velocity between its points.
    #[inline(always)]
    fn update<S: Simd>(&mut self, simd: S, n: usize) -> f64 {
        let (contact, rows) = (self.first + n, &mut *self.rows);
        let one = &mut self.list[self.island[n].number as usize];
        let along = rows.along_normal(simd, contact);
        let change = ((one.target - along) / one.normal_inverse_mass).max(-one.normal_impulse);
        let normal_impulse = one.normal_impulse + change;
        if !(one.friction > 0.0 && (normal_impulse > 0.0 || one.friction_impulse != DVec3::ZERO)) {
            if change == 0.0 {
                return 0.0;
            }
            one.normal_impulse = normal_impulse;
            rows.push_along_normal(simd, contact, change);
            return (one.inverse_mass * (one.points.normal * change)).length();
        }
        let axes = rows.axes(contact);
        let [second, third] = rows.across(simd, contact);
        let w = axes[0] * along + axes[1] * second + axes[2] * third;
        let mut impulse = one.points.normal * change;
        let after = one.slip + w + one.inverse_mass * impulse;
        let sliding = after - one.points.normal * one.points.normal.dot(after);
        let friction_impulse = limit_friction(
            one.friction_impulse + stop_sliding(sliding, &one.inverse_mass),
            one.friction,
            one.points.normal,
            normal_impulse,
            &one.inverse_mass,
        );
        impulse += friction_impulse - one.friction_impulse;
        if impulse == DVec3::ZERO {
            return 0.0;
        }
        (one.normal_impulse, one.friction_impulse) = (normal_impulse, friction_impulse);
        rows.push_along_axes(simd, contact, axes.map(|axis| axis.dot(impulse)));
        (one.inverse_mass * impulse).length()
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DQuat};

    use super::*;
    use crate::bodies::displacement::displacement;
    use crate::contacts::contact_constraint::{ContactPoints, GROUND, Side, Source};
    use crate::contacts::islands::Islands;
    use crate::contacts::solver::contact_rows::RowPoint;
    use crate::contacts::solver::rigid_velocity::{RigidVelocity, modal_inverse_mass};
    use crate::packed_rows::dispatch;
    use crate::test_shapes::tetrahedron;
    use crate::{Body, Shape, Start, WorldOptions};

    /// Returns the next of a fixed sequence of pseudo-random numbers in [-1, 1).
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 33) as f64 / 2.0_f64.powi(30) - 1.0
    }

    fn vector(state: &mut u64) -> DVec3 {
        DVec3::new(random(state), random(state), random(state))
    }

    /// Returns a tetrahedron with random modes.
    fn shape(rank: usize, state: &mut u64) -> Shape {
        let modes = (0..4 * rank).map(|_| vector(state)).collect();
        let stiffness: Vec<f64> = (0..rank).map(|k| 10.0_f64.powi(k as i32 % 7)).collect();
        tetrahedron(modes, &stiffness)
    }

    /// Contacts of a few bodies, without geometry: points and modes are arbitrary.
    struct Contacts {
        bodies: Vec<Body>,
        masses: Vec<RigidVelocity>,
        list: Vec<Correction>,
        modes: Vec<[Vec<DVec3>; 2]>,
    }

    impl Contacts {
        /// Creates the contacts. `shapes` has one shape for each body, the last of which is held.
        fn new(shapes: &[Shape], count: usize, state: &mut u64) -> Self {
            let mut all = Vec::new();
            for (n, shape) in shapes.iter().enumerate() {
                let orientation = DQuat::from_scaled_axis(vector(state) * 3.0);
                let position = Some(vector(state));
                let is_free = n + 1 < shapes.len();
                let start = Start { is_free, position, orientation, ..Start::default() };
                all.push(Body::new(shape, &start, &WorldOptions::default(), None).unwrap());
            }
            let masses: Vec<RigidVelocity> = all.iter().map(RigidVelocity::of).collect();
            let (mut list, mut modes) = (Vec::new(), Vec::new());
            for n in 0..count {
                let mut any = || (random(state).abs() * shapes.len() as f64) as u32;
                let bodies = match n % 4 {
                    0 => [any(), GROUND],
                    1 => [any(); 2],
                    _ => [any(), any()],
                };
                let of = |body: u32, state: &mut u64| -> Vec<DVec3> {
                    let rank = all.get(body as usize).map_or(0, |body| body.q.len());
                    (0..rank).map(|_| vector(state)).collect()
                };
                let own = bodies.map(|body| of(body, state));
                let (normal, arms) = (vector(state).normalize(), [vector(state), vector(state)]);
                let mut inverse_mass = DMat3::ZERO;
                let source = Source::Contact(n as u32);
                let points = ContactPoints { bodies, source, normal, arms };
                for Side { n, body, .. } in points.sides() {
                    let weights = &all[body].step_weights;
                    inverse_mass += if bodies[0] == bodies[1] {
                        modal_inverse_mass(&own[n], weights)
                    } else {
                        masses[body].inverse_mass_at(arms[n], &own[n], weights)
                    };
                }
                let normal_impulse = (random(state) - 0.2).max(0.0);
                list.push(Correction {
                    points,
                    inverse_mass,
                    normal_inverse_mass: normal.dot(inverse_mass * normal),
                    target: random(state),
                    slip: vector(state),
                    friction: if n % 3 == 0 { 0.0 } else { 0.4 },
                    bounce: None,
                    normal_impulse,
                    friction_impulse: if n % 3 == 0 {
                        DVec3::ZERO
                    } else {
                        normal.cross(DVec3::X) * (0.1 * normal_impulse)
                    },
                    end_impulse: DVec3::ZERO,
                });
                modes.push(own);
            }
            Self { bodies: all, masses, list, modes }
        }

        fn rows(&self) -> ContactRows {
            let mut rows = ContactRows::default();
            let bodies = self.masses.iter().zip(&self.bodies);
            rows.begin(bodies.map(|(mass, body)| (mass, &body.step_weights[..])));
            for (one, modes) in self.list.iter().zip(&self.modes) {
                let points = one.points.sides().map(|Side { n, body, sign }| RowPoint {
                    body,
                    sign,
                    arm: (!one.points.is_within()).then_some(one.points.arms[n]),
                    modes: &modes[n],
                });
                rows.push_rows::<3>(one.points.normal, points);
            }
            rows
        }
    }

    /// Oracle: the same computation without rows.
    struct Plain<'c> {
        contacts: &'c Contacts,
        masses: Vec<RigidVelocity>,
        modal: Vec<Vec<f64>>,
    }

    impl<'c> Plain<'c> {
        fn new(contacts: &'c Contacts) -> Self {
            let modal = contacts.bodies.iter().map(|body| vec![0.0; body.q.len()]).collect();
            Self { contacts, masses: contacts.masses.clone(), modal }
        }

        fn velocity(&self, contact: usize) -> DVec3 {
            let (one, modes) = (&self.contacts.list[contact], &self.contacts.modes[contact]);
            let of = |Side { n, body, sign }: Side| {
                let modal = displacement(&modes[n], &self.modal[body]);
                if one.points.is_within() {
                    modal
                } else {
                    self.masses[body].of_point(one.points.arms[n], modal) * sign
                }
            };
            one.points.sides().map(of).sum()
        }

        fn push(&mut self, contact: usize, impulse: DVec3) {
            let (one, modes) = (&self.contacts.list[contact], &self.contacts.modes[contact]);
            for Side { n, body, sign } in one.points.sides() {
                let impulse = impulse * sign;
                let mut local = impulse;
                if !one.points.is_within() {
                    self.masses[body].push(impulse, one.points.arms[n]);
                    local = self.masses[body].rotation.transpose() * impulse;
                }
                let weights = &self.contacts.bodies[body].step_weights;
                for ((v, u), weight) in self.modal[body].iter_mut().zip(&modes[n]).zip(weights) {
                    *v += weight * u.dot(local);
                }
            }
        }

        /// Returns the impulses of all contacts.
        fn solve(&mut self, tolerance: f64) -> Vec<DVec3> {
            let mut list = self.contacts.list.clone();
            (0..list.len()).for_each(|n| self.push(n, list[n].impulse()));
            for iteration in 0..MAX_ITERATIONS {
                let mut most = 0.0_f64;
                for n in 0..list.len() {
                    let n = if iteration % 2 == 0 { n } else { list.len() - 1 - n };
                    let w = self.velocity(n);
                    let one = &mut list[n];
                    let change = (one.target - one.points.normal.dot(w)) / one.normal_inverse_mass;
                    let change = change.max(-one.normal_impulse);
                    let mut impulse = one.points.normal * change;
                    one.normal_impulse += change;
                    if one.friction > 0.0 {
                        let after = one.slip + w + one.inverse_mass * impulse;
                        let sliding = after - one.points.normal * one.points.normal.dot(after);
                        let wanted = one.friction_impulse + stop_sliding(sliding, &one.inverse_mass);
                        let limited = limit_friction(
                            wanted,
                            one.friction,
                            one.points.normal,
                            one.normal_impulse,
                            &one.inverse_mass,
                        );
                        impulse += limited - one.friction_impulse;
                        one.friction_impulse = limited;
                    }
                    most = most.max((one.inverse_mass * impulse).length());
                    self.push(n, impulse);
                }
                if most <= tolerance {
                    break;
                }
            }
            list.iter().map(Correction::impulse).collect()
        }
    }

    /// Applies an impulse at each contact, and records the velocities along all axes of all contacts.
    struct Push<'s> {
        rows: &'s mut ContactRows,
        impulses: &'s [DVec3],
    }

    impl WithSimd for Push<'_> {
        type Output = Vec<DVec3>;

        fn with_simd<S: Simd>(self, simd: S) -> Vec<DVec3> {
            for (n, impulse) in self.impulses.iter().enumerate() {
                let along = self.rows.axes(n).map(|axis| axis.dot(*impulse));
                // The impulse is applied in two parts. The first is along the normal.
                self.rows.push_along_normal(simd, n, 0.5 * along[0]);
                self.rows.push_along_axes(simd, n, [0.5 * along[0], along[1], along[2]]);
            }
            let of = |n: usize| {
                let [x, y, z] = self.rows.axes(n);
                let (along, [second, third]) = (self.rows.along_normal(simd, n), self.rows.across(simd, n));
                x * along + y * second + z * third
            };
            (0..self.impulses.len()).map(of).collect()
        }
    }

    #[test]
    fn rows_give_the_velocities_of_points() {
        let state = &mut 5;
        for ranks in [[1, 2, 3], [10, 1, 30], [3, 40, 2]] {
            let shapes = ranks.map(|rank| shape(rank, state));
            let contacts = Contacts::new(&shapes, 24, state);
            let impulses: Vec<DVec3> = contacts.list.iter().map(|_| vector(state)).collect();
            let found = dispatch(Push { rows: &mut contacts.rows(), impulses: &impulses });
            let mut plain = Plain::new(&contacts);
            impulses.iter().enumerate().for_each(|(n, impulse)| plain.push(n, *impulse));
            for (n, found) in found.iter().enumerate() {
                let expected = plain.velocity(n);
                assert!(
                    (*found - expected).length() < 1e-11 * (1.0 + expected.length()),
                    "{n}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn impulses_are_those_of_the_iteration_without_rows() {
        let state = &mut 8;
        let (mut pushed, mut open, mut slides) = (0, 0, 0);
        for case in 0..20 {
            let shapes = [2, 7, 12].map(|rank| shape(rank, state));
            let contacts = Contacts::new(&shapes, 3 + case, state);
            let expected = Plain::new(&contacts).solve(1e-3);
            let mut list = contacts.list.clone();
            let mut islands = Islands::default();
            islands.reset(1);
            let one = islands.of(0);
            let island: Vec<Active> =
                (0..list.len() as u32).map(|number| Active { island: one, number }).collect();
            let mut rows = contacts.rows();
            dispatch(GaussSeidel {
                list: &mut list,
                island: &island,
                first: 0,
                rows: &mut rows,
                tolerance: 1e-3,
            });
            for (one, expected) in list.iter().zip(&expected) {
                let error = (one.impulse() - *expected).length();
                assert!(
                    error < 1e-8 * (1.0 + expected.length()),
                    "case {case}: {} {expected}",
                    one.impulse()
                );
                pushed += usize::from(one.normal_impulse > 0.0);
                open += usize::from(one.normal_impulse == 0.0);
                slides += usize::from(one.friction_impulse != DVec3::ZERO);
            }
        }
        assert!(pushed > 40 && open > 40 && slides > 20, "{pushed} {open} {slides}");
    }
}
