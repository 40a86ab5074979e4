//! Shapes in the world, one against another: BD-trees in their own axes, turned and moved (paper, section 7: collisions
//! between objects).

use glam::{DMat3, DVec3};

use crate::detect::tables::Tables;
use crate::detect::volumes::{Boxes, margin};
use crate::geometry::Aabb;
use crate::query::context::{Asked, Ends};
use crate::query::{Method, Query};
use crate::{Certificates, Error, Pair, ReducedModel, intersect_triangle_triangle, limits};

/// Where a shape is: `x -> rotation x + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Any matrix; for a rigid motion a rotation.
    pub rotation: DMat3,
    /// Added after it (model unit).
    pub translation: DVec3,
}

impl Default for Pose {
    fn default() -> Self {
        Self { rotation: DMat3::IDENTITY, translation: DVec3::ZERO }
    }
}

impl Pose {
    /// The place in the world of a point of the shape: products and sums in f64, in a fixed order, none fused.
    #[inline]
    pub fn apply(&self, x: DVec3) -> DVec3 {
        self.rotation * x + self.translation
    }

    /// A box around the places of all points of a box; `margin` is the rounding.
    #[inline]
    pub(crate) fn enclose(&self, Aabb { lower, upper }: Aabb, margin: f64) -> Aabb {
        let [x, y, z] = [self.rotation.x_axis, self.rotation.y_axis, self.rotation.z_axis].map(DVec3::abs);
        let half = (upper - lower) * 0.5;
        let half = x * half.x + y * half.y + z * half.z + DVec3::splat(margin);
        let center = self.apply(lower * 0.5 + upper * 0.5);
        Aabb { lower: center - half, upper: center + half }
    }

    /// An upper bound (up to rounding) of all that is added up where a coordinate of the shape is at most `reach`.
    fn reach(&self, reach: f64) -> f64 {
        let r = &self.rotation;
        let row = r.x_axis.abs() + r.y_axis.abs() + r.z_axis.abs();
        row.max_element() * reach + self.translation.abs().max_element()
    }
}

/// A pose, and about where the shapes are that are compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub(crate) pose: Pose,
    pub(crate) around: Aabb,
}

/// The present state of a shape.
#[derive(Clone)]
struct State {
    q: Vec<f64>,
    placement: Placement,
    reach: f64,
}

impl State {
    fn ends(&self) -> Ends<'_, 1> {
        Ends { q: [&self.q], norm: 0.0, reach: self.reach, ball: None, pose: Some(&self.placement) }
    }
}

/// A shape at some q, somewhere in the world, to be tested against others. All answers speak of the f64 positions
/// [`Pose::apply`] of [`deformed_position`](crate::deformed_position): for them they are exact. Owns its memory, so
/// that repeated questions allocate nothing; clones share what does not change.
#[derive(Clone)]
pub struct PosedShape<'a> {
    asked: Asked<'a>,
    boxes: Boxes<1>,
    state: State,
    /// Whether boxes are of this state.
    is_current: bool,
    stack: Vec<Pair>,
}

impl<'a> PosedShape<'a> {
    /// At q = 0 in its own axes. Of the certificates only the hierarchy is used.
    ///
    /// # Errors
    /// When the certificates are of another model.
    pub fn new(model: &'a ReducedModel, certificates: &'a Certificates) -> Result<Self, Error> {
        let query = Query::with_method(model, certificates, Method::BdTree)?;
        let boxes = Boxes::new(&query.discrete.boxes.tables, true);
        let q = vec![0.0; model.rank()];
        let reach = model.check_coordinates(&q)?;
        let placement = Placement { pose: Pose::default(), around: Aabb::default() };
        let state = State { q, placement, reach };
        Ok(Self { asked: query.asked, boxes, state, is_current: false, stack: Vec::new() })
    }

    /// Deforms and moves it; gives a box around it in the world, at a cost of O(r).
    ///
    /// # Errors
    /// When q has the wrong length or an entry is not finite, or the shape leaves the range of numbers.
    pub fn place(&mut self, q: &[f64], pose: &Pose) -> Result<Aabb, Error> {
        let reach = pose.reach(self.asked.model.check_coordinates(q)?);
        // Rounding may carry a position a little beyond the exact reach.
        // What is no number hides from the largest of several.
        let is_finite = pose.rotation.is_finite() && pose.translation.is_finite();
        if !(is_finite && reach * 1.001 <= limits::LARGEST) {
            return Err(Error::CoordinatesRange);
        }
        self.state.q.copy_from_slice(q);
        self.state.placement.pose = *pose;
        self.state.reach = reach;
        self.is_current = false;
        let margin = margin(reach, q.len());
        let whole = self.boxes.tables.bd_tree.root([q], DVec3::splat(margin));
        Ok(pose.enclose(whole, margin))
    }

    /// Adds all pairs (triangle of this shape, triangle of the other one) that have a point in common, sorted;
    /// touching counts. `around` says about where all shapes are that are compared. Any box is right; boxes are made
    /// once after each [`PosedShape::place`] while it stays the same.
    pub fn colliding(&mut self, other: &mut Self, around: Aabb, found: &mut Vec<Pair>) {
        let first = found.len();
        self.enter(around);
        other.enter(around);
        let mut stack = std::mem::take(&mut self.stack);
        stack.clear();
        if self.boxes.node(0).overlaps(other.boxes.node(0)) {
            stack.push((0, 0));
        }
        while let Some((n, m)) = stack.pop() {
            match [self.cluster(n), other.cluster(m)] {
                [Some(a), Some(b)] => self.clusters(a, other, b, found),
                // What is larger than a cluster is opened.
                [None, Some(_)] => {
                    self.open(n);
                    let first_child = self.first_child(n);
                    let open = self.boxes.pack(n).overlapping(other.boxes.node(m));
                    stack.extend(open.map(|i| (first_child + i, m)));
                }
                [Some(_), None] => {
                    other.open(m);
                    let first_child = other.first_child(m);
                    let open = other.boxes.pack(m).overlapping(self.boxes.node(n));
                    stack.extend(open.map(|j| (n, first_child + j)));
                }
                [None, None] => {
                    self.open(n);
                    other.open(m);
                    let [x, y] = [self.first_child(n), other.first_child(m)];
                    for i in self.boxes.pack(n).overlapping(other.boxes.node(m)) {
                        let open = other.boxes.pack(m).overlapping_lane(self.boxes.pack(n), i as usize);
                        stack.extend(open.map(|j| (x + i, y + j)));
                    }
                }
            }
        }
        self.stack = stack;
        found[first..].sort_unstable();
    }

    /// Adds the vertices x of triangles with `normal . x < height` in the world, ascending; all of them up to rounding.
    pub fn vertices_below(&mut self, normal: DVec3, height: f64, found: &mut Vec<u32>) {
        let first = found.len();
        let Tables { vertices, clusters, bd_tree, .. } = &*self.boxes.tables;
        let State { q, placement: Placement { pose, .. }, reach } = &self.state;
        let local = pose.rotation.transpose() * normal;
        let height = height - normal.dot(pose.translation);
        let margin = DVec3::splat(margin(*reach, q.len()));
        self.stack.clear();
        self.stack.push((0, 0));
        while let Some((n, _)) = self.stack.pop() {
            let is_above = bd_tree.at(n, [q], margin).is_some_and(|Aabb { lower, upper }| {
                let half = (upper - lower) * 0.5;
                local.dot((upper + lower) * 0.5) - local.abs().dot(half) > height
            });
            if is_above {
                continue;
            }
            if let Some(cluster) = clusters.of_node(n) {
                let below = |v: &&u32| local.dot(vertices.position(**v, [q])[0]) < height;
                found.extend(clusters.vertices(cluster).iter().filter(below).map(|v| vertices.vertex(*v)));
            } else {
                self.stack.extend(self.asked.hierarchy.nodes()[n as usize].children().map(|n| (n, 0)));
            }
        }
        // Clusters have vertices in common.
        found[first..].sort_unstable();
        let mut kept = first;
        for i in first..found.len() {
            if kept == first || found[kept - 1] != found[i] {
                found[kept] = found[i];
                kept += 1;
            }
        }
        found.truncate(kept);
    }

    /// Where triangles are in the world: the corners that answers speak of.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let face = self.asked.model.mesh().faces()[triangle as usize];
        face.map(|v| self.state.placement.pose.apply(self.asked.model.position(v, &self.state.q)))
    }

    /// Makes the root's box current in the frame of this box.
    fn enter(&mut self, around: Aabb) {
        if !self.is_current || self.state.placement.around != around {
            self.state.placement.around = around;
            self.is_current = true;
            self.boxes.update(&self.asked.hierarchy, &self.state.ends());
            self.boxes.enclose(0, &self.state.ends());
        }
    }

    fn cluster(&self, node: u32) -> Option<u32> {
        self.boxes.tables.clusters.of_node(node)
    }

    fn first_child(&self, node: u32) -> u32 {
        self.asked.hierarchy.nodes()[node as usize].first_child
    }

    fn open(&mut self, node: u32) {
        self.boxes.open(&self.asked, node, &self.state.ends());
    }

    /// Two clusters whose boxes overlap.
    fn clusters(&mut self, a: u32, other: &mut Self, b: u32, found: &mut Vec<Pair>) {
        self.boxes.open_cluster(a, &self.state.ends());
        other.boxes.open_cluster(b, &other.state.ends());
        let [x, y] = [(&*self, a), (&*other, b)].map(|(shape, cluster)| {
            let clusters = &shape.boxes.tables.clusters;
            (
                clusters,
                clusters.blocks(cluster),
                shape.boxes.cluster(cluster),
                shape.boxes.node(clusters.node(cluster)),
            )
        });
        if !x.3.overlaps(y.3) {
            return;
        }
        for i in x.2.overlapping(y.3) {
            let block_x = x.1.start + i as usize;
            for j in y.2.overlapping_lane(x.2, i as usize) {
                let block_y = y.1.start + j as usize;
                // Most triangles of a block stay clear of the whole other block.
                let rows = self.boxes.block(block_x).overlapping_lane(y.2, j as usize);
                for row in rows {
                    let columns =
                        other.boxes.block(block_y).overlapping_lane(self.boxes.block(block_x), row as usize);
                    for column in columns {
                        let [p, q] = [
                            x.0.places(block_x).start + row as usize,
                            y.0.places(block_y).start + column as usize,
                        ];
                        let [s, t] = [
                            self.boxes.corners(x.0.corners()[p])[0],
                            other.boxes.corners(y.0.corners()[q])[0],
                        ];
                        if intersect_triangle_triangle(&s, &t) {
                            found.push((x.0.triangle(p), y.0.triangle(q)));
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CertifyOptions, Modes, TriMesh};

    /// Fixed pseudo-random numbers in [-1, 1).
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 33) as f64 / 2.0_f64.powi(30) - 1.0
    }

    fn vector(state: &mut u64) -> DVec3 {
        DVec3::new(random(state), random(state), random(state))
    }

    /// A crumpled ball of loose triangles, with modes.
    fn model(triangles: usize, state: &mut u64) -> ReducedModel {
        let positions: Vec<DVec3> = (0..triangles)
            .flat_map(|_| {
                let center = vector(state);
                [(); 3].map(|()| center + vector(state) * 0.1)
            })
            .collect();
        let faces = (0..triangles as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let modes = positions.iter().flat_map(|p| [*p * 0.3, DVec3::new(p.y, -p.z, p.x * p.x)]).collect();
        ReducedModel::new(TriMesh::new(positions, faces).unwrap(), Modes::new(2, modes).unwrap()).unwrap()
    }

    #[test]
    fn pairs_are_those_of_all_triangles() {
        let state = &mut 7;
        let models = [model(400, state), model(150, state), model(40, state), model(9, state)];
        let certificates = models.each_ref().map(|model| {
            Certificates::compute(model, &CertifyOptions { budget: 0, ..CertifyOptions::default() }, &())
                .unwrap()
        });
        let mut shapes: Vec<PosedShape<'_>> =
            models.iter().zip(&certificates).map(|(m, c)| PosedShape::new(m, c).unwrap()).collect();
        let (mut found, mut empty) = (0, 0);
        for case in 0..60 {
            // From on top of each other to apart; sometimes far from the origin.
            let far = if case % 3 == 0 { DVec3::new(1e6, -3.0, 2e3) } else { DVec3::ZERO };
            for shape in &mut shapes {
                let rotation = DMat3::from_quat(glam::DQuat::from_scaled_axis(vector(state) * 3.0));
                let translation = vector(state) * (0.05 * f64::from(case)) + far;
                let q = [random(state), random(state)];
                let pose = Pose { rotation, translation };
                let Aabb { lower, upper } = shape.place(&q, &pose).unwrap();
                for t in 0..shape.asked.model.mesh().faces().len() as u32 {
                    let corners = shape.corners(t);
                    assert!(corners.iter().all(|x| x.cmpge(lower).all() && x.cmple(upper).all()));
                }
                // Half of it below.
                let normal = vector(state).normalize();
                let height = normal.dot(translation) + random(state);
                let mut below = Vec::new();
                shape.vertices_below(normal, height, &mut below);
                let vertices = 0..shape.asked.model.mesh().rest_positions().len() as u32;
                let is_below = |v: &u32| normal.dot(pose.apply(shape.asked.model.position(*v, &q))) < height;
                assert_eq!(below, vertices.filter(is_below).collect::<Vec<u32>>());
            }
            // Any box is right, also one turned round.
            let [a, b] = if case % 2 == 0 { [far - 2.0, far + 2.0] } else { [far + 2.0, far - 2.0] };
            let around = Aabb { lower: a, upper: b };
            for a in 0..shapes.len() {
                for b in 0..a {
                    let (left, right) = shapes.split_at_mut(a);
                    let (x, y) = (&mut left[b], &mut right[0]);
                    let mut pairs = Vec::new();
                    x.colliding(y, around, &mut pairs);
                    let mut expected = Vec::new();
                    for i in 0..x.asked.model.mesh().faces().len() as u32 {
                        for j in 0..y.asked.model.mesh().faces().len() as u32 {
                            if intersect_triangle_triangle(&x.corners(i), &y.corners(j)) {
                                expected.push((i, j));
                            }
                        }
                    }
                    assert_eq!(pairs, expected);
                    found += pairs.len();
                    empty += usize::from(pairs.is_empty());
                    // Asked from the other side, with other boxes.
                    let mut turned = vec![(0, 0)];
                    y.colliding(x, Aabb { lower: far - 1e3, upper: far + 1.0 }, &mut turned);
                    let mut turned: Vec<Pair> = turned.drain(1..).map(|(j, i)| (i, j)).collect();
                    turned.sort_unstable();
                    assert_eq!(turned, expected);
                }
            }
        }
        assert!(found > 200 && empty > 200, "{found} {empty}");
    }

    #[test]
    fn what_has_no_place_is_refused() {
        let model = model(20, &mut 3);
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        let mut shape = PosedShape::new(&model, &certificates).unwrap();
        for wrong in [f64::NAN, f64::INFINITY, 1e61] {
            for axis in 0..3 {
                let mut moved = Pose::default();
                moved.translation[axis] = wrong;
                assert_eq!(shape.place(&[0.0; 2], &moved), Err(Error::CoordinatesRange));
            }
            let turned = Pose { rotation: DMat3::IDENTITY * wrong, ..Pose::default() };
            assert_eq!(shape.place(&[0.0; 2], &turned), Err(Error::CoordinatesRange));
        }
        assert!(matches!(shape.place(&[0.0], &Pose::default()), Err(Error::CoordinatesLength { .. })));
    }
}
