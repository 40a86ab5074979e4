//! Tests the inequality of a certificate against exact arithmetic.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DMat3, DVec3};
use sscc_testing::{Dyadic, Numbers, common_denominator};

use super::*;
use crate::certificates::local::widest_gap::{parents, widest_gap};
use crate::certificates::test_models::ring;
use crate::filter::Relation;
use crate::test_models::square;
use crate::{CancelToken, ContactFilter, Modes, TriMesh};

fn exact(x: f64) -> Dyadic {
    Dyadic::new(x)
}

/// Returns the leaves of a node.
fn leaves_of(hierarchy: &Hierarchy, n: u32) -> Vec<u32> {
    let nodes = hierarchy.nodes();
    let node = &nodes[n as usize];
    let own = node.first_triangle..node.first_triangle + node.triangle_count;
    let is_own =
        |leaf: &u32| nodes[*leaf as usize].is_leaf() && own.contains(&nodes[*leaf as usize].first_triangle);
    (0..nodes.len() as u32).filter(is_own).collect()
}

/// `|(E_j - E_i) f| <= s_ij (kappa |W f| + rho T)` for the exact residuals of the modes, not for computed ones. Modes are affine
/// maps up to rounding, so that residuals are rounding alone, or have a part that is not affine.
#[test]
fn strains_are_at_least_those_of_exact_residuals() {
    let random = &mut Numbers(8);
    let (mut checked, mut close) = (0, 0);
    for case in 0..1500 {
        let (count, rank) = (2 + random.below(2) as u32, 1 + case % 3);
        let size = random.power(-4.0, -1.0);
        let middle = random.vector();
        let at = |i: u32| middle + (DVec3::X * 3.0 * f64::from(i / 3) + random.vector()) * size;
        let p: Vec<DVec3> = (0..3 * count).map(at).collect();
        // Translations up to a few units in the last place: in other cases the rounding of G hides that of residuals.
        let is_translation = case % 5 == 4;
        let noise = match (is_translation, case % 4) {
            (true, _) => 4.0 * f64::EPSILON,
            (false, 0) => random.power(-12.0, -2.0),
            _ => 0.0,
        };
        let slope = if is_translation { 0.0 } else { 1.0 };
        let ways: Vec<[DVec3; 3]> =
            (0..rank).map(|_| [random.vector(), random.vector() * slope, random.vector()]).collect();
        let mut modes = Vec::new();
        for x in &p {
            modes.extend(ways.iter().map(|[w, a, b]| *w * x.dot(*a) + *b + random.vector() * noise));
        }
        let faces: Vec<[u32; 3]> = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let mesh = TriMesh::new(p, faces.clone()).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(rank, modes).unwrap()).unwrap();
        let hierarchy = Hierarchy::build(&model, model.metric());
        let filter = PairFilter::new(&model, &ContactFilter::default());
        let center = vec![0.0; rank];
        let all = compute_local_certificates(&model, &hierarchy, &filter, &center, 1 << 20, &()).unwrap();
        if all.nodes != [0] || !all.bounds[0].ratio.is_finite() {
            continue;
        }
        let bounds = all.bounds[0];
        let patch_model = PatchModel::new(&model, &center).unwrap();
        let gaps = CornerGaps::new(&hierarchy, &filter, &patch_model.positions, &()).unwrap().unwrap();
        let gradient = |c: usize, j: usize, k: usize| {
            let e = 3 * j + c;
            exact(f64::from(if e < 8 { all.gradients[8 * k + e] } else { all.gradients[8 * rank + k] }))
        };
        let f: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
        let column =
            |k: usize, i: usize| f64::from(f32::from_bits(u32::from(all.ellipsoids[8 * k + i]) << 16));
        let image =
            (0..rank).map(|i| (0..rank).map(|k| column(k, i) * f[k]).sum::<f64>().powi(2)).sum::<f64>();
        let total: f64 = f.iter().map(|f| f.abs()).sum();
        let strain = (bounds.ratio * image.sqrt() + bounds.per_factor * total) * (1.0 + 1e-12);
        // Lengths are multiplied by the sizes of the modes, so that they have no quotients.
        let sizes: Vec<Dyadic> = (0..rank).map(|k| exact(model.mode_displacement_bound(k, 1.0))).collect();
        let (denominator, others) = common_denominator(&sizes);
        let displaced: Vec<[Dyadic; 3]> = (0..3 * count)
            .map(|v| {
                let of_vertex = model.modes().of_vertex(v);
                std::array::from_fn(|c| {
                    (0..rank).map(|k| exact(of_vertex[k][c]) * exact(f[k]) * &others[k]).sum()
                })
            })
            .collect();
        let turned: Vec<Vec<Dyadic>> = (0..3)
            .map(|c| (0..3).map(|j| (0..rank).map(|k| gradient(c, j, k) * exact(f[k])).sum()).collect())
            .collect();
        let table = gaps.near((0, 0)).unwrap().as_ref().unwrap();
        let vertices = gaps.vertices(0);
        for s in 0..count {
            for t in s + 1..count {
                assert_eq!(filter.relation(s, t), Relation::NonAdjacent);
                for (i, j) in faces[s as usize].into_iter().flat_map(|i| faces[t as usize].map(|j| (i, j))) {
                    let number = |v: u32| vertices.binary_search(&v).unwrap();
                    let at = |i: u32, j: u32| table.gaps[number(i) * vertices.len() + number(j)];
                    let gap = f64::from(at(i, j).min(at(j, i)));
                    let [x, y] = [i, j].map(|v| patch_model.positions[v as usize]);
                    let d: Vec<Dyadic> = (0..3).map(|c| exact(y[c]) - exact(x[c])).collect();
                    let square: Dyadic = (0..3)
                        .map(|c| {
                            let affine: Dyadic = (0..3).map(|k| &turned[c][k] * &d[k]).sum();
                            &displaced[j as usize][c] - &displaced[i as usize][c] - affine * &denominator
                        })
                        .map(|x| &x * &x)
                        .sum();
                    let bound = exact(gap) * exact(strain) * &denominator;
                    assert!(square <= &bound * &bound, "case {case}: {i} {j}");
                    checked += 1;
                    close += usize::from(square * exact(4.0) > &bound * &bound);
                }
            }
        }
    }
    assert!(checked > 5000 && close > 300, "{checked} {close}");
}

/// Returns a sheet of 14 x 14 cells with bumps in one corner, or two sheets with the same wave, one slightly above the other.
fn flat_sheets(random: &mut Numbers, layers: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let side = 14_u32;
    let row = side + 1;
    let (apart, phase) = (random.power(-7.0, -4.0), 3.0 * random.signed());
    let mut positions = Vec::new();
    for layer in 0..layers {
        for i in 0..row * row {
            let [x, y] = [i % row, i / row].map(|x| f64::from(x) / f64::from(side));
            let bump = if x.max(y) < 0.35 { 0.02 * random.signed() } else { 0.0 };
            let wave = 0.01 * (3.0 * x + 2.0 * y + phase).sin();
            positions.push(DVec3::new(
                x,
                y,
                if layers == 1 { bump } else { wave + f64::from(layer) * apart },
            ));
        }
    }
    let corners = |i: u32| [[i, i + 1, i + row], [i + 1, i + row + 1, i + row]];
    let of_layer = |layer: u32| {
        (0..side * side).flat_map(move |i| corners(layer * row * row + i / side * row + i % side))
    };
    (positions, (0..layers).flat_map(of_layer).collect())
}

/// Returns two triangles one above the other, far above the middle of two triangles that come first and are as long as the patch.
/// There are few pairs, so that the rounding of heights decides which share is the largest.
fn flat_triangles(random: &mut Numbers) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (apart, height) = (random.power(-7.0, -5.0), 0.03 * random.signed());
    let mut positions = Vec::new();
    for (middle, size, height, roughness) in [
        (-DVec3::X, 0.5, 0.0, 0.0),
        (DVec3::X, 0.5, 0.0, 0.0),
        (DVec3::ZERO, 0.01, height, 0.2 * apart),
        (DVec3::ZERO, 0.01, height + apart, 0.2 * apart),
    ] {
        // Centroids are in the middle, so that the direction across is the third axis.
        for corner in [DVec3::X, DVec3::Y, -DVec3::X - DVec3::Y] {
            positions.push(middle + corner * size + DVec3::Z * (height + roughness * random.signed()));
        }
    }
    (positions, (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

/// Returns two triangles of one plane whose tips nearly touch, far from the first triangle, which is in the plane, too. The
/// height of one tip above the other is about the smallest share of the gap that is distinguished, and not much more than the
/// rounding of offsets.
fn flat_tips(random: &mut Numbers) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let gap = random.power(-8.8, -8.7);
    let height = f64::from(LEAST_FLATNESS) * gap * (1.0 + 0.1 * random.signed().abs());
    let small = [DVec3::ZERO, DVec3::new(0.1, 0.05, 0.0), DVec3::new(0.1, -0.05, 0.0)];
    let first =
        [DVec3::new(-1.5, 0.5, 0.0), DVec3::new(-1.5, -0.5, 0.0), DVec3::new(-1.0, random.signed(), 0.0)];
    let tip = DVec3::new(1.3, random.signed(), 0.0);
    let left = small.map(|p| tip - p);
    let right = small.map(|p| tip + p + DVec3::new(gap, 0.0, height));
    ([first, left, right].concat(), (0..3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

/// `|a.(p_j - p_i)| <= phi s_ij` for the pairs of a flat patch, in exact arithmetic wherever it nearly fails.
#[test]
fn heights_are_at_most_their_share_of_gaps() {
    let random = &mut Numbers(21);
    let (mut checked, mut close, mut outside) = (0, 0, 0);
    for case in 0..4306 {
        let (positions, faces) = match case {
            0..6 => flat_sheets(random, 1 + case % 2),
            6..306 => flat_triangles(random),
            _ => flat_tips(random),
        };
        let axis = (random.vector() + DVec3::X * 1e-3).normalize();
        let turn = DMat3::from_axis_angle(axis, 3.0 * random.signed());
        let positions: Vec<DVec3> = positions.into_iter().map(|p| turn * p).collect();
        let modes = Modes::from_matrix(positions.len(), 1, |row, _| (row as f64).sin()).unwrap();
        let model = ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes).unwrap();
        let hierarchy = Hierarchy::build(&model, model.metric());
        let filter = PairFilter::new(&model, &ContactFilter::default());
        let all = compute_local_certificates(&model, &hierarchy, &filter, &[0.0], 1 << 20, &()).unwrap();
        let patch_model = PatchModel::new(&model, &[0.0]).unwrap();
        let gaps = CornerGaps::new(&hierarchy, &filter, &patch_model.positions, &()).unwrap().unwrap();
        let parents = parents(&hierarchy);
        let leaves = |n: u32| leaves_of(&hierarchy, n);
        for (index, n) in all.nodes.iter().enumerate() {
            let bounds = all.bounds[index];
            if !bounds.flatness.is_finite() {
                continue;
            }
            let across = DVec3::from_array(bounds.across);
            let list = &all.list_nodes[all.list_starts[index] as usize..all.list_starts[index + 1] as usize];
            let own: BTreeSet<u32> = leaves(*n).into_iter().collect();
            let around: BTreeSet<u32> = list.iter().flat_map(|m| leaves(*m)).collect();
            for (x, y) in own.iter().flat_map(|x| own.range(x..).chain(&around).map(|y| (*x, *y))) {
                let (x, y) = (x.min(y), x.max(y));
                let Some(Some(table)) = gaps.near((x, y)) else { continue };
                let pairs =
                    gaps.vertices(x).iter().flat_map(|i| gaps.vertices(y).iter().map(move |j| (*i, *j)));
                for ((i, j), gap) in pairs.zip(&table.gaps).filter(|(_, gap)| **gap < f32::INFINITY) {
                    checked += 1;
                    let [p, q] = [i, j].map(|v| patch_model.positions[v as usize]);
                    let is_near = |gap: f64| across.dot(q - p).abs() >= 0.98 * bounds.flatness * gap;
                    if x != y && !is_near(f64::from(*gap)) {
                        continue;
                    }
                    let gap = widest_gap(&gaps, &parents, (x, y), (i, j));
                    if !is_near(gap) {
                        continue;
                    }
                    // Exact arithmetic takes long.
                    let height: Dyadic = (0..3).map(|c| exact(across[c]) * (exact(q[c]) - exact(p[c]))).sum();
                    let limit = exact(bounds.flatness) * exact(gap);
                    assert!(height <= limit && -height <= limit, "case {case}: {i} {j} of node {n}");
                    close += 1;
                    outside += usize::from(!(own.contains(&x) && own.contains(&y)));
                }
            }
        }
    }
    assert!(checked > 1_000_000 && close > 1000 && outside > 30, "{checked} {close} {outside}");
}

/// `|(E_j - E_i) f| <= s_ij (kappa |W f| + rho T)` with the ratio of each node of a list, for pairs of that node and the
/// certificate's own. With one mode, whose f is 1 here, the largest quotient of all pairs is close to the ratio.
#[test]
fn ratios_of_lists_are_at_least_those_of_their_pairs() {
    let random = &mut Numbers(33);
    let (mut checked, mut close, mut of_parts) = (0, 0, 0);
    for case in 0..6 {
        let side = 16 + 6 * case;
        let flat = square(side);
        let bump = |p: &DVec3, random: &mut Numbers| *p + DVec3::Z * (0.3 * random.signed() / side as f64);
        let positions: Vec<DVec3> = flat.rest_positions().iter().map(|p| bump(p, random)).collect();
        let modes: Vec<DVec3> = positions
            .iter()
            .map(|p| {
                DVec3::new((4.0 * p.y).sin(), p.x * p.y, (5.0 * p.x).cos())
                    + random.vector() * random.power(-4.0, -1.0)
            })
            .collect();
        let mesh = TriMesh::new(positions, flat.faces().to_vec()).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(1, modes.clone()).unwrap()).unwrap();
        // Displacements count in units of the mode's size.
        let size = model.mode_displacement_bound(0, 1.0);
        let hierarchy = Hierarchy::build(&model, model.metric());
        let filter = PairFilter::new(&model, &ContactFilter::default());
        let all = compute_local_certificates(&model, &hierarchy, &filter, &[0.0], 1 << 20, &()).unwrap();
        let patch_model = PatchModel::new(&model, &[0.0]).unwrap();
        let gaps = CornerGaps::new(&hierarchy, &filter, &patch_model.positions, &()).unwrap().unwrap();
        let (nodes, parents) = (hierarchy.nodes(), parents(&hierarchy));
        let leaves = |n: u32| leaves_of(&hierarchy, n);
        for (index, n) in all.nodes.iter().enumerate() {
            assert_eq!(all.mode_starts[index + 1] - all.mode_starts[index], 1);
            let own = leaves(*n);
            let entries = &all.gradients[16 * index..][..9];
            let gradient = DMat3::from_cols_array(&std::array::from_fn(|e| f64::from(entries[e])));
            let image = f64::from(f32::from_bits(u32::from(all.ellipsoids[8 * index]) << 16)).abs();
            for of_list in all.list_starts[index]..all.list_starts[index + 1] {
                let (m, ratio) = (all.list_nodes[of_list as usize], all.list_ratios[of_list as usize]);
                let strain = f64::from(ratio) * image + all.bounds[index].per_factor;
                let is_part = !nodes[m as usize].fits_in_bucket();
                for (x, y) in leaves(m).iter().flat_map(|y| own.iter().map(move |x| (*x.min(y), *x.max(y)))) {
                    let Some(Some(table)) = gaps.near((x, y)) else { continue };
                    let pairs =
                        gaps.vertices(x).iter().flat_map(|i| gaps.vertices(y).iter().map(move |j| (*i, *j)));
                    for ((i, j), gap) in pairs.zip(&table.gaps).filter(|(_, gap)| **gap < f32::INFINITY) {
                        let [i, j] = [i, j].map(|v| v as usize);
                        let apart = patch_model.positions[j] - patch_model.positions[i];
                        let residual = ((modes[j] - modes[i]) / size - gradient * apart).length();
                        checked += 1;
                        if residual < 0.9 * strain * f64::from(*gap) {
                            continue;
                        }
                        let gap = widest_gap(&gaps, &parents, (x, y), (i as u32, j as u32));
                        assert!(
                            residual <= strain * gap * (1.0 + 1e-9),
                            "case {case}: {i} {j}, nodes {n} {m}"
                        );
                        let is_close = residual > 0.9 * strain * gap;
                        (close, of_parts) =
                            (close + u32::from(is_close), of_parts + u32::from(is_close && is_part));
                    }
                }
            }
        }
    }
    assert!(checked > 100_000 && close > 300 && of_parts > 10, "{checked} {close} {of_parts}");
}

/// A budget of 0 gives no certificates, and a larger one gives that of the root.
#[test]
fn a_budget_of_zero_gives_no_certificates() {
    let positions =
        (0..6).map(|i| DVec3::new(f64::from(i % 2), f64::from(i / 2 % 2), f64::from(i / 3))).collect();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let modes = Modes::from_matrix(6, 1, |row, _| (row as f64).sin()).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let hierarchy = Hierarchy::build(&model, model.metric());
    let filter = PairFilter::new(&model, &ContactFilter::default());
    let none = compute_local_certificates(&model, &hierarchy, &filter, &[0.0], 0, &()).unwrap();
    assert_eq!(none, LocalCertificates::default());
    let some = compute_local_certificates(&model, &hierarchy, &filter, &[0.0], 1 << 20, &()).unwrap();
    assert_eq!((some.nodes.as_slice(), some.modes.as_slice()), (&[0][..], &[0][..]));
    assert!(some.bytes() > 0 && some.bounds[0].per_error >= 1.0);
    // The ends of both lists of starts.
    assert_eq!(some.budgeted_bytes(), LocalCertificates::bytes_of(1));
    assert_eq!(some.bytes() - some.budgeted_bytes(), 8);
    assert_eq!((none.bytes(), none.budgeted_bytes()), (0, 0));
}

/// The computation checks for cancellation regularly, and ends with the error if it was cancelled at any of these checks.
#[test]
fn a_cancelled_computation_ends_with_an_error() {
    let model = ring(600, 3, 0.4);
    let hierarchy = Hierarchy::build(&model, model.metric());
    let filter = PairFilter::new(&model, &ContactFilter::default());
    let compute = |most: usize| {
        let checks = Arc::new(AtomicUsize::new(0));
        let counted = Arc::clone(&checks);
        let token = CancelToken::when(move || counted.fetch_add(1, Ordering::Relaxed) >= most);
        // On one thread the number of checks is always the same.
        let found = parallel::on_threads(Some(1), || {
            compute_local_certificates(&model, &hierarchy, &filter, &[0.0; 3], 1 << 30, &token)
        });
        (found.err(), checks.load(Ordering::Relaxed))
    };
    let (error, all) = compute(usize::MAX);
    assert!(error.is_none() && all > 20, "{error:?} {all}");
    for most in [0, 1, all / 2, all - 1] {
        assert_eq!(compute(most).0, Some(Error::Cancelled), "{most} of {all}");
    }
}

/// Buckets, nodes at odd heights above them and the root have a certificate, but never nodes within buckets.
#[test]
fn certified_nodes_are_at_odd_heights_and_buckets() {
    for quads in [3, 40, 200, 3000] {
        let model = ring(quads, 1, 0.4);
        let hierarchy = Hierarchy::build(&model, model.metric());
        let (nodes, parents) = (hierarchy.nodes(), parents(&hierarchy));
        let is_bucket = |n: u32| {
            let is_small = |n: u32| nodes[n as usize].fits_in_bucket();
            is_small(n) && (n == 0 || !is_small(parents[n as usize]))
        };
        // Ascends from each bucket.
        let mut heights = vec![None; nodes.len()];
        for mut n in (0..nodes.len() as u32).filter(|n| is_bucket(*n)) {
            let mut height = 0;
            loop {
                heights[n as usize] = heights[n as usize].max(Some(height));
                if n == 0 {
                    break;
                }
                (n, height) = (parents[n as usize], height + 1);
            }
        }
        let wanted = |n: &u32| heights[*n as usize].is_some_and(|h| *n == 0 || h == 0 || h % 2 == 1);
        let expected: Vec<u32> = (0..nodes.len() as u32).filter(wanted).collect();
        assert_eq!(certified_nodes(&hierarchy), expected, "{quads} quads");
        assert_eq!(quads == 3000, heights.iter().flatten().any(|h| *h > 2), "{quads} quads");
    }
}

/// The four parts of a sheet have certificates of 20, 5, 5 and 5 modes, and the whole sheet one of 30.
#[test]
fn certificates_of_few_modes_are_kept_if_they_cover_most() {
    let mesh = square(40);
    let modes = Modes::from_matrix(mesh.rest_positions().len(), 1, |_, _| 1e-3).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let hierarchy = Hierarchy::build(&model, model.metric());
    let children: Vec<u32> = hierarchy.nodes()[0].children().collect();
    assert_eq!(children.len(), 4);
    let share = |n: u32| f64::from(hierarchy.nodes()[n as usize].triangle_count) / 3200.0;
    assert!(share(children[1]) + share(children[2]) < LEAST_PROVEN_SHARE, "{children:?}");
    let certificate = |modes: usize| LocalCertificate {
        modes: vec![0; modes],
        gradients: Vec::new(),
        ellipsoid: Vec::new(),
        bounds: LocalBounds::default(),
        list: Vec::new(),
    };
    let kept = |most_bytes: usize| -> Vec<u32> {
        let nodes = std::iter::once(0).chain(children.iter().copied());
        let mut found: Vec<_> =
            nodes.zip([30, 20, 5, 5, 5]).map(|(n, modes)| (n, certificate(modes))).collect();
        keep_within(&mut found, &hierarchy, most_bytes);
        found.into_iter().map(|(n, _)| n).collect()
    };
    let [few, some, all] = [5, 20, 30].map(LocalCertificates::bytes_of);
    assert_eq!(kept(3 * few + some + all), [&[0], &children[..]].concat());
    assert_eq!(kept(3 * few + some + all - 1), children);
    assert_eq!(kept(3 * few + some - 1), children[1..]);
    assert!(kept(3 * few - 1).is_empty());
}

/// The ellipsoid is fitted to residuals of a few vertices over their distances, and to differences of residuals over gaps.
#[test]
fn ellipsoids_are_fitted_to_a_few_quotients_of_residuals() {
    let model = ring(600, 3, 0.4);
    let hierarchy = Hierarchy::build(&model, model.metric());
    let filter = PairFilter::new(&model, &ContactFilter::default());
    let patch_model = PatchModel::new(&model, &[0.0; 3]).unwrap();
    let gaps = CornerGaps::new(&hierarchy, &filter, &patch_model.positions, &()).unwrap().unwrap();
    let touching = TouchingNodes::new(&hierarchy, &filter);
    let builder = Builder { model: &patch_model, gaps: &gaps, touching: &touching };
    let mut patch = Patch::new(patch_model.positions.len());
    patch.load(&patch_model, &hierarchy, filter.faces(), [0].into_iter(), MOST_MODES).unwrap();
    let width = 3 * patch.row_len;
    let residual = |i: u32| &patch.residuals[width * i as usize..][..width];
    let tight = builder.tight(0, &patch);
    assert!(tight.len() > 2 * TIGHT_BLOCKS, "{}", tight.len());
    let parts = tight.len().div_ceil(tight.len().div_ceil(TIGHT_BLOCKS));
    let difference = |TightPair { i, j, gap }: TightPair| -> Vec<f64> {
        residual(i).iter().zip(residual(j)).map(|(x, y)| (y - x) / f64::from(gap)).collect()
    };
    let differences: Vec<Vec<f64>> = tight.into_iter().map(|(_, pair)| difference(pair)).collect();
    let blocks = builder.blocks(0, &patch);
    let is_difference = |block: &[f64]| differences.iter().any(|difference| difference.as_slice() == block);
    let of_pairs = blocks.chunks_exact(width).filter(|block| is_difference(block)).count();
    assert_eq!(of_pairs, parts + TIGHT_BLOCKS / 2);
    let of_vertices = blocks.len() / width - of_pairs;
    assert!(of_vertices > VERTEX_BLOCKS / 2 && of_vertices <= VERTEX_BLOCKS, "{of_vertices}");
}

/// A model with the tables of its leaves, for tests of the parts of a builder.
struct Case {
    model: ReducedModel,
    hierarchy: Hierarchy,
    filter: PairFilter,
}

impl Case {
    fn ring(quads: usize, rank: usize) -> Self {
        let model = ring(quads, rank, 0.4);
        let hierarchy = Hierarchy::build(&model, model.metric());
        let filter = PairFilter::new(&model, &ContactFilter::default());
        Self { model, hierarchy, filter }
    }

    fn with_builder(&self, check: impl FnOnce(&Builder<'_>)) {
        let Self { model, hierarchy, filter } = self;
        let patch_model = PatchModel::new(model, &vec![0.0; model.rank()]).unwrap();
        let gaps = CornerGaps::new(hierarchy, filter, &patch_model.positions, &()).unwrap().unwrap();
        let touching = TouchingNodes::new(hierarchy, filter);
        check(&Builder { model: &patch_model, gaps: &gaps, touching: &touching });
    }
}

/// Returns the nodes around a node, and the nodes of its patch.
fn patch_nodes(builder: &Builder<'_>, n: u32) -> (Vec<u32>, Vec<u32>) {
    let around = builder.touching.around(n);
    let top = around.iter().copied().filter(|m| !builder.touching.has_parent(*m, &around));
    let nodes = std::iter::once(n).chain(top).collect();
    (around, nodes)
}

/// Loads the patch of these nodes.
fn load(builder: &Builder<'_>, patch: &mut Patch, nodes: &[u32]) {
    let CornerGaps { hierarchy, filter, .. } = builder.gaps;
    patch.load(builder.model, hierarchy, filter.faces(), nodes.iter().copied(), MOST_MODES).unwrap();
}

/// The ratios of lists are those of searches that begin at the ratio of the node.
#[test]
fn error_terms_are_products_of_norms_over_the_smallest_gap() {
    let case = Case::ring(60, 3);
    let (mut near, mut listed) = (0, 0);
    case.with_builder(|builder| {
        let mut scratch = Scratch::new(builder.model.positions.len());
        for n in certified_nodes(&case.hierarchy) {
            let LocalCertificate { bounds, list, .. } = builder.certify(n, &mut scratch).unwrap();
            let Scratch { instructions, patch, search, images } = &mut scratch;
            let gap = search.smallest_gap.min(1.0);
            let blocks = builder.blocks(n, patch);
            let fit = FitEllipsoid { blocks: &blocks, rank: patch.modes.len(), row_len: patch.row_len };
            let ellipsoid = instructions.run(fit).unwrap();
            assert_eq!((bounds.steepest, bounds.widest), (patch.steepest(), ellipsoid.largest_column()));
            let quotient = bounds.per_error * gap;
            assert!((1.0..1.0 + 1e-11).contains(&quotient), "node {n}: {quotient}");
            // 64 units of 2^-53.
            let of_residuals = 2.0_f64.powi(-47) * (2.0 + patch.steepest() * patch.longest());
            let of_images = 2.0 * ellipsoid.defect() * patch.largest_residual();
            let quotient = bounds.per_factor * gap / (of_residuals + of_images);
            assert!((quotient - 1.0).abs() < 1e-9, "node {n}: {quotient}");
            near += u32::from(gap < 0.5);

            // Heights may have replaced the images.
            let (around, nodes) = patch_nodes(builder, n);
            assert_eq!(list.iter().map(|(m, _)| *m).collect::<Vec<u32>>(), around, "node {n}");
            let parts = search.load(builder.gaps, patch, nodes.iter().copied());
            let largest_image = patch.images(&ellipsoid, images, &mut search.images);
            search.begin(largest_image);
            for (m, ratio) in list {
                let part = parts.iter().copied().find(|part| search.node(*part).0 == m);
                let Some(part) = part.filter(|part| search.node(*part).1.is_none()) else { continue };
                let found = search.between(builder.gaps, (0, part), bounds.ratio as f32);
                assert_eq!(ratio, infinite_for_nan(found), "nodes {n} {m}");
                listed += 1;
            }
        }
    });
    assert!(near > 0 && listed > 2, "{near} {listed}");
}

/// Images that no listed bucket has are far larger than the others, so that ratios of other nodes would show.
#[test]
fn lists_have_the_nodes_that_share_a_vertex_with_ratios_of_their_own() {
    let case = Case::ring(300, 2);
    let random = &mut Numbers(12);
    let (mut buckets, mut larger, mut mixed) = (0, 0, 0);
    case.with_builder(|builder| {
        let nodes = case.hierarchy.nodes();
        let mut patch = Patch::new(builder.model.positions.len());
        let mut search = StrainSearch::default();
        for n in nodes[0].children() {
            let (around, of_patch) = patch_nodes(builder, n);
            load(builder, &mut patch, &of_patch);
            let parts = search.load(builder.gaps, &patch, of_patch.iter().copied());
            let is_bucket = |m: &u32| nodes[*m as usize].fits_in_bucket();
            let mut is_listed = vec![false; patch.vertices.len()];
            for m in std::iter::once(n).chain(around.iter().copied().filter(is_bucket)) {
                for v in case.hierarchy.vertices(&nodes[m as usize], case.filter.faces()) {
                    is_listed[patch.numbers[v as usize] as usize] = true;
                }
            }
            let width = 3 * patch.row_len;
            search.images.clear();
            for e in 0..patch.vertices.len() * width {
                let size = if is_listed[e / width] { 1.0 } else { 1e3 };
                search.images.push((size * random.signed()) as f32);
            }
            search.begin(1e3 * (width as f64).sqrt());
            let mut list = Vec::new();
            for part in &parts[1..] {
                builder.list(&mut search, &around, *part, 0.0, &mut list);
            }
            list.sort_unstable_by_key(|(m, _)| *m);
            assert_eq!(list.iter().map(|(m, _)| *m).collect::<Vec<u32>>(), around, "node {n}");
            let mut stack = parts[1..].to_vec();
            while let Some(part) = stack.pop() {
                let (m, children) = search.node(part);
                let Ok(at) = around.binary_search(&m) else { continue };
                if let Some(children) = children {
                    let is_touching = |part: u32| around.binary_search(&search.node(part).0).is_ok();
                    mixed +=
                        u32::from(children.clone().any(is_touching) && !children.clone().all(is_touching));
                    stack.extend(children);
                }
                let ratio = list[at].1;
                let alone = search.between(builder.gaps, (0, part), 0.0);
                assert!(alone.is_finite(), "nodes {n} {m}");
                if is_bucket(&m) {
                    assert_eq!(ratio, alone, "nodes {n} {m}");
                    buckets += 1;
                } else {
                    // Accepted ratios are up to 1.1 times the largest one, singular values up to 1.07 times.
                    assert!(ratio <= 1.2 * alone && alone <= 1.2 * ratio, "nodes {n} {m}: {ratio} {alone}");
                    larger += 1;
                }
            }
        }
    });
    assert!(buckets > 3 && larger > 0 && mixed > 0, "{buckets} {larger} {mixed}");
}

/// Returns the index of the largest number.
fn largest_of(numbers: &[f64]) -> usize {
    (0..numbers.len()).fold(0, |best, i| if numbers[i] > numbers[best] { i } else { best })
}

/// The largest pair of each part of the list comes first, then the largest of all pairs.
#[test]
fn blocks_are_quotients_of_residuals_of_vertices_and_of_the_largest_pairs() {
    let case = Case::ring(80, 3);
    let mut others = 0;
    case.with_builder(|builder| {
        let mut patch = Patch::new(builder.model.positions.len());
        for n in certified_nodes(&case.hierarchy) {
            load(builder, &mut patch, &patch_nodes(builder, n).1);
            let own = leaves_of(&case.hierarchy, n);
            let number = |v: u32| patch.vertices.iter().position(|w| *w == v).map(|i| i as u32);
            let mut expected = Vec::new();
            for (leaf, pair) in own.iter().flat_map(|leaf| builder.gaps.tight(*leaf)) {
                if let (Some(i), Some(j)) = (number(pair.i), number(pair.j)) {
                    expected.push((*leaf, i, j, pair.gap.to_bits()));
                }
            }
            expected.sort_unstable();
            let tight = builder.tight(n, &patch);
            let mut found: Vec<_> =
                tight.iter().map(|(leaf, TightPair { i, j, gap })| (*leaf, *i, *j, gap.to_bits())).collect();
            found.sort_unstable();
            assert_eq!(found, expected, "node {n}");
            let key = |pair: &TightPair| (pair.i, pair.j, pair.gap.to_bits());
            let within: Vec<_> =
                tight.iter().filter(|(leaf, _)| own.contains(leaf)).map(|(_, pair)| key(pair)).collect();
            let found: Vec<_> = builder.tight_within(n, &patch).iter().map(key).collect();
            assert_eq!(found, within, "node {n}");
            others += tight.len() - within.len();

            let width = 3 * patch.row_len;
            let residual = |i: usize| &patch.residuals[width * i..][..width];
            let norm = |block: &[f64]| block.iter().map(|x| x * x).sum::<f64>().sqrt();
            let all = builder.blocks(n, &patch);
            let mut blocks = all.chunks_exact(width);
            for i in (1..patch.vertices.len()).step_by(patch.vertices.len().div_ceil(VERTEX_BLOCKS)) {
                let distance = patch.offsets[i].length();
                let expected: Vec<f64> = residual(i).iter().map(|x| x / distance).collect();
                assert_eq!(blocks.next().unwrap(), expected, "node {n}: {i}");
            }
            let mut of_pairs: Vec<Vec<f64>> = Vec::new();
            for (_, TightPair { i, j, gap }) in &tight {
                let pairs = residual(*i as usize).iter().zip(residual(*j as usize));
                of_pairs.push(pairs.map(|(x, y)| (y - x) / f64::from(*gap)).collect());
            }
            let mut norms: Vec<f64> = of_pairs.iter().map(|block| norm(block)).collect();
            let part = tight.len().div_ceil(TIGHT_BLOCKS).max(1);
            for (of_pairs, norms) in of_pairs.chunks(part).zip(norms.chunks(part)) {
                let found = norm(blocks.next().unwrap());
                let expected = norm(&of_pairs[largest_of(norms)]);
                assert!((found - expected).abs() <= 1e-12 * expected, "node {n}: {found} {expected}");
            }
            norms.sort_by(|a, b| b.total_cmp(a));
            for expected in &norms[..norms.len().min(TIGHT_BLOCKS / 2)] {
                let block = blocks.next().unwrap();
                assert!(of_pairs.iter().any(|of_pair| of_pair == block), "node {n}");
                assert!((norm(block) - expected).abs() <= 1e-12 * expected, "node {n}: {expected}");
            }
            assert!(blocks.next().is_none());
            // A vertex at the place of the first one has no quotient.
            patch.offsets[1] = DVec3::ZERO;
            assert_eq!(builder.blocks(n, &patch), all[width..], "node {n}");
        }
    });
    assert!(others > 0);
}

/// Eight entries of each mode come first, then the ninth entries of all modes, and zeros.
#[test]
fn gradients_are_stored_column_by_column() {
    let row_len = 16;
    for count in [1, 3, 8, 11] {
        let mut patch = Patch::new(0);
        patch.modes = (0..count as u32).collect();
        patch.row_len = row_len;
        patch.gradient = (0..9 * row_len as u32).map(f64::from).collect();
        let numbers = gradients(&patch);
        assert_eq!(numbers.len(), gradient_len(count));
        for (k, e) in (0..count).flat_map(|k| (0..9).map(move |e| (k, e))) {
            let (column, row) = (e / 3, e % 3);
            let stored = numbers[if e < 8 { 8 * k + e } else { 8 * count + k }];
            assert_eq!(
                f64::from(stored),
                patch.gradient[(3 * row + column) * row_len + k],
                "{count}: {k} {e}"
            );
        }
        assert!(numbers[9 * count..].iter().all(|x| *x == 0.0));
    }
}

/// Each entry of a list takes eight bytes.
#[test]
fn lists_count_as_memory() {
    let Case { hierarchy, .. } = Case::ring(10, 1);
    let is_kept = |most_bytes: usize| {
        let certificate = LocalCertificate {
            modes: vec![0; 3],
            gradients: Vec::new(),
            ellipsoid: Vec::new(),
            bounds: LocalBounds::default(),
            list: vec![(0, 0.0); 5],
        };
        let mut found = vec![(0, certificate)];
        keep_within(&mut found, &hierarchy, most_bytes);
        !found.is_empty()
    };
    let bytes = LocalCertificates::bytes_of(3) + 40;
    assert!(is_kept(bytes) && !is_kept(bytes - 1));
}

#[test]
fn folded_neighbours_have_no_certificates() {
    let Case { model, hierarchy, filter } = Case::ring(10, 1);
    let folded = PairFilter::new(&model, &ContactFilter::new(Neighbours::IncludeFolded));
    for (filter, has_certificates) in [(&filter, true), (&folded, false)] {
        let all = compute_local_certificates(&model, &hierarchy, filter, &[0.0], 1 << 20, &()).unwrap();
        assert_eq!(all != LocalCertificates::default(), has_certificates);
    }
}

/// Heights above a plane are within rounding, so that the bound is the smallest one that is distinguished.
#[test]
fn only_flat_patches_have_a_direction_across() {
    let mesh = square(6);
    let modes = Modes::from_matrix(mesh.rest_positions().len(), 1, |row, _| (row as f64).sin()).unwrap();
    let flat = ReducedModel::new(mesh, modes).unwrap();
    for (model, is_flat) in [(&flat, true), (&ring(60, 1, 0.4), false)] {
        let hierarchy = Hierarchy::build(model, model.metric());
        let filter = PairFilter::new(model, &ContactFilter::default());
        let all = compute_local_certificates(model, &hierarchy, &filter, &[0.0], 1 << 20, &()).unwrap();
        assert_eq!(all.nodes[0], 0);
        let LocalBounds { across: [x, y, z], flatness, .. } = all.bounds[0];
        if is_flat {
            assert!(x.abs().max(y.abs()) < 1e-9 && (z.abs() - 1.0).abs() < 1e-9, "{x} {y} {z}");
            let least = f64::from(LEAST_FLATNESS);
            assert!((least..1.2 * least).contains(&flatness), "{flatness}");
        } else {
            assert_eq!(([x, y, z], flatness), ([0.0; 3], f64::INFINITY));
        }
    }
}

#[test]
fn starts_of_kept_certificates_have_32_bits() {
    assert_eq!([0, 1, 1 << 30].map(addressed_bytes), [0, 1, 1 << 30]);
    // A number of a list takes 8 bytes, and a start counts numbers.
    assert!(addressed_bytes(usize::MAX) / 8 <= u32::MAX as usize);
}
