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

/// Refuses nodes that have too many triangles or vertices together.
pub(super) fn check_scene_size(file: &Path, nodes: &[MeshNode], request: &Detection) -> Result<()> {
    let triangles: u64 = nodes.iter().map(|node| node.faces().len() as u64).sum();
    let vertices: u64 = nodes.iter().map(|node| node.rest_positions().len() as u64).sum();
    if nodes.len() == 1 || triangles.max(vertices) <= MAX_SIZE {
        return Ok(());
    }
    let [triangles, vertices, limit] = [triangles, vertices, MAX_SIZE].map(grouped);
    let nodes = counted(nodes.len() as u64, "node");
    let cause = format!(
        "its {nodes} have {triangles} triangles and {vertices} vertices in all, but at most {limit} of each are checked \
         together: "
    );
    Err(TaskError::refused(file.display(), Message::from(cause) + way_out(request)))
}

/// Returns how to ask for a single node.
pub(super) fn way_out(request: &Detection) -> Message {
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
