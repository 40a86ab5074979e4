//! The ignored pairs of different nodes: pairs that collide at the first frame, and pairs around them.

use std::collections::BTreeMap;

use sscc::Pair;
use sscc::parts::surroundings_between_meshes;

use super::interval_tree::IntervalTree;
use super::moving_mesh::MovingMesh;
use super::node_boxes::boxes;
use super::request::Detection;
use super::scene_size::check_colliding;
use super::worker::{Side, read_all};
use crate::error::{At, Result};

/// Ignored pairs of each two meshes, by their numbers; sorted.
#[derive(Default)]
pub(super) struct IgnoredBetween(BTreeMap<[usize; 2], Vec<Pair>>);

impl IgnoredBetween {
    /// Finds the pairs if the request ignores pairs at rest. Adds their number to the ignored pairs of the mesh with the
    /// lower number.
    pub fn find(request: &Detection, meshes: &mut [MovingMesh<'_>]) -> Result<Self> {
        let Some(rings) = request.ignore_rest else { return Ok(Self::default()) };
        let (mut found, mut ignored) = (BTreeMap::new(), 0);
        let mut sides: Vec<Side<'_, '_>> = meshes.iter().map(Side::new).collect();
        read_all(&mut sides, 0, false)?;
        let boxes = boxes(&sides);
        let tree = IntervalTree::new(&boxes);
        let mut near = Vec::new();
        for b in 1..sides.len() {
            sides[b].mesh.check_cancelled()?;
            tree.find_before(b, 0.0, &mut near);
            let (before, from_b) = sides.split_at_mut(b);
            for &a in &near {
                let (x, y) = (&mut before[a], &mut from_b[0]);
                let place = || x.mesh.place(0);
                let pairs = x.detector.against(&x.x_t0, &mut y.detector, &y.x_t0).at(place)?.to_vec();
                if !pairs.is_empty() {
                    let around = surroundings_between_meshes([&x.detector, &y.detector], &pairs, rings);
                    let around = around.at(place)?;
                    ignored += around.len();
                    check_colliding(found.len() + 1, ignored, place, request)?;
                    found.insert([a, b], around);
                }
            }
        }
        drop(sides);
        for ([a, _], pairs) in &found {
            meshes[*a].left_out = std::mem::take(&mut meshes[*a].left_out).and_ignored(pairs.len());
        }
        Ok(Self(found))
    }

    /// Returns the ignored pairs of two meshes, in the order of the meshes' numbers.
    pub fn of(&self, meshes: [usize; 2]) -> &[Pair] {
        self.0.get(&meshes).map_or(&[], Vec::as_slice)
    }
}
