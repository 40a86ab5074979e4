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
        let vertices = positions.len();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let modes = Modes::from_matrix(vertices, 1, |row, _| (row as f64).sin()).unwrap();
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
    }
}
