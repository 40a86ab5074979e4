//! Body: state, integrators and self-collision detection.

use glam::{DMat3, DQuat, DVec3};
use sscc::{KineticQuery, Method, Pair, Pose, PosedShape, Query};

use crate::nonlinear_oscillator::NewmarkBuffers;
use crate::{
    Damping, DynamicsError, LinearOscillator, NonlinearOscillator, RigidMotion, Shape, WorldOptions,
};

/// How a body detects self-collisions. All exact methods find the same pairs, hence give the same motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detection {
    /// Certified discrete query ([`Query`]) in each step.
    #[default]
    Certified,
    /// Kinetic query ([`KineticQuery`]), which reuses safe distances of earlier steps.
    Kinetic,
    /// Discrete query with this method.
    Method(Method),
    /// No detection: the body can pass through itself.
    Off,
}

/// Initial state and settings of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Whether the body has rigid motion. A held body (false) keeps its pose, and its modes must be those of a held
    /// shape.
    pub is_free: bool,
    /// Position of the centre of mass (model unit). None: that of the rest pose.
    pub position: Option<DVec3>,
    /// Rotation from axes of the rest pose to axes of the world.
    pub orientation: DQuat,
    /// Velocity of the centre of mass (model unit per s).
    pub velocity: DVec3,
    /// Angular velocity in axes of the world (rad/s).
    pub spin: DVec3,
    /// Initial q (r numbers). Empty: zeros.
    pub q: Vec<f64>,
    /// Initial rate of q (r numbers, 1/s). Empty: zeros.
    pub v: Vec<f64>,
    /// Damping of the modes.
    pub damping: Damping,
    /// Method of self-collision detection.
    pub detection: Detection,
}

impl Default for Start {
    fn default() -> Self {
        Self {
            is_free: true,
            position: None,
            orientation: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            spin: DVec3::ZERO,
            q: Vec::new(),
            v: Vec::new(),
            damping: Damping::default(),
            detection: Detection::default(),
        }
    }
}

/// A body of a [`World`](crate::World). The world position of a vertex is `R (p + U q - c) + x`, where c is the centre
/// of mass of the rest pose, and R and x are the rigid motion. The equations neglect centrifugal forces on q and the
/// change of the inertia by deformation.
pub struct Body<'a> {
    shape: &'a Shape,
    is_free: bool,
    pub(crate) rigid: RigidMotion,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    /// Undamped acceleration of q after the last step, and its change (2 r numbers); empty for linear forces.
    pub(crate) a: Vec<f64>,
    /// Constant generalised forces (r numbers): gravity on a held body, else zeros.
    load: Vec<f64>,
    /// Weight of each mode in [`ModalInverseMass::slow_modes`](crate::contact::ModalInverseMass::slow_modes).
    pub(crate) slow_weights: Vec<f64>,
    oscillator: Oscillator<'a>,
    detection: Detection,
    detector: Detector<'a>,
    pub(crate) posed: PosedShape<'a>,
    /// Colliding triangle pairs within the body, found by the last detection.
    pub(crate) pairs: Vec<Pair>,
    /// Whether q was outside the certificate of the root in the last detection.
    pub(crate) root_failed: bool,
    /// Whether q was moved since the last step.
    pub(crate) has_moved: bool,
    /// Energy budget: the body's share of the energy that contacts have dissipated, less the energy that they have
    /// returned.
    pub(crate) energy_budget: f64,
}

/// Integrator of q.
#[derive(Clone)]
enum Oscillator<'a> {
    Linear(LinearOscillator),
    Nonlinear(NonlinearOscillator<'a>),
}

/// Maximum rotation in a step (rad). [`RigidMotion::advance`] iterates for the middle of the rotation; the iteration
/// converges up to here.
const MAX_STEP_ROTATION: f64 = 1.0;

/// Query that detects self-collisions.
enum Detector<'a> {
    Off,
    Discrete(Box<Query<'a>>),
    Kinetic(Box<KineticQuery<'a>>),
}

impl<'a> Body<'a> {
    /// Creates a body in its initial state. `same_shape` is an existing body of the same shape; its query and posed
    /// shape are cloned instead of computed.
    pub(crate) fn new(
        shape: &'a Shape,
        start: &Start,
        options: &WorldOptions,
        same_shape: Option<&Self>,
    ) -> Result<Self, DynamicsError> {
        let WorldOptions { step, gravity, contact, .. } = *options;
        let (model, certificates, r) = (shape.model(), shape.certificates(), shape.model().rank());
        let coordinates = |given: &[f64]| if given.is_empty() { vec![0.0; r] } else { given.to_vec() };
        let (q, v) = (coordinates(&start.q), coordinates(&start.v));
        model.check_coordinates(&q)?;
        model.check_coordinates(&v)?;
        let mut rigid = RigidMotion::new(*shape.mass())?;
        let position = start.position.unwrap_or(shape.mass().center);
        let orientation = start.orientation.normalize();
        let vectors = [position, start.velocity, start.spin];
        if !(vectors.iter().all(|x| x.is_finite()) && orientation.is_finite()) {
            return Err(DynamicsError::Start);
        }
        let rotation_angle = start.spin.length() * step;
        if rotation_angle > MAX_STEP_ROTATION {
            let what = "the rotation of a body by its spin in a step (rad)";
            return Err(DynamicsError::Option {
                what,
                value: rotation_angle,
                range: "at most 1: take a smaller step",
            });
        }
        (rigid.position, rigid.orientation) = (position, orientation);
        if start.is_free {
            rigid.momentum = start.velocity * shape.mass().mass;
            rigid.angular_momentum =
                orientation * (shape.mass().inertia * (orientation.inverse() * start.spin));
        }
        let load = if start.is_free {
            vec![0.0; r]
        } else {
            shape.moments().iter().map(|m| m.dot(orientation.inverse() * gravity)).collect()
        };
        let stiffness = shape.elasticity().stiffness();
        let (oscillator, a) = match shape.elastic_energy() {
            None => {
                let eigenvalues: Vec<f64> = stiffness.diagonal().collect();
                let oscillator = LinearOscillator::new(&eigenvalues, start.damping, step)?;
                (Oscillator::Linear(oscillator), Vec::new())
            }
            Some(energy) => {
                let oscillator = NonlinearOscillator::new(energy, stiffness, start.damping, step)?;
                let a = oscillator.undamped_acceleration(&q, &load, &mut NewmarkBuffers::default());
                (Oscillator::Nonlinear(oscillator), a)
            }
        };
        let square = contact.rate() * contact.rate();
        let slow_weights = stiffness.diagonal().map(|lambda| square / (square + lambda)).collect();
        let method = match start.detection {
            Detection::Method(method) => method,
            _ => Method::Certified,
        };
        let detector = match (start.detection, same_shape.map(|other| (other.detection, &other.detector))) {
            (Detection::Off, _) => Detector::Off,
            (Detection::Kinetic, _) => Detector::Kinetic(Box::new(KineticQuery::new(model, certificates)?)),
            (own, Some((other, Detector::Discrete(query)))) if own == other => {
                Detector::Discrete(query.clone())
            }
            _ => Detector::Discrete(Box::new(Query::with_method(model, certificates, method)?)),
        };
        let posed = match same_shape {
            Some(other) => other.posed.clone(),
            None => PosedShape::new(model, certificates)?,
        };
        Ok(Self {
            shape,
            is_free: start.is_free,
            rigid,
            q,
            v,
            a,
            load,
            slow_weights,
            oscillator,
            detection: start.detection,
            detector,
            posed,
            pairs: Vec::new(),
            root_failed: false,
            has_moved: false,
            energy_budget: 0.0,
        })
    }

    /// Returns the shape, shared by all bodies that use it.
    pub fn shape(&self) -> &'a Shape {
        self.shape
    }

    /// Returns whether the body has rigid motion (false: it is held).
    pub fn is_free(&self) -> bool {
        self.is_free
    }

    /// Returns the modal coordinates q (r numbers).
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Returns the rate of q (r numbers, 1/s).
    pub fn v(&self) -> &[f64] {
        &self.v
    }

    /// Returns the rigid motion of the body.
    pub fn rigid(&self) -> &RigidMotion {
        &self.rigid
    }

    /// Returns the pose of the body. The world position of a vertex is [`Pose::apply`] of `p + U q`.
    pub fn pose(&self) -> Pose {
        let rotation = self.rotation();
        Pose { rotation, translation: self.rigid.position - rotation * self.shape.mass().center }
    }

    /// Returns the pairs of the body's triangles that collided at the start of the last step.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Returns kinetic and elastic energy, without the potential energy of gravity.
    pub fn energy(&self) -> f64 {
        let elastic = match &self.oscillator {
            Oscillator::Linear(oscillator) => oscillator.energy(&self.q, &self.v),
            Oscillator::Nonlinear(oscillator) => oscillator.energy(&self.q, &self.v),
        };
        elastic + self.rigid.energy()
    }

    /// Returns the kinetic energy of rigid motion and vibration.
    pub fn kinetic_energy(&self) -> f64 {
        self.v.iter().map(|v| v * v / 2.0).sum::<f64>() + self.rigid.energy()
    }

    /// Returns the potential energy of the weight, and of the load on a held body.
    pub fn potential(&self, gravity: DVec3) -> f64 {
        let load: f64 = self.load.iter().zip(&self.q).map(|(f, q)| f * q).sum();
        -self.shape.mass().mass * gravity.dot(self.rigid.position) - load
    }

    /// Returns the positions of the corners of a triangle, in axes of the rest pose.
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let model = self.shape.model();
        model.mesh().faces()[triangle as usize].map(|v| model.position(v, &self.q))
    }

    /// Returns the rotation from axes of the rest pose to axes of the world.
    pub(crate) fn rotation(&self) -> DMat3 {
        DMat3::from_quat(self.rigid.orientation)
    }

    /// Detects self-collisions and stores the pairs in `pairs`.
    pub(crate) fn detect(&mut self) -> Result<(), DynamicsError> {
        self.pairs.clear();
        let statistics = match &mut self.detector {
            Detector::Off => return Ok(()),
            Detector::Discrete(query) => {
                self.pairs.extend_from_slice(query.discrete(&self.q)?);
                query.statistics()
            }
            Detector::Kinetic(query) => {
                self.pairs.extend_from_slice(query.discrete(&self.q)?);
                query.statistics()
            }
        };
        self.root_failed = !statistics.root_certified;
        Ok(())
    }

    /// Updates the posed shape to the body's pose and q. Returns its AABB in the world.
    pub(crate) fn place(&mut self) -> Result<sscc::Aabb, DynamicsError> {
        let pose = self.pose();
        Ok(self.posed.place(&self.q, &pose)?)
    }

    /// Advances the body by one step without contacts. Half of the impulse of the weight acts before and half after the
    /// displacement, which is exact for the position of the centre of mass.
    pub(crate) fn advance(
        &mut self,
        gravity: DVec3,
        step: f64,
        buffers: &mut NewmarkBuffers,
    ) -> Result<(), DynamicsError> {
        let has_moved = std::mem::take(&mut self.has_moved);
        match &self.oscillator {
            Oscillator::Linear(oscillator) => oscillator.advance(&mut self.q, &mut self.v, &self.load),
            Oscillator::Nonlinear(oscillator) => {
                if has_moved {
                    // The stored acceleration belongs to the old q.
                    self.a = oscillator.undamped_acceleration(&self.q, &self.load, buffers);
                }
                oscillator.advance(&mut self.q, &mut self.v, &mut self.a, &self.load, buffers)?;
            }
        }
        if self.is_free {
            let half = gravity * (self.shape.mass().mass * step / 2.0);
            self.rigid.momentum += half;
            self.rigid.advance(step);
            self.rigid.momentum += half;
        }
        Ok(())
    }

    /// Records that q was moved between steps. The next step then computes the acceleration again.
    pub(crate) fn mark_moved(&mut self) {
        self.has_moved = true;
    }
}
