//! The node hierarchy.

use std::collections::BTreeMap;

use glam::DMat4;

use super::json;
use super::transform::{Parts, Transform};
use crate::FormatError;

/// Memory of a node in bytes. The text of a node has at least 3 bytes (`{},`).
pub(super) const NODE_SIZE: u64 = 512;

/// Nodes with their parents and stored transforms.
pub(super) struct Nodes {
    transforms: Vec<Transform>,
    parents: Vec<Option<u32>>,
    /// Numbers of all nodes, each after its parent.
    order: Vec<u32>,
}

/// Maximum number of ancestors of a node. Rigs have some dozens; where the states of a scene are not kept, a node costs as much as its
/// ancestors at each time.
const MAX_DEPTH: u32 = 1000;

impl Nodes {
    /// Creates the hierarchy of a file's nodes. A child that does not exist, a node with two parents, a cycle, and more
    /// than [`MAX_DEPTH`] ancestors are errors.
    pub fn new(nodes: &[json::Node]) -> Result<Self, FormatError> {
        let refused = |node: usize, cause: String| Err(FormatError::part(format!("nodes[{node}]"), cause));
        let mut transforms = Vec::with_capacity(nodes.len());
        let mut parents: Vec<Option<u32>> = vec![None; nodes.len()];
        for (number, node) in nodes.iter().enumerate() {
            match Transform::of(node) {
                Ok(transform) => transforms.push(transform),
                Err(cause) => return refused(number, cause.into()),
            }
            for child in node.children.iter() {
                let Some(parent) = parents.get_mut(*child as usize) else {
                    return refused(number, format!("its child nodes[{child}] does not exist"));
                };
                if let Some(first) = parent {
                    let cause = format!("it is a child of nodes[{first}] and of nodes[{number}]");
                    return refused(*child as usize, cause);
                }
                *parent = Some(number as u32);
            }
        }
        let mut order: Vec<u32> =
            (0..nodes.len() as u32).filter(|n| parents[*n as usize].is_none()).collect();
        let mut next = 0;
        while let Some(node) = order.get(next) {
            order.extend(&nodes[*node as usize].children);
            next += 1;
        }
        // A node that no root reaches is in a cycle, or below one.
        if order.len() < nodes.len() {
            let mut is_reached = vec![false; nodes.len()];
            order.iter().for_each(|node| is_reached[*node as usize] = true);
            let first = is_reached.iter().position(|reached| !reached).unwrap_or_default();
            return refused(first, "its ancestors form a cycle".into());
        }
        // Parents come first.
        let mut depths = vec![0_u32; nodes.len()];
        for node in &order {
            let depth = parents[*node as usize].map_or(0, |parent| depths[parent as usize] + 1);
            if depth > MAX_DEPTH {
                return refused(*node as usize, format!("it has more than {MAX_DEPTH} ancestors"));
            }
            depths[*node as usize] = depth;
        }
        Ok(Self { transforms, parents, order })
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.transforms.len()
    }

    /// Returns translation, rotation and scale of a node. An axis of length 0 in its matrix is an error.
    pub fn parts(&self, node: usize) -> Result<Parts, FormatError> {
        self.transforms[node].parts().ok_or_else(|| {
            let cause = "an animation moves it, but its matrix has an axis of length 0: store translation, \
                         rotation and scale instead";
            FormatError::part(format!("nodes[{node}]"), cause)
        })
    }

    /// Returns the world transforms of all nodes. `moved` has the local transforms that an animation changes.
    pub fn world_transforms(&self, moved: &[(usize, DMat4)]) -> Vec<DMat4> {
        let mut world: Vec<DMat4> = self.transforms.iter().map(Transform::matrix).collect();
        moved.iter().for_each(|(node, matrix)| world[*node] = *matrix);
        for node in &self.order {
            if let Some(parent) = self.parents[*node as usize] {
                world[*node as usize] = world[parent as usize] * world[*node as usize];
            }
        }
        world
    }

    /// Adds the world transforms of a node and of its ancestors to the known ones, bit for bit as
    /// [`Nodes::world_transforms`] computes them. `moved` returns the local transform that an animation gives to a node.
    pub fn add_world_transforms(
        &self,
        node: usize,
        moved: impl Fn(usize) -> Result<Option<DMat4>, FormatError>,
        world: &mut BTreeMap<usize, DMat4>,
    ) -> Result<(), FormatError> {
        let (mut unknown, mut next) = (Vec::new(), Some(node));
        while let Some(node) = next.filter(|node| !world.contains_key(node)) {
            unknown.push(node);
            next = self.parents[node].map(|parent| parent as usize);
        }
        for node in unknown.into_iter().rev() {
            let local = moved(node)?.unwrap_or_else(|| self.transforms[node].matrix());
            let parent = self.parents[node].and_then(|parent| world.get(&(parent as usize)));
            let own = parent.map_or(local, |parent| *parent * local);
            world.insert(node, own);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn nodes(json: &str) -> Result<Nodes, String> {
        let nodes: Vec<json::Node> = serde_json::from_str(json).unwrap();
        Nodes::new(&nodes).map_err(|error| error.to_string())
    }

    #[test]
    fn parents_move_their_children() {
        // A child may come before its parent.
        let nodes = nodes(
            r#"[{"translation":[1,0,0]},{"children":[0],"scale":[2,2,2]},{"children":[1],"translation":[0,0,5]}]"#,
        )
        .ok()
        .unwrap();
        let at = |moved: &[(usize, DMat4)]| nodes.world_transforms(moved)[0].transform_point3(DVec3::Y);
        assert_eq!(at(&[]), DVec3::new(2.0, 2.0, 5.0));
        assert_eq!(at(&[(2, DMat4::IDENTITY), (1, DMat4::ZERO)]), DVec3::ZERO);
        assert_eq!(nodes.len(), 3);
    }

    #[test]
    fn chains_of_nodes_have_a_limit() {
        let chain = |count: usize| {
            let node =
                |n: usize| if n + 1 < count { format!(r#"{{"children":[{}]}}"#, n + 1) } else { "{}".into() };
            nodes(&format!("[{}]", (0..count).map(node).collect::<Vec<_>>().join(",")))
        };
        assert!(chain(1 + MAX_DEPTH as usize).is_ok());
        let refused = chain(2 + MAX_DEPTH as usize).err().unwrap();
        assert_eq!(refused, "nodes[1001]: it has more than 1000 ancestors");
    }

    /// A rotation that changes every bit, so that another order of products would show.
    #[test]
    fn single_nodes_have_the_transforms_that_all_nodes_have_together() {
        let node = |number: usize| {
            let child = number + 2;
            let children = if child < 40 { format!("[{child}]") } else { "[]".into() };
            format!(
                r#"{{"children":{children},"rotation":[0.1,0.{number},0.3,1],"scale":[1.1,0.9,1],"translation":[0.1,{number},7]}}"#
            )
        };
        let json: Vec<String> = (0..40).map(node).collect();
        let nodes = nodes(&format!("[{}]", json.join(","))).ok().unwrap();
        let turned = DMat4::from_rotation_x(0.7);
        for moved in [&[][..], &[(4, turned)], &[(0, turned), (13, turned), (38, turned)]] {
            let all = nodes.world_transforms(moved);
            let local = |node: usize| Ok(moved.iter().find(|(other, _)| *other == node).map(|(_, m)| *m));
            let mut together = BTreeMap::new();
            for node in (0..40).rev() {
                let mut alone = BTreeMap::new();
                nodes.add_world_transforms(node, local, &mut alone).unwrap();
                nodes.add_world_transforms(node, local, &mut together).unwrap();
                assert_eq!((alone[&node], together[&node]), (all[node], all[node]));
                assert_eq!(alone.len(), 1 + node / 2);
            }
            assert_eq!(together.into_values().collect::<Vec<_>>(), all);
        }
    }

    #[test]
    fn graphs_that_are_no_forest_are_rejected() {
        for (json, message) in [
            (r#"[{"children":[1]}]"#, "nodes[0]: its child nodes[1] does not exist"),
            (r#"[{"children":[0]}]"#, "nodes[0]: its ancestors form a cycle"),
            (r#"[{},{"children":[2]},{"children":[1,0]}]"#, "nodes[0]: its ancestors form a cycle"),
            (
                r#"[{"children":[2]},{"children":[2]},{}]"#,
                "nodes[2]: it is a child of nodes[0] and of nodes[1]",
            ),
            (r#"[{"children":[1,1]},{}]"#, "nodes[1]: it is a child of nodes[0] and of nodes[0]"),
            (r#"[{"rotation":[0,0,0,0]}]"#, "nodes[0]: its rotation has length 0"),
        ] {
            assert_eq!(nodes(json).err().as_deref(), Some(message));
        }
        assert_eq!(nodes("[]").ok().unwrap().len(), 0);
        // The hierarchy of a chain is not traversed by recursion.
        let chain: Vec<_> = (1..=50_000).map(|n| format!(r#"{{"children":[{n}]}}"#)).collect();
        let refused = nodes(&format!("[{},{{}}]", chain.join(","))).err().unwrap();
        assert_eq!(refused, "nodes[1001]: it has more than 1000 ancestors");
    }
}
