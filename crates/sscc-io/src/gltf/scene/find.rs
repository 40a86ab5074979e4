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

    /// Returns the node of that number, else of that name, which must show a mesh with triangles; without a name all such nodes.
    ///
    /// # Errors
    /// When there is none, or several have that name; the message lists the nodes with meshes.
    pub fn find_mesh_nodes(&self, node: Option<&str>) -> Result<&[MeshNode], FormatError> {
        let all = &self.mesh_nodes[..];
        if all.is_empty() {
            return Err(FormatError::whole("no node of the file shows a mesh with triangles"));
        }
        let Some(node) = node else { return Ok(all) };
        let number = node.parse().ok().and_then(|node| all.binary_search_by_key(&node, MeshNode::node).ok());
        let named = |other: &MeshNode| other.name() == Some(node);
        let found = number.or_else(|| all.iter().position(named));
        let list: Vec<String> = all.iter().map(|node| listed(node.node, node.name())).collect();
        let list = list.join(", ");
        let cause = match found {
            None if node.parse::<usize>().is_ok() => {
                format!("node {node} shows no mesh with triangles; these nodes do: {list}")
            }
            None => format!("no node {} shows a mesh with triangles; these nodes do: {list}", quoted(node)),
            Some(at) if number.is_none() && all[at + 1..].iter().any(named) => {
                format!("several nodes have the name {}: choose one by its number: {list}", quoted(node))
            }
            Some(at) => return Ok(&all[at..=at]),
        };
        Err(FormatError::whole(cut(&cause, MAX_LIST)))
    }

    /// Returns the number and the name of each animation.
    fn animation_list(&self) -> String {
        let listed = |(number, info): (usize, &super::AnimationInfo)| listed(number, info.name.as_deref());
        let list: Vec<String> = self.infos.iter().enumerate().map(listed).collect();
        cut(&format!("the animations of the file, by number: {}", list.join(", ")), MAX_LIST)
    }
}

fn listed(number: usize, name: Option<&str>) -> String {
    name.map_or_else(|| number.to_string(), |name| format!("{number} {}", quoted(name)))
}
