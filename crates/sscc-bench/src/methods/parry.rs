//! Queries by the peer parry3d-f64, in its fastest use.
//!
//! A discrete query moves the vertices, refits parry's BVH as parry's `TriMesh` does (each leaf, then
//! `refit_without_opt`, the faster variant by parry's documentation), traverses the BVH against itself, skips triangles
//! that share a vertex, and runs our exact test on the rest. A continuous query does the same with swept AABBs and our
//! CCD test.

use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use sscc::{
    Error, Impact, MovingTriangle, Pair, ReducedModel, impact_triangle_triangle, intersect_triangle_triangle,
};

use super::engine::Engine;

/// parry's BVH over the triangles of a model.
pub struct Parry<'a> {
    model: &'a ReducedModel,
    bvh: Bvh,
    workspace: BvhWorkspace,
    positions: Vec<DVec3>,
    positions_t1: Vec<DVec3>,
    pairs: Vec<Pair>,
    impacts: Vec<Impact>,
}

impl<'a> Parry<'a> {
    /// Builds the BVH with one of parry's two strategies.
    pub fn new(model: &'a ReducedModel, strategy: BvhBuildStrategy) -> Self {
        let positions = model.mesh().rest_positions().to_vec();
        let leaves: Vec<Aabb> =
            model.mesh().faces().iter().map(|face| bounds(corners(face, &positions))).collect();
        let mut this = Self {
            model,
            bvh: Bvh::from_leaves(strategy, &leaves),
            workspace: BvhWorkspace::default(),
            positions_t1: positions.clone(),
            positions,
            pairs: Vec::new(),
            impacts: Vec::new(),
        };
        // The first refit sorts the nodes in memory.
        this.bvh.refit(&mut this.workspace);
        this
    }
}

impl Engine for Parry<'_> {
    fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error> {
        deform(self.model, &mut self.positions, q)?;
        let (faces, positions) = (self.model.mesh().faces(), &self.positions);
        refit(&mut self.bvh, faces.iter().map(|face| bounds(corners(face, positions))));
        self.pairs.clear();
        let pairs = &mut self.pairs;
        traverse(&self.bvh, &mut self.workspace, faces, |i, j| {
            let [x, y] = [i, j].map(|t| corners(&faces[t as usize], positions));
            if intersect_triangle_triangle(&x, &y) {
                pairs.push((i, j));
            }
        });
        self.pairs.sort_unstable();
        Ok(&self.pairs)
    }

    fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error> {
        deform(self.model, &mut self.positions, q_t0)?;
        deform(self.model, &mut self.positions_t1, q_t1)?;
        let faces = self.model.mesh().faces();
        let moving = |face: &[u32; 3]| MovingTriangle {
            t0: corners(face, &self.positions),
            t1: corners(face, &self.positions_t1),
        };
        let swept = |face| {
            let MovingTriangle { t0, t1 } = moving(face);
            let (a, b) = (bounds(t0), bounds(t1));
            Aabb::new(a.mins.min(b.mins), a.maxs.max(b.maxs))
        };
        refit(&mut self.bvh, faces.iter().map(swept));
        self.impacts.clear();
        let impacts = &mut self.impacts;
        traverse(&self.bvh, &mut self.workspace, faces, |i, j| {
            let [x, y] = [i, j].map(|t| moving(&faces[t as usize]));
            if let Some(time) = impact_triangle_triangle(&x, &y, Impact::TOLERANCE) {
                impacts.push(Impact { pair: (i, j), time });
            }
        });
        self.impacts.sort_unstable_by_key(|impact| impact.pair);
        Ok(&self.impacts)
    }
}

fn deform(model: &ReducedModel, positions: &mut [DVec3], q: &[f64]) -> Result<(), Error> {
    model.check_coordinates(q)?;
    for (v, x) in positions.iter_mut().enumerate() {
        *x = model.position(v as u32, q);
    }
    Ok(())
}

fn refit(bvh: &mut Bvh, leaves: impl Iterator<Item = Aabb>) {
    for (i, leaf) in leaves.enumerate() {
        let _ = bvh.insert_or_update_partially(leaf, i as u32, 0.0);
    }
    bvh.refit_without_opt();
}

/// Calls `visit` for the pairs without a common vertex whose AABBs overlap, the smaller number first.
fn traverse(bvh: &Bvh, workspace: &mut BvhWorkspace, faces: &[[u32; 3]], mut visit: impl FnMut(u32, u32)) {
    bvh.traverse_bvtt_single_tree::<false>(workspace, &mut |i, j| {
        let [a, b] = [i, j].map(|t| faces[t as usize]);
        if !a.iter().any(|v| b.contains(v)) {
            visit(i.min(j), i.max(j));
        }
    });
}

fn corners(face: &[u32; 3], positions: &[DVec3]) -> [DVec3; 3] {
    face.map(|v| positions[v as usize])
}

fn bounds([a, b, c]: [DVec3; 3]) -> Aabb {
    let vector = |x: DVec3| Vector::from_array(x.to_array());
    Aabb::new(vector(a.min(b).min(c)), vector(a.max(b).max(c)))
}
