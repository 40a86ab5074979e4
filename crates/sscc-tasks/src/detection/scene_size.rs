//! The maximum size of a scene: each node has a mesh and a detector of its own, also where nodes show the same mesh.

use std::path::Path;

use sscc_io::gltf::MeshNode;
use sscc_io::{Message, Setting};

use super::request::{Detection, MeshMotion};
use crate::TaskError;
use crate::error::Result;
use crate::text::{counted, grouped};

/// Maximum number of triangles in all nodes, and of vertices. A triangle with its detector takes about 100 bytes, so that
/// the nodes take a few GiB for each thread; a small file can show a mesh by any number of nodes. A mesh alone is bounded by its file.
const MAX_SIZE: u64 = 1 << 25;

/// A node counts as at least this number of triangles: its mesh, its detector, which has buckets of this size, and its buffers
/// take some kB, however few triangles it has.
const MIN_TRIANGLES: u64 = 64;

/// Maximum number of pairs of nodes that collide at one time: the answers of a frame take less than a GiB, unless they have many pairs
/// of triangles each. A few frames for each thread wait until those before them are written.
pub(super) const COLLIDING: Maximum = Maximum { most: 1 << 20, what: "nodes collide" };

/// Maximum number of something in a scene.
#[derive(Clone, Copy)]
pub(super) struct Maximum {
    pub most: usize,
    /// What is counted, after `pairs of`.
    pub what: &'static str,
}

/// Refuses nodes that have too many triangles or vertices together, or are too many.
pub(super) fn check_scene_size(file: &Path, nodes: &[MeshNode], request: &Detection) -> Result<()> {
    let sizes = nodes.iter().map(|node| [node.faces().len() as u64, node.rest_positions().len() as u64]);
    match reason_against(sizes) {
        Some(cause) => {
            Err(TaskError::refused(file.display(), Message::from(cause + ": ") + way_out(request)))
        }
        None => Ok(()),
    }
}

/// Returns why nodes with these numbers of triangles and vertices cannot be checked together; None if they can.
fn reason_against(nodes: impl Iterator<Item = [u64; 2]>) -> Option<String> {
    let [mut count, mut triangles, mut vertices, mut counted_triangles] = [0_u64; 4];
    for [of_node, vertices_of_node] in nodes {
        count += 1;
        triangles += of_node;
        vertices += vertices_of_node;
        counted_triangles += of_node.max(MIN_TRIANGLES);
    }
    if count <= 1 || counted_triangles.max(vertices) <= MAX_SIZE {
        return None;
    }
    let limit = grouped(MAX_SIZE);
    let nodes = counted(count, "node");
    if triangles.max(vertices) <= MAX_SIZE {
        let [triangles, counted_triangles] = [triangles, counted_triangles].map(grouped);
        return Some(format!(
            "its {nodes} have {triangles} triangles in all and count as {counted_triangles}, each node as at least \
             {MIN_TRIANGLES}, but at most {limit} are checked together"
        ));
    }
    let [triangles, vertices] = [triangles, vertices].map(grouped);
    Some(format!(
        "its {nodes} have {triangles} triangles and {vertices} vertices in all, but at most {limit} of each are checked \
         together"
    ))
}

/// Refuses a number of pairs beyond a maximum.
pub(super) fn check_count(
    count: usize,
    Maximum { most, what }: Maximum,
    place: impl FnOnce() -> String,
    request: &Detection,
) -> Result<()> {
    if count <= most {
        return Ok(());
    }
    let cause = format!("more than {} pairs of {what}: ", grouped(most as u64));
    Err(TaskError::refused(place(), Message::from(cause) + way_out(request)))
}

/// Returns how to ask for a single node.
fn way_out(request: &Detection) -> Message {
    match request.motion {
        MeshMotion::Animation(_) => "select a node by " + Setting::Node,
        _ => "name a node, as in FILE#NODE".into(),
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::detection::{AnimationMotion, Times, detect};

    #[test]
    fn pairs_of_nodes_have_a_maximum() {
        let request = Detection::default();
        let check = |count| check_count(count, COLLIDING, || "a.glb".into(), &request);
        assert!(check(1 << 20).is_ok());
        assert_eq!(
            check((1 << 20) + 1).unwrap_err().to_string(),
            "a.glb: more than 1,048,576 pairs of nodes collide: name a node, as in FILE#NODE"
        );
    }

    /// 2^19 nodes of one triangle are allowed, and not one more.
    #[test]
    fn nodes_count_as_64_triangles_at_least() {
        let nodes = |count: usize, size: [u64; 2]| std::iter::repeat_n(size, count);
        assert_eq!(reason_against(nodes(524_288, [1, 3])), None);
        assert_eq!(
            reason_against(nodes(524_289, [1, 3])).unwrap(),
            "its 524,289 nodes have 524,289 triangles in all and count as 33,554,496, each node as at least 64, but at most \
             33,554,432 are checked together"
        );
        let mixed = nodes(1000, [1, 3]);
        assert_eq!(reason_against(mixed.chain([[33_490_432, 9]])), None);
        let mixed = nodes(1000, [1, 3]);
        assert!(reason_against(mixed.chain([[33_490_433, 9]])).is_some());
        // A single node is bounded by its file.
        assert_eq!(reason_against(nodes(1, [1 << 30, 1 << 30])), None);
        assert!(reason_against(nodes(2, [1, 1 << 25])).unwrap().contains(" 67,108,864 vertices in all"));
        assert_eq!(reason_against(nodes(0, [0, 0])), None);
    }

    #[test]
    fn nodes_of_a_small_file_have_a_maximum_size() {
        // 5,500 nodes with 2,048 triangles each. The positions need no bytes: all are zero.
        let nodes = vec![r#"{"mesh":0}"#; 5500].join(",");
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"accessors":[{{"componentType":5126,"count":6144,"type":"VEC3"}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{nodes}]}}"#
        );
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("many.gltf");
        std::fs::write(&file, text).unwrap();
        let message = |node: Option<&str>, between_nodes| {
            let motion = AnimationMotion {
                animation: None,
                times: Times::List(vec![0.0]),
                node: node.map(str::to_owned),
                weights: Default::default(),
            };
            let request = Detection {
                meshes: vec![file.clone()],
                motion: if between_nodes { MeshMotion::Rest } else { MeshMotion::Animation(motion) },
                between_nodes,
                weld: Some(false),
                limit: Some(1),
                ..Detection::default()
            };
            let mut message = String::new();
            detect(&request, &(), |_, found| {
                message = found.err().map(|error| error.to_string()).unwrap_or_default();
                Ok::<_, TaskError>(ControlFlow::Continue(()))
            })
            .unwrap();
            message
        };
        let start = format!(
            "{}: its 5,500 nodes have 11,264,000 triangles and 33,792,000 vertices in all, but at most 33,554,432 of each \
             are checked together: ",
            file.display()
        );
        assert_eq!(message(None, false), format!("{start}select a node by node"));
        assert_eq!(message(None, true), format!("{start}name a node, as in FILE#NODE"));
        assert_eq!(message(Some("7"), false), "");
    }
}
