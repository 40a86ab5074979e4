//! Influences of joints on the vertices of a mesh.

use crate::FormatError;
use crate::gltf::accessors::Accessors;
use crate::gltf::role::Role;

use super::json::SkinAttributes;

/// An influence: a joint (its index in the list of used joints) and a weight.
pub(super) type Influence = (u32, f64);

/// Influences of all vertices, each vertex's sorted by joint.
#[derive(Default)]
pub(super) struct Influences {
    /// Joints that some vertex uses, ascending.
    pub joints: Vec<u32>,
    /// Influences of vertex v: `entries[starts[v]..starts[v + 1]]`.
    starts: Vec<usize>,
    entries: Vec<Influence>,
    /// The largest |sum of weights - 1| of a vertex.
    pub largest_sum_error: f64,
}

impl Influences {
    /// Creates influences without vertices.
    pub fn new() -> Self {
        Self { starts: vec![0], ..Self::default() }
    }

    /// Appends the vertices of a primitive. `part` is its name in messages, `vertices` its number of vertices. Joints
    /// are indices in the skin until [`Influences::finish`].
    ///
    /// Weights of 0 are left out. A vertex of zero weights keeps its first joint with weight 0: see
    /// [`SkinWeights`](super::SkinWeights).
    pub fn push(
        &mut self,
        accessors: &mut Accessors<'_>,
        attributes: &SkinAttributes,
        vertices: usize,
        part: &str,
    ) -> Result<(), FormatError> {
        let refused = |cause: String| FormatError::part(part, cause);
        let (joints, weights) = (&attributes.joints, &attributes.weights);
        if joints.is_empty() {
            return Err(refused("a node shows it with a skin, but it has no JOINTS_0".into()));
        }
        if joints.len() != weights.len() || joints.iter().zip(weights).any(|(j, w)| j.0 != w.0) {
            return Err(refused(
                "its attributes JOINTS_n and WEIGHTS_n do not have the same numbers n".into(),
            ));
        }
        let mut sets = Vec::new();
        for ((n, joints), (_, weights)) in joints.iter().zip(weights) {
            for (name, accessor) in [("JOINTS", *joints), ("WEIGHTS", *weights)] {
                let count = accessors.count(accessor)?;
                if count != vertices {
                    return Err(refused(format!("{name}_{n} has {count} items for {vertices} vertices")));
                }
            }
            accessors.allowance.take(vertices as u64, 4 * size_of::<Influence>() as u64).map_err(refused)?;
            let joints = accessors.read(*joints, Role::Joints)?;
            sets.push((joints, accessors.read_finite(*weights, Role::SkinWeights)?));
        }
        for vertex in 0..vertices {
            let start = self.entries.len();
            let of_vertex = |set: &(Vec<f64>, Vec<f64>)| -> [Influence; 4] {
                [0, 1, 2, 3].map(|i| (set.0[4 * vertex + i] as u32, set.1[4 * vertex + i]))
            };
            for (joint, weight) in sets.iter().flat_map(of_vertex) {
                if weight < 0.0 {
                    return Err(refused(format!(
                        "joint {joint} has the negative weight {weight} at vertex {vertex} (counted from 0)"
                    )));
                }
                if weight > 0.0 {
                    self.entries.push((joint, weight));
                }
            }
            let influences = &mut self.entries[start..];
            // Equal influences in another order give the same positions to the last bit.
            influences.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            let sum: f64 = influences.iter().map(|(_, weight)| weight).sum();
            self.largest_sum_error = self.largest_sum_error.max((sum - 1.0).abs());
            if influences.is_empty() {
                self.entries.push((of_vertex(&sets[0])[0].0, 0.0));
            }
            self.starts.push(self.entries.len());
        }
        Ok(())
    }

    /// Collects the used joints, and replaces joints by their indices among them.
    pub fn finish(&mut self) {
        self.joints = self.entries.iter().map(|(joint, _)| *joint).collect();
        self.joints.sort_unstable();
        self.joints.dedup();
        for (joint, _) in &mut self.entries {
            *joint = self.joints.partition_point(|used| used < joint) as u32;
        }
    }

    /// Returns the influences of a vertex, at least one. All weights are positive, or the only one is 0.
    pub fn of_vertex(&self, vertex: usize) -> &[Influence] {
        &self.entries[self.starts[vertex]..self.starts[vertex + 1]]
    }

    /// Returns the first vertex that a joint of this index in the list of used joints moves.
    pub fn first_vertex_of(&self, joint: u32) -> usize {
        let entry = self.entries.iter().position(|(other, _)| *other == joint).unwrap_or_default();
        self.starts.partition_point(|start| *start <= entry).saturating_sub(1)
    }
}
