//! The vertices of a posed shape below a plane.

use glam::DVec3;

use super::posed_motion::PosedMotion;
use super::posed_shape::PosedShape;
use crate::detect::layout::Layout;
use crate::detect::vertex_motion::VertexMotion;
use crate::geometry::Aabb;

impl PosedShape<'_> {
    /// Adds the used vertices x with `normal . x < height` in the world, ascending; all of them up to rounding.
    pub fn vertices_below(&mut self, normal: DVec3, height: f64, found: &mut Vec<u32>) {
        let first = found.len();
        let Layout { vertices, buckets, bd_tree, .. } = &*self.volumes.layout;
        let PosedMotion { q: [q], pose: [pose], .. } = &self.motion;
        let local = pose.rotation.transpose() * normal;
        let height = height - normal.dot(pose.translation);
        let rounding = DVec3::splat(self.motion.rounding());
        self.stack.clear();
        self.stack.push((0, 0));
        while let Some((n, _)) = self.stack.pop() {
            let is_above = bd_tree.at(n, [q], rounding).is_some_and(|Aabb { lower, upper }| {
                let half = (upper - lower) * 0.5;
                local.dot((upper + lower) * 0.5) - local.abs().dot(half) > height
            });
            if is_above {
                continue;
            }
            if let Some(bucket) = buckets.of_node(n) {
                let below = |v: &&u32| local.dot(vertices.position(**v, [q])[0]) < height;
                found.extend(buckets.vertices(bucket).iter().filter(below).map(|v| vertices.mesh_vertex(*v)));
            } else {
                self.stack.extend(self.context.hierarchy.nodes()[n as usize].children().map(|n| (n, 0)));
            }
        }
        // Buckets have vertices in common.
        found[first..].sort_unstable();
        let mut kept = first;
        for i in first..found.len() {
            if kept == first || found[kept - 1] != found[i] {
                found[kept] = found[i];
                kept += 1;
            }
        }
        found.truncate(kept);
    }
}
