//! Selection of a mesh and the nodes that show it.

use super::json::PlacedRoot;
use crate::FormatError;
use crate::error::quoted;
use crate::gltf::json::Root;
use crate::gltf::select::{choose_base, has_triangles};

/// A mesh, and the nodes that show it, in file order.
pub(super) struct Shown {
    pub mesh: usize,
    pub nodes: Vec<usize>,
}

/// Returns the mesh of a name with its nodes, else the mesh at the only node of this name with this node alone.
pub(super) fn choose_shown(
    root: &Root,
    placed: &PlacedRoot,
    name: Option<&str>,
) -> Result<Shown, FormatError> {
    let error = match choose_base(root, name) {
        Ok(mesh) => return Ok(Shown { mesh, nodes: shown_nodes(placed, mesh) }),
        Err(error) => error,
    };
    let is_mesh = root.meshes.iter().any(|mesh| mesh.name.is_some() && mesh.name.as_deref() == name);
    let Some(name) = name.filter(|_| !is_mesh) else { return Err(error) };
    let mesh_of = |node: usize| {
        let node = &placed.nodes[node];
        let mesh = node.mesh.filter(|_| node.name.as_deref() == Some(name))? as usize;
        root.meshes.get(mesh).filter(|mesh| has_triangles(mesh)).map(|_| mesh)
    };
    let named: Vec<_> = (0..placed.nodes.len()).filter_map(|node| Some((node, mesh_of(node)?))).collect();
    match named[..] {
        [] => Err(error),
        [(node, mesh)] => Ok(Shown { mesh, nodes: vec![node] }),
        _ => {
            let cause = format!("{} nodes with a mesh have the name {}", named.len(), quoted(name));
            Err(FormatError::whole(format!("{cause}: choose the mesh, by its name or number")))
        }
    }
}

/// Returns the nodes of the default scene that show a mesh; if there are none, all nodes that do.
pub(super) fn shown_nodes(placed: &PlacedRoot, mesh: usize) -> Vec<usize> {
    let shows = |node: &usize| placed.nodes[*node].mesh.is_some_and(|shown| shown as usize == mesh);
    let all: Vec<usize> = (0..placed.nodes.len()).filter(shows).collect();
    let is_in_scene = nodes_of_default_scene(placed);
    let in_scene: Vec<usize> = all.iter().copied().filter(|node| is_in_scene[*node]).collect();
    if in_scene.is_empty() { all } else { in_scene }
}

/// Returns for each node whether the default scene has it. Without `scene`, players show the first scene.
pub(super) fn nodes_of_default_scene(placed: &PlacedRoot) -> Vec<bool> {
    let mut is_in_scene = vec![false; placed.nodes.len()];
    let scene = placed.scenes.get(placed.scene.unwrap_or(0));
    let mut next: Vec<u32> = scene.map(|scene| scene.nodes.to_vec()).unwrap_or_default();
    while let Some(node) = next.pop() {
        if let Some(is_in_scene) = is_in_scene.get_mut(node as usize)
            && !*is_in_scene
        {
            *is_in_scene = true;
            next.extend(&placed.nodes[node as usize].children);
        }
    }
    is_in_scene
}
