//! The ignored pairs of different nodes: pairs that collide at the first frame, and pairs around them.

use std::collections::BTreeMap;

use sscc::Pair;
use sscc::parts::surroundings_between_meshes;

use super::interval_tree::IntervalTree;
use super::moving_mesh::MovingMesh;
use super::node_boxes::boxes;
use super::request::Detection;
use super::scene_size::{Maximum, check_count};
use super::worker::{Side, read_all};
use crate::error::{At, Result};

/// Maximum number of ignored pairs of all pairs of nodes (0.5 GiB). The pairs of two nodes have a limit of their own.
const IGNORED: Maximum = Maximum { most: 1 << 26, what: "triangles of different nodes would be ignored" };

/// Two nodes with ignored pairs count as this number of further pairs, because their entry takes about as much memory.
const OF_NODES: usize = 12;

/// Ignored pairs of each two meshes, by their numbers; sorted.
#[derive(Default)]
pub(super) struct IgnoredBetween(BTreeMap<[usize; 2], Vec<Pair>>);

impl IgnoredBetween {
    /// Finds the pairs if the request ignores pairs at rest. Adds their number to the ignored pairs of the mesh with the
    /// lower number.
    ///
    /// # Errors
    /// When there are too many, a position cannot be read, or the work is cancelled.
    pub fn find(request: &Detection, meshes: &mut [MovingMesh<'_>]) -> Result<Self> {
        Self::find_at_most(IGNORED, request, meshes)
    }

    fn find_at_most(most: Maximum, request: &Detection, meshes: &mut [MovingMesh<'_>]) -> Result<Self> {
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
                    ignored += around.len() + OF_NODES;
                    check_count(ignored, most, place, request)?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::AnimationMotion;

    /// Three nodes with one triangle, all of whose vertices are the origin.
    #[test]
    fn ignored_pairs_have_a_maximum() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("three.gltf");
        let text = r#"{"asset":{"version":"2.0"},"accessors":[{"componentType":5126,"count":3,"type":"VEC3"}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0},{"mesh":0},{"mesh":0}]}"#;
        std::fs::write(&file, text).unwrap();
        let request = Detection { between_nodes: true, ignore_rest: Some(0), ..Detection::default() };
        let mut meshes = MovingMesh::animated(&file, &AnimationMotion::at_rest(), &request, &()).unwrap();
        let mut find = |most| {
            let most = Maximum { most, ..IGNORED };
            IgnoredBetween::find_at_most(most, &request, &mut meshes)
        };
        let needed = 3 * (1 + OF_NODES);
        let found = find(needed).unwrap();
        assert!([[0, 1], [0, 2], [1, 2]].iter().all(|nodes| found.of(*nodes) == [(0, 0)]));
        let message = find(needed - 1).err().unwrap().to_string();
        assert!(
            message.contains("more than 38 pairs of triangles of different nodes would be ignored"),
            "{message}"
        );
    }
}
