//! Queries of meshes at given positions by the peer parry3d-f64, with our exact test.

use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use sscc::{Pair, TriMesh, intersect_triangle_triangle};

/// parry's BVH of a mesh at some positions.
pub struct Peer<'a> {
    bvh: Bvh,
    corners: Vec<[DVec3; 3]>,
    faces: &'a [[u32; 3]],
}

impl<'a> Peer<'a> {
    /// Builds the BVH.
    pub fn new(strategy: BvhBuildStrategy, mesh: &'a TriMesh, positions: &[DVec3]) -> Self {
        let corners: Vec<[DVec3; 3]> =
            mesh.faces().iter().map(|face| face.map(|v| positions[v as usize])).collect();
        let leaves: Vec<Aabb> = corners.iter().map(bounds).collect();
        Self { bvh: Bvh::from_leaves(strategy, &leaves), corners, faces: mesh.faces() }
    }

    /// Refits the BVH to these positions.
    pub fn refit(&mut self, positions: &[DVec3]) {
        for (t, face) in self.faces.iter().enumerate() {
            self.corners[t] = face.map(|v| positions[v as usize]);
            let _ = self.bvh.insert_or_update_partially(bounds(&self.corners[t]), t as u32, 0.0);
        }
        self.bvh.refit_without_opt();
    }

    /// Returns the colliding pairs of the mesh with itself, without neighbours, sorted.
    pub fn with_itself(&self) -> Vec<Pair> {
        let mut pairs = Vec::new();
        self.bvh.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut |i, j| {
            let [a, b] = [i, j].map(|t| self.faces[t as usize]);
            let is_adjacent = a.iter().any(|v| b.contains(v));
            if !is_adjacent
                && intersect_triangle_triangle(&self.corners[i as usize], &self.corners[j as usize])
            {
                pairs.push((i.min(j), i.max(j)));
            }
        });
        pairs.sort_unstable();
        pairs
    }

    /// Returns the colliding pairs with another mesh, sorted.
    pub fn with(&self, other: &Self) -> Vec<Pair> {
        let mut pairs: Vec<Pair> = self
            .bvh
            .leaf_pairs(&other.bvh, |a, b| a.intersects(b))
            .filter(|(i, j)| {
                intersect_triangle_triangle(&self.corners[*i as usize], &other.corners[*j as usize])
            })
            .collect();
        pairs.sort_unstable();
        pairs
    }
}

fn bounds([a, b, c]: &[DVec3; 3]) -> Aabb {
    let vector = |x: DVec3| Vector::from_array(x.to_array());
    Aabb::new(vector(a.min(*b).min(*c)), vector(a.max(*b).max(*c)))
}
