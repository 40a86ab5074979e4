//! Contacts of a body's vertices with the ground, from a list of near vertices that serves many steps.

use glam::DVec3;
use sscc::Aabb;

use crate::body::Body;
use crate::contact::{ModalInverseMass, displacement};
use crate::contact_constraint::{ContactConstraint, GROUND, Source};
use crate::contact_set::adapt_preload;
use crate::{DynamicsError, Ground};

/// Number of steps for which a search for near vertices is meant to serve.
const SEARCH_STEPS: f64 = 64.0;

/// Minimum margin of a search, as a share of the body's radius.
const MIN_MARGIN: f64 = 1e-3;

/// Vertices of one body that can reach the ground within the margin of the last search.
///
/// Since the search, no vertex has approached the plane by more than `|n . dx| + |da| (radius + sum_k u_k |q_k|) +
/// sum_k u_k |dq_k|`. Here a is the plane's normal in axes of the body, and dx the displacement of the body. While this
/// bound is below the margin, no other vertex is within the skin.
#[derive(Clone, Debug, Default)]
pub(crate) struct GroundContacts {
    /// Distance beyond the skin that the last search covered; None before the first search.
    margin: Option<f64>,
    /// Position of the body at the last search.
    position: DVec3,
    /// Normal of the ground at the last search, in axes of the body.
    normal: DVec3,
    /// Coordinates q at the last search.
    q: Vec<f64>,
    /// Bound on the approach since the search, as of the last step.
    approach: f64,
    /// Numbers of the vertices, ascending.
    vertices: Vec<u32>,
    /// Modal inverse mass of each vertex.
    modal_inverse_masses: Vec<ModalInverseMass>,
    /// Length by which the springs of the ground exceed the skin: see [`adapt_preload`].
    pub(crate) preload: f64,
}

impl GroundContacts {
    /// Updates the list. Afterwards it holds every vertex below `ground.height + skin`.
    pub(crate) fn update(
        &mut self,
        body: &mut Body<'_>,
        ground: &Ground,
        skin: f64,
    ) -> Result<(), DynamicsError> {
        let local = body.rotation().transpose() * ground.normal;
        let shape = body.shape();
        let mut approach = f64::INFINITY;
        if self.margin.is_some() {
            let mut reach = shape.radius();
            approach = ground.normal.dot(body.rigid.position - self.position).abs();
            for ((u, q), before) in shape.reach().iter().zip(&body.q).zip(&self.q) {
                reach += u * q.abs();
                approach += u * (q - before).abs();
            }
            approach += (local - self.normal).length() * reach;
        }
        let step = approach - self.approach;
        if self.margin.is_some_and(|margin| approach < margin) {
            self.approach = approach;
            return Ok(());
        }
        // The speed is unknown before the first search.
        let step = if step.is_finite() { step } else { 0.0 };
        let near = (SEARCH_STEPS * step).max(MIN_MARGIN * shape.radius());
        self.vertices.clear();
        let Aabb { lower, upper } = body.place()?;
        let lowest =
            ground.normal.dot((lower + upper) * 0.5) - ground.normal.abs().dot((upper - lower) * 0.5);
        let clear = lowest - ground.height - skin;
        if clear < near {
            body.posed.vertices_below(ground.normal, ground.height + skin + near, &mut self.vertices);
        }
        self.margin = Some(near.max(clear));
        self.modal_inverse_masses.clear();
        let modes = shape.model().modes();
        self.modal_inverse_masses.extend(
            self.vertices.iter().map(|v| ModalInverseMass::of(modes.of_vertex(*v), &body.slow_weights)),
        );
        (self.position, self.normal, self.approach) = (body.rigid.position, local, 0.0);
        self.q.clear();
        self.q.extend_from_slice(&body.q);
        Ok(())
    }

    /// Updates the preload, and appends a constraint for each vertex within the skin to `constraints`.
    pub(crate) fn add_constraints(
        &mut self,
        number: u32,
        body: &Body<'_>,
        ground: &Ground,
        skin: f64,
        preload_rate: f64,
        constraints: &mut Vec<ContactConstraint>,
    ) {
        let (first, mut min_gap) = (constraints.len(), skin);
        let rotation = body.rotation();
        let local = rotation.transpose() * ground.normal;
        let shape = body.shape();
        let (rest, modes) = (shape.model().mesh().rest_positions(), shape.model().modes());
        let height = ground.normal.dot(body.rigid.position) - ground.height;
        for (&v, modal_inverse_mass) in self.vertices.iter().zip(&self.modal_inverse_masses) {
            let point = rest[v as usize] - shape.mass().center + displacement(modes.of_vertex(v), &body.q);
            let gap = height + local.dot(point);
            if gap < skin {
                min_gap = min_gap.min(gap);
                constraints.push(ContactConstraint {
                    bodies: [number, GROUND],
                    source: Source::Vertex(v),
                    normal: ground.normal,
                    arms: [rotation * point, DVec3::ZERO],
                    compression: skin - gap,
                    modal_inverse_mass: [*modal_inverse_mass, ModalInverseMass::default()],
                    friction: ground.friction,
                    normal_impulse: 0.0,
                    friction_impulse: DVec3::ZERO,
                });
            }
        }
        self.preload = adapt_preload(self.preload, min_gap, skin, preload_rate);
        constraints[first..].iter_mut().for_each(|constraint| constraint.compression += self.preload);
    }

    /// Discards the list of near vertices; needed after the body was moved to another state.
    pub(crate) fn reset(&mut self) {
        self.margin = None;
        self.approach = 0.0;
    }
}
