//! Queries of the meshes of the nodes of a scene against each other, frame by frame.

use std::sync::Arc;

use glam::DVec3;

use super::ignored_between::IgnoredBetween;
use super::interval_tree::IntervalTree;
use super::moving_mesh::MovingMesh;
use super::node_boxes::boxes;
use super::request::Detection;
use super::scene_size::{COLLIDING, check_count};
use super::worker::{QueryResult, Side, query, read_all};
use crate::error::{At, Result};

/// A detector for each mesh, and its positions at one frame. The scene and all positions are evaluated once for all pairs.
pub(super) struct NodePairs<'m, 'w> {
    request: &'m Detection,
    sides: Vec<Side<'m, 'w>>,
    ignored: &'m IgnoredBetween,
}

impl<'m, 'w> NodePairs<'m, 'w> {
    pub fn new(
        request: &'m Detection,
        meshes: &'m [Arc<MovingMesh<'w>>],
        ignored: &'m IgnoredBetween,
    ) -> Self {
        Self { request, sides: meshes.iter().map(|mesh| Side::new(mesh)).collect(), ignored }
    }

    /// Answers the queries of all pairs of meshes at a frame. Returns the answers with colliding (or near) pairs, in order.
    pub fn answer(&mut self, frame: usize) -> Result<Vec<([usize; 2], QueryResult)>> {
        let Self { request, sides, ignored } = self;
        read_all(sides, frame, request.is_continuous)?;
        let boxes = boxes(sides);
        let tree = IntervalTree::new(&boxes);
        let reach = request.clearance.map_or(0.0, |clearance| clearance.distance());
        let mut positions: Vec<Option<Arc<[Vec<DVec3>; 2]>>> = vec![None; sides.len()];
        let (mut near, mut found) = (Vec::new(), Vec::new());
        for b in 1..sides.len() {
            sides[b].mesh.check_cancelled()?;
            tree.find_before(b, reach, &mut near);
            let (before, from_b) = sides.split_at_mut(b);
            for &a in &near {
                let side = &mut before[a];
                let (mesh, other) = (side.mesh, &mut from_b[0]);
                let ignored = ignored.of([a, b]);
                let limit = if ignored.is_empty() { request.limit } else { None };
                let result = query(request, limit, (side, Some(other)), false).at(|| mesh.place(frame))?;
                let mut result = result.without(ignored, request.limit);
                if result.pairs.is_empty() {
                    continue;
                }
                check_count(found.len() + 1, COLLIDING, || mesh.place(frame), request)?;
                if request.has_positions {
                    let mut shared = |node: usize, side: &Side<'_, '_>| {
                        Arc::clone(positions[node].get_or_insert_with(|| Arc::new(side.positions())))
                    };
                    result.positions = vec![shared(a, &before[a]), shared(b, &from_b[0])];
                }
                found.push(([a, b], result));
            }
        }
        found.sort_by_key(|(nodes, _)| *nodes);
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use sscc::{CancelToken, Progress};

    use super::*;
    use crate::detection::AnimationMotion;
    use crate::{Stage, Watch};

    /// Cancels at the fourth poll and later.
    struct CancelledAtFourth {
        token: CancelToken,
        polls: Arc<AtomicUsize>,
    }

    impl CancelledAtFourth {
        fn new() -> Self {
            let polls = Arc::new(AtomicUsize::new(0));
            let counter = Arc::clone(&polls);
            let token = CancelToken::when(move || counter.fetch_add(1, Ordering::Relaxed) >= 3);
            Self { token, polls }
        }
    }

    impl Progress for CancelledAtFourth {
        fn report(&self, _done: usize, _total: usize) {}

        fn cancel_token(&self) -> Option<&CancelToken> {
            Some(&self.token)
        }
    }

    impl Watch for CancelledAtFourth {
        fn begin(&self, _stage: Stage) {}

        fn note(&self, _note: &str) {}
    }

    /// No query is answered that could poll: the three nodes are apart.
    #[test]
    fn cancellation_ends_the_loading_and_the_comparison_of_nodes() {
        let (folder, watch) = (tempfile::tempdir().unwrap(), CancelledAtFourth::new());
        let file = folder.path().join("three.gltf");
        let write = |nodes: usize| {
            let nodes = (0..nodes).map(|x| format!(r#"{{"mesh":0,"translation":[{x},0,0]}}"#));
            let nodes = nodes.collect::<Vec<_>>().join(",");
            let text = format!(
                r#"{{"asset":{{"version":"2.0"}},"accessors":[{{"componentType":5126,"count":3,"type":"VEC3"}}],
                "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{nodes}]}}"#
            );
            std::fs::write(&file, text).unwrap();
        };
        let request = Detection { between_nodes: true, ..Detection::default() };
        let load = || {
            watch.polls.store(0, Ordering::Relaxed);
            MovingMesh::animated(&file, &AnimationMotion::at_rest(), &request, &watch)
        };
        write(4);
        assert!(load().err().unwrap().is_cancelled());
        write(3);
        let mut meshes = load().unwrap();
        watch.polls.store(0, Ordering::Relaxed);
        let at_rest = Detection { ignore_rest: Some(0), ..request.clone() };
        assert!(IgnoredBetween::find(&at_rest, &mut meshes).err().unwrap().is_cancelled());
        let meshes: Vec<Arc<MovingMesh<'_>>> = meshes.into_iter().map(Arc::new).collect();
        let ignored = IgnoredBetween::default();
        watch.polls.store(0, Ordering::Relaxed);
        assert!(NodePairs::new(&request, &meshes, &ignored).answer(0).err().unwrap().is_cancelled());
    }
}
