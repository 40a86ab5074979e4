//! Selection of an animation or a node; errors list the available ones.

use super::animated_scene::AnimatedScene;
use super::mesh_node::MeshNode;
use crate::FormatError;
use crate::error::{cut, quoted};

/// Maximum length of a list in a message.
const MAX_LIST: usize = 300;

impl AnimatedScene {
    /// Returns the number of the animation of that name, else of that number (counted from 0).
    ///
    /// # Errors
    /// When there is no such animation, or several have that name: the message lists the animations. When the animation
    /// has no key frames or is malformed.
    pub fn find_animation(&self, name: &str) -> Result<usize, FormatError> {
        let named = |info: &&super::AnimationInfo| info.name.as_deref() == Some(name);
        let found = match self.infos.iter().filter(named).count() {
            0 => name.parse().ok().filter(|number| *number < self.infos.len()),
            1 => self.infos.iter().position(|info| named(&info)),
            count => {
                let cause =
                    format!("{count} animations have the name {}: choose one by its number", quoted(name));
                return Err(FormatError::whole(format!("{cause}; {}", self.animation_list())));
            }
        };
        let Some(number) = found else {
            let cause = match self.infos.len() {
                0 => "the file has no animations".to_owned(),
                _ => format!("there is no animation {}; {}", quoted(name), self.animation_list()),
            };
            return Err(FormatError::whole(cause));
        };
        // An animation without key frames is an error here, before its first frame.
        self.pose(Some(number), 0.0)?;
        Ok(number)
    }

    /// Returns the node of that number, else of that name, which must have a mesh with triangles; without a name all such nodes
    /// that a player shows. A name finds a node that a player does not show only if it shows none of this name.
    ///
    /// # Errors
    /// When there is none, or several have that name; the message lists the nodes with meshes.
    pub fn find_mesh_nodes(&self, node: Option<&str>) -> Result<&[MeshNode], FormatError> {
        let all = &self.mesh_nodes[..];
        if all.is_empty() {
            return Err(FormatError::whole("no node of the file shows a mesh with triangles"));
        }
        let Some(node) = node else { return Ok(all) };
        let number = node.parse::<usize>().ok();
        if let Some(found) = number.and_then(|number| self.mesh_nodes_of_number(number)) {
            return Ok(found);
        }
        let named = |other: &MeshNode| other.name() == Some(node);
        for nodes in [all, &self.left_out[..]] {
            let Some(at) = nodes.iter().position(named) else { continue };
            if nodes.iter().skip(at + 1).any(named) {
                let (name, list) = (quoted(node), mesh_node_list(nodes));
                let cause = format!("several nodes have the name {name}: choose one by its number: {list}");
                return Err(FormatError::whole(cut(&cause, MAX_LIST)));
            }
            return Ok(&nodes[at..=at]);
        }
        let place = match number {
            None => format!("no node {} shows a mesh", quoted(node)),
            Some(_) => format!("node {node} shows no mesh"),
        };
        let list = mesh_node_list(all.iter().chain(&self.left_out));
        let cause = format!("{place} with triangles; these nodes do: {list}");
        Err(FormatError::whole(cut(&cause, MAX_LIST)))
    }

    /// Returns the number and the name of each animation.
    fn animation_list(&self) -> String {
        let listed = |(number, info): (usize, &super::AnimationInfo)| listed(number, info.name.as_deref());
        let list: Vec<String> = self.infos.iter().enumerate().map(listed).collect();
        cut(&format!("the animations of the file, by number: {}", list.join(", ")), MAX_LIST)
    }
}

/// Returns the number and the name of each node.
fn mesh_node_list<'a>(nodes: impl IntoIterator<Item = &'a MeshNode>) -> String {
    let list: Vec<String> = nodes.into_iter().map(|node| listed(node.node, node.name())).collect();
    list.join(", ")
}

fn listed(number: usize, name: Option<&str>) -> String {
    name.map_or_else(|| number.to_string(), |name| format!("{number} {}", quoted(name)))
}
