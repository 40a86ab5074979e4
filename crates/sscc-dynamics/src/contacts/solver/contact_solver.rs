//! Solver for contact impulses: projected Gauss-Seidel with an energy budget for each body.
//!
//! Contacts are springs and dampers, integrated implicitly. The solver visits one constraint after the other, several
//! times. An impulse p changes the energy by exactly `p . (v + v') / 2`, where v and v' are the relative velocities before
//! and after it.
//!
//! The energy budget of a body is the energy that its contacts have dissipated so far. An impulse may add at most the
//! sum of the budgets of its bodies. Contacts therefore never add energy to the initial energy, up to rounding, for
//! every stiffness and step. Budgets of bodies that take no part in a contact are not used.

use glam::{DMat3, DVec3};
use pulp::{Simd, WithSimd};

use super::contact_rows::ContactRows;
use super::friction_cone::{is_mobile, stop_sliding};
use super::rigid_velocity::RigidVelocity;
use crate::Body;
use crate::bodies::displacement::displacement;
use crate::contacts::contact::Contact;
use crate::contacts::contact_constraint::{ContactConstraint, ContactPoints, Side};
use crate::packed_rows::dispatch;

/// Constants of a constraint in the solver.
#[derive(Clone, Copy, Debug)]
struct Coefficients {
    /// Matrix from impulse to velocity change (inverse effective mass).
    inverse_mass: DMat3,
    /// Velocity change along the normal by a unit impulse along the normal.
    normal_inverse_mass: f64,
    /// Compliance of the implicit spring and damper (velocity by impulse). The constraint along the normal is
    /// `v + compliance * normal_impulse = target_velocity`.
    compliance: f64,
    /// Velocity along the normal at which the spring separates the points.
    target_velocity: f64,
}

/// Constants of all contacts in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spring {
    /// Angular frequency (rad/s).
    pub rate: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Step (s).
    pub step: f64,
    /// Maximum number of iterations over all constraints.
    pub max_iterations: usize,
}

/// Iterations end when one changes velocities by less than this share of the first one's change.
const RELATIVE_TOLERANCE: f64 = 1e-3;

/// Compliance added to a contact within one body, as a share of the inverse mass of the body.
const SELF_CONTACT_COMPLIANCE: f64 = 1e-2;

/// Contact constraints of a step, and the buffers to solve them.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactSolver {
    pub constraints: Vec<ContactConstraint>,
    coefficients: Vec<Coefficients>,
    velocities: Vec<RigidVelocity>,
    /// Number of constraints of each body.
    counts: Vec<usize>,
    /// Energy budget of each body.
    budgets: Vec<f64>,
    /// For each constraint the relative velocity of its points before any impulse.
    velocities_before: Vec<DVec3>,
    rows: ContactRows,
    /// Inverse mass of each mode: 1.
    mode_weights: Vec<f64>,
}

impl ContactSolver {
    /// Computes the impulses of all constraints, and applies them to the bodies.
    pub fn solve(&mut self, bodies: &mut [Body], contacts: &[Contact], spring: &Spring) {
        self.coefficients.clear();
        if self.constraints.is_empty() {
            return;
        }
        self.velocities.clear();
        self.velocities.extend(bodies.iter().map(RigidVelocity::of));
        self.counts.clear();
        self.counts.resize(bodies.len(), 0);
        for side in self.constraints.iter().flat_map(|constraint| constraint.points.sides()) {
            self.counts[side.body] += 1;
        }
        self.coefficients.clear();
        for constraint in &self.constraints {
            let (mut all_modes, mut slow_modes, mut count) = (DMat3::ZERO, DMat3::ZERO, 1);
            for Side { n, body, .. } in constraint.points.sides() {
                let [a, b] = self.velocities[body].inverse_masses(
                    constraint.points.arms[n],
                    &constraint.modal_inverse_mass[n],
                    constraint.points.is_within(),
                );
                all_modes += a;
                slow_modes += b;
                count = self.counts[body].max(count);
            }
            let implicit = spring.implicit_share(count);
            let mut coefficients = Coefficients::new(constraint, all_modes, slow_modes, spring, implicit);
            if constraint.points.is_within() {
                // Where hardly any mode separates the two points, the impulse would otherwise have no bound.
                let mass = bodies[constraint.points.bodies[0] as usize].shape().mass().mass;
                coefficients.compliance += SELF_CONTACT_COMPLIANCE / mass;
            }
            self.coefficients.push(coefficients);
        }
        self.budgets.clear();
        self.budgets.extend(bodies.iter().map(|body| body.energy_budget));
        self.velocities_before.clear();
        for constraint in &self.constraints {
            self.velocities_before.push(self.relative_velocity(&constraint.points, bodies, contacts));
        }
        self.add_rows(bodies, contacts);
        dispatch(SpringGaussSeidel { solver: self, max_iterations: spring.max_iterations });
        for (body, budget) in bodies.iter_mut().zip(&self.budgets) {
            body.energy_budget = *budget;
        }
        for constraint in &self.constraints {
            // Modes have mass 1.
            constraint.points.push(constraint.impulse(), bodies, contacts, |_| 1.0);
        }
    }

    /// Adds the rows of all constraints. An impulse changes modal velocities by the displacements of the modes, which have
    /// mass 1.
    fn add_rows(&mut self, bodies: &[Body], contacts: &[Contact]) {
        let Self { rows, velocities, constraints, mode_weights, .. } = self;
        let most_modes = bodies.iter().map(|body| body.v.len()).max().unwrap_or(0);
        mode_weights.clear();
        mode_weights.resize(most_modes, 1.0);
        rows.begin(
            velocities.iter().zip(bodies).map(|(velocity, body)| (velocity, &mode_weights[..body.v.len()])),
        );
        for constraint in &*constraints {
            if constraint.friction > 0.0 {
                rows.push::<3>(&constraint.points, bodies, contacts);
            } else {
                rows.push::<1>(&constraint.points, bodies, contacts);
            }
        }
    }

    /// Returns the velocity of the first body at the contact, less that of the second.
    fn relative_velocity(&self, points: &ContactPoints, bodies: &[Body], contacts: &[Contact]) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for Side { n, body, sign } in points.sides() {
            let rigid = &self.velocities[body];
            let body = &bodies[body];
            let modal = displacement(points.modes(n, &body.shape, contacts), &body.v);
            sum += if points.is_within() { modal } else { rigid.of_point(points.arms[n], modal) * sign };
        }
        sum
    }
}

/// Iterations over all constraints of a solver, in packed rows.
struct SpringGaussSeidel<'s> {
    solver: &'s mut ContactSolver,
    max_iterations: usize,
}

impl WithSimd for SpringGaussSeidel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { solver, max_iterations } = self;
        let mut first_change = 0.0;
        for iteration in 0..max_iterations {
            let mut max_change = 0.0_f64;
            for n in 0..solver.constraints.len() {
                // Symmetric Gauss-Seidel: the order alternates.
                let n = if iteration % 2 == 0 { n } else { solver.constraints.len() - 1 - n };
                max_change = max_change.max(solver.update_impulse(simd, n));
            }
            if iteration == 0 {
                first_change = max_change;
            }
            if max_change <= RELATIVE_TOLERANCE * first_change {
                break;
            }
        }
    }
}

impl ContactSolver {
    /// Updates the impulse of one constraint. Returns the change of velocity along its normal.
    #[inline(always)]
    fn update_impulse<S: Simd>(&mut self, simd: S, n: usize) -> f64 {
        let Self { constraints, coefficients, rows, budgets, velocities_before, .. } = self;
        let constraint = &mut constraints[n];
        let Coefficients { inverse_mass, normal_inverse_mass, compliance, target_velocity } = coefficients[n];
        if !is_mobile(normal_inverse_mass, &inverse_mass) {
            return 0.0;
        }
        let budget: f64 = constraint.points.sides().map(|side| budgets[side.body]).sum();
        let normal = constraint.points.normal;
        let along = rows.along_normal(simd, n);
        let approach = velocities_before[n].dot(normal) + along;
        let mut change = (target_velocity - approach - compliance * constraint.normal_impulse)
            / (normal_inverse_mass + compliance);
        change = change.max(-constraint.normal_impulse);
        // Work of the normal impulse: change (approach + normal_inverse_mass change / 2).
        let work_of = |change: f64| change * (approach + normal_inverse_mass * change / 2.0);
        if work_of(change) > budget {
            let limit = ((approach * approach + 2.0 * normal_inverse_mass * budget).sqrt() - approach)
                / normal_inverse_mass;
            change = if change > 0.0 { change.min(limit) } else { 0.0 };
        }
        let mut work = work_of(change);
        let normal_impulse = constraint.normal_impulse + change;
        let has_friction =
            constraint.friction > 0.0 && (normal_impulse > 0.0 || constraint.friction_impulse != DVec3::ZERO);
        constraint.normal_impulse = normal_impulse;
        if !has_friction {
            if change != 0.0 {
                account(constraint, work, budget, budgets);
                rows.push_along_normal(simd, n, change);
            }
            return change.abs() * normal_inverse_mass;
        }
        let mut impulse = normal * change;
        let axes = rows.axes(n);
        let [second, third] = rows.across(simd, n);
        let v = velocities_before[n] + axes[0] * along + axes[1] * second + axes[2] * third;
        let after = v + inverse_mass * impulse;
        // The friction impulse that would stop the sliding, clamped to Coulomb's cone.
        let sliding = after - normal * normal.dot(after);
        let mut friction_impulse = constraint.friction_impulse + stop_sliding(sliding, &inverse_mass);
        friction_impulse = friction_impulse.clamp_length_max(constraint.friction * normal_impulse);
        let friction_change = friction_impulse - constraint.friction_impulse;
        let after_friction = after + inverse_mass * friction_change;
        let friction_work = friction_change.dot(after + after_friction) / 2.0;
        if friction_work <= 0.0 || work + friction_work <= budget {
            impulse += friction_change;
            work += friction_work;
            constraint.friction_impulse = friction_impulse;
        }
        account(constraint, work, budget, budgets);
        rows.push_along_axes(simd, n, axes.map(|axis| axis.dot(impulse)));
        change.abs() * normal_inverse_mass
    }
}

/// Charges the work of an impulse to the energy budgets of the bodies, whose sum is `budget`.
fn account(constraint: &ContactConstraint, work: f64, budget: f64, budgets: &mut [f64]) {
    // Added energy is paid by the bodies in proportion to their budgets; dissipated energy is shared equally.
    let count = constraint.points.sides().count() as f64;
    for Side { body, .. } in constraint.points.sides() {
        let own = &mut budgets[body];
        let share = if work > 0.0 && budget > 0.0 { *own / budget } else { 1.0 / count };
        *own = (*own - work * share).max(0.0);
    }
}

impl Spring {
    /// Returns the implicit share of the spring force when `count` constraints act on one body. The frequency of
    /// `count` springs together is higher by the square root of `count`. A share of 0 conserves energy but is unstable
    /// for long steps; a share of 1 is always stable but damps.
    fn implicit_share(&self, count: usize) -> f64 {
        let angle = self.rate * self.step;
        (angle * angle * count as f64).clamp(f64::EPSILON, 1.0)
    }
}

impl Coefficients {
    fn new(
        constraint: &ContactConstraint,
        all_modes: DMat3,
        slow_modes: DMat3,
        spring: &Spring,
        implicit: f64,
    ) -> Self {
        let normal = constraint.points.normal;
        let normal_inverse_mass = normal.dot(all_modes * normal);
        // Per mass: stiffness w^2, damping 2 zeta w.
        let Spring { rate, damping, step, .. } = *spring;
        let divisor = 2.0 * damping + implicit * rate * step;
        Self {
            inverse_mass: all_modes,
            normal_inverse_mass,
            compliance: normal.dot(slow_modes * normal) / (step * rate * divisor),
            target_velocity: constraint.compression * rate / divisor,
        }
    }
}
