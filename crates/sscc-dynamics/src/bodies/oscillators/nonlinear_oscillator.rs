//! Integrator for reduced nonlinear dynamics: implicit Newmark (Barbic and James 2005, section 5). Where Newmark's method
//! fails, it uses a mean force that conserves energy, and shorter steps.

use std::sync::Arc;

use sscc_solid::Stiffness;

use super::elastic_energy::{ElasticEnergy, Evaluation};
use super::implicit_step::{ImplicitStep, NewmarkBuffers, Rule, Start};
use super::trial::Trial;
use crate::{Damping, DynamicsError};

/// Maximum energy that Newmark's method may have added, as a share of the energy of the modes. Its energy oscillates by about
/// this much where it resolves the motion.
const MAX_GAIN: f64 = 0.02;

/// Maximum energy that Newmark's method may have lost and may return later, as a share of the energy of the modes.
const MAX_LOSS: f64 = 0.1;

/// Maximum number of times that a step is halved.
const MAX_HALVINGS: u32 = 10;

/// Integrator for reduced St. Venant-Kirchhoff forces, `q'' + C q' + f(q) = g`. It uses the implicit Newmark method of
/// average acceleration (second order, no numerical damping). The Rayleigh damping uses the stiffness at rest.
///
/// Newmark's method conserves the energy of linear forces. With nonlinear forces it may add energy in each step, where the
/// step is long against the period of a mode that swings far. Steps that would add too much, and steps that it does not
/// solve, are solved with the mean force of the step (`implicit_step.rs`), which adds none. A step without a solution is
/// halved until its parts have solutions.
#[derive(Clone, Debug)]
pub struct NonlinearOscillator {
    energy: Arc<ElasticEnergy>,
    step: f64,
    solver: ImplicitStep,
}

impl NonlinearOscillator {
    /// Creates the integrator with steps of `step` seconds. `stiffness` is that at rest.
    ///
    /// # Errors
    /// When the step is not positive, the damping is negative or not finite, or stiffness and energy have different
    /// ranks.
    pub fn new(
        energy: Arc<ElasticEnergy>,
        stiffness: &Stiffness,
        damping: Damping,
        step: f64,
    ) -> Result<Self, DynamicsError> {
        if !(step.is_finite() && step > 0.0) {
            return Err(DynamicsError::Step { step });
        }
        let given = damping.check()?;
        let (r, found) = (energy.rank(), stiffness.rank());
        if found != r {
            return Err(DynamicsError::Rank { found, rank: r });
        }
        let mut damping: Vec<f64> = stiffness.entries().iter().map(|k| given.stiffness * k).collect();
        (0..r).for_each(|k| damping[k * (r + 1)] += given.mass);
        Ok(Self { step, solver: ImplicitStep::new(Arc::clone(&energy), damping, step), energy })
    }

    /// Returns the memory of the integrator (2 r + 2 numbers), which the first step needs: the undamped acceleration
    /// `g - f(q)` under the forces g (r numbers each), the q whose derivative the step begins with (rest), the elastic energy at
    /// q, and the energy that steps have added, less the energy that they have lost (0).
    pub fn undamped_acceleration(&self, q: &[f64], g: &[f64], buffers: &mut NewmarkBuffers) -> Vec<f64> {
        let mut undamped = vec![0.0; 2 * q.len() + 2];
        self.update(q, &mut undamped, g, buffers);
        undamped
    }

    /// Computes the undamped acceleration and the elastic energy at a q that was moved between steps. Returns this energy.
    pub(crate) fn update(
        &self,
        q: &[f64],
        undamped: &mut [f64],
        g: &[f64],
        buffers: &mut NewmarkBuffers,
    ) -> f64 {
        self.energy.evaluate_forces(q, &mut buffers.evaluation);
        let forces = buffers.evaluation.forces();
        undamped.iter_mut().zip(g).zip(forces).for_each(|((undamped, g), f)| *undamped = g - f);
        undamped[2 * q.len()] = buffers.evaluation.energy();
        buffers.evaluation.energy()
    }

    /// Advances q, v and the memory of the integrator by one step under the forces g (r numbers each). `undamped` is that of
    /// [`undamped_acceleration`](Self::undamped_acceleration). Its acceleration and energy depend on q alone, so impulses
    /// may change v between steps. The same numbers give the same bits, independent of earlier steps. Returns the elastic
    /// energy at the end of the step.
    ///
    /// # Errors
    /// When even the shortest steps have no solution; then q, v and `undamped` are unchanged.
    pub fn advance(
        &mut self,
        q: &mut [f64],
        v: &mut [f64],
        undamped: &mut [f64],
        g: &[f64],
        buffers: &mut NewmarkBuffers,
    ) -> Result<f64, DynamicsError> {
        let r = q.len();
        let energy = kinetic(v) + undamped[2 * r];
        // Contacts may have taken energy from the modes since the last step.
        let sum = limit_sum(undamped[2 * r + 1], energy);
        let start = Start { q, v, undamped: &undamped[..r], g };
        let solved = self.solver.solve(Rule::Newmark, self.step, start, &undamped[r..2 * r], buffers);
        if let Some(is_quick) = solved {
            let trial = &buffers.trial;
            let gain = trial.elastic_energy - undamped[2 * r] - work_of_mean_force(start, trial);
            if gain <= MAX_GAIN * energy - sum {
                trial.finish(q, v, undamped);
                undamped[r..2 * r].copy_from_slice(if is_quick {
                    self.solver.linearised_at()
                } else {
                    &trial.q
                });
                undamped[2 * r] = trial.elastic_energy;
                undamped[2 * r + 1] = limit_sum(sum + gain, kinetic(v) + trial.elastic_energy);
                return Ok(trial.elastic_energy);
            }
        }
        let before = [q.to_vec(), v.to_vec(), undamped.to_vec()];
        if self.advance_in_parts(q, v, undamped, g, buffers) {
            return Ok(undamped[2 * r]);
        }
        q.copy_from_slice(&before[0]);
        v.copy_from_slice(&before[1]);
        undamped.copy_from_slice(&before[2]);
        Err(DynamicsError::Unsolved { energy })
    }

    /// Advances by one step with the energy-conserving force, split into as many parts as are needed. Returns false if the
    /// shortest part has no solution.
    fn advance_in_parts(
        &mut self,
        q: &mut [f64],
        v: &mut [f64],
        undamped: &mut [f64],
        g: &[f64],
        buffers: &mut NewmarkBuffers,
    ) -> bool {
        let r = q.len();
        let whole = 1_u32 << MAX_HALVINGS;
        let (mut left, mut part) = (whole, whole);
        while left > 0 {
            let step = self.step * (f64::from(part) / f64::from(whole));
            let start = Start { q, v, undamped: &undamped[..r], g };
            if self.solver.solve(Rule::Conserving, step, start, q, buffers).is_none() {
                part /= 2;
                if part == 0 {
                    return false;
                }
                continue;
            }
            q.copy_from_slice(&buffers.trial.q);
            v.copy_from_slice(&buffers.trial.v);
            self.update(q, undamped, g, buffers);
            undamped[2 * r + 1] = limit_sum(undamped[2 * r + 1], kinetic(v) + undamped[2 * r]);
            left -= part;
        }
        true
    }

    /// Returns kinetic and elastic energy.
    pub fn energy(&self, q: &[f64], v: &[f64]) -> f64 {
        self.elastic_energy(q) + kinetic(v)
    }

    /// Returns the elastic energy.
    pub(crate) fn elastic_energy(&self, q: &[f64]) -> f64 {
        self.energy.at(q, &mut Evaluation::default())
    }
}

/// Returns the kinetic energy of the modes.
fn kinetic(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v / 2.0).sum()
}

/// Returns the work of the mean of the elastic forces at both ends of a step. Newmark's method uses it as the change of the
/// elastic energy.
fn work_of_mean_force(start: Start<'_>, end: &Trial) -> f64 {
    let undamped = end.acceleration.iter().zip(&end.damping_forces).map(|(b, damping)| b + damping);
    let forces = start.g.iter().zip(start.undamped).zip(undamped).map(|((g, e0), e1)| g - (e0 + e1) / 2.0);
    forces.zip(end.q.iter().zip(start.q)).map(|(force, (q1, q0))| force * (q1 - q0)).sum()
}

/// Limits the sum of the energies that steps gained and lost (negative) beyond the work of all forces. Newmark's method returns
/// losses later, within limits: losses count up to the amount that it may lose where it resolves the motion, gains up to the
/// allowed gain. `energy` is the present energy of the modes.
fn limit_sum(sum: f64, energy: f64) -> f64 {
    sum.max(-MAX_LOSS * energy).min(MAX_GAIN * energy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sscc_solid::ReducedForces;

    const NONE: Damping = Damping { mass: 0.0, stiffness: 0.0 };

    /// Forces of two modes with the energy `l1 x^2 / 2 + l2 y^2 / 2 + s (x^2 + x y)^2 / 4`.
    fn forces(l1: f64, l2: f64, s: f64) -> ReducedForces {
        // d/dx: l1 x + s (x^2 + x y) (2 x + y) / 2 = .. + s (2 x^3 + 3 x^2 y + x y^2) / 2
        // d/dy: l2 y + s (x^2 + x y) x / 2 = .. + s (x^3 + x^2 y) / 2
        let cubic = [1.0, 1.5, 0.5, 0.0, 0.5, 0.5, 0.0, 0.0].map(|c| s * c).to_vec();
        ReducedForces::new(Stiffness::from_diagonal(&[l1, l2]).unwrap(), vec![0.0; 6], cubic).unwrap()
    }

    #[test]
    fn free_vibration_has_the_exact_frequency() {
        let lambda = 40.0_f64;
        // 200 steps a period; the method lengthens the period by (omega h)^2 / 12.
        let period = std::f64::consts::TAU / lambda.sqrt();
        let step = period / 200.0;
        let forces = forces(lambda, 90.0, 0.0);
        let energy = Arc::new(ElasticEnergy::new(&forces).unwrap());
        let mut oscillator =
            NonlinearOscillator::new(Arc::clone(&energy), forces.linear(), NONE, step).unwrap();
        let (mut q, mut v) = (vec![1e-3, 0.0], vec![0.0, 0.0]);
        let buffers = &mut NewmarkBuffers::default();
        let mut a = oscillator.undamped_acceleration(&q, &[0.0; 2], buffers);
        let (mut crossings, mut last) = (Vec::new(), q[0]);
        for step in 0..4000 {
            oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers).unwrap();
            if last > 0.0 && q[0] <= 0.0 {
                crossings.push(f64::from(step) + last / (last - q[0]));
            }
            last = q[0];
        }
        let measured = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64 / 200.0;
        assert!((measured - 1.0).abs() < 1e-3, "{measured} periods");
    }

    #[test]
    fn energy_stays_bounded_without_damping_and_falls_with_it() {
        let forces = forces(40.0, 90.0, 3e4);
        for (damping, grows) in [(NONE, false), (Damping { mass: 0.1, stiffness: 1e-3 }, true)] {
            let energy = Arc::new(ElasticEnergy::new(&forces).unwrap());
            let mut oscillator =
                NonlinearOscillator::new(Arc::clone(&energy), forces.linear(), damping, 2e-3).unwrap();
            let (mut q, mut v) = (vec![0.2, -0.1], vec![0.0, 1.0]);
            let buffers = &mut NewmarkBuffers::default();
            let mut a = oscillator.undamped_acceleration(&q, &[0.0; 2], buffers);
            let first = oscillator.energy(&q, &v);
            let (mut least, mut largest) = (first, first);
            for _ in 0..10_000 {
                oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers).unwrap();
                let energy = oscillator.energy(&q, &v);
                (least, largest) = (least.min(energy), largest.max(energy));
            }
            assert!(largest < 1.01 * first, "{first} to {largest}");
            assert_eq!(least < 0.9 * first, grows, "{first} to {least}");
        }
    }

    #[test]
    fn a_constant_force_leads_to_its_static_solution() {
        let forces = forces(40.0, 90.0, 3e4);
        let goal = [0.05, -0.02];
        let force = forces.at(&goal);
        let damping = Damping { mass: 10.0, stiffness: 0.0 };
        let energy = Arc::new(ElasticEnergy::new(&forces).unwrap());
        let mut oscillator =
            NonlinearOscillator::new(Arc::clone(&energy), forces.linear(), damping, 1e-2).unwrap();
        let buffers = &mut NewmarkBuffers::default();
        let (mut q, mut v) = (vec![0.0; 2], vec![0.0; 2]);
        let mut a = oscillator.undamped_acceleration(&q, &force, buffers);
        for _ in 0..2000 {
            oscillator.advance(&mut q, &mut v, &mut a, &force, buffers).unwrap();
        }
        assert!((q[0] - goal[0]).abs() + (q[1] - goal[1]).abs() < 1e-9, "{q:?}");
    }

    #[test]
    fn modes_much_faster_than_the_step_are_solved() {
        let forces = forces(4e7, 9e5, 1e8);
        let energy = Arc::new(ElasticEnergy::new(&forces).unwrap());
        let mut oscillator =
            NonlinearOscillator::new(Arc::clone(&energy), forces.linear(), NONE, 1e-3).unwrap();
        let buffers = &mut NewmarkBuffers::default();
        for speed in [5.0, 50.0] {
            let (mut q, mut v) = (vec![0.2, -0.1], vec![-speed, speed / 2.0]);
            let mut a = oscillator.undamped_acceleration(&q, &[0.0; 2], buffers);
            let first = oscillator.energy(&q, &v);
            for step in 0..500 {
                oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers).unwrap();
                let energy = oscillator.energy(&q, &v);
                assert!(energy < 1.5 * first, "step {step}: {energy}, not {first}");
            }
        }
    }

    /// Newmark's method alone multiplies the energy by 4 and by 12, and the two fastest motions end within 40 steps. With the
    /// mean force alone, some whole step of each motion has no solution.
    #[test]
    fn steps_too_long_for_their_forces_add_no_energy() {
        let forces = forces(4e3, 9e3, 1e8);
        let energy = Arc::new(ElasticEnergy::new(&forces).unwrap());
        for speed in [5.0, 50.0, 500.0, 5000.0] {
            let mut oscillator =
                NonlinearOscillator::new(Arc::clone(&energy), forces.linear(), NONE, 1e-3).unwrap();
            let (mut q, mut v) = (vec![0.2, -0.1], vec![-speed, speed / 2.0]);
            let buffers = &mut NewmarkBuffers::default();
            let mut a = oscillator.undamped_acceleration(&q, &[0.0; 2], buffers);
            let first = oscillator.energy(&q, &v);
            for step in 0..3000 {
                let answer = oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers);
                answer.unwrap_or_else(|error| panic!("speed {speed}, step {step}: {error}"));
                let energy = oscillator.energy(&q, &v);
                assert!(
                    energy <= first * (1.0 + 1.01 * MAX_GAIN),
                    "speed {speed}, step {step}: {energy}, not {first}"
                );
            }
        }
    }

    /// Contacts have taken the energy of a fast motion, in which Newmark's method lost energy. It may not return that loss to the
    /// slow motion that remains: from this state it would multiply the energy by 1.46.
    #[test]
    fn losses_at_a_higher_energy_are_not_returned() {
        let forces = forces(4e3, 9e3, 1e8);
        let energy = Arc::new(ElasticEnergy::new(&forces).unwrap());
        let mut oscillator =
            NonlinearOscillator::new(Arc::clone(&energy), forces.linear(), NONE, 1e-3).unwrap();
        let (mut q, mut v) = (vec![0.15, 0.0], vec![0.0; 2]);
        let buffers = &mut NewmarkBuffers::default();
        let mut a = oscillator.undamped_acceleration(&q, &[0.0; 2], buffers);
        let first = oscillator.energy(&q, &v);
        a[5] = -MAX_LOSS * 1e6 * first;
        oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers).unwrap();
        let after = oscillator.energy(&q, &v);
        assert!(after <= (1.0 + MAX_LOSS + MAX_GAIN) * first, "{after}, not {first}");
        assert!(a[5] >= -1.01 * MAX_LOSS * after, "{}", a[5]);
    }

    #[test]
    fn a_new_oscillator_continues_with_the_same_bits() {
        for (soft, speed) in [(4e5, 5.0), (4e3, 50.0), (4e3, 500.0)] {
            let forces = forces(soft, 9e5, 1e8);
            let energy = Arc::new(ElasticEnergy::new(&forces).unwrap());
            let new = || NonlinearOscillator::new(Arc::clone(&energy), forces.linear(), NONE, 1e-3).unwrap();
            let (mut oscillator, buffers) = (new(), &mut NewmarkBuffers::default());
            let (mut q, mut v) = (vec![0.2, -0.1], vec![-speed, speed / 2.0]);
            let mut a = oscillator.undamped_acceleration(&q, &[0.0; 2], buffers);
            let mut has_other_derivative = false;
            for _ in 0..100 {
                let (mut other_q, mut other_v, mut other_a) = (q.clone(), v.clone(), a.clone());
                new().advance(&mut other_q, &mut other_v, &mut other_a, &[0.0; 2], buffers).unwrap();
                oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers).unwrap();
                assert_eq!((&q, &v, &a), (&other_q, &other_v, &other_a));
                has_other_derivative |= a[2..4].iter().any(|x| *x != 0.0);
            }
            assert!(has_other_derivative || speed > 5.0, "the derivative of a later step was used");
        }
    }

    #[test]
    fn invalid_arguments_and_steps_are_refused() {
        let forces = forces(1.0, 1.0, 1.0);
        let energy = Arc::new(ElasticEnergy::new(&forces).unwrap());
        let new =
            |damping, step| NonlinearOscillator::new(Arc::clone(&energy), forces.linear(), damping, step);
        assert!(matches!(new(NONE, 0.0), Err(DynamicsError::Step { .. })));
        let wrong = Damping { mass: f64::NAN, stiffness: 0.0 };
        assert!(matches!(new(wrong, 1.0), Err(DynamicsError::Damping { .. })));
        let mut oscillator = new(NONE, 1.0).unwrap();
        let (mut q, mut v) = (vec![1e200, 0.0], vec![0.0, 0.0]);
        let mut a = vec![0.0; 6];
        let (before, buffers) = (q.clone(), &mut NewmarkBuffers::default());
        let answer = oscillator.advance(&mut q, &mut v, &mut a, &[0.0; 2], buffers);
        assert!(matches!(answer, Err(DynamicsError::Unsolved { .. })));
        assert_eq!(q, before);
    }
}
