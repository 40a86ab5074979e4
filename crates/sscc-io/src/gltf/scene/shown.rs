//! The nodes that a player shows, and the selection of a mesh with the nodes that show it.

use std::collections::BTreeSet;

use super::json::{Node, PlacedRoot, PointerRoot, Scene};
use crate::FormatError;
use crate::error::quoted;
use crate::gltf::json::{Root, parse_parts};
use crate::gltf::select::{choose_base, has_triangles};

/// Whether a player shows a node at first, and why not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Display {
    /// It is in the default scene and visible.
    Shown,
    /// It is stored as hidden (KHR_node_visibility), or a node above it is, but an animation can show it. It counts as shown,
    /// because no collision may be missed.
    Switched,
    /// It is stored as hidden, or a node above it is.
    Hidden,
    /// Another scene has it, or none.
    OutsideScene,
}

impl Display {
    /// Whether the node counts as shown.
    pub fn is_shown(self) -> bool {
        matches!(self, Self::Shown | Self::Switched)
    }
}

/// Returns how a player shows each node. If the file has no default scene, all nodes count as in it. `text` is the JSON of the
/// file.
pub(super) fn displays_of_nodes(
    nodes: &[Node],
    scenes: &[Scene],
    scene: Option<usize>,
    text: &[u8],
) -> Vec<Display> {
    let mut displays = vec![Display::Shown; nodes.len()];
    let (switched, hidden) = hidden_nodes(nodes, text);
    for (roots, display) in [(switched, Display::Switched), (hidden, Display::Hidden)] {
        if !roots.is_empty() {
            let is_below = with_descendants(nodes, roots);
            set(&mut displays, display, |node| is_below[node]);
        }
    }
    if scenes.get(default_scene(scene)).is_some() {
        let is_in_scene = nodes_of_default_scene(nodes, scenes, scene);
        set(&mut displays, Display::OutsideScene, |node| !is_in_scene[node]);
    }
    displays
}

/// Returns the number of the default scene: without `scene`, players show the first scene.
pub(super) fn default_scene(scene: Option<usize>) -> usize {
    scene.unwrap_or(0)
}

/// Returns for each node whether the default scene has it; no node if the file has no such scene.
pub(super) fn nodes_of_default_scene(nodes: &[Node], scenes: &[Scene], scene: Option<usize>) -> Vec<bool> {
    let scene = scenes.get(default_scene(scene));
    with_descendants(nodes, scene.map(|scene| scene.nodes.to_vec()).unwrap_or_default())
}

fn set(displays: &mut [Display], display: Display, is_of_kind: impl Fn(usize) -> bool) {
    for (node, of_node) in displays.iter_mut().enumerate() {
        if is_of_kind(node) {
            *of_node = display;
        }
    }
}

/// Returns for each node whether it is one of these or below one. The hierarchy may be malformed.
fn with_descendants(nodes: &[Node], mut next: Vec<u32>) -> Vec<bool> {
    let mut is_below = vec![false; nodes.len()];
    while let Some(node) = next.pop() {
        if let Some(is_below) = is_below.get_mut(node as usize)
            && !*is_below
        {
            *is_below = true;
            next.extend(&nodes[node as usize].children);
        }
    }
    is_below
}

/// Returns the nodes that are stored as hidden themselves: those that an animation can show, and the others.
fn hidden_nodes(nodes: &[Node], text: &[u8]) -> (Vec<u32>, Vec<u32>) {
    let hidden: Vec<u32> =
        (0..nodes.len() as u32).filter(|node| !nodes[*node as usize].is_visible()).collect();
    if hidden.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let animated = nodes_with_animated_visibility(text);
    // Malformed animations may show any node.
    hidden.into_iter().partition(|node| animated.as_ref().is_none_or(|animated| animated.contains(node)))
}

/// Returns the nodes that an animation shows or hides; None if animations are malformed.
fn nodes_with_animated_visibility(text: &[u8]) -> Option<BTreeSet<u32>> {
    let node_of = |pointer: &str| -> Option<u32> {
        let node = pointer.strip_prefix("/nodes/")?;
        node.strip_suffix("/extensions/KHR_node_visibility/visible")?.parse().ok()
    };
    let root: PointerRoot = parse_parts(text).ok()?;
    Some(root.pointers().filter_map(node_of).collect())
}

/// Returns notes on the nodes of meshes that a player does not show, or shows only at some times. `displays` are those of the
/// nodes, of which at least one is shown, and `scene` is the number of the default scene.
pub(super) fn notes_on_displays(displays: &[Display], scene: usize) -> impl Iterator<Item = String> {
    let count_of = |display: Display| displays.iter().filter(|other| **other == display).count();
    let note = move |(display, count): (Display, usize)| {
        let (nodes, are) = if count == 1 { ("node", "is") } else { ("nodes", "are") };
        let hidden = format!("{count} {nodes} that KHR_node_visibility hides {are}");
        match display {
            _ if count == 0 => None,
            Display::Shown => None,
            Display::OutsideScene => Some(format!("{count} {nodes} outside scene {scene} {are} left out")),
            Display::Hidden => Some(format!("{hidden} left out")),
            Display::Switched => Some(format!(
                "{hidden} treated as shown at all times: an animation can change that, and it is not evaluated"
            )),
        }
    };
    let counted = [Display::OutsideScene, Display::Hidden, Display::Switched];
    counted.map(|display| (display, count_of(display))).into_iter().filter_map(note)
}

/// A mesh, and the nodes that show it, in file order.
pub(super) struct Shown {
    pub mesh: usize,
    pub nodes: Vec<usize>,
}

/// Returns the mesh of a name with its nodes, else the mesh at the only node of this name with this node alone, whether or not
/// a player shows that node.
pub(super) fn choose_shown(
    root: &Root,
    placed: &PlacedRoot,
    displays: &[Display],
    name: Option<&str>,
) -> Result<Shown, FormatError> {
    let error = match choose_base(root, name) {
        Ok(mesh) => return Ok(Shown { mesh, nodes: shown_nodes(placed, displays, mesh) }),
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

/// Returns the nodes of a mesh that a player shows; if there are none, all nodes of the mesh.
pub(super) fn shown_nodes(placed: &PlacedRoot, displays: &[Display], mesh: usize) -> Vec<usize> {
    let has_mesh = |node: &usize| placed.nodes[*node].mesh.is_some_and(|shown| shown as usize == mesh);
    let all: Vec<usize> = (0..placed.nodes.len()).filter(has_mesh).collect();
    let shown: Vec<usize> = all.iter().copied().filter(|node| displays[*node].is_shown()).collect();
    if shown.is_empty() { all } else { shown }
}
