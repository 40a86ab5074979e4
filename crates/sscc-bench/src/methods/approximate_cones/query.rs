//! Queries by normal cones: refit, then a traversal that normal cones cull.

use glam::{DVec3, Vec4};
use sscc::{Certificates, Error, Impact, Method, Pair, Query, ReducedModel, intersect_triangle_triangle};

use super::aabb8::{Aabb, Aabb8, Frame};
use super::directions::positive_sides;
use super::volumes::{Kind, Volume, volumes};
use crate::methods::engine::Engine;

/// Self-collision queries of one model by normal cones, which may list too few pairs.
pub struct ApproximateCones<'a> {
    model: &'a ReducedModel,
    volumes: Vec<Volume>,
    /// Triangle in each slot of the hierarchy's order, with its vertices.
    triangles: Vec<(u32, [u32; 3])>,
    frame: Frame,
    /// Exact position of each vertex.
    positions: Vec<DVec3>,
    /// Position of each vertex in the frame.
    mapped: Vec<Vec4>,
    /// AABB of each volume.
    aabbs: Vec<Aabb>,
    /// AABBs of the children of each volume.
    children: Vec<Aabb8>,
    /// Directions (one bit each) on whose positive side all normals of a volume are.
    positive: Vec<u16>,
    stack: Vec<(usize, usize)>,
    pairs: Vec<Pair>,
    /// Query for continuous queries.
    traditional: Query<'a>,
}

impl<'a> ApproximateCones<'a> {
    /// Creates queries on the hierarchy of the certificates. Triangles that share a vertex never count, for any contact
    /// filter of the certificates.
    ///
    /// # Errors
    /// When the certificates belong to another model.
    pub fn new(model: &'a ReducedModel, certificates: &'a Certificates) -> Result<Self, Error> {
        let traditional = Query::with_method(model, certificates, Method::Traditional)?;
        let (hierarchy, faces) = (certificates.hierarchy(), model.mesh().faces());
        let volumes = volumes(hierarchy);
        let positions = model.mesh().rest_positions().to_vec();
        Ok(Self {
            model,
            triangles: hierarchy.order().iter().map(|&t| (t, faces[t as usize])).collect(),
            frame: Frame::around(&positions),
            mapped: vec![Vec4::ZERO; positions.len()],
            positions,
            aabbs: vec![Aabb::EMPTY; volumes.len()],
            children: vec![Aabb8::EMPTY; volumes.len()],
            positive: vec![0; volumes.len()],
            volumes,
            stack: Vec::new(),
            pairs: Vec::new(),
            traditional,
        })
    }

    /// Moves all vertices, and updates AABBs and normals of all volumes.
    fn refit(&mut self, q: &[f64]) {
        for (v, (x, mapped)) in self.positions.iter_mut().zip(&mut self.mapped).enumerate() {
            *x = self.model.position(v as u32, q);
            *mapped = self.frame.map(*x);
        }
        for (n, volume) in self.volumes.iter().enumerate().rev() {
            let (mut bounds, mut positive) = (Aabb::EMPTY, !0);
            for (lane, child) in volume.children.clone().enumerate() {
                let (aabb, sides) = if volume.kind == Kind::Packet {
                    let corners = self.triangles[child].1.map(|v| v as usize);
                    let sides = positive_sides(corners.map(|v| self.positions[v]));
                    (Aabb::around(corners.map(|v| self.mapped[v])), sides)
                } else {
                    (self.aabbs[child], self.positive[child])
                };
                self.children[n].set(lane, &aabb);
                bounds = bounds.union(&aabb);
                positive &= sides;
            }
            (self.aabbs[n], self.positive[n]) = (bounds, positive);
        }
    }

    /// Appends all colliding pairs. On the stack, `(n, n)` is a volume against itself, `(n, m)` two volumes without
    /// common triangles whose AABBs overlap.
    fn traverse(&mut self) {
        self.stack.clear();
        self.stack.push((0, 0));
        while let Some((n, m)) = self.stack.pop() {
            if n == m {
                self.within(n);
            } else if self.volumes[n].kind >= self.volumes[m].kind {
                self.between(n, m);
            } else {
                self.between(m, n);
            }
        }
    }

    /// Tests a volume against itself unless its normals cull it.
    fn within(&mut self, n: usize) {
        let Volume { kind, children } = self.volumes[n].clone();
        if kind != Kind::Packet && self.positive[n] != 0 {
            return;
        }
        for (lane, child) in children.clone().enumerate() {
            let later = self.children[n].overlapping_lane(&self.children[n], lane).beyond(lane);
            if kind == Kind::Packet {
                later.for_each(|other| self.test(child, children.start + other));
            } else {
                self.stack.push((child, child));
                self.stack.extend(later.map(|other| (child, children.start + other)));
            }
        }
    }

    /// Tests two volumes, the first no finer than the second. Volumes of the same kind are both opened.
    fn between(&mut self, n: usize, m: usize) {
        let [x, y] = [n, m].map(|n| self.volumes[n].clone());
        let rows = self.children[n].overlapping(&self.aabbs[m]);
        if x.kind > y.kind {
            self.stack.extend(rows.map(|row| (x.children.start + row, m)));
            return;
        }
        let columns = self.children[m].overlapping(&self.aabbs[n]);
        for row in rows {
            let overlapping = self.children[m].overlapping_lane(&self.children[n], row).and(columns);
            let pairs = overlapping.map(|column| (x.children.start + row, y.children.start + column));
            if x.kind == Kind::Packet {
                pairs.for_each(|(a, b)| self.test(a, b));
            } else {
                self.stack.extend(pairs);
            }
        }
    }

    /// Tests two triangles, given by their slots, whose AABBs overlap.
    #[inline]
    fn test(&mut self, a: usize, b: usize) {
        let [(i, x), (j, y)] = [a, b].map(|slot| self.triangles[slot]);
        if x.iter().any(|v| y.contains(v)) {
            return;
        }
        let [x, y] = [x, y].map(|face| face.map(|v| self.positions[v as usize]));
        if intersect_triangle_triangle(&x, &y) {
            self.pairs.push((i.min(j), i.max(j)));
        }
    }
}

impl Engine for ApproximateCones<'_> {
    /// May miss pairs.
    fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error> {
        self.model.check_coordinates(q)?;
        self.refit(q);
        self.pairs.clear();
        self.traverse();
        self.pairs.sort_unstable();
        Ok(&self.pairs)
    }

    fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error> {
        self.traditional.continuous(q_t0, q_t1)
    }
}
