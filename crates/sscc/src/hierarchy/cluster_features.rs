//! The vectors that k-means clusters: for each triangle its centroid, and its modes projected to a few numbers.
//!
//! Clustering on the modes as well tends to put regions that move differently into different nodes even where they are
//! close in space, which makes certificates stronger (paper, section 3, after Huang et al. 2009). Projections with random
//! signs keep distances between triangles within a few tens of percent (Johnson and Lindenstrauss 1984, *Extensions of
//! Lipschitz Mappings into a Hilbert Space*).

use std::ops::Range;

use glam::DVec3;

use crate::{Metric, ReducedModel, random};

/// The number of features that represent the modes of a triangle: sums of the scaled mode entries with fixed random
/// signs (docs/notes/broad-phase.md#hierarchy).
const MODE_FEATURES: usize = 9;

pub(super) const FEATURES: usize = 3 + MODE_FEATURES;

pub(super) type ClusterFeature = [f64; FEATURES];

/// Returns one point for each triangle: its centroid, and its mean scaled modes, projected. Both are relative to their
/// mean over all triangles, in units of their largest deviation from it along an axis.
pub(super) fn cluster_features(model: &ReducedModel, metric: &Metric) -> Vec<ClusterFeature> {
    let (mesh, modes) = (model.mesh(), model.modes());
    let p = mesh.rest_positions();
    let mut vertex_features = vec![[0.0; FEATURES]; p.len()];
    let mut scaled = vec![DVec3::ZERO; modes.rank()];
    for i in mesh.used_vertices() {
        let feature = &mut vertex_features[i as usize];
        feature[..3].copy_from_slice(&p[i as usize].to_array());
        metric.scaled_modes(modes.of_vertex(i), &mut scaled);
        for (k, a) in scaled.iter().enumerate() {
            for (axis, a) in a.to_array().into_iter().enumerate() {
                let signs = hash(3 * k as u64 + axis as u64);
                for (bit, f) in feature[3..].iter_mut().enumerate() {
                    *f += if signs >> bit & 1 == 0 { a } else { -a };
                }
            }
        }
    }
    let mut features: Vec<ClusterFeature> = mesh
        .faces()
        .iter()
        .map(|face| {
            let [f0, f1, f2] = face.map(|i| vertex_features[i as usize]);
            std::array::from_fn(|i| (f0[i] + f1[i] + f2[i]) / 3.0)
        })
        .collect();
    for range in [0..3, 3..FEATURES] {
        normalize(&mut features, range);
    }
    features
}

/// Centres the features of a range and divides them by the largest deviation from the mean.
fn normalize(features: &mut [ClusterFeature], range: Range<usize>) {
    let mut largest = 0.0_f64;
    for i in range.clone() {
        let mean = features.iter().map(|f| f[i]).sum::<f64>() / features.len() as f64;
        for f in features.iter_mut() {
            f[i] -= mean;
            largest = largest.max(f[i].abs());
        }
    }
    if largest > 0.0 {
        features.iter_mut().for_each(|f| f[range.clone()].iter_mut().for_each(|x| *x /= largest));
    }
}

/// Returns fixed pseudo-random bits: number x of a generator that begins at 0.
fn hash(x: u64) -> u64 {
    random::next_bits(&mut x.wrapping_mul(random::INCREMENT))
}
