//! Reader of animations.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::animation::{Animation, AnimationInfo, Channel, Property};
use super::json;
use super::nodes::Nodes;
use super::sampler::{Interpolation, Sampler};
use crate::FormatError;
use crate::error::quoted;
use crate::gltf::accessors::Accessors;
use crate::gltf::json::Root;
use crate::gltf::role::Role;
use crate::gltf::triangles::morph_targets;

/// Reads animations. Channels share key times, because most files use one accessor of times for many channels.
pub(super) struct AnimationReader<'a, 'b> {
    pub accessors: &'a mut Accessors<'b>,
    pub nodes: &'a Nodes,
    /// Number of morph targets of each node's mesh.
    pub morph_targets: &'a [usize],
    pub times: BTreeMap<usize, Arc<[f64]>>,
}

/// Returns the number of morph targets of each node's mesh.
pub(super) fn morph_targets_of_nodes(root: &Root, nodes: &[json::Node]) -> Vec<usize> {
    let of_meshes: Vec<usize> = root.meshes.iter().map(morph_targets).collect();
    let of_node = |node: &json::Node| of_meshes.get(node.mesh? as usize).copied();
    nodes.iter().map(|node| of_node(node).unwrap_or(0)).collect()
}

impl AnimationReader<'_, '_> {
    /// Reads one animation; `number` is its place in the file.
    pub fn read(
        &mut self,
        number: usize,
        animation: &json::Animation,
    ) -> Result<(Animation, AnimationInfo), FormatError> {
        let part = format!("animations[{number}]");
        let mut info = AnimationInfo {
            name: animation.name.clone(),
            first_time: f64::INFINITY,
            last_time: f64::NEG_INFINITY,
            channels: 0,
            extension_channels: 0,
        };
        let mut channels: Vec<Channel> = Vec::new();
        for (at, channel) in animation.channels.iter().enumerate() {
            let refused = |cause: String| FormatError::part(format!("{part}.channels[{at}]"), cause);
            let Some(sampler) = animation.samplers.get(channel.sampler) else {
                return Err(refused(format!("samplers[{}] does not exist", channel.sampler)));
            };
            let sampler_part = format!("{part}.samplers[{}]", channel.sampler);
            let times = self.times_of(sampler.input, &sampler_part)?;
            // Channels without a node belong to extensions; readers must ignore them.
            let Some(node) = channel.target.node else {
                info.extension_channels += 1;
                continue;
            };
            info.first_time = info.first_time.min(times[0]);
            info.last_time = info.last_time.max(times[times.len() - 1]);
            if node >= self.nodes.len() {
                return Err(refused(format!("nodes[{node}] does not exist")));
            }
            let (property, role, width) = match channel.target.path.as_str() {
                "translation" => (Property::Translation, Role::KeyVectors, 3),
                "rotation" => (Property::Rotation, Role::KeyRotations, 4),
                "scale" => (Property::Scale, Role::KeyVectors, 3),
                "weights" if self.morph_targets[node] == 0 => {
                    return Err(refused(format!("nodes[{node}] has no morph targets")));
                }
                "weights" => (Property::Weights, Role::KeyWeights, self.morph_targets[node]),
                other => {
                    let cause = format!(
                        "the path {} is unknown: translation, rotation, scale or weights was expected",
                        quoted(other)
                    );
                    return Err(refused(cause));
                }
            };
            if property != Property::Weights {
                self.nodes.parts(node)?;
            }
            let sampler = self.sampler(times, sampler, role, width, &sampler_part)?;
            channels.push(Channel { node, property, sampler });
        }
        info.channels = channels.len();
        if info.channels == 0 {
            // Some exporters write animations without channels. Only their evaluation is an error.
            (info.first_time, info.last_time) = (0.0, 0.0);
        }
        let animation = Animation::new(channels).map_err(|node| {
            FormatError::part(part, format!("two channels move the same property of nodes[{node}]"))
        })?;
        Ok((animation, info))
    }

    fn times_of(&mut self, accessor: usize, part: &str) -> Result<Arc<[f64]>, FormatError> {
        if let Some(times) = self.times.get(&accessor) {
            return Ok(Arc::clone(times));
        }
        if self.accessors.count(accessor)? == 0 {
            return Err(FormatError::part(part, "it has no key frames"));
        }
        let times: Arc<[f64]> = self.accessors.read_finite(accessor, Role::KeyTimes)?.into();
        if let Some(at) = times.windows(2).position(|pair| pair[0] > pair[1]) {
            let cause = format!("the time of key frame {} is before that of key frame {at}", at + 1);
            return Err(FormatError::part(part, cause));
        }
        self.times.insert(accessor, Arc::clone(&times));
        Ok(times)
    }

    fn sampler(
        &mut self,
        times: Arc<[f64]>,
        sampler: &json::Sampler,
        role: Role,
        width: usize,
        part: &str,
    ) -> Result<Sampler, FormatError> {
        let refused = |cause: String| Err(FormatError::part(part, cause));
        let Some(interpolation) = Interpolation::from_name(sampler.interpolation.as_deref()) else {
            let name = quoted(sampler.interpolation.as_deref().unwrap_or_default());
            return refused(format!(
                "the interpolation {name} is unknown: STEP, LINEAR or CUBICSPLINE was expected"
            ));
        };
        let items = self.accessors.count(sampler.output)?;
        let needed = times.len().checked_mul(interpolation.items_per_key() * (width / role.width()));
        if Some(items) != needed {
            let needed = needed.map_or_else(|| "more".into(), |needed| needed.to_string());
            return refused(format!(
                "its output has {items} items, but {} key frames need {needed}",
                times.len()
            ));
        }
        let values = self.accessors.read_finite(sampler.output, role)?;
        let sampler = Sampler { times, values, width, interpolation };
        let zero = sampler.key_values().position(|value| value.iter().all(|x| *x == 0.0));
        match zero.filter(|_| role == Role::KeyRotations) {
            Some(key) => refused(format!("the rotation of key frame {key} has length 0")),
            None => Ok(sampler),
        }
    }
}
