//! The fast construction of the hierarchy, top down by median splits, for detectors, which are often used only once.
//!
//! Each node is split in half along the longest axis of its triangles' centroids, twice, so that it has up to four
//! children. Sizes are multiples of a bucket's, so that all buckets except the last one are full. Buckets are split in the same
//! way, and the triangles of each bucket are in the order of its packets. The construction by k-means results in stronger
//! certificates and takes more than ten times as long (docs/notes/queries.md#one-shot-detector).

use glam::{DVec3, Vec3};

use super::hierarchy::Hierarchy;
use super::node::{BUCKET_TRIANGLES, Node, PACKET_TRIANGLES};
use crate::geometry::Aabb;

impl Hierarchy {
    /// Builds a hierarchy whose leaves are buckets, by the positions of vertices at some configuration. The same input gives
    /// the same tree on every machine. O(N log N) for N triangles.
    pub(crate) fn build_by_median(faces: &[[u32; 3]], positions: &[DVec3]) -> Self {
        let mut triangles = sort_keys(faces, positions);
        let mut nodes = vec![Node::leaf(0, triangles.len() as u32)];
        let mut next = 0;
        while next < nodes.len() {
            let Node { first_triangle, triangle_count, .. } = nodes[next];
            if triangle_count as usize > BUCKET_TRIANGLES {
                let own = &mut triangles[first_triangle as usize..][..triangle_count as usize];
                let middle = split_in_half(own, BUCKET_TRIANGLES);
                let (left, right) = own.split_at_mut(middle);
                let quarters = [left, right].map(|half| split_in_half(half, BUCKET_TRIANGLES));
                let ends = [quarters[0], middle, middle + quarters[1], triangle_count as usize];
                nodes[next].first_child = nodes.len() as u32;
                let mut start = 0;
                for end in ends {
                    if end > start {
                        nodes.push(Node::leaf(first_triangle + start as u32, (end - start) as u32));
                        nodes[next].child_count += 1;
                    }
                    start = end;
                }
            } else {
                cut_into_packets(&mut triangles[first_triangle as usize..][..triangle_count as usize]);
            }
            next += 1;
        }
        Self { nodes, order: triangles.into_iter().map(|key| key.triangle).collect() }
    }
}

/// A triangle, and three times its centroid in the scaled coordinates of [`sort_keys`].
#[derive(Clone, Copy)]
struct SortKey {
    centroid: Vec3,
    triangle: u32,
}

/// Returns the triangles with their centroids, in single precision relative to the AABB of all corners. The tree need
/// not be more precise, because boxes are computed from exact positions.
fn sort_keys(faces: &[[u32; 3]], positions: &[DVec3]) -> Vec<SortKey> {
    let corners = faces.iter().flatten().map(|v| positions[*v as usize]);
    let Aabb { lower, upper } = Aabb::of_points(corners);
    let scale = (1.0 / (upper * 0.5 - lower * 0.5).max_element()).min(f64::MAX);
    let center = lower * 0.5 + upper * 0.5;
    let key = |(triangle, face): (usize, &[u32; 3])| {
        let [a, b, c] = face.map(|v| ((positions[v as usize] - center) * scale).as_vec3());
        SortKey { centroid: a + b + c, triangle: triangle as u32 }
    };
    faces.iter().enumerate().map(key).collect()
}

/// Orders the triangles of a bucket packet by packet, those of each packet close together.
fn cut_into_packets(triangles: &mut [SortKey]) {
    let middle = split_in_half(triangles, PACKET_TRIANGLES);
    if middle > 0 {
        let (left, right) = triangles.split_at_mut(middle);
        cut_into_packets(left);
        cut_into_packets(right);
    }
}

/// Reorders triangles so that the first half, a multiple of `unit`, lies before the second along the longest axis;
/// returns the size of the first half, 0 if there is at most one unit.
fn split_in_half(triangles: &mut [SortKey], unit: usize) -> usize {
    let middle = triangles.len().div_ceil(unit) / 2 * unit;
    if middle > 0 {
        let (lower, upper) = triangles.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |all, key| {
            (all.0.min(key.centroid), all.1.max(key.centroid))
        });
        // The key compares the coordinate first, then the triangle, by one integer comparison.
        let key = |coordinate: f32, triangle: u32| {
            u64::from(ascending_bits(coordinate)) << 32 | u64::from(triangle)
        };
        match (upper - lower).max_position() {
            0 => triangles.select_nth_unstable_by_key(middle, |t| key(t.centroid.x, t.triangle)),
            1 => triangles.select_nth_unstable_by_key(middle, |t| key(t.centroid.y, t.triangle)),
            _ => triangles.select_nth_unstable_by_key(middle, |t| key(t.centroid.z, t.triangle)),
        };
    }
    middle
}

/// Returns an integer for each number, in the same order, -0 before +0.
fn ascending_bits(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TriMesh;
    use crate::test_models::Random;

    /// In some cases centroids coincide, are far away, or differ by less than single precision.
    #[test]
    fn every_triangle_is_in_one_bucket() {
        let random = &mut Random(5);
        for (case, count) in [1, 2, 63, 64, 65, 128, 129, 191, 257, 1000, 5000].into_iter().enumerate() {
            let size = [0.0, 1.0, 1e-300, 1e59][case % 4];
            let positions: Vec<DVec3> = (0..3 * count).map(|_| random.vector() * size).collect();
            let faces: Vec<[u32; 3]> = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let mesh = TriMesh::new(positions, faces).unwrap();
            let hierarchy = Hierarchy::build_by_median(mesh.faces(), mesh.rest_positions());
            let parts = (hierarchy.nodes().to_vec(), hierarchy.order().to_vec());
            assert_eq!(Hierarchy::from_parts(parts.0, parts.1, count as usize).unwrap(), hierarchy);
            let leaves = hierarchy.nodes().iter().filter(|node| node.is_leaf());
            assert!(leaves.clone().all(|leaf| leaf.fits_in_bucket()));
            assert_eq!(leaves.count(), (count as usize).div_ceil(BUCKET_TRIANGLES), "{count}");
            let again = Hierarchy::build_by_median(mesh.faces(), mesh.rest_positions());
            assert_eq!(hierarchy, again);
        }
    }
}
