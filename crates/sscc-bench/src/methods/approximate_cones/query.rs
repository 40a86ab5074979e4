//! Queries by normal cones: refit, then a traversal that the cones cull.

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
    /// The triangle at each place of the hierarchy's order, and its vertices.
    triangles: Vec<(u32, [u32; 3])>,
    frame: Frame,
    /// Of each vertex, exact and in the frame.
    positions: Vec<DVec3>,
    mapped: Vec<Vec4>,
    /// Of each volume its AABB, those of its children, and the directions on whose positive side all of its normals are.
    aabbs: Vec<Aabb>,
    children: Vec<Aabb8>,
    positive: Vec<u16>,
    stack: Vec<(usize, usize)>,
    pairs: Vec<Pair>,
    /// For continuous queries.
    traditional: Query<'a>,
}

impl<'a> ApproximateCones<'a> {
    /// On the hierarchy of the certificates. Triangles that share a vertex never count, whatever the contact filter of
    /// the certificates says.
    ///
    /// # Errors
    /// When the certificates are of another model.
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

    /// Moves all vertices, and makes AABBs and normals of all volumes current.
    fn refit(&mut self, q: &[f64]) {
        for (v, (x, mapped)) in self.positions.iter_mut().zip(&mut self.mapped).enumerate() {
            *x = self.model.position(v as u32, q);
            *mapped = self.frame.map(*x);
        }
        for (n, volume) in self.volumes.iter().enumerate().rev() {
            let (mut whole, mut positive) = (Aabb::EMPTY, !0);
            for (lane, child) in volume.children.clone().enumerate() {
                let (aabb, sides) = if volume.kind == Kind::Block {
                    let corners = self.triangles[child].1.map(|v| v as usize);
                    let sides = positive_sides(corners.map(|v| self.positions[v]));
                    (Aabb::around(corners.map(|v| self.mapped[v])), sides)
                } else {
                    (self.aabbs[child], self.positive[child])
                };
                self.children[n].set(lane, &aabb);
                whole = whole.union(&aabb);
                positive &= sides;
            }
            (self.aabbs[n], self.positive[n]) = (whole, positive);
        }
    }

    /// Adds the pairs of the root. On the stack, `(n, n)` is a volume against itself, `(n, m)` two volumes without common
    /// triangles whose AABBs overlap.
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

    /// A volume against itself, if its normals do not cull it.
    fn within(&mut self, n: usize) {
        let Volume { kind, children } = self.volumes[n].clone();
        if kind != Kind::Block && self.positive[n] != 0 {
            return;
        }
        for (lane, child) in children.clone().enumerate() {
            let later = self.children[n].overlapping_lane(&self.children[n], lane).beyond(lane);
            if kind == Kind::Block {
                later.for_each(|other| self.test(child, children.start + other));
            } else {
                self.stack.push((child, child));
                self.stack.extend(later.map(|other| (child, children.start + other)));
            }
        }
    }

    /// Two volumes, the first no finer than the second. Volumes of the same kind are opened both at once.
    fn between(&mut self, n: usize, m: usize) {
        let [x, y] = [n, m].map(|n| self.volumes[n].clone());
        let rows = self.children[n].overlapping(&self.aabbs[m]);
        if x.kind > y.kind {
            self.stack.extend(rows.map(|row| (x.children.start + row, m)));
            return;
        }
        let columns = self.children[m].overlapping(&self.aabbs[n]);
        for row in rows {
            let met = self.children[m].overlapping_lane(&self.children[n], row).and(columns);
            let pairs = met.map(|column| (x.children.start + row, y.children.start + column));
            if x.kind == Kind::Block {
                pairs.for_each(|(a, b)| self.test(a, b));
            } else {
                self.stack.extend(pairs);
            }
        }
    }

    /// Two triangles by their places, whose AABBs overlap.
    #[inline]
    fn test(&mut self, a: usize, b: usize) {
        let [(i, x), (j, y)] = [a, b].map(|place| self.triangles[place]);
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
    /// Some pairs may be missing.
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
