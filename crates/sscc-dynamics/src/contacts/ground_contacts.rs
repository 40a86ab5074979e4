//! Search for a body's vertices near the ground: a list of near vertices serves many steps, and each of them is tested
//! again only when it can have come within the skin.

use glam::DVec3;
use sscc::parts::Aabb;

use super::ground_point::GroundPoint;
use crate::bodies::displacement::displacement;
use crate::{Body, DynamicsError, Ground, Shape};

/// Number of steps for which one search for near vertices should be valid.
const SEARCH_STEPS: f64 = 64.0;

/// Minimum margin of a search, as a share of the body's radius.
const MIN_MARGIN: f64 = 1e-3;

/// Maximum margin of a search, as a share of the body's radius. Where the motion would need a larger one, most vertices would be
/// near, and a search with the minimum margin in each step takes less time.
const MAX_MARGIN: f64 = 0.25;

/// Number of vertices that are skipped together while all of them are outside the skin.
const CHUNK: usize = 32;

/// Factor on the travel in a step. It covers the rounding errors of a million additions.
const TRAVEL_ROUNDING: f64 = 1.0 + 1e-9;

/// Contacts of one body with the ground.
///
/// In a step, the gap of a vertex falls by at most its travel `|n . dx| + |da| |p + U q| + sum_k |a . U_k| |dq_k|`. Here
/// a is the plane's normal in axes of the body at the start of the step, da its change, and dx the displacement of the
/// body. [`Reach`] bounds these terms for many vertices together. A vertex whose gap exceeds the skin by d is outside the
/// skin until the sum of travels has grown by d, less the rounding errors.
#[derive(Clone, Debug, Default)]
pub(crate) struct GroundContacts {
    /// Travel of the body at which the next search is needed; None before the first search.
    search_limit: Option<f64>,
    /// Sum of the travels of all steps since the last search, for all vertices of the body.
    travel: f64,
    /// Sum of the travels of all steps since the last search, for the vertices that the last search found.
    near_travel: f64,
    near_reach: Reach,
    /// Position of the body in the last step.
    position: DVec3,
    /// Normal of the ground in the last step, in axes of the body.
    normal: DVec3,
    /// Coordinates q in the last step.
    q: Vec<f64>,
    /// Numbers of the vertices that the last search found, ascending.
    vertices: Vec<u32>,
    /// The `near_travel` up to which each vertex of `vertices` is outside the skin.
    limits: Vec<f64>,
    /// The smallest limit of each [`CHUNK`] vertices.
    chunk_limits: Vec<f64>,
    /// The skin of the last update.
    pub(super) skin: f64,
    /// A bound of the rounding of a gap in the last update.
    pub(super) rounding: f64,
    /// Vertices within the skin, ascending, each with its gap, in the state of the last update.
    pub(super) touching: Vec<(u32, f64)>,
    /// Vertices within the skin at the beginning of this step, with their gaps.
    pub(super) touching_at_start: Vec<(u32, f64)>,
    /// Vertices that corrections keep above the ground, ascending.
    pub points: Vec<GroundPoint>,
    /// Number of vertices within the skin at the beginning of this step.
    pub count: usize,
}

/// Bounds on the motion of some vertices of a body.
#[derive(Clone, Debug, Default)]
struct Reach {
    /// Maximum distance from the centre of mass, at rest.
    radius: f64,
    /// Maximum displacement by a unit of each mode.
    modes: Vec<f64>,
    /// Normal of the ground at the time of the search, in axes of the body.
    normal: DVec3,
    /// Maximum displacement along this normal by a unit of each mode.
    along: Vec<f64>,
}

impl Reach {
    /// Computes the bounds of these vertices.
    fn set(&mut self, shape: &Shape, vertices: &[u32], normal: DVec3) {
        let (rest, modes) = (shape.model().mesh().rest_positions(), shape.model().modes());
        (self.radius, self.normal) = (0.0, normal);
        for bounds in [&mut self.modes, &mut self.along] {
            bounds.clear();
            bounds.resize(modes.rank(), 0.0);
        }
        for v in vertices {
            self.radius = self.radius.max(rest[*v as usize].distance(shape.mass().center));
            for ((u, modes), along) in modes.of_vertex(*v).iter().zip(&mut self.modes).zip(&mut self.along) {
                *modes = modes.max(u.length());
                *along = along.max(normal.dot(*u).abs());
            }
        }
    }

    /// Returns a bound of the travel in a step, without the displacement of the body. `normals` and `q` are those before
    /// and after the step.
    fn travel(&self, normals: [DVec3; 2], q: [&[f64]; 2]) -> f64 {
        let turned = (normals[0] - self.normal).length();
        let (mut distance, mut travel) = (self.radius, 0.0);
        for (((q0, q1), modes), along) in q[0].iter().zip(q[1]).zip(&self.modes).zip(&self.along) {
            distance += modes * q1.abs();
            travel += (along + turned * modes) * (q1 - q0).abs();
        }
        travel + (normals[1] - normals[0]).length() * distance
    }
}

impl GroundContacts {
    /// Lists the vertices within the skin in the body's current state, and their gaps.
    pub fn update(&mut self, body: &mut Body, ground: &Ground, skin: f64) -> Result<(), DynamicsError> {
        let rotation = body.rotation();
        let local = rotation.transpose() * ground.normal;
        let is_same = (self.position, self.normal) == (body.rigid.position, local) && self.q == body.q;
        if is_same && self.search_limit.is_some() {
            return Ok(());
        }
        // A clone shares the shape, so that the body can change.
        let shape = &body.shape().clone();
        let displacement_travel = ground.normal.dot(body.rigid.position - self.position).abs();
        let near_travel =
            displacement_travel + self.near_reach.travel([self.normal, local], [&self.q, &body.q]);
        self.near_travel += near_travel * TRAVEL_ROUNDING;
        let (mut reach, mut travel) = (shape.radius(), displacement_travel);
        for ((u, q), before) in shape.reach().iter().zip(&body.q).zip(&self.q) {
            reach += u * q.abs();
            travel += u * (q - before).abs();
        }
        travel = (travel + (local - self.normal).length() * reach) * TRAVEL_ROUNDING;
        (self.position, self.normal) = (body.rigid.position, local);
        self.q.clear();
        self.q.extend_from_slice(&body.q);
        self.travel += travel;
        let height = ground.normal.dot(body.rigid.position) - ground.height;
        // Products and sums of a gap round by less than this, now and when the vertex is tested again.
        let size = body.rigid.position.abs().max_element() + ground.height.abs() + reach;
        let rounding = 8.0 * (shape.reach().len() + 16) as f64 * f64::EPSILON * size;
        if !self.search_limit.is_some_and(|limit| self.travel < limit) {
            // The travel is unknown in the first search.
            let wanted = self.search_limit.map_or(0.0, |_| SEARCH_STEPS * travel);
            let near = if wanted <= MAX_MARGIN * shape.radius() { wanted } else { 0.0 };
            self.search(body, ground, skin, near.max(MIN_MARGIN * shape.radius()), rounding)?;
        }
        (self.skin, self.rounding) = (skin, rounding);
        self.touching.clear();
        let (rest, modes) = (shape.model().mesh().rest_positions(), shape.model().modes());
        let chunks = self.limits.chunks_mut(CHUNK).zip(self.vertices.chunks(CHUNK));
        for ((limits, vertices), chunk_limit) in chunks.zip(&mut self.chunk_limits) {
            if *chunk_limit > self.near_travel {
                continue;
            }
            for (limit, v) in limits.iter_mut().zip(vertices) {
                if *limit > self.near_travel {
                    continue;
                }
                let modes = modes.of_vertex(*v);
                let point = rest[*v as usize] - shape.mass().center + displacement(modes, &body.q);
                let gap = height + local.dot(point);
                if gap >= skin {
                    *limit = self.near_travel + (gap - skin - rounding);
                } else {
                    self.touching.push((*v, gap));
                }
            }
            *chunk_limit = limits.iter().copied().fold(f64::INFINITY, f64::min);
        }
        Ok(())
    }

    /// Lists all vertices below `ground.height + skin + near`, or none if the body's AABB is above.
    fn search(
        &mut self,
        body: &mut Body,
        ground: &Ground,
        skin: f64,
        near: f64,
        rounding: f64,
    ) -> Result<(), DynamicsError> {
        self.vertices.clear();
        let Aabb { lower, upper } = body.place()?;
        let lowest =
            ground.normal.dot((lower + upper) * 0.5) - ground.normal.abs().dot((upper - lower) * 0.5);
        let clear = lowest - ground.height - skin;
        if clear < near {
            body.posed.vertices_below(ground.normal, ground.height + skin + near, &mut self.vertices)?;
        }
        self.search_limit = Some(near.max(clear) - rounding);
        (self.travel, self.near_travel) = (0.0, 0.0);
        self.near_reach.set(body.shape(), &self.vertices, body.rotation().transpose() * ground.normal);
        self.limits.clear();
        self.limits.resize(self.vertices.len(), f64::NEG_INFINITY);
        self.chunk_limits.clear();
        self.chunk_limits.resize(self.vertices.len().div_ceil(CHUNK), f64::NEG_INFINITY);
        Ok(())
    }

    /// Discards all lists; needed after the body was moved to another state.
    pub fn reset(&mut self) {
        self.search_limit = None;
        self.points.clear();
    }
}
