//! One body: its state, and what moves and tests it.

use glam::{DMat3, DQuat, DVec3};
use sscc::{KineticQuery, Method, Pair, Pose, PosedShape, Query};
use sscc_solid::Elasticity;

use crate::{
    Damping, DynamicsError, LinearOscillator, NonlinearOscillator, RigidMotion, Shape, WorldOptions,
};

/// How a body looks for collisions with itself. All exact methods find the same pairs, hence the same motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detection {
    /// By certificates, each step by itself.
    #[default]
    Certified,
    /// By certificates, and by what was known a step ago.
    Kinetic,
    /// By another method.
    Method(Method),
    /// Not at all: it may pass through itself.
    Off,
}

/// Where and how a body begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Whether it moves as a whole. Others are held where they are: their modes must be those of a held shape.
    pub is_free: bool,
    /// Where the centre of mass is (model unit); none: where the rest pose has it.
    pub position: Option<DVec3>,
    /// From the rest pose's axes to those of the world.
    pub orientation: DQuat,
    /// Of the centre of mass (model unit per s).
    pub velocity: DVec3,
    /// Angular velocity in axes of the world (1/s).
    pub spin: DVec3,
    /// Deformation; empty: none.
    pub q: Vec<f64>,
    /// Its rate (1/s); empty: none.
    pub v: Vec<f64>,
    /// Damping of the modes.
    pub damping: Damping,
    /// How it looks for collisions with itself.
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

/// A body. A vertex is at `R (p + U q - c) + x` in the world: c is the centre of mass of the rest pose, R and x are
/// the rigid motion. What the motion of the frame does to q (centrifugal forces) and deformation to the inertia is
/// left out.
pub struct Body<'a> {
    shape: &'a Shape,
    is_free: bool,
    pub(crate) rigid: RigidMotion,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    /// The last acceleration of q, where forces are nonlinear.
    pub(crate) a: Vec<f64>,
    /// Forces on q that stay the same: gravity, where the body is held.
    load: Vec<f64>,
    /// Of each mode, how much of it follows a contact slowly: see [`Mobility`](crate::contact::Mobility).
    pub(crate) shares: Vec<f64>,
    oscillator: Oscillator<'a>,
    detection: Detection,
    detector: Detector<'a>,
    pub(crate) posed: PosedShape<'a>,
    /// What collides within the body, as of the last detection.
    pub(crate) pairs: Vec<Pair>,
    pub(crate) root_failed: bool,
    pub(crate) is_pushed: bool,
    /// Energy that contacts have taken from the motion so far, less what they gave back: its share.
    pub(crate) ledger: f64,
}

#[derive(Clone)]
enum Oscillator<'a> {
    Linear(LinearOscillator),
    Nonlinear(NonlinearOscillator<'a>),
}

/// The middle of a step's turn is found by iterating, which is safe up to here.
const MOST_TURN: f64 = 1.0;

enum Detector<'a> {
    Off,
    Plain(Box<Query<'a>>),
    Kinetic(Box<KineticQuery<'a>>),
}

impl<'a> Body<'a> {
    /// A body at its start. A twin, another body of the same shape, lends what both can share.
    pub(crate) fn new(
        shape: &'a Shape,
        start: &Start,
        options: &WorldOptions,
        twin: Option<&Self>,
    ) -> Result<Self, DynamicsError> {
        let WorldOptions { step, gravity, contact, .. } = *options;
        let (model, certificates, r) = (shape.model(), shape.certificates(), shape.model().rank());
        let coordinates = |given: &[f64]| if given.is_empty() { vec![0.0; r] } else { given.to_vec() };
        let (q, v) = (coordinates(&start.q), coordinates(&start.v));
        model.check_coordinates(&q)?;
        model.check_coordinates(&v)?;
        let mut rigid = RigidMotion::new(*shape.mass())?;
        let sound = |x: DVec3| x.is_finite();
        let place = start.position.unwrap_or(shape.mass().center);
        let turn = start.orientation.normalize();
        if !(sound(place) && sound(start.velocity) && sound(start.spin) && turn.is_finite()) {
            return Err(DynamicsError::Start);
        }
        let turned = start.spin.length() * step;
        if turned > MOST_TURN {
            let what = "the angle by which a body's spin turns it in a step (rad)";
            return Err(DynamicsError::Option {
                what,
                value: turned,
                range: "at most 1: take a smaller step",
            });
        }
        (rigid.position, rigid.orientation) = (place, turn);
        if start.is_free {
            rigid.momentum = start.velocity * shape.mass().mass;
            rigid.angular_momentum = turn * (shape.mass().inertia * (turn.inverse() * start.spin));
        }
        let load = if start.is_free {
            vec![0.0; r]
        } else {
            shape.moments().iter().map(|m| m.dot(turn.inverse() * gravity)).collect()
        };
        let oscillator = match shape.elasticity() {
            Elasticity::Linear(stiffness) => {
                let eigenvalues: Vec<f64> = stiffness.diagonal().collect();
                Oscillator::Linear(LinearOscillator::new(&eigenvalues, start.damping, step)?)
            }
            Elasticity::Nonlinear(forces) => {
                Oscillator::Nonlinear(NonlinearOscillator::new(forces, start.damping, step)?)
            }
        };
        let a = match &oscillator {
            Oscillator::Linear(_) => Vec::new(),
            Oscillator::Nonlinear(oscillator) => oscillator.acceleration(&q, &v, &load),
        };
        let square = contact.rate() * contact.rate();
        let stiffness = shape.elasticity().stiffness().diagonal();
        let shares = stiffness.map(|lambda| square / (square + lambda)).collect();
        let method = match start.detection {
            Detection::Method(method) => method,
            _ => Method::Certified,
        };
        let detector = match (start.detection, twin.map(|twin| (twin.detection, &twin.detector))) {
            (Detection::Off, _) => Detector::Off,
            (Detection::Kinetic, _) => Detector::Kinetic(Box::new(KineticQuery::new(model, certificates)?)),
            (same, Some((other, Detector::Plain(query)))) if same == other => Detector::Plain(query.clone()),
            _ => Detector::Plain(Box::new(Query::with_method(model, certificates, method)?)),
        };
        let posed = match twin {
            Some(twin) => twin.posed.clone(),
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
            shares,
            oscillator,
            detection: start.detection,
            detector,
            posed,
            pairs: Vec::new(),
            root_failed: false,
            is_pushed: false,
            ledger: 0.0,
        })
    }

    /// What it shares with others.
    pub fn shape(&self) -> &'a Shape {
        self.shape
    }

    /// Whether it moves as a whole.
    pub fn is_free(&self) -> bool {
        self.is_free
    }

    /// Its deformation.
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// The rate of its deformation (1/s).
    pub fn v(&self) -> &[f64] {
        &self.v
    }

    /// Its motion as a whole.
    pub fn rigid(&self) -> &RigidMotion {
        &self.rigid
    }

    /// From rest axes to the world: a vertex is at [`Pose::apply`] of `p + U q`.
    pub fn pose(&self) -> Pose {
        let rotation = self.rotation();
        Pose { rotation, translation: self.rigid.position - rotation * self.shape.mass().center }
    }

    /// The pairs of its triangles that collided when the last step began.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Kinetic and elastic energy (weight apart).
    pub fn energy(&self) -> f64 {
        let elastic = match &self.oscillator {
            Oscillator::Linear(oscillator) => oscillator.energy(&self.q, &self.v),
            Oscillator::Nonlinear(oscillator) => oscillator.energy(&self.q, &self.v),
        };
        elastic + self.rigid.energy()
    }

    /// Kinetic energy.
    pub fn kinetic_energy(&self) -> f64 {
        self.v.iter().map(|v| v * v / 2.0).sum::<f64>() + self.rigid.energy()
    }

    /// Energy of position: of its weight, and of the load on held bodies.
    pub fn potential(&self, gravity: DVec3) -> f64 {
        let load: f64 = self.load.iter().zip(&self.q).map(|(f, q)| f * q).sum();
        -self.shape.mass().mass * gravity.dot(self.rigid.position) - load
    }

    /// The corners of a triangle, in axes of the rest pose.
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let model = self.shape.model();
        model.mesh().faces()[triangle as usize].map(|v| model.position(v, &self.q))
    }

    pub(crate) fn rotation(&self) -> DMat3 {
        DMat3::from_quat(self.rigid.orientation)
    }

    /// Finds what collides within the body.
    pub(crate) fn detect(&mut self) -> Result<(), DynamicsError> {
        self.pairs.clear();
        let statistics = match &mut self.detector {
            Detector::Off => return Ok(()),
            Detector::Plain(query) => {
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

    /// Puts the posed shape where the body is; gives a box around it.
    pub(crate) fn place(&mut self) -> Result<sscc::Aabb, DynamicsError> {
        let pose = self.pose();
        Ok(self.posed.place(&self.q, &pose)?)
    }

    /// One step of free motion. Weight acts half before and half after the way, which is exact for the way of the
    /// centre.
    pub(crate) fn advance(&mut self, gravity: DVec3, step: f64) -> Result<(), DynamicsError> {
        let was_pushed = std::mem::take(&mut self.is_pushed);
        match &self.oscillator {
            Oscillator::Linear(oscillator) => oscillator.advance(&mut self.q, &mut self.v, &self.load),
            Oscillator::Nonlinear(oscillator) => {
                if was_pushed {
                    // Accelerations belong to the new v.
                    self.a = oscillator.acceleration(&self.q, &self.v, &self.load);
                }
                oscillator.advance(&mut self.q, &mut self.v, &mut self.a, &self.load)?;
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

    /// Is to be told when q or v was changed.
    pub(crate) fn was_pushed(&mut self) {
        self.is_pushed = true;
    }
}
