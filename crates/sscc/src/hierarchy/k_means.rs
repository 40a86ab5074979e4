//! 4-means clustering of a node's triangles (paper, section 3).

use super::cluster_features::{ClusterFeature, FEATURES};
use super::node::BRANCHING;

/// Iterations of k-means (docs/notes/broad-phase.md#hierarchy).
const ITERATIONS: usize = 6;

/// A child may have at most this share of its parent's triangles, 7/8; otherwise the parent is cut evenly. So no input
/// makes the tree deep: its depth is at most log N / log(8/7).
const MAX_CHILD_NUMERATOR: usize = 7;
const MAX_CHILD_DENOMINATOR: usize = 8;

/// Reorders `triangles` into 2 to 4 clusters and returns their sizes, each positive.
pub(super) fn cluster(features: &[ClusterFeature], triangles: &mut [u32]) -> Vec<u32> {
    let mut centers = find_starting_centers(features, triangles);
    let mut labels = vec![0_u8; triangles.len()];
    for iteration in 0..ITERATIONS {
        for (label, &a) in labels.iter_mut().zip(triangles.iter()) {
            *label = find_nearest(&centers, &features[a as usize]);
        }
        if iteration + 1 < ITERATIONS {
            move_centers(&mut centers, features, triangles, &labels);
        }
    }
    let mut sizes = [0_u32; BRANCHING];
    labels.iter().for_each(|&label| sizes[label as usize] += 1);
    let largest = sizes.iter().max().map_or(0, |&size| size as usize);
    if largest * MAX_CHILD_DENOMINATOR > triangles.len() * MAX_CHILD_NUMERATOR {
        return cut_evenly(features, triangles);
    }
    let mut sorted: Vec<(u8, u32)> = labels.iter().copied().zip(triangles.iter().copied()).collect();
    sorted.sort_by_key(|&(label, a)| (label, a));
    triangles.iter_mut().zip(sorted).for_each(|(slot, (_, a))| *slot = a);
    sizes.into_iter().filter(|&size| size > 0).collect()
}

/// Cuts triangles into four equal parts along the widest feature, where k-means would split them too unevenly.
fn cut_evenly(features: &[ClusterFeature], triangles: &mut [u32]) -> Vec<u32> {
    let width = |i: usize| {
        let values = triangles.iter().map(|&a| features[a as usize][i]);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    let widest = (0..FEATURES).fold(0, |best, i| if width(i) > width(best) { i } else { best });
    triangles.sort_by(|&a, &b| {
        features[a as usize][widest].total_cmp(&features[b as usize][widest]).then(a.cmp(&b))
    });
    let count = triangles.len();
    (0..BRANCHING)
        .map(|i| ((i + 1) * count / BRANCHING - i * count / BRANCHING) as u32)
        .filter(|&size| size > 0)
        .collect()
}

/// Chooses starting centres: the triangle farthest from the mean, then repeatedly the one farthest from those chosen.
fn find_starting_centers(features: &[ClusterFeature], triangles: &[u32]) -> [ClusterFeature; BRANCHING] {
    let mut mean = [0.0; FEATURES];
    for &a in triangles {
        mean.iter_mut().zip(&features[a as usize]).for_each(|(m, f)| *m += f);
    }
    mean.iter_mut().for_each(|m| *m /= triangles.len() as f64);
    let farthest = |distances: &mut [f64], from: &ClusterFeature| {
        let mut best = 0;
        for (i, &a) in triangles.iter().enumerate() {
            distances[i] = distances[i].min(squared_distance(from, &features[a as usize]));
            if distances[i] > distances[best] {
                best = i;
            }
        }
        features[triangles[best] as usize]
    };
    let mut centers = [farthest(&mut vec![f64::INFINITY; triangles.len()], &mean); BRANCHING];
    let mut distances = vec![f64::INFINITY; triangles.len()];
    for i in 1..BRANCHING {
        centers[i] = farthest(&mut distances, &centers[i - 1]);
    }
    centers
}

/// Returns the index of the nearest centre, the first one among equals.
fn find_nearest(centers: &[ClusterFeature; BRANCHING], feature: &ClusterFeature) -> u8 {
    let mut best = (f64::INFINITY, 0);
    for (i, center) in centers.iter().enumerate() {
        let d = squared_distance(center, feature);
        if d < best.0 {
            best = (d, i as u8);
        }
    }
    best.1
}

/// Moves each centre to the mean of its cluster; centres of empty clusters stay.
fn move_centers(
    centers: &mut [ClusterFeature; BRANCHING],
    features: &[ClusterFeature],
    triangles: &[u32],
    labels: &[u8],
) {
    let mut sums = [[0.0; FEATURES]; BRANCHING];
    let mut counts = [0.0; BRANCHING];
    for (&label, &a) in labels.iter().zip(triangles) {
        counts[label as usize] += 1.0;
        sums[label as usize].iter_mut().zip(&features[a as usize]).for_each(|(s, f)| *s += f);
    }
    for ((center, sum), count) in centers.iter_mut().zip(sums).zip(counts) {
        if count > 0.0 {
            *center = sum.map(|s| s / count);
        }
    }
}

fn squared_distance(a: &ClusterFeature, b: &ClusterFeature) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All triangles alike, at two places, one far away, or in a row.
    #[test]
    fn clusters_hold_all_triangles_and_none_holds_nearly_all() {
        let places: [fn(usize) -> f64; 4] =
            [|_| 0.0, |i| (i % 2) as f64, |i| if i == 0 { 1e3 } else { 0.0 }, |i| i as f64];
        for (case, place) in places.into_iter().enumerate() {
            for count in [9, 20, 200] {
                let feature = |i: usize| std::array::from_fn(|k| if k == 0 { place(i) } else { 0.0 });
                let features: Vec<ClusterFeature> = (0..count).map(feature).collect();
                let mut triangles: Vec<u32> = (0..count as u32).rev().collect();
                let sizes = cluster(&features, &mut triangles);
                assert!((2..=BRANCHING).contains(&sizes.len()), "{case} {count}: {sizes:?}");
                assert!(sizes.iter().all(|s| *s > 0 && *s as usize * 8 <= count * 7), "{case}: {sizes:?}");
                assert_eq!(sizes.iter().sum::<u32>() as usize, count);
                triangles.sort_unstable();
                assert!(triangles.into_iter().eq(0..count as u32));
            }
        }
    }
}
