//! Animations: the state of the nodes at a time.

use std::collections::BTreeMap;

use glam::{DMat4, DVec3};

use super::nodes::Nodes;
use super::sampler::Sampler;
use crate::FormatError;

/// An animation of a glTF file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AnimationInfo {
    /// Its name, if the file has one. Names may repeat.
    pub name: Option<String>,
    /// Time of the first key frame of any channel (s). Players begin at 0, and hold the first key frame until then.
    pub first_time: f64,
    /// Time of the last key frame of any channel (s).
    pub last_time: f64,
    /// Number of channels that move nodes. An animation without any, or a malformed one, has the times 0, and cannot be
    /// evaluated.
    pub channels: usize,
    /// Number of channels of extensions, which are not evaluated.
    pub extension_channels: usize,
}

impl AnimationInfo {
    /// Returns the entry of an animation that cannot be evaluated.
    pub(super) fn unreadable(name: Option<String>) -> Self {
        Self { name, first_time: 0.0, last_time: 0.0, channels: 0, extension_channels: 0 }
    }
}

/// Channels of an animation, sorted by node.
pub(super) struct Animation {
    channels: Vec<Channel>,
}

/// Key frames of one property of a node.
pub(super) struct Channel {
    pub node: usize,
    pub property: Property,
    pub sampler: Sampler,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Property {
    Translation,
    Rotation,
    Scale,
    Weights,
}

/// State of the nodes that an animation moves.
#[derive(Default)]
pub(super) struct NodeStates {
    /// Local transforms.
    pub transforms: Vec<(usize, DMat4)>,
    /// Weights of morph targets.
    pub weights: BTreeMap<usize, Vec<f64>>,
}

/// State that an animation gives to one node.
#[derive(Default)]
pub(super) struct NodeState {
    /// Local transform; None if the animation does not move the node.
    pub transform: Option<DMat4>,
    /// Weights of morph targets; None if the animation does not change them.
    pub weights: Option<Vec<f64>>,
}

impl Animation {
    /// Creates an animation from its channels. The error is a node for which two channels move the same property.
    pub fn new(mut channels: Vec<Channel>) -> Result<Self, usize> {
        let property = |channel: &Channel| (channel.node, channel.property);
        channels.sort_by_key(property);
        match channels.windows(2).find(|pair| property(&pair[0]) == property(&pair[1])) {
            Some(pair) => Err(pair[0].node),
            None => Ok(Self { channels }),
        }
    }

    /// Returns the nodes that the animation moves, at a time (s).
    pub fn moved_at(&self, time: f64, nodes: &Nodes) -> Result<NodeStates, FormatError> {
        let mut moved = NodeStates::default();
        for channels in self.channels.chunk_by(|a, b| a.node == b.node) {
            let node = channels[0].node;
            let NodeState { transform, weights } = NodeState::of(node, channels, time, nodes)?;
            moved.transforms.extend(transform.map(|transform| (node, transform)));
            moved.weights.extend(weights.map(|weights| (node, weights)));
        }
        Ok(moved)
    }

    /// Returns the state of one node at a time (s), as in [`Animation::moved_at`].
    pub fn node_at(&self, node: usize, time: f64, nodes: &Nodes) -> Result<NodeState, FormatError> {
        let start = self.channels.partition_point(|channel| channel.node < node);
        let end = self.channels.partition_point(|channel| channel.node <= node);
        NodeState::of(node, &self.channels[start..end], time, nodes)
    }
}

impl NodeState {
    /// Returns the state of a node that these channels give to it.
    fn of(node: usize, channels: &[Channel], time: f64, nodes: &Nodes) -> Result<Self, FormatError> {
        let mut weights = None;
        let mut parts = None;
        for Channel { property, sampler, .. } in channels {
            if *property == Property::Weights {
                weights = Some(sampler.values_at(time));
                continue;
            }
            let parts = match &mut parts {
                Some(parts) => parts,
                None => parts.insert(nodes.parts(node)?),
            };
            match property {
                Property::Translation => parts.translation = DVec3::from_slice(&sampler.values_at(time)),
                Property::Scale => parts.scale = DVec3::from_slice(&sampler.values_at(time)),
                _ => parts.rotation = sampler.rotation_at(time),
            }
        }
        Ok(Self { transform: parts.map(|parts| parts.matrix()), weights })
    }
}
