//! Random models of two triangles, and all bounds of them.

use glam::DVec3;

use super::random::Random;
use super::true_minimum::OraclePair;
use crate::bounds::affine_bound::AffineBound;
use crate::bounds::pair_corners::PairCorners;
use crate::bounds::separating_direction::{CornerProjections, bound_along, bound_rest_distance};
use crate::bounds::{LeafPair, NodePairBounds, NodePairScratch, PairRefiner, RefinementTarget};
use crate::geometry::nearest_to_origin;
use crate::hierarchy::{Hierarchy, Node};
use crate::model::{ScaledModel, scale_direction};
use crate::vectors::InstructionSet;
use crate::{DISTANCE_ERROR, Metric, MetricKind, Modes, ReducedModel, TriMesh};

/// A factor that covers the rounding of the search for the true minimum.
pub(super) const ROOM: f64 = 1.0 + 1e-9;

/// The number of kinds of random pairs, see [`random_pair`].
pub(super) const KINDS: usize = 13;

/// Returns two triangles and their modes, of one of [`KINDS`] difficult kinds.
pub(super) fn random_pair(kind: usize, random: &mut Random) -> ReducedModel {
    let rank = match random.below(4) {
        0 => 1 + random.below(3),
        1 => 1 + random.below(40),
        _ => 3 + random.below(6),
    };
    let mut p: [DVec3; 6] = std::array::from_fn(|_| random.vector());
    let apart = DVec3::new(random.power(-1.0, 0.7) + 1.0, 0.0, 0.0);
    p[3..].iter_mut().for_each(|p| *p += apart);
    let mut u: Vec<[DVec3; 6]> = (0..rank).map(|_| std::array::from_fn(|_| random.vector())).collect();
    // Modes are constant over each triangle up to a part of this size.
    let calm = random.power(-4.0, 0.0);
    for u in &mut u {
        let means = [u[0], u[3]];
        u.iter_mut().enumerate().for_each(|(v, u)| *u = means[v / 3] + *u * calm);
    }
    let mut scales = vec![1.0; rank];
    match kind {
        0 | 1 => {}
        // Almost planar modes.
        2 => {
            let flat = DVec3::new(1.0, 1.0, random.power(-12.0, -1.0));
            u.iter_mut().flatten().for_each(|u| *u *= flat);
        }
        // A large common translation.
        3 => {
            let size = random.power(0.0, 8.0);
            for u in &mut u {
                let common = random.vector() * size;
                u.iter_mut().for_each(|u| *u += common);
            }
        }
        // Tiny gaps.
        4 => {
            let gap = random.power(-12.0, -2.0);
            p[..3].iter_mut().for_each(|p| p.x = -p.x.abs());
            p[3..].iter_mut().for_each(|p| p.x = (p.x - apart.x).abs() + gap);
            p[0].x = 0.0;
            p[3] = DVec3::new(gap, p[0].y, p[0].z);
        }
        // Far from the origin.
        5 => {
            let offset = random.vector() * random.power(2.0, 12.0);
            p.iter_mut().for_each(|p| *p += offset);
        }
        // Slivers.
        6 => {
            let thin = random.power(-12.0, -2.0);
            p[2] = p[0].lerp(p[1], random.uniform()) + random.vector() * thin;
            p[5] = p[3].lerp(p[4], random.uniform()) + random.vector() * thin;
        }
        // Two rings apart on a smooth surface that moves almost rigidly.
        7 | 8 => {
            let h = random.power(-3.0, -0.5);
            let (tilt, bend) = (random.power(-9.0, -1.0), random.vector());
            let at = [[0., 0.], [1., 0.], [0., 1.], [2., 0.], [3., 0.], [2., 1.]];
            p = at.map(|[x, y]| DVec3::new(x * h, y * h, 0.0) + random.vector() * (0.1 * h));
            p.iter_mut().for_each(|p| p.z = bend.x * p.x * p.x + bend.y * p.y * p.y + bend.z * p.x * p.y);
            for u in &mut u {
                let (w, t, noise) = (random.vector(), random.vector(), random.vector() * tilt);
                *u = p.map(|p| w.cross(p) + t + noise * DVec3::new(p.y * p.z, p.x * p.x, p.x * p.y + p.x));
            }
        }
        // Some corners do not move.
        9 => {
            for v in 0..6 {
                if random.below(2) == 0 {
                    u.iter_mut().for_each(|u| u[v] = DVec3::ZERO);
                }
            }
        }
        // Modes that depend on each other.
        10 => {
            let kept = 1 + random.below(rank);
            for k in kept..rank {
                let (a, b) = (u[random.below(kept)], u[random.below(kept)]);
                u[k] = std::array::from_fn(|v| a[v] * 2.0 - b[v] * 0.5);
            }
        }
        // Metrics that differ much.
        11 => scales.iter_mut().for_each(|s| *s = random.power(-6.0, 6.0)),
        // Very small or large altogether.
        _ => {
            let (size, speed) = (random.power(-40.0, 40.0), random.power(-40.0, 40.0));
            p.iter_mut().for_each(|p| *p *= size);
            u.iter_mut().flatten().for_each(|u| *u *= speed);
        }
    }
    let displacements = (0..6).flat_map(|v| u.iter().map(move |u| u[v])).collect();
    let mesh = TriMesh::new(p.to_vec(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let metric = Metric::from_scales(MetricKind::Given, scales).unwrap();
    ReducedModel::with_metric(mesh, Modes::new(rank, displacements).unwrap(), metric).unwrap()
}

pub(super) fn reference(model: &ReducedModel, faces: [u32; 2]) -> OraclePair {
    let corners: Vec<u32> = faces.iter().flat_map(|&f| model.mesh().faces()[f as usize]).collect();
    let scaled = |v: u32| {
        let u = model.modes().of_vertex(v).iter().zip(model.metric().scales());
        u.map(|(u, s)| *u / s).collect()
    };
    OraclePair {
        p: std::array::from_fn(|i| model.mesh().rest_positions()[corners[i] as usize]),
        a: std::array::from_fn(|i| scaled(corners[i])),
    }
}

/// Returns the first two triangles of a model.
pub(super) fn pair_corners(scaled: &ScaledModel) -> PairCorners<'_> {
    PairCorners::of(scaled, [0, 1, 2], [3, 4, 5])
}

/// Returns the model with two more triangles, each of which resembles one of its own.
fn with_others(model: &ReducedModel, random: &mut Random) -> ReducedModel {
    let mut positions = model.mesh().rest_positions().to_vec();
    let mut displacements = model.modes().displacements().to_vec();
    for v in 0..6 {
        let (size, speed) = (random.power(-0.3, 0.3), random.power(-1.0, 0.3));
        positions.push(model.mesh().rest_positions()[v] * size);
        displacements.extend(model.modes().of_vertex(v as u32).iter().map(|u| *u * speed));
    }
    let faces = vec![[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
    let (mesh, modes) =
        (TriMesh::new(positions, faces).unwrap(), Modes::new(model.rank(), displacements).unwrap());
    ReducedModel::with_metric(mesh, modes, model.metric().clone()).unwrap()
}

fn far_target() -> RefinementTarget {
    RefinementTarget { cap: f64::INFINITY, upper: f64::INFINITY, epsilon: 0.1, subdivisions: 500 }
}

/// Returns the model in scaled coordinates about the rest pose, with a clearance unless that is 0.
pub(super) fn scaled_keeping(model: &ReducedModel, clearance: f64) -> ScaledModel {
    let scaled = ScaledModel::new(model, model.metric(), &vec![0.0; model.rank()]);
    if clearance > 0.0 { scaled.keeping(clearance, DISTANCE_ERROR) } else { scaled }
}

/// Returns all bounds of one pair of triangles, by name.
pub(super) fn all_bounds(model: &ReducedModel, random: &mut Random) -> Vec<(&'static str, f64)> {
    all_bounds_keeping(model, 0.0, random)
}

/// Returns all bounds of one pair of triangles that keep a clearance, by name.
pub(super) fn all_bounds_keeping(
    model: &ReducedModel,
    clearance: f64,
    random: &mut Random,
) -> Vec<(&'static str, f64)> {
    let scaled = scaled_keeping(model, clearance);
    let pair = pair_corners(&scaled);
    let differences = pair.differences();
    let row_len = scaled.row_len;
    let mut projections = CornerProjections::new(row_len);
    let mut affine = AffineBound::new(row_len);
    let mut bounds = Vec::new();
    let among_others = with_others(model, random);
    let scaled_others = scaled_keeping(&among_others, clearance);
    let mut leaves = LeafPair::new(&scaled_others);
    leaves.load(&[2, 0], &[1, 3]);
    for sufficient in [f64::INFINITY, random.power(-6.0, 6.0)] {
        bounds.push(("shared affine", leaves.bound_by_affine_map([0, 1, 2], [3, 4, 5], sufficient)));
    }
    let closest = nearest_to_origin(&differences).point;
    for i in 0..12 {
        let dir = match i {
            0 => closest,
            1 => differences.iter().sum(),
            2 => closest * 1e-200,
            3 => closest * 1e200,
            4..8 => closest + random.vector() * closest.length() * random.power(-3.0, 0.3),
            _ => random.vector(),
        };
        let Some(dir) = scale_direction(dir) else { continue };
        bounds.push((
            "direction",
            bound_along(&pair, &differences, dir, scaled.least_gap(dir), &mut projections),
        ));
        leaves.set_direction(dir);
        let shared = leaves.bound_along_direction([0, 1, 2], [3, 4, 5]);
        let alone = bound_along(&pair, &differences, dir, scaled_others.least_gap(dir), &mut projections);
        assert_eq!(shared.to_bits(), alone.to_bits());
        projections.instructions = InstructionSet::Baseline;
        let in_baseline =
            bound_along(&pair, &differences, dir, scaled_others.least_gap(dir), &mut projections);
        projections.instructions = InstructionSet::default();
        assert_eq!(in_baseline.to_bits(), alone.to_bits());
        let distance = bound_rest_distance(&differences, dir, &scaled.rounding);
        if distance > 0.0 {
            for sufficient in [0.0, f64::INFINITY, random.power(-6.0, 6.0)] {
                let bound = affine.fit_and_bound(&pair, &differences, distance, sufficient, &scaled);
                bounds.push(("affine", bound));
            }
        }
    }
    let mut refiner = PairRefiner::new(&scaled);
    let (a, b) = ([0, 1, 2], [3, 4, 5]);
    bounds.push(("bound", refiner.bound(a, b, &mut far_target())));
    bounds.push(("refine", refiner.refine(a, b, &mut far_target())));
    let order = refiner.refine(b, a, &mut RefinementTarget { epsilon: 0.01, ..far_target() });
    bounds.push(("refine exchanged", order));
    bounds
}

/// Returns a hierarchy of two leaves: the first `split` triangles and the others.
fn two_leaves(split: u32, count: u32) -> Hierarchy {
    let leaf = |first_triangle, triangle_count| Node {
        first_triangle,
        triangle_count,
        first_child: 0,
        child_count: 0,
    };
    let root = Node { first_triangle: 0, triangle_count: count, first_child: 1, child_count: 2 };
    let nodes = vec![root, leaf(0, split), leaf(split, count - split)];
    Hierarchy::from_parts(nodes, (0..count).collect(), count as usize).unwrap()
}

/// Returns the bound of two nodes: the first `split` triangles and the others.
pub(super) fn node_pair_bound(model: &ReducedModel, split: u32) -> f64 {
    node_pair_bound_keeping(model, 0.0, split)
}

/// Returns this bound for nodes that keep a clearance.
pub(super) fn node_pair_bound_keeping(model: &ReducedModel, clearance: f64, split: u32) -> f64 {
    let scaled = scaled_keeping(model, clearance);
    let hierarchy = two_leaves(split, model.mesh().faces().len() as u32);
    let bounds = NodePairBounds::new(&scaled, &hierarchy);
    let mut scratch = NodePairScratch::new(scaled.row_len);
    let bound = bounds.bound(&scaled, 1, 2, f64::INFINITY, &mut scratch);
    scratch.instructions = InstructionSet::Baseline;
    let in_baseline = bounds.bound(&scaled, 1, 2, f64::INFINITY, &mut scratch);
    assert_eq!(in_baseline.to_bits(), bound.to_bits());
    bound
}
