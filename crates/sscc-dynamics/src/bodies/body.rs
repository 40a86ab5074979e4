//! Body: state, integrators and self-collision detection.

use glam::{DMat3, DQuat, DVec3};
use sscc::parts::{Aabb, Pose, PosedShape, SweptShape};
use sscc::{Impact, KineticQuery, Method, Pair, Query};

use super::change::Change;
use super::displacement::displacement;
use super::kinematics::{Kinematics, pose};
use super::oscillators::NewmarkBuffers;
use super::rest::Rest;
use super::start::{Detection, Start};
use crate::{DynamicsError, LinearOscillator, NonlinearOscillator, RigidMotion, Shape, WorldOptions};

/// A body of a [`World`](crate::World). The world position of a vertex is `R (p + U q - c) + x`, where c is the centre
/// of mass of the rest pose, and R and x are the rigid motion. The equations neglect centrifugal forces on q and the
/// change of the inertia by deformation.
pub struct Body {
    pub(crate) shape: Shape,
    is_free: bool,
    pub(crate) rigid: RigidMotion,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    /// State of the integrator of nonlinear forces (2 r + 2 numbers); empty for linear forces.
    pub(crate) a: Vec<f64>,
    /// Constant generalised forces (r numbers): gravity on a held body, else zeros.
    load: Vec<f64>,
    /// Weight of each mode in [`ModalInverseMass::slow_modes`](crate::contacts::contact::ModalInverseMass::slow_modes).
    pub(crate) slow_weights: Vec<f64>,
    /// Displacement at the end of a step, divided by the step, by a unit impulse on each mode at its beginning.
    pub(crate) step_weights: Vec<f64>,
    oscillator: Oscillator,
    detection: Detection,
    detector: Detector,
    /// Continuous query of the body with itself; made when it is first needed.
    continuous: Option<Box<Query>>,
    /// Impacts of the body with itself, found by the last continuous query.
    pub(crate) impacts: Vec<Impact>,
    /// Whether a continuous query has proven the last motion free of self-collisions, so that no discrete one is needed.
    pub(crate) is_proven_free: bool,
    pub(crate) posed: PosedShape,
    /// The motion of the last step; made when it is first needed.
    pub(crate) swept: Option<Box<SweptShape>>,
    /// Colliding triangle pairs within the body, found by the last detection.
    pub(crate) pairs: Vec<Pair>,
    /// Whether q was outside the certificate of the root in the last detection.
    pub(crate) root_failed: bool,
    /// Whether q was moved since the integrator's last step.
    pub(crate) has_moved: bool,
    /// The elastic energy of nonlinear forces at q, and at the beginning of the step, where they are known.
    elastic_energy: Option<f64>,
    start_elastic_energy: Option<f64>,
    /// Energy budget: the body's share of the energy that contacts have dissipated, less the energy that they have
    /// returned.
    pub(crate) energy_budget: f64,
    /// State at the beginning of this step.
    pub(crate) start: Kinematics,
    /// State at the end of this step before corrections.
    pub(crate) trial: Kinematics,
    pub(crate) rest: Rest,
}

/// Integrator of q.
#[derive(Clone)]
enum Oscillator {
    Linear(LinearOscillator),
    Nonlinear(NonlinearOscillator),
}

/// Maximum rotation in a step (rad). [`RigidMotion::advance`] iterates for the middle of the rotation; the iteration
/// converges up to here.
const MAX_STEP_ROTATION: f64 = 1.0;

/// Query that detects self-collisions.
enum Detector {
    Off,
    Discrete(Box<Query>),
    Kinetic(Box<KineticQuery>),
}

impl Oscillator {
    /// Creates the integrator of a body. Returns it with its state for the initial q and the forces on q.
    fn new(
        shape: &Shape,
        start: &Start,
        step: f64,
        (q, load): (&[f64], &[f64]),
    ) -> Result<(Self, Vec<f64>), DynamicsError> {
        let stiffness = shape.elasticity().stiffness();
        let Some(energy) = shape.elastic_energy() else {
            let eigenvalues: Vec<f64> = stiffness.diagonal().collect();
            let oscillator = LinearOscillator::new(&eigenvalues, start.damping, step)?;
            return Ok((Self::Linear(oscillator), Vec::new()));
        };
        let oscillator = NonlinearOscillator::new(energy.clone(), stiffness, start.damping, step)?;
        let a = oscillator.undamped_acceleration(q, load, &mut NewmarkBuffers::default());
        Ok((Self::Nonlinear(oscillator), a))
    }
}

impl Detector {
    /// Creates the query of a body. The discrete query of a body with the same shape and detection is cloned.
    fn new(shape: &Shape, detection: Detection, same_shape: Option<&Body>) -> Result<Self, DynamicsError> {
        let (model, certificates) = (shape.model(), shape.certificates());
        let known = same_shape.filter(|other| other.detection == detection);
        let method = match (detection, known.map(|other| &other.detector)) {
            (Detection::Off, _) => return Ok(Self::Off),
            (Detection::Kinetic, _) => {
                return Ok(Self::Kinetic(Box::new(KineticQuery::new(model, certificates)?)));
            }
            (_, Some(Self::Discrete(query))) => return Ok(Self::Discrete(query.clone())),
            (Detection::Method(method), _) => method,
            (Detection::Certified, _) => Method::Certified,
        };
        Ok(Self::Discrete(Box::new(Query::with_method(model, certificates, method)?)))
    }
}

/// Returns the rigid motion with which a body starts.
fn initial_motion(shape: &Shape, start: &Start, step: f64) -> Result<RigidMotion, DynamicsError> {
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
        rigid.angular_momentum = orientation * (shape.mass().inertia * (orientation.inverse() * start.spin));
    }
    Ok(rigid)
}

impl Body {
    /// Creates a body in its initial state. `same_shape` is an existing body of the same shape. Its posed shape is
    /// cloned instead of computed, and so is its discrete query if it has the same detection.
    pub(crate) fn new(
        shape: &Shape,
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
        let rigid = initial_motion(shape, start, step)?;
        let load = if start.is_free {
            vec![0.0; r]
        } else {
            shape.moments().iter().map(|m| m.dot(rigid.orientation.inverse() * gravity)).collect()
        };
        let stiffness = shape.elasticity().stiffness();
        let (oscillator, a) = Oscillator::new(shape, start, step, (&q, &load))?;
        let square = contact.rate() * contact.rate();
        let slow_weights = stiffness.diagonal().map(|lambda| square / (square + lambda)).collect();
        // Newmark's method, linear about the rest pose.
        let weight =
            |lambda: f64| 1.0 / (1.0 + step / 2.0 * (start.damping.of(lambda) + lambda * step / 2.0));
        let step_weights = stiffness.diagonal().map(weight).collect();
        let detector = Detector::new(shape, start.detection, same_shape)?;
        let posed = match same_shape {
            Some(other) => other.posed.clone(),
            None => PosedShape::new(model, certificates)?,
        };
        let RigidMotion { position, orientation, .. } = rigid;
        let rest = Rest { is_asleep: false, time: 0.0, position, orientation, q: q.clone() };
        let now = Kinematics { rigid, q: q.clone(), v: v.clone() };
        Ok(Self {
            shape: shape.clone(),
            is_free: start.is_free,
            rigid,
            q,
            v,
            a,
            load,
            slow_weights,
            step_weights,
            oscillator,
            detection: start.detection,
            detector,
            continuous: None,
            impacts: Vec::new(),
            is_proven_free: false,
            posed,
            swept: None,
            pairs: Vec::new(),
            root_failed: false,
            has_moved: false,
            elastic_energy: None,
            start_elastic_energy: None,
            energy_budget: 0.0,
            start: now.clone(),
            trial: now,
            rest,
        })
    }

    /// Returns the shape, shared by all bodies that use it.
    pub fn shape(&self) -> &Shape {
        &self.shape
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
        pose(&self.rigid, &self.shape)
    }

    /// Returns whether the body sleeps. Its motion is then zero until another body touches it.
    pub fn is_asleep(&self) -> bool {
        self.rest.is_asleep
    }

    /// Returns the pairs of the body's triangles that collided at the start of the last step.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Returns kinetic and elastic energy, without the potential energy of gravity.
    pub fn energy(&self) -> f64 {
        self.energy_of_modes(&self.q, &self.v, self.elastic_energy) + self.rigid.energy()
    }

    /// Returns the kinetic and elastic energy of modes.
    fn energy_of_modes(&self, q: &[f64], v: &[f64], elastic_energy: Option<f64>) -> f64 {
        match (&self.oscillator, elastic_energy) {
            (Oscillator::Linear(oscillator), _) => oscillator.energy(q, v),
            (Oscillator::Nonlinear(_), Some(energy)) => energy + v.iter().map(|v| v * v / 2.0).sum::<f64>(),
            (Oscillator::Nonlinear(oscillator), None) => oscillator.energy(q, v),
        }
    }

    /// Returns the elastic energy.
    pub(crate) fn elastic_energy(&self) -> f64 {
        match (&self.oscillator, self.elastic_energy) {
            (Oscillator::Linear(oscillator), _) => oscillator.elastic_energy(&self.q),
            (Oscillator::Nonlinear(_), Some(energy)) => energy,
            (Oscillator::Nonlinear(oscillator), None) => oscillator.elastic_energy(&self.q),
        }
    }

    /// Returns the total energy at the beginning of the step and now.
    pub(crate) fn energies(&self, gravity: DVec3) -> [f64; 2] {
        let Kinematics { rigid, q, v } = &self.start;
        let elastic = self.energy_of_modes(q, v, self.start_elastic_energy);
        let load: f64 = self.load.iter().zip(q).map(|(f, q)| f * q).sum();
        let weight = self.shape.mass().mass * gravity.dot(rigid.position);
        [elastic + rigid.energy() - weight - load, self.energy() + self.potential(gravity)]
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

    /// Returns the world position of the point that is at `rest` from the centre of mass in the rest pose.
    pub(crate) fn point(&self, rest: DVec3, modes: &[DVec3]) -> DVec3 {
        self.rigid.position + self.rigid.orientation * (rest + displacement(modes, &self.q))
    }

    /// Returns the positions of the corners of a triangle, in axes of the rest pose.
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let model = self.shape.model();
        model.mesh().faces()[triangle as usize].map(|v| model.position(v, &self.q))
    }

    /// Returns the positions of the corners of a triangle in the world.
    pub(crate) fn world_corners(&self, triangle: u32) -> [DVec3; 3] {
        let pose = self.pose();
        self.corners(triangle).map(|x| pose.apply(x))
    }

    /// Returns the positions of the corners of a triangle at the beginning of the step: in axes of the rest pose if
    /// `within`, else of the world.
    pub(crate) fn start_corners(&self, triangle: u32, within: bool) -> [DVec3; 3] {
        if within {
            let model = self.shape.model();
            return model.mesh().faces()[triangle as usize].map(|v| model.position(v, &self.start.q));
        }
        self.start.corners(&self.shape, triangle)
    }

    /// Returns the rotation from axes of the rest pose to axes of the world.
    pub(crate) fn rotation(&self) -> DMat3 {
        DMat3::from_quat(self.rigid.orientation)
    }

    /// Detects self-collisions and stores the pairs in `pairs`.
    pub(crate) fn detect(&mut self) -> Result<(), DynamicsError> {
        self.pairs.clear();
        self.measure_root();
        if std::mem::take(&mut self.is_proven_free) {
            return Ok(());
        }
        match &mut self.detector {
            Detector::Off => {}
            Detector::Discrete(query) => self.pairs.extend_from_slice(query.discrete(&self.q)?),
            Detector::Kinetic(query) => self.pairs.extend_from_slice(query.discrete(&self.q)?),
        }
        Ok(())
    }

    /// Stores whether q is outside the certificate of the root, if self-collisions are detected.
    pub(crate) fn measure_root(&mut self) {
        self.root_failed = !matches!(self.detector, Detector::Off) && !self.is_root_certified();
    }

    /// Whether the certificate of the root holds at q.
    pub(crate) fn is_root_certified(&self) -> bool {
        let certificates = self.shape.certificates();
        certificates.norm(&self.q).is_ok_and(|norm| norm < certificates.root_radius())
    }

    /// Finds the impacts of the body with itself in the motion from the beginning of the step to the current state. Finds no
    /// impact if self-collisions are not detected, nor for a body that collides with itself at the beginning: it may
    /// pass through itself until it is free.
    pub(crate) fn find_own_impacts(&mut self) -> Result<(), DynamicsError> {
        self.impacts.clear();
        if !self.pairs.is_empty() || self.detection == Detection::Off {
            return Ok(());
        }
        if let Detector::Kinetic(query) = &mut self.detector {
            self.impacts.extend_from_slice(query.continuous(&self.start.q, &self.q)?);
            return Ok(());
        }
        let query = match (&mut self.continuous, &self.detector) {
            (Some(query), _) => query,
            (none, Detector::Discrete(query)) if self.detection == Detection::Certified => {
                none.insert(query.clone())
            }
            (none, _) => none.insert(Box::new(Query::new(self.shape.model(), self.shape.certificates())?)),
        };
        self.impacts.extend_from_slice(query.continuous(&self.start.q, &self.q)?);
        self.is_proven_free = self.impacts.is_empty();
        Ok(())
    }

    /// Updates the posed shape to the body's pose and q. Returns its AABB in the world.
    pub(crate) fn place(&mut self) -> Result<Aabb, DynamicsError> {
        let pose = self.pose();
        Ok(self.posed.place(&self.q, &pose)?)
    }

    /// Checks that all positions of the body in the world are in the range of numbers. [`Body::place`] checks this too, but a
    /// step needs no placed shape where no other body and no ground is near.
    pub(crate) fn check_range(&self) -> Result<(), DynamicsError> {
        let own = self.shape.model().check_coordinates(&self.q)?;
        self.pose().check_reach(own)?;
        Ok(())
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
        match &mut self.oscillator {
            Oscillator::Linear(oscillator) => oscillator.advance(&mut self.q, &mut self.v, &self.load),
            Oscillator::Nonlinear(oscillator) => {
                if has_moved {
                    // The stored acceleration belongs to the old q.
                    oscillator.update(&self.q, &mut self.a, &self.load, buffers);
                }
                let energy =
                    oscillator.advance(&mut self.q, &mut self.v, &mut self.a, &self.load, buffers)?;
                self.elastic_energy = Some(energy);
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

    /// Discards the elastic energy, which belongs to an old q.
    pub(crate) fn forget_energy(&mut self) {
        self.elastic_energy = None;
    }

    /// Updates the time for which all points of the body have stayed within a distance.
    pub(crate) fn measure_rest(&mut self, step: f64, distance: f64) {
        let Self { shape, rigid, q, posed, rest, .. } = self;
        let bend_bound = |change: &[f64]| posed.displacement_bound(change).unwrap_or(f64::INFINITY);
        rest.update(shape, rigid, q, (step, distance), bend_bound);
    }

    /// Makes the current state the beginning of the step.
    pub(crate) fn save_start(&mut self) {
        self.start.set(&self.rigid, &self.q, &self.v);
        self.start_elastic_energy = self.elastic_energy;
    }

    /// Makes the current state the trial end of the step.
    pub(crate) fn save_trial(&mut self) {
        self.trial.set(&self.rigid, &self.q, &self.v);
    }

    /// Moves the body to the trial end of the step, changed by an impulse that acts during `step` seconds.
    pub(crate) fn correct(&mut self, change: &Change, modes: &[f64], step: f64) {
        self.rigid = self.trial.rigid;
        if self.is_free {
            let turn = DQuat::from_scaled_axis(change.angular_velocity * step);
            self.rigid.position += change.velocity * step;
            self.rigid.orientation = (turn * self.rigid.orientation).normalize();
            self.rigid.momentum += change.impulse;
            self.rigid.angular_momentum += change.angular_impulse;
        }
        for (k, change) in modes.iter().enumerate() {
            self.q[k] = self.trial.q[k] + change * step;
            self.v[k] = self.trial.v[k] + change;
        }
        self.mark_moved();
    }

    /// Moves the body back to the point at a fraction `share` of its motion from the beginning of the step to its current state.
    pub(crate) fn shorten(&mut self, share: f64) {
        let before = &self.start.rigid;
        self.rigid.position = before.position.lerp(self.rigid.position, share);
        self.rigid.orientation = before.orientation.slerp(self.rigid.orientation, share).normalize();
        self.q.iter_mut().zip(&self.start.q).for_each(|(q, before)| *q = before + (*q - before) * share);
        if share == 0.0 {
            (self.rigid.position, self.rigid.orientation) = (before.position, before.orientation);
        }
        self.mark_moved();
    }

    /// Multiplies all velocities by a factor.
    pub(crate) fn scale_velocities(&mut self, factor: f64) {
        self.rigid.momentum *= factor;
        self.rigid.angular_momentum *= factor;
        self.v.iter_mut().for_each(|v| *v *= factor);
    }

    /// Places the swept shape on the motion from the beginning of the step to the current state. Returns an AABB of this motion.
    pub(crate) fn sweep(&mut self) -> Result<Aabb, DynamicsError> {
        let (t0, t1) = (self.start.pose(&self.shape), self.pose());
        let swept = match &mut self.swept {
            Some(swept) => swept,
            none => none.insert(Box::new(SweptShape::new(&self.posed)?)),
        };
        Ok(swept.place([&self.start.q, &self.q], [&t0, &t1])?)
    }

    /// Evaluates the nonlinear forces at a q to which the body was moved. They give its elastic energy, and the acceleration with
    /// which the next step begins.
    pub(crate) fn update_forces(&mut self, buffers: &mut NewmarkBuffers) {
        if let (true, Oscillator::Nonlinear(oscillator)) = (self.has_moved, &self.oscillator) {
            self.elastic_energy = Some(oscillator.update(&self.q, &mut self.a, &self.load, buffers));
            self.has_moved = false;
        }
    }

    /// Records that q was moved since the integrator's last step. The next step then computes the acceleration again.
    pub(crate) fn mark_moved(&mut self) {
        (self.has_moved, self.elastic_energy) = (true, None);
    }
}
