//! Tests ratios and spreads against all pairs, in double precision.

use sscc_testing::{FlexibleShape, Numbers, Shape};

use super::*;
use crate::certificates::local::patch_model::PatchModel;
use crate::certificates::local::widest_gap::{parents, widest_gap};
use crate::filter::{PairFilter, Relation};
use crate::hierarchy::Hierarchy;
use crate::{ContactFilter, Modes, Neighbours, ReducedModel, TriMesh};

/// Returns a lower bound of the largest singular value of three rows: the longest image of three vectors after 64 products with
/// the Gram matrix. Its power is computed by squaring, which takes less time than one product after another.
fn singular_value(rows: &[f64]) -> f64 {
    let row_len = rows.len() / 3;
    let row = |c: usize| &rows[c * row_len..][..row_len];
    let dot = |a: usize, b: usize| row(a).iter().zip(row(b)).map(|(x, y)| x * y).sum::<f64>();
    let gram: [[f64; 3]; 3] = std::array::from_fn(|a| std::array::from_fn(|b| dot(a, b)));
    let mut power = gram;
    for _ in 0..6 {
        let trace = power[0][0] + power[1][1] + power[2][2];
        if trace == 0.0 {
            return 0.0;
        }
        // Scaling keeps the directions, and the numbers in range.
        let scaled = power.map(|row| row.map(|x| x / trace));
        let entry = |a: usize, b: usize| (0..3).map(|c| scaled[a][c] * scaled[c][b]).sum::<f64>();
        power = std::array::from_fn(|a| std::array::from_fn(|b| entry(a, b)));
    }
    let times = |matrix: &[[f64; 3]; 3], x: &[f64; 3]| -> [f64; 3] {
        std::array::from_fn(|a| (0..3).map(|b| matrix[a][b] * x[b]).sum())
    };
    let product = |x: &[f64; 3], y: &[f64; 3]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let mut best = 0.0_f64;
    for start in [[1.0, 0.3, 0.2], [0.1, 1.0, -0.4], [-0.3, 0.2, 1.0]] {
        let x = times(&power, &start);
        best = best.max(product(&times(&gram, &x), &x) / product(&x, &x));
    }
    best.sqrt()
}

#[test]
fn singular_values_are_at_least_exact() {
    let random = &mut Numbers(9);
    for case in 0..3000 {
        let row_len = [8, 16, 40, 200][case % 4];
        let size = random.power(-12.0, 12.0);
        let base: Vec<f64> = (0..row_len).map(|_| random.signed()).collect();
        let mix = random.power(-6.0, 0.5);
        // Rows that are nearly one row times three numbers have a singular value of up to the root of three times the longest.
        let weights = random.vector();
        let weights = if case % 3 == 0 { [1.0; 3] } else { weights.to_array() };
        let x: Vec<f32> = (0..3 * row_len)
            .map(|i| ((weights[i / row_len] * base[i % row_len] + mix * random.signed()) * size) as f32)
            .collect();
        let y = vec![0.0; 3 * row_len];
        let exact = singular_value(&x.iter().map(|x| f64::from(*x)).collect::<Vec<_>>());
        let bound = f64::from(largest_singular_value(&x, &y) * ROUND_UP);
        assert!(bound >= exact, "case {case}: {bound} {exact}");
        assert!(bound <= exact * 1.05, "case {case}: {bound} {exact}");
        let frobenius = f64::from(squared_distance(&x, &y).sqrt() * ROUND_UP);
        let exact = x.iter().map(|x| f64::from(*x) * f64::from(*x)).sum::<f64>().sqrt();
        assert!(frobenius >= exact && bound <= frobenius * 1.04, "case {case}: {frobenius} {exact}");
    }
    assert_eq!(largest_singular_value(&[0.0; 24], &[0.0; 24]), 0.0);
    for odd in [f32::NAN, f32::INFINITY, 1e30] {
        assert!(!largest_singular_value(&[odd; 24], &[0.0; 24]).is_finite());
    }
}

/// Returns the distance of two images.
fn distance(x: &[f32], y: &[f32]) -> f64 {
    let square = |(x, y): (&f32, &f32)| (f64::from(*x) - f64::from(*y)).powi(2);
    x.iter().zip(y).map(square).sum::<f64>().sqrt()
}

/// Also of images that are large beside their difference. A bound of the singular value is above it without any
/// further rounding up.
#[test]
fn distances_and_singular_values_are_those_of_differences() {
    let random = &mut Numbers(10);
    for case in 0..600 {
        let row_len = [8, 16, 40][case % 3];
        let (size, share) = (random.power(-6.0, 6.0), random.power(-3.0, 0.0));
        let base: Vec<f64> = (0..row_len).map(|_| random.signed()).collect();
        let weights = random.vector().to_array();
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for i in 0..3 * row_len {
            // In every second case the three rows of the difference are one row times three numbers.
            let parallel = weights[i / row_len] * base[i % row_len];
            let change = if case % 2 == 0 { parallel } else { random.signed() };
            let middle = random.signed();
            x.push((size * middle) as f32);
            y.push((size * (middle + share * change)) as f32);
        }
        let difference: Vec<f64> = x.iter().zip(&y).map(|(x, y)| f64::from(*y) - f64::from(*x)).collect();
        let (exact, bound) = (singular_value(&difference), f64::from(largest_singular_value(&x, &y)));
        assert!(bound > exact && bound < 1.06 * exact, "case {case}: {bound} {exact}");
        let (exact, found) = (distance(&x, &y), f64::from(squared_distance(&x, &y).sqrt()));
        assert!((found / exact - 1.0).abs() < 2e-6, "case {case}: {found} {exact}");
    }
}

#[test]
fn nan_is_the_largest_ratio() {
    for other in [0.0, 1.0, f32::INFINITY, f32::NAN] {
        assert!(larger(f32::NAN, other).is_nan() && larger(other, f32::NAN).is_nan());
    }
    assert_eq!(larger(1.0, 2.0), 2.0);
    assert_eq!(larger(f32::INFINITY, 2.0), f32::INFINITY);
    assert_eq!(larger(0.0, f32::INFINITY), f32::INFINITY);
}

/// A model whose whole mesh is one patch, for tests with given images.
struct Case {
    model: ReducedModel,
    hierarchy: Hierarchy,
    filter: PairFilter,
}

impl Case {
    fn new(positions: Vec<DVec3>, faces: Vec<[u32; 3]>, neighbours: Neighbours) -> Self {
        let modes = Modes::from_matrix(positions.len(), 1, |row, _| (row as f64).sin()).unwrap();
        Self::with_modes(TriMesh::new(positions, faces).unwrap(), modes, neighbours)
    }

    /// Returns a case of triangles with these corners. Nodes consist of triangles that are near each other.
    fn of_triangles(positions: Vec<DVec3>) -> Self {
        // A mode that is the position separates the same triangles.
        let modes = Modes::new(1, positions.clone()).unwrap();
        let faces = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Self::with_modes(TriMesh::new(positions, faces).unwrap(), modes, Neighbours::Exclude)
    }

    fn with_modes(mesh: TriMesh, modes: Modes, neighbours: Neighbours) -> Self {
        let model = ReducedModel::new(mesh, modes).unwrap();
        let hierarchy = Hierarchy::build(&model, model.metric());
        let filter = PairFilter::new(&model, &ContactFilter::new(neighbours));
        Self { model, hierarchy, filter }
    }
}

/// Returns random images with a common part: three rows for each vertex of the patch.
fn images(random: &mut Numbers, count: usize, width: usize) -> Vec<f64> {
    let common: Vec<f64> = (0..width).map(|_| random.signed() * 1e3).collect();
    let size = random.power(-5.0, 2.0);
    (0..count * width).map(|i| common[i % width] + size * random.signed()).collect()
}

/// Calls `check` with the search over all of a mesh with random images.
fn with_search(
    case: &Case,
    random: &mut Numbers,
    check: impl FnOnce(&mut StrainSearch, &CornerGaps<'_>, &Patch, &[f64]),
) {
    let Case { model, hierarchy, filter } = case;
    let patch_model = PatchModel::new(model, &vec![0.0; model.rank()]).unwrap();
    let gaps = CornerGaps::new(hierarchy, filter, &patch_model.positions, &()).unwrap().unwrap();
    let mut patch = Patch::new(model.mesh().rest_positions().len());
    patch.load(&patch_model, hierarchy, filter.faces(), [0].into_iter(), 200).unwrap();
    let mut search = StrainSearch::default();
    search.load(&gaps, &patch, [0].into_iter());
    let exact = images(random, patch.vertices.len(), search.width);
    search.images = exact.iter().map(|x| *x as f32).collect();
    let norm = |rows: &[f64]| rows.iter().map(|x| x * x).sum::<f64>().sqrt();
    let largest = exact.chunks(search.width).map(norm).fold(0.0, f64::max) * (1.0 + 1e-12);
    search.begin(largest);
    check(&mut search, &gaps, &patch, &exact);
}

#[test]
fn images_are_within_the_spread_of_their_part() {
    let mut checked = 0;
    for seed in 0..14 {
        let random = &mut Numbers(seed);
        let shape = FlexibleShape::new(seed, Shape::ALL[seed as usize % 7], 1);
        let case = Case::new(shape.positions, shape.faces, Neighbours::Exclude);
        with_search(&case, random, |search, _, _, _| {
            for part in 0..search.parts.len() as u32 {
                let mut below = vec![part];
                while let Some(next) = below.pop() {
                    let Part { first_child, child_count, .. } = search.parts[next as usize];
                    below.extend(first_child..first_child + child_count);
                    for i in search.leaf_vertices(next) {
                        let pairs = search.mean(part).iter().zip(search.image(*i));
                        let square: f64 = pairs.map(|(x, y)| (f64::from(*x) - f64::from(*y)).powi(2)).sum();
                        assert!(square.sqrt() <= f64::from(search.parts[part as usize].spread));
                        checked += 1;
                    }
                }
            }
        });
    }
    assert!(checked > 10_000, "{checked}");
}

/// Returns 64 triangles in cells of two rows and two layers, as a case. All of them have gaps; some leaves are
/// near each other, and others are not.
fn cells_of_triangles(random: &mut Numbers) -> Case {
    let cell = |v: u32| DVec3::new(f64::from(v / 12), f64::from(v / 6 % 2), f64::from(v / 3 % 2));
    Case::of_triangles((0..192).map(|v| cell(v) + random.vector() * 0.2).collect())
}

/// Spreads have room for the rounding of distances at each level.
#[test]
fn means_and_spreads_are_those_of_vertices_and_parts_below() {
    let random = &mut Numbers(59);
    with_search(&cells_of_triangles(random), &mut Numbers(4), |search, _, _, _| {
        assert!(search.parts.len() > 8, "{}", search.parts.len());
        search.images.iter_mut().for_each(|x| *x = random.signed() as f32);
        search.begin(1.0);
        for (p, part) in search.parts.iter().enumerate() {
            let children = part.first_child..part.first_child + part.child_count;
            let is_leaf = children.is_empty();
            let (below, round_up): (Vec<(&[f32], f32)>, f64) = if is_leaf {
                (search.leaf_vertices(p as u32).iter().map(|i| (search.image(*i), 0.0)).collect(), 1.0)
            } else {
                let child = |c: u32| (search.mean(c), search.parts[c as usize].spread);
                (children.map(child).collect(), f64::from(ROUND_UP))
            };
            let mean = search.mean(p as u32);
            for k in 0..search.width {
                let sum: f64 = below.iter().map(|(x, _)| f64::from(x[k])).sum();
                let expected = sum / below.len() as f64;
                assert!((f64::from(mean[k]) - expected).abs() < 2e-6, "{p}: {} {expected}", mean[k]);
            }
            let spreads = below.iter().map(|(x, spread)| distance(mean, x) * round_up + f64::from(*spread));
            let expected = spreads.fold(0.0, f64::max) * f64::from(ROUND_UP);
            assert!(
                (f64::from(part.spread) / expected - 1.0).abs() < 2e-6,
                "{p}: {} {expected}",
                part.spread
            );
        }
    });
}

/// Parts are replaced by the parts below until all pairs of leaves were compared, whichever of two parts is given
/// first. Checks for cancellation change nothing.
#[test]
fn ratios_of_parts_are_those_of_all_of_their_leaves() {
    let random = &mut Numbers(58);
    let case = cells_of_triangles(random);
    let parents = parents(&case.hierarchy);
    with_search(&case, &mut Numbers(4), |search, gaps, _, _| {
        search.images.iter_mut().for_each(|x| *x = random.signed() as f32);
        // No image is longer.
        search.begin((search.width as f64).sqrt());
        let parts = search.parts.clone();
        let leaves: Vec<usize> = (0..parts.len()).filter(|p| parts[*p].child_count == 0).collect();
        // The largest ratios of each two leaves: with the widest gap that may be used, and with that of the leaves.
        let mut ratios = vec![vec![[0.0_f64; 2]; parts.len()]; parts.len()];
        for (x, y) in leaves.iter().flat_map(|x| leaves.iter().map(move |y| (*x, *y))) {
            let nodes = (parts[x].node, parts[y].node);
            if nodes.0 > nodes.1 {
                continue;
            }
            let mut components = [Vec::new(), Vec::new()];
            let near = gaps.near(nodes).map(|table| table.as_ref().unwrap());
            let are_apart = near.is_some() || gaps.components(nodes, &mut components).is_some();
            assert!(are_apart, "leaves {x} {y}");
            let [of_x, of_y] = [x, y].map(|part| search.leaf_vertices(part as u32));
            let mut largest = [0.0_f64; 2];
            for (a, b) in (0..of_x.len()).flat_map(|a| (0..of_y.len()).map(move |b| (a, b))) {
                let gap = match near {
                    Some(table) => f64::from(table.gaps[a * of_y.len() + b]),
                    None => CornerGaps::gap_between(components[0][a], components[1][b]),
                };
                if gap == f64::INFINITY {
                    continue;
                }
                let images = search.image(of_x[a]).iter().zip(search.image(of_y[b]));
                let difference: Vec<f64> = images.map(|(x, y)| f64::from(*y) - f64::from(*x)).collect();
                let stretch = singular_value(&difference);
                let vertices = (gaps.vertices(nodes.0)[a], gaps.vertices(nodes.1)[b]);
                let widest = widest_gap(gaps, &parents, nodes, vertices);
                let error = f64::from(search.image_error);
                largest = [largest[0].max(stretch / widest), largest[1].max((stretch + error) / gap)];
            }
            (ratios[x][y], ratios[y][x]) = (largest, largest);
        }
        let mut below: Vec<Vec<usize>> = vec![Vec::new(); parts.len()];
        for p in (0..parts.len()).rev() {
            let Part { first_child, child_count, .. } = parts[p];
            let children = first_child as usize..(first_child + child_count) as usize;
            let of_children = children.flat_map(|c| below[c].iter().copied()).collect();
            below[p] = if child_count == 0 { vec![p] } else { of_children };
        }
        for (x, y) in (0..parts.len()).flat_map(|x| (0..parts.len()).map(move |y| (x, y))) {
            if x != y && below[x].iter().any(|p| below[y].contains(p)) {
                continue;
            }
            let pairs = below[x].iter().flat_map(|p| below[y].iter().map(move |q| (*p, *q)));
            let each = pairs.map(|(p, q)| ratios[p][q]);
            let [low, high] = each.fold([0.0_f64; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
            search.visits = VISITS_PER_CHECK - 1;
            let (part, pair) = (x as u32, (x as u32, y as u32));
            let found = if x == y { search.within(gaps, part, 0.0) } else { search.between(gaps, pair, 0.0) };
            // Bounds of singular values are up to 7% too large.
            let most = 1.08 * f64::from(ACCEPTED) * high;
            assert!((low..=most).contains(&f64::from(found)), "parts {x} {y}: {found}, not {low} to {most}");
        }
    });
}

/// Parts whose spheres are apart are accepted with the distance of their means, both spreads and the error of
/// images, over the gap of the spheres.
#[test]
fn ratios_of_far_parts_are_those_of_their_means_over_the_gap_of_their_spheres() {
    let random = &mut Numbers(60);
    let case = cells_of_triangles(random);
    with_search(&case, &mut Numbers(4), |_, gaps, _, _| {
        let width = 3 * LANES;
        for case in 0..300 {
            let size = random.power(-3.0, 3.0);
            let means: Vec<f32> = (0..2 * width).map(|_| (size * random.signed()) as f32).collect();
            let centers = [random.vector(), random.vector()];
            let length = (centers[1] - centers[0]).length();
            let parts = centers.map(|center| Part {
                center,
                radius: 0.4 * length * random.signed().abs(),
                spread: (size * random.signed().abs()) as f32,
                ..Part::default()
            });
            let image_error = (size * random.signed().abs()) as f32;
            let [a, b] = parts;
            let gap = length - a.radius - b.radius;
            let terms =
                distance(&means[..width], &means[width..]) + f64::from(a.spread) + f64::from(b.spread);
            let round_up = f64::from(ROUND_UP);
            let expected = (terms * round_up + f64::from(image_error)) / gap * round_up;
            let mut search = StrainSearch {
                parts: parts.to_vec(),
                width,
                means,
                image_error,
                smallest_gap: f64::INFINITY,
                ..StrainSearch::default()
            };
            let found = f64::from(search.between(gaps, (0, 1), (expected / 1.05) as f32));
            assert!((found / expected - 1.0).abs() < 2e-6, "case {case}: {found} {expected}");
            // The gap is shortened by its rounding.
            let shortened = (gap - search.smallest_gap) / length;
            assert!(shortened > 5e-15 && shortened < 2e-14, "case {case}: {shortened}");
        }
    });
}

/// Two leaves that are far apart are accepted with their gap along the direction between them, where their spheres
/// are not: they are flat, and this direction is across both.
#[test]
fn ratios_of_far_leaves_are_those_of_their_means_over_their_gap() {
    let random = &mut Numbers(61);
    let corner = |v: u32| DVec3::new(6.0 * f64::from(v / 24), random.signed(), random.signed());
    let case = Case::of_triangles((0..48).map(corner).collect());
    let positions = PatchModel::new(&case.model, &[0.0]).unwrap().positions;
    with_search(&case, &mut Numbers(4), |search, gaps, _, _| {
        search.images.iter_mut().for_each(|x| *x = random.signed() as f32);
        search.begin(1.0);
        search.image_error = 0.25;
        let parts = search.parts.clone();
        let leaves: Vec<usize> = (0..parts.len()).filter(|p| parts[*p].child_count == 0).collect();
        let pairs = leaves.iter().flat_map(|x| leaves.iter().map(move |y| (*x, *y)));
        let is_apart = |(x, y): &(usize, usize)| parts[*x].center.x * parts[*y].center.x < -0.9;
        let pairs: Vec<(usize, usize)> = pairs.filter(is_apart).collect();
        assert!(!pairs.is_empty());
        for (x, y) in pairs {
            let (a, b, pair) = (parts[x], parts[y], (x as u32, y as u32));
            assert!(gaps.near((a.node.min(b.node), a.node.max(b.node))).is_none());
            let dir = (b.center - a.center).normalize();
            let along = |v: &u32| dir.dot(positions[*v as usize]);
            let last = gaps.vertices(a.node).iter().map(along).fold(f64::NEG_INFINITY, f64::max);
            let gap = gaps.vertices(b.node).iter().map(along).fold(f64::INFINITY, f64::min) - last;
            let difference = distance(search.mean(pair.0), search.mean(pair.1));
            let round_up = f64::from(ROUND_UP);
            let terms = (difference + f64::from(a.spread) + f64::from(b.spread)) * round_up;
            let expected = (terms + 0.25) / gap * round_up;
            search.smallest_gap = f64::INFINITY;
            let found = f64::from(search.between(gaps, pair, (expected / 1.08) as f32));
            assert!((found / expected - 1.0).abs() < 2e-6, "parts {x} {y}: {found} {expected}");
            assert!((search.smallest_gap - gap).abs() < 1e-12, "{} {gap}", search.smallest_gap);
        }
    });
}

/// Calls `each` with the ratio and the widest gap of each pair of corners that counts, and their triangles.
fn each_ratio(
    case: &Case,
    (width, gaps, patch, images): (usize, &CornerGaps<'_>, &Patch, &[f64]),
    mut each: impl FnMut(f64, f64, (u32, u32)),
) {
    let nodes = case.hierarchy.nodes();
    let parents = parents(&case.hierarchy);
    let leaves = (0..nodes.len() as u32).filter(|n| nodes[*n as usize].is_leaf());
    let triangles: Vec<(u32, u32)> = leaves
        .flat_map(|n| case.hierarchy.triangles(&nodes[n as usize]).iter().map(move |t| (n, *t)))
        .collect();
    for (at, (n, s)) in triangles.iter().enumerate() {
        for (m, t) in &triangles[at + 1..] {
            if case.filter.relation(*s, *t) == Relation::Adjacent {
                continue;
            }
            for simplices in case.filter.simplex_pairs(*s, *t) {
                for (i, j) in simplices.a.into_iter().flat_map(|i| simplices.b.map(|j| (i, j))) {
                    let [x, y] = [i, j].map(|v| patch.numbers[v as usize] as usize * width);
                    let rows: Vec<f64> = (0..width).map(|k| images[y + k] - images[x + k]).collect();
                    let widest = widest_gap(gaps, &parents, (*n, *m), (i, j));
                    each(singular_value(&rows) / widest, widest, (*s, *t));
                }
            }
        }
    }
}

#[test]
fn ratios_are_at_least_those_of_all_pairs() {
    let (mut finite, mut close) = (0, 0);
    for seed in 0..420 {
        let random = &mut Numbers(seed + 31);
        let neighbours = [Neighbours::Exclude, Neighbours::IncludeOneVertex][seed as usize % 2];
        let case = if seed % 10 == 0 {
            let shape = FlexibleShape::new(seed, Shape::ALL[seed as usize / 10 % 7], 1);
            Case::new(shape.positions, shape.faces, neighbours)
        } else {
            // There are few pairs, so that rounding decides which ratio is the largest.
            let count = 2 + random.below(3) as u32;
            let corner = |i: u32| DVec3::X * f64::from(i / 3) * 3.0 + random.vector();
            let positions = (0..3 * count).map(corner).collect();
            Case::new(positions, (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(), neighbours)
        };
        with_search(&case, random, |search, gaps, patch, exact| {
            let ratio = search.within(gaps, 0, 0.0);
            if !ratio.is_finite() {
                return;
            }
            finite += 1;
            let mut largest = 0.0_f64;
            each_ratio(&case, (search.width, gaps, patch, exact), |one, gap, _| {
                assert!(one <= f64::from(ratio), "seed {seed}: {one} {ratio}");
                assert!(search.smallest_gap <= gap * (1.0 + 1e-12), "seed {seed}");
                largest = largest.max(one);
            });
            close += usize::from(largest > 0.8 * f64::from(ratio));
        });
    }
    assert!(finite > 200 && close > 100, "{finite} {close}");
}

/// Two small clusters of triangles that are far apart are not divided. Their images are at the ends of their spreads, so that
/// the bound of the ratio is nearly reached.
#[test]
fn ratios_of_parts_that_are_not_divided_are_at_least_those_of_their_pairs() {
    const TRIANGLES: u32 = 40;
    let mut accepted = 0;
    for seed in 0..40 {
        let random = &mut Numbers(seed + 5);
        let cluster = |v: u32| v / (3 * TRIANGLES);
        let corner = |v: u32| DVec3::X * f64::from(cluster(v)) * 10.0 + random.vector() * 0.03;
        let positions = (0..6 * TRIANGLES).map(corner).collect();
        let faces = (0..2 * TRIANGLES).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let case = Case::new(positions, faces, Neighbours::Exclude);
        let signs: Vec<f64> = (0..6 * TRIANGLES).map(|_| random.signed().signum()).collect();
        with_search(&case, random, |search, gaps, patch, _| {
            let width = search.width;
            let mut images = vec![0.0; patch.vertices.len() * width];
            for (v, sign) in (0..).zip(&signs) {
                images[patch.numbers[v as usize] as usize * width] = f64::from(cluster(v)) + sign;
            }
            search.images = images.iter().map(|x| *x as f32).collect();
            search.begin(2.0);
            let (mut largest, mut smallest_gap) = (0.0_f64, f64::INFINITY);
            each_ratio(&case, (width, gaps, patch, &images), |ratio, gap, (s, t)| {
                if s / TRIANGLES != t / TRIANGLES {
                    largest = largest.max(ratio);
                    smallest_gap = smallest_gap.min(gap);
                }
            });
            // All pairs of parts of both clusters.
            let Part { first_child, child_count, .. } = search.parts[0];
            let children = first_child..first_child + child_count;
            let middle = search.parts[0].center.x;
            let is_far = |part: u32| search.parts[part as usize].center.x > middle;
            let (near, far): (Vec<u32>, Vec<u32>) = children.partition(|part| !is_far(*part));
            let floor = (0.97 * largest) as f32;
            let mut found = 0.0_f32;
            for pair in near.iter().flat_map(|x| far.iter().map(move |y| (*x, *y))) {
                found = found.max(search.between(gaps, pair, floor));
            }
            assert!(f64::from(found) >= largest, "seed {seed}: {found} {largest}");
            assert!(search.smallest_gap <= smallest_gap * (1.0 + 1e-12), "seed {seed}");
            accepted += usize::from(f64::from(found) > 1.005 * largest);
        });
    }
    assert!(accepted > 20, "{accepted}");
}

/// A floor only ends the search for ratios below it: larger ratios are found all the same.
#[test]
fn floors_are_never_above_the_result_and_nan_stays() {
    let mut finite = 0;
    for seed in 0..28 {
        let random = &mut Numbers(seed + 77);
        let shape = FlexibleShape::new(seed, Shape::ALL[seed as usize % 7], 1);
        let case = Case::new(shape.positions, shape.faces, Neighbours::Exclude);
        with_search(&case, random, |search, gaps, _, _| {
            for is_within in [true, false] {
                let last = search.parts[0].child_count;
                let mut ratio = |floor: f32| match is_within || last < 2 {
                    true => search.within(gaps, 0, floor),
                    false => search.between(gaps, (1, last), floor),
                };
                let plain = ratio(0.0);
                assert_eq!(ratio(f32::INFINITY), f32::INFINITY, "seed {seed}");
                assert!(ratio(f32::NAN).is_nan() || plain == f32::INFINITY, "seed {seed}");
                if plain == f32::INFINITY {
                    assert_eq!((ratio(1.0), ratio(1e30)), (plain, plain), "seed {seed}");
                    continue;
                }
                finite += 1;
                for share in [1e-3, 0.5, 0.99] {
                    let found = ratio(share * plain);
                    // Bounds of singular values are up to 7% too large.
                    assert!(found >= plain / (1.08 * ACCEPTED) && found >= share * plain, "seed {seed}");
                    assert!(found <= plain * 1.08 * ACCEPTED, "seed {seed}: {found} {plain}");
                }
                for share in [1.1, 10.0] {
                    let floor = 1.08 * share * plain;
                    assert!((floor..=floor * ACCEPTED * 1.0001).contains(&ratio(floor)), "seed {seed}");
                }
            }
        });
    }
    assert!(finite > 10, "{finite}");
}

/// Of triangles that touch at the centre no strain is small enough.
#[test]
fn triangles_without_a_gap_have_no_ratio() {
    for (gap, has_ratio) in [(0.0, false), (1e-12, false), (0.5, true)] {
        let first = [DVec3::ZERO, DVec3::new(-1.0, 1.0, 0.0), DVec3::new(-1.0, -1.0, 0.0)];
        let second = [DVec3::X * gap, DVec3::new(1.0, 0.0, 1.0), DVec3::new(1.0, 0.0, -1.0)];
        let case = Case::new([first, second].concat(), vec![[0, 1, 2], [3, 4, 5]], Neighbours::Exclude);
        with_search(&case, &mut Numbers(3), |search, gaps, _, _| {
            assert_eq!(search.within(gaps, 0, 0.0).is_finite(), has_ratio, "{gap}");
        });
    }
}

/// A pair is skipped only if its ratio is surely not the largest one, also if it is next to the largest.
#[test]
fn ratios_just_above_the_largest_are_found() {
    let width = 3 * LANES;
    for step in 0..100_u8 {
        let next = 1.0 + 5e-6 * f32::from(step);
        let mut images = vec![0.0; 3 * width];
        (images[width], images[2 * width]) = (1.0, next);
        let search = StrainSearch { width, images, ..StrainSearch::default() };
        let mut largest = 0.0;
        for j in [1, 2] {
            search.compare(search.image(0), j, 1.0, &mut largest);
        }
        assert!(largest >= next, "{largest} {next}");
    }
}

/// A sum is at most a limit only with more in hand than its rounding.
#[test]
fn limits_are_kept_with_room_for_rounding() {
    for (distance, more, image_error) in
        [(1.0_f32, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.5, 0.25, 0.25)]
    {
        let search = StrainSearch { image_error, ..StrainSearch::default() };
        let is_at_most = |limit: f32| search.is_at_most(distance * distance, more, limit);
        assert!(!is_at_most(1.0 + 9e-5) && is_at_most(1.0 + 3e-4), "{distance} {more} {image_error}");
        let least = (more + image_error) * ROUND_UP + distance * ROUND_UP * ROUND_UP.sqrt();
        assert!(!is_at_most(least * (1.0 - 4e-6)) && is_at_most(least * (1.0 + 4e-6)), "{least}");
    }
}

/// The error of images is added to the singular value, and the quotient is rounded up by more than it errs.
#[test]
fn ratios_of_vertices_include_the_error_of_images() {
    let width = 3 * LANES;
    for (stretch, image_error, gap) in
        [(1.0_f32, 0.0_f32, 1.0_f32), (0.25, 0.0, 1e-3), (1.0, 0.5, 0.7), (2.0, 3.0, 5.0), (0.0, 0.5, 2.0)]
    {
        let mut images = vec![0.0; 3 * width];
        (images[width], images[2 * width]) = (0.5 * stretch, stretch);
        let search = StrainSearch { width, images, image_error, ..StrainSearch::default() };
        // The bound of a singular value is higher by half of 1e-5.
        let (stretch, round_up) = (f64::from(stretch) * (1.0 + 5e-6), f64::from(ROUND_UP));
        let expected = (stretch * round_up + f64::from(image_error)) / f64::from(gap) * round_up;
        let pair = |j: u32| TightPair { i: 0, j, gap };
        // The ratio of the first of two pairs is smaller.
        for pairs in [vec![pair(2)], vec![pair(1), pair(2)], vec![pair(2), pair(1)]] {
            let found = f64::from(search.largest_ratio(&pairs));
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        }
    }
    assert_eq!(StrainSearch::default().largest_ratio(&[]), 0.0);
}

/// Lists go down to buckets: what is below them has no ratio of its own.
#[test]
fn buckets_have_no_children_to_list() {
    let bucket = BUCKET_TRIANGLES as u32;
    let part = |triangle_count: u32| Part {
        node: 7,
        first_child: 3,
        child_count: 2,
        triangle_count,
        ..Part::default()
    };
    let parts = [bucket + 1, bucket, 1].map(part).to_vec();
    let search = StrainSearch { parts, ..StrainSearch::default() };
    let found = [0, 1, 2].map(|part| search.node(part));
    assert_eq!(found, [(7, Some(3..5)), (7, None), (7, None)]);
}
