//! Vertices of a body near the ground, found once for many steps.

use glam::DVec3;
use sscc::Aabb;

use crate::body::Body;
use crate::contact::{Mobility, moved};
use crate::contacts::adapted;
use crate::solve::{GROUND, Source, Touch};
use crate::{DynamicsError, Ground};

/// A search for near vertices reaches as far as the body comes in about so many steps.
const STEPS: f64 = 64.0;

/// And at least this share of the body's radius.
const LEAST: f64 = 1e-3;

/// Vertices of one body that can reach the ground within the margin of the last search.
///
/// Since the search, no vertex has approached the plane by more than `|n . dx| + |da| (radius + sum_k u_k |q_k|) +
/// sum_k u_k |dq_k|`. Here a is the plane's normal in axes of the body, and dx the displacement of the body. While this
/// bound is below the margin, no other vertex is within the skin.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearGround {
    /// Distance beyond the skin that the last search covered; None before the first search.
    margin: Option<f64>,
    position: DVec3,
    normal: DVec3,
    q: Vec<f64>,
    /// Bound on the approach since the search, as of the last step.
    used: f64,
    /// Numbers of the vertices, ascending.
    vertices: Vec<u32>,
    /// Mobility of each vertex.
    mobilities: Vec<Mobility>,
    /// Length by which the springs of the ground exceed the skin: see [`adapted`].
    pub(crate) preload: f64,
}

impl NearGround {
    /// Updates the list. Afterwards it holds every vertex below `ground.height + skin`.
    pub(crate) fn update(
        &mut self,
        body: &mut Body<'_>,
        ground: &Ground,
        skin: f64,
    ) -> Result<(), DynamicsError> {
        let local = body.rotation().transpose() * ground.normal;
        let shape = body.shape();
        let mut moved = f64::INFINITY;
        if self.margin.is_some() {
            let mut reach = shape.radius();
            moved = ground.normal.dot(body.rigid.position - self.position).abs();
            for ((u, q), before) in shape.reach().iter().zip(&body.q).zip(&self.q) {
                reach += u * q.abs();
                moved += u * (q - before).abs();
            }
            moved += (local - self.normal).length() * reach;
        }
        let step = moved - self.used;
        if self.margin.is_some_and(|margin| moved < margin) {
            self.used = moved;
            return Ok(());
        }
        // The speed is unknown before the first search.
        let step = if step.is_finite() { step } else { 0.0 };
        let near = (STEPS * step).max(LEAST * shape.radius());
        self.vertices.clear();
        let Aabb { lower, upper } = body.place()?;
        let lowest =
            ground.normal.dot((lower + upper) * 0.5) - ground.normal.abs().dot((upper - lower) * 0.5);
        let clear = lowest - ground.height - skin;
        if clear < near {
            body.posed.vertices_below(ground.normal, ground.height + skin + near, &mut self.vertices);
        }
        self.margin = Some(near.max(clear));
        self.mobilities.clear();
        let modes = shape.model().modes();
        self.mobilities.extend(self.vertices.iter().map(|v| Mobility::of(modes.of_vertex(*v), &body.shares)));
        (self.position, self.normal, self.used) = (body.rigid.position, local, 0.0);
        self.q.clear();
        self.q.extend_from_slice(&body.q);
        Ok(())
    }

    /// Adds the vertices that touch.
    pub(crate) fn touch(
        &mut self,
        number: u32,
        body: &Body<'_>,
        ground: &Ground,
        skin: f64,
        creep: f64,
        touches: &mut Vec<Touch>,
    ) {
        let (first, mut least) = (touches.len(), skin);
        let rotation = body.rotation();
        let local = rotation.transpose() * ground.normal;
        let shape = body.shape();
        let (rest, modes) = (shape.model().mesh().rest_positions(), shape.model().modes());
        let height = ground.normal.dot(body.rigid.position) - ground.height;
        for (&v, mobility) in self.vertices.iter().zip(&self.mobilities) {
            let point = rest[v as usize] - shape.mass().center + moved(modes.of_vertex(v), &body.q);
            let gap = height + local.dot(point);
            if gap < skin {
                least = least.min(gap);
                touches.push(Touch {
                    bodies: [number, GROUND],
                    source: Source::Vertex(v),
                    normal: ground.normal,
                    arms: [rotation * point, DVec3::ZERO],
                    depth: skin - gap,
                    mobility: [*mobility, Mobility::default()],
                    friction: ground.friction,
                    pressure: 0.0,
                    drag: DVec3::ZERO,
                });
            }
        }
        self.preload = adapted(self.preload, least, skin, creep);
        touches[first..].iter_mut().for_each(|touch| touch.depth += self.preload);
    }

    /// Forgets all: the body was put elsewhere.
    pub(crate) fn forget(&mut self) {
        self.margin = None;
        self.used = 0.0;
    }
}
