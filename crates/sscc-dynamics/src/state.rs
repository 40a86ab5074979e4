//! State of a world as plain numbers, to stop a simulation and continue it with the same bits.

use glam::{DQuat, DVec3};

use crate::contacts::contact::{Anchor, Contact};
use crate::contacts::contact_constraint::GROUND;
use crate::contacts::ground_point::GroundPoint;
use crate::contacts::world_contacts::WorldContacts;
use crate::{Body, DynamicsError};

/// State of a world. A world with the same options and bodies continues from it with the same bits (see "Determinism" in
/// [the crate's guarantees](crate#guarantees)).
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Number of completed steps.
    pub step: u64,
    /// Motion and energy budget of each body, then the contacts; the order is internal.
    pub numbers: Vec<f64>,
}

/// Position, orientation, momentum, angular momentum, number of vertices on the ground, whether q was moved, whether the
/// body sleeps, time at rest, reference position and orientation of the rest, energy budget.
const RIGID: usize = 13 + 11 + 1;

/// Bodies, triangles, weights, normal, offset, maximum slip, preload, age, whether it is rigid (2: a duplicate),
/// features and impulses of a contact. A point on the ground, after all contacts, has [`GROUND`] for the second body and
/// a vertex for the first triangle.
const CONTACT: usize = 2 + 2 + 6 + 3 + 10;

impl State {
    /// Returns the state of a world after `step` steps.
    pub(crate) fn of(step: u64, bodies: &[Body], contacts: &WorldContacts) -> Self {
        let mut numbers = Vec::new();
        for (body, ground) in bodies.iter().zip(&contacts.ground) {
            let rigid = &body.rigid;
            numbers.extend([&body.q, &body.v, &body.a].into_iter().flatten());
            numbers.extend(rigid.position.to_array());
            numbers.extend(rigid.orientation.to_array());
            numbers.extend(rigid.momentum.to_array());
            numbers.extend(rigid.angular_momentum.to_array());
            let flag = |x: bool| f64::from(u8::from(x));
            let rest = &body.rest;
            numbers.extend([ground.count as f64, flag(body.has_moved)]);
            numbers.extend([flag(rest.is_asleep), rest.time]);
            numbers.extend(rest.position.to_array());
            numbers.extend(rest.orientation.to_array());
            numbers.push(body.energy_budget);
            numbers.extend(&rest.q);
        }
        for contact in &contacts.triangles.list {
            numbers.extend(contact.bodies.map(f64::from));
            numbers.extend(contact.anchors.iter().map(|anchor| f64::from(anchor.triangle)));
            numbers.extend(contact.anchors.iter().flat_map(|anchor| anchor.weights));
            numbers.extend(contact.normal.to_array());
            numbers.extend([contact.offset, contact.max_slip, contact.preload, f64::from(contact.age)]);
            let kind = u8::from(contact.is_rigid) + u8::from(contact.is_duplicate);
            numbers.extend([f64::from(kind), f64::from(contact.features), contact.normal_impulse]);
            numbers.extend(contact.friction_impulse.to_array());
        }
        for (n, ground) in contacts.ground.iter().enumerate() {
            for point in &ground.points {
                let mut one = [0.0; CONTACT];
                one[..3].copy_from_slice(&[n as f64, f64::from(GROUND), f64::from(point.vertex)]);
                one[19] = point.normal_impulse;
                one[20..].copy_from_slice(&point.friction_impulse.to_array());
                numbers.extend(one);
            }
        }
        Self { step, numbers }
    }

    /// Restores the state of bodies, and of their contacts.
    ///
    /// # Errors
    /// When the state does not fit the bodies or holds an invalid number; then nothing is changed.
    pub(crate) fn restore(&self, bodies: &mut [Body], all: &mut WorldContacts) -> Result<(), DynamicsError> {
        let expected = bodies.iter().map(numbers_of).sum::<usize>();
        let found = self.numbers.len();
        let invalid = || DynamicsError::State { found, expected };
        let (motion, contacts) = self.numbers.split_at(expected.min(found));
        let (contacts, rest) = contacts.as_chunks::<CONTACT>();
        if motion.len() < expected || !rest.is_empty() || self.numbers.iter().any(|x| !x.is_finite()) {
            return Err(invalid());
        }
        let first_point = contacts.partition_point(|numbers| numbers[1] != f64::from(GROUND));
        let (contacts, points) = contacts.split_at(first_point);
        let points: Option<Vec<(usize, GroundPoint)>> =
            points.iter().map(|numbers| ground_point(numbers, bodies)).collect();
        let contacts: Option<Vec<Contact>> =
            contacts.iter().map(|numbers| contact(numbers, bodies)).collect();
        let (points, mut contacts) = (points.ok_or_else(invalid)?, contacts.ok_or_else(invalid)?);
        // `ContactSet::update` requires contacts sorted by key.
        let in_order = contacts.is_sorted_by(|a, b| a.key() < b.key())
            && points.is_sorted_by(|(n, a), (m, b)| (n, a.vertex) < (m, b.vertex));
        if !in_order || !is_valid_motion(motion, bodies) {
            return Err(invalid());
        }
        let mut numbers = motion.iter().copied();
        let mut next = || numbers.next().unwrap_or_default();
        for (body, ground) in bodies.iter_mut().zip(&mut all.ground) {
            body.q.iter_mut().chain(&mut body.v).chain(&mut body.a).for_each(|x| *x = next());
            let rigid = &mut body.rigid;
            rigid.position = DVec3::from_array([(); 3].map(|()| next()));
            rigid.orientation = DQuat::from_array([(); 4].map(|()| next()));
            rigid.momentum = DVec3::from_array([(); 3].map(|()| next()));
            rigid.angular_momentum = DVec3::from_array([(); 3].map(|()| next()));
            ground.reset();
            ground.count = next() as usize;
            body.has_moved = next() != 0.0;
            let rest = &mut body.rest;
            (rest.is_asleep, rest.time) = (next() != 0.0, next());
            rest.position = DVec3::from_array([(); 3].map(|()| next()));
            rest.orientation = DQuat::from_array([(); 4].map(|()| next()));
            body.energy_budget = next();
            rest.q.iter_mut().for_each(|x| *x = next());
            body.forget_energy();
            body.save_start();
            body.is_proven_free = false;
            body.measure_root();
            body.pairs.clear();
        }
        for contact in &mut contacts {
            contact.attach(contact.bodies.map(|body| &bodies[body as usize]));
        }
        all.triangles.list = contacts;
        for (body, point) in points {
            all.ground[body].points.push(point);
        }
        all.collisions.reset();
        Ok(())
    }
}

/// Whether orientations have the length 1, vertices on the ground exist, and energy budgets are not negative.
fn is_valid_motion(motion: &[f64], bodies: &[Body]) -> bool {
    let mut at = 0;
    bodies.iter().all(|body| {
        let rigid = &motion[at + body.q.len() + body.v.len() + body.a.len()..][..RIGID];
        at += numbers_of(body);
        let length: f64 = rigid[3..7].iter().map(|x| x * x).sum();
        let vertices = body.shape().model().mesh().rest_positions().len() as f64;
        let is_count = (0.0..=vertices).contains(&rigid[13]);
        (length - 1.0).abs() < 1e-9 && is_count && rigid[RIGID - 1] >= 0.0
    })
}

/// Creates a point on the ground from its numbers, with its body. None if one of them is not valid.
fn ground_point(numbers: &[f64; CONTACT], all: &[Body]) -> Option<(usize, GroundPoint)> {
    let body = index(numbers[0], all.len())?;
    let vertices = all[body as usize].shape().model().mesh().rest_positions().len();
    let vertex = index(numbers[2], vertices)?;
    let is_point = numbers[1] == f64::from(GROUND) && numbers[3..19].iter().all(|x| *x == 0.0);
    let friction_impulse = DVec3::new(numbers[20], numbers[21], numbers[22]);
    let point = GroundPoint { vertex, normal_impulse: numbers[19], friction_impulse, ..Default::default() };
    is_point.then_some((body as usize, point))
}

/// Creates a contact from its numbers. None if a body, a triangle or the age is not a valid number.
fn contact(numbers: &[f64; CONTACT], all: &[Body]) -> Option<Contact> {
    let bodies = [index(numbers[0], all.len())?, index(numbers[1], all.len())?];
    let triangle = |n: usize| {
        let mesh = all[bodies[n] as usize].shape().model().mesh();
        index(numbers[2 + n], mesh.faces().len())
    };
    let anchor = |n: usize| {
        let weights = [0, 1, 2].map(|k| numbers[4 + 3 * n + k]);
        Some(Anchor { triangle: triangle(n)?, weights })
    };
    Some(Contact {
        bodies,
        anchors: [anchor(0)?, anchor(1)?],
        normal: DVec3::new(numbers[10], numbers[11], numbers[12]),
        offset: numbers[13],
        max_slip: numbers[14],
        preload: numbers[15],
        age: index(numbers[16], u32::MAX as usize)?,
        is_rigid: index(numbers[17], 3)? > 0,
        is_duplicate: numbers[17] == 2.0,
        features: index(numbers[18], 32)? as u8,
        normal_impulse: numbers[19],
        friction_impulse: DVec3::new(numbers[20], numbers[21], numbers[22]),
        ..Contact::default()
    })
}

/// Returns a number as an index below `count`. None if it is not such an index.
fn index(x: f64, count: usize) -> Option<u32> {
    (x >= 0.0 && x < count as f64 && x.fract() == 0.0).then_some(x as u32)
}

/// Returns the count of numbers of a body.
fn numbers_of(body: &Body) -> usize {
    2 * body.q.len() + body.v.len() + body.a.len() + RIGID
}
