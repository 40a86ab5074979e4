//! Exact integrator for linear modal dynamics.

use crate::DynamicsError;

/// Rayleigh damping: a mode with eigenvalue `lambda` has the damping rate `mass + stiffness lambda` (1/s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// Coefficient of the mass (1/s): damps all modes equally.
    pub mass: f64,
    /// Coefficient of the stiffness (s): damps high frequencies more.
    pub stiffness: f64,
}

impl Damping {
    /// # Errors
    /// When a coefficient is negative or not finite.
    pub(crate) fn check(self) -> Result<Self, DynamicsError> {
        let is_valid = |x: f64| x.is_finite() && x >= 0.0;
        if is_valid(self.mass) && is_valid(self.stiffness) {
            Ok(self)
        } else {
            Err(DynamicsError::Damping { mass: self.mass, stiffness: self.stiffness })
        }
    }

    /// Returns the damping rate (1/s) of a mode with this eigenvalue (1/s^2).
    pub fn of(self, stiffness: f64) -> f64 {
        self.mass + self.stiffness * stiffness
    }
}

/// Coefficients of a step under a constant force: `(q, v) -> (qq q + qv v + qf f, vq q + vv v + vf f)`.
#[derive(Clone, Copy, Debug)]
struct Step {
    qq: f64,
    qv: f64,
    qf: f64,
    vq: f64,
    vv: f64,
    vf: f64,
}

/// Integrator for independent modes, `q'' + c q' + lambda q = f`, with a fixed step. A step is exact for a force that
/// is constant during it, at every frequency: the integrator is unconditionally stable and adds no numerical damping.
#[derive(Clone, Debug)]
pub struct LinearOscillator {
    steps: Vec<Step>,
    eigenvalues: Vec<f64>,
}

impl LinearOscillator {
    /// Creates the integrator for modes with these eigenvalues (r numbers, 1/s^2) and steps of `step` seconds.
    ///
    /// # Errors
    /// When the step is not positive, or an eigenvalue or the damping is negative or not finite.
    pub fn new(eigenvalues: &[f64], damping: Damping, step: f64) -> Result<Self, DynamicsError> {
        if !(step.is_finite() && step > 0.0) {
            return Err(DynamicsError::Step { step });
        }
        let damping = damping.check()?;
        let steps = eigenvalues.iter().enumerate().map(|(mode, &lambda)| {
            if lambda.is_finite() && lambda >= 0.0 {
                Ok(Step::new(lambda, damping.of(lambda), step))
            } else {
                Err(DynamicsError::Stiffness { mode, value: lambda })
            }
        });
        Ok(Self { steps: steps.collect::<Result<_, _>>()?, eigenvalues: eigenvalues.to_vec() })
    }

    /// Advances q and v by one step under the forces f (r numbers each).
    pub fn advance(&self, q: &mut [f64], v: &mut [f64], f: &[f64]) {
        for (((step, q), v), f) in self.steps.iter().zip(q).zip(v).zip(f) {
            let before = (*q, *v);
            *q = step.qq * before.0 + step.qv * before.1 + step.qf * f;
            *v = step.vq * before.0 + step.vv * before.1 + step.vf * f;
        }
    }

    /// Returns kinetic and elastic energy.
    pub fn energy(&self, q: &[f64], v: &[f64]) -> f64 {
        self.eigenvalues.iter().zip(q).zip(v).map(|((lambda, q), v)| (v * v + lambda * q * q) / 2.0).sum()
    }

    /// Returns the elastic energy.
    pub(crate) fn elastic_energy(&self, q: &[f64]) -> f64 {
        self.eigenvalues.iter().zip(q).map(|(lambda, q)| lambda * q * q / 2.0).sum()
    }
}

impl Step {
    /// Computes the coefficients for a step of h seconds. With `a = c / 2` and `d = lambda - a^2`, the motion is
    /// `q = e^(-a t) (q0 (C + a S) + v0 S)` for `C = cos(t root d)` and `S = sin(t root d) / root d`, hyperbolic where d is
    /// negative. A constant force adds the integral of `e^(-a t) S`.
    fn new(lambda: f64, damping: f64, h: f64) -> Self {
        let a = damping / 2.0;
        let (c, s) = decaying(lambda, a, h);
        // (1 - e^(-a h) (C + a S)) / lambda cancels when the step is short against the period. Then the integrand is
        // smooth; with strong damping it is the difference of two decaying exponentials.
        let qf = if a * h > 1.0 && a * a > 2.0 * lambda {
            let root = (a * a - lambda).sqrt();
            let integral = |x: f64| if x > 0.0 { -libm::expm1(-x * h) / x } else { h };
            (integral(lambda / (a + root)) - integral(a + root)) / (2.0 * root)
        } else if lambda * h * h > 1e-2 {
            (1.0 - (c + a * s)) / lambda
        } else {
            GAUSS.iter().map(|(x, w)| w * h * decaying(lambda, a, h * x).1).sum()
        };
        Self { qq: c + a * s, qv: s, qf, vq: -lambda * s, vv: c - a * s, vf: s }
    }
}

/// Returns `e^(-a t) C` and `e^(-a t) S`.
fn decaying(lambda: f64, a: f64, t: f64) -> (f64, f64) {
    let d = lambda - a * a;
    let x = d * t * t;
    if x.abs() < 1e-8 {
        let decay = libm::exp(-a * t);
        (decay * (1.0 - x / 2.0), decay * t * (1.0 - x / 6.0))
    } else if d > 0.0 {
        let (decay, root) = (libm::exp(-a * t), d.sqrt());
        (decay * libm::cos(root * t), decay * libm::sin(root * t) / root)
    } else {
        // e^(-a t) cosh: the slower exponent is -(a - root) = -lambda / (a + root), without cancellation.
        let root = (-d).sqrt();
        let (slow, fast) = (libm::exp(-lambda / (a + root) * t), libm::exp(-(a + root) * t));
        ((slow + fast) / 2.0, (slow - fast) / (2.0 * root))
    }
}

/// Nodes and weights of Gauss-Legendre quadrature on (0, 1), exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Damping = Damping { mass: 0.0, stiffness: 0.0 };

    fn near(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{a} and {b}");
    }

    #[test]
    fn free_vibration_has_the_frequency_and_keeps_the_energy() {
        // Periods from far above to far below the step.
        let eigenvalues = [1e-6, 1.0, 400.0, 4e6, 4e10];
        let step = 1e-3;
        let oscillator = LinearOscillator::new(&eigenvalues, NONE, step).unwrap();
        let (mut q, mut v) = ([1.0; 5], [0.0; 5]);
        let energies = |q: &[f64], v: &[f64]| -> Vec<f64> {
            (0..5).map(|k| (v[k] * v[k] + eigenvalues[k] * q[k] * q[k]) / 2.0).collect()
        };
        let first = energies(&q, &v);
        for _ in 0..10_000 {
            oscillator.advance(&mut q, &mut v, &[0.0; 5]);
        }
        for (k, (before, after)) in first.iter().zip(energies(&q, &v)).enumerate() {
            assert!((after / before - 1.0).abs() < 1e-9, "mode {k}");
            let root = eigenvalues[k].sqrt();
            near(q[k], libm::cos(10.0 * root), 1e-9 * (1.0 + 10.0 * root));
        }
        near(oscillator.energy(&q, &v), first.iter().sum(), 1e-9);
    }

    #[test]
    fn damping_and_forces_follow_the_closed_forms() {
        // Underdamped, critically damped and overdamped modes, and modes without stiffness.
        for (lambda, c) in [(100.0, 2.0), (100.0, 20.0), (100.0, 50.0), (0.0, 3.0), (0.0, 0.0), (1e-9, 1e-3)]
        {
            let oscillator =
                LinearOscillator::new(&[lambda], Damping { mass: c, stiffness: 0.0 }, 0.01).unwrap();
            let (mut q, mut v) = ([0.3], [-1.0]);
            for _ in 0..100 {
                oscillator.advance(&mut q, &mut v, &[5.0]);
            }
            // Reference: the classical Runge-Kutta method with short steps.
            let slope = |q: f64, v: f64| (v, 5.0 - c * v - lambda * q);
            let (mut x, mut y, h) = (0.3, -1.0, 1e-4);
            for _ in 0..10_000 {
                let k1 = slope(x, y);
                let k2 = slope(x + h / 2.0 * k1.0, y + h / 2.0 * k1.1);
                let k3 = slope(x + h / 2.0 * k2.0, y + h / 2.0 * k2.1);
                let k4 = slope(x + h * k3.0, y + h * k3.1);
                x += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
                y += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
            }
            near(q[0], x, 1e-9);
            near(v[0], y, 1e-9);
        }
    }

    #[test]
    fn one_step_equals_many_small_steps() {
        let h = 1e-3;
        for lambda in [0.0, 1e-6, 1.0, 1e3, 1e5, 1e8] {
            for c in [0.0, 10.0, 2.1e3, 1e4, 1e5, 1e6] {
                let after = |steps: usize| {
                    let damping = Damping { mass: c, stiffness: 0.0 };
                    let oscillator = LinearOscillator::new(&[lambda], damping, h / steps as f64).unwrap();
                    let (mut q, mut v) = ([0.0], [0.0]);
                    (0..steps).for_each(|_| oscillator.advance(&mut q, &mut v, &[1.0]));
                    (q[0], v[0])
                };
                let ((q, v), (x, y)) = (after(1), after(2000));
                let is_near = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-9 * size;
                assert!(
                    is_near(q, x, x.abs()) && is_near(v, y, y.abs() + x.abs() / h),
                    "{lambda} {c}: {q} {x}, {v} {y}"
                );
            }
        }
    }

    #[test]
    fn invalid_arguments_are_refused() {
        let of = |eigenvalue, mass, step| {
            LinearOscillator::new(&[1.0, eigenvalue], Damping { mass, stiffness: 0.0 }, step).err()
        };
        assert_eq!(of(1.0, 0.0, 1e-3), None);
        assert_eq!(of(-1.0, 0.0, 1e-3), Some(DynamicsError::Stiffness { mode: 1, value: -1.0 }));
        assert!(matches!(of(f64::NAN, 0.0, 1e-3), Some(DynamicsError::Stiffness { mode: 1, .. })));
        assert!(matches!(of(1.0, -1.0, 1e-3), Some(DynamicsError::Damping { .. })));
        for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(of(1.0, 0.0, step), Some(DynamicsError::Step { .. })));
        }
    }
}
