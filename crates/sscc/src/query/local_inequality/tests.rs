//! Compares the inequality of local certificates with exact arithmetic.

use sscc_testing::{Dyadic, Numbers};

use super::super::exact_matrix::{Matrix, exact, gram, is_above, matrix, of_map};
use super::super::local_tables::tables_of;
use super::*;
use crate::Metric;
use crate::certificates::LocalBounds;
use crate::certificates::LocalCertificates;
use crate::detect::layout::Layout;
use crate::detect::vertex_motion::DeformedMotion;
use crate::geometry::Aabb;

/// The numbers of a certificate in the layout of its arrays, and as matrices.
struct Certificate {
    local: LocalCertificates,
    /// The gradient of each mode.
    gradients: Vec<DMat3>,
    /// The upper triangular matrix W.
    ellipsoid: Vec<Vec<f64>>,
}

fn certificate(gradients: Vec<DMat3>, ellipsoid: Vec<Vec<f64>>) -> Certificate {
    let rank = gradients.len();
    let mut numbers = Vec::new();
    gradients.iter().for_each(|g| numbers.extend(g.to_cols_array()[..8].iter().map(|x| *x as f32)));
    numbers.extend(gradients.iter().map(|g| g.z_axis.z as f32));
    numbers.resize(gradient_len(rank), 0.0);
    let mut halves = Vec::new();
    for first in (0..rank).step_by(8) {
        for column in first..rank {
            for row in ellipsoid.iter().map(Some).chain(std::iter::repeat(None)).skip(first).take(8) {
                halves.push((row.map_or(0.0, |row| row[column] as f32).to_bits() >> 16) as u16);
            }
        }
    }
    let norm = |numbers: &[f64]| numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
    let column = |k: usize| norm(&ellipsoid.iter().map(|row| row[k]).collect::<Vec<_>>());
    let bounds = LocalBounds {
        ratio: 1.0,
        steepest: gradients.iter().map(|g| norm(&g.to_cols_array())).fold(0.0, f64::max) * (1.0 + 1e-12),
        widest: (0..rank).map(column).fold(0.0, f64::max) * (1.0 + 1e-12),
        ..LocalBounds::default()
    };
    let local = LocalCertificates {
        nodes: vec![0],
        mode_starts: vec![0, rank as u32],
        modes: (0..rank as u32).collect(),
        gradients: numbers,
        ellipsoids: halves,
        bounds: vec![bounds],
        list_starts: vec![0, 0],
        ..LocalCertificates::default()
    };
    Certificate { local, gradients, ellipsoid }
}

/// Returns the bound of the allowed ratios at these q, for a model with `rank` modes.
fn allowed<const E: usize>(local: &LocalCertificates, rank: usize, q: [&[f64]; E]) -> f64 {
    allowed_during(local, rank, &DeformedMotion::new(q, 1.0))
}

/// Returns the bound of the allowed ratios during a motion.
fn allowed_during<const E: usize, M: VertexMotion<E>>(
    local: &LocalCertificates,
    rank: usize,
    motion: &M,
) -> f64 {
    allowed_in(local, &Metric::identity(rank), motion)
}

/// Returns the bound of the allowed ratios during a motion, in a metric.
fn allowed_in<const E: usize, M: VertexMotion<E>>(
    local: &LocalCertificates,
    metric: &Metric,
    motion: &M,
) -> f64 {
    let center = vec![0.0; metric.rank()];
    let (tables, _) = tables_of(local, &center, metric);
    let mut inequality = LocalInequality::<E>::new();
    assert!(inequality.set_motion(&tables, motion));
    f64::from(inequality.allowed(&tables, 0))
}

/// Returns `I + G f`, exactly.
fn exact_map(certificate: &Certificate, f: &[f64]) -> Matrix {
    matrix(|i, j| {
        let unit = exact(f64::from(u8::from(i == j)));
        certificate.gradients.iter().zip(f).map(|(g, f)| exact(g.col(j)[i]) * exact(*f)).sum::<Dyadic>()
            + unit
    })
}

/// Whether `ratio |W f| < sigma_min(I + G f)`.
fn holds(certificate: &Certificate, ratio: f64, f: &[f64]) -> bool {
    let map = exact_map(certificate, f);
    let strain: Dyadic = certificate
        .ellipsoid
        .iter()
        .map(|row| row.iter().zip(f).map(|(w, f)| exact(*w) * exact(*f)).sum::<Dyadic>())
        .map(|x| &x * &x)
        .sum();
    is_above(&gram(&map), &(strain * exact(ratio) * exact(ratio)))
}

#[test]
fn allowed_ratios_are_at_most_exact() {
    let random = &mut Numbers(4);
    let single = |x: f64| f64::from(x as f32);
    let half = |x: f64| f64::from(f32::from_bits((x as f32).to_bits() & 0xffff_0000));
    let (mut positive, mut swept, mut short) = (0, 0, 0);
    for case in 0..1200 {
        let rank = 2 + random.below(if case % 20 == 0 { 30 } else { 6 });
        let size = random.power(-2.0, 0.5);
        let mut gradients: Vec<DMat3> = (0..rank)
            .map(|_| DMat3::from_cols_array(&[(); 9].map(|()| single(random.signed() * size))))
            .collect();
        let mut ellipsoid: Vec<Vec<f64>> = (0..rank)
            .map(|i| (0..rank).map(|k| if k >= i { half(random.signed()) } else { 0.0 }).collect())
            .collect();
        // Draws factors whose sums cancel in F, or in W f.
        let mut draw = |random: &mut Numbers| -> Vec<f64> {
            let mut f: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
            let large = random.power(2.0, 7.0);
            match case % 3 {
                0 => {
                    (f[0], f[1]) = (large + 0.3 * random.signed(), -large);
                    gradients[1] = gradients[0];
                }
                1 => {
                    (f[0], f[1]) = (large + 0.01 * random.signed(), -large);
                    f[2..].iter_mut().for_each(|f| *f *= 1e-3);
                    gradients[..2].fill(DMat3::ZERO);
                    ellipsoid[0][0] = 1.0;
                    ellipsoid[0][1] = 1.0;
                    ellipsoid[1][1] = half(1e-6);
                }
                _ => {}
            }
            f
        };
        let [f, mut g] = [draw(random), draw(random)];
        // In every second case the map changes little along the motion.
        if case % 2 == 1 {
            let share = 0.03 / size.max(1.0);
            g = f.iter().map(|f| f + share * random.signed()).collect();
            short += 1;
        }
        let certificate = certificate(gradients, ellipsoid);
        let one = allowed(&certificate.local, rank, [&f]);
        if one > 0.0 {
            positive += 1;
            assert!(holds(&certificate, one, &f), "case {case}: {one} at {f:?}");
        }
        let two = allowed(&certificate.local, rank, [&f, &g]);
        assert!(two <= 0.0 || two <= one * (1.0 + 1e-4));
        if two > 0.0 {
            swept += 1;
            for t in [0.0, 0.125, 0.5, 0.75, 1.0] {
                let between: Vec<f64> = f.iter().zip(&g).map(|(x, y)| x * (1.0 - t) + y * t).collect();
                assert!(holds(&certificate, two * (1.0 - 1e-6), &between), "case {case}: {two} at {t}");
            }
        }
    }
    assert!(positive > 500 && swept > 150 && short > 500, "{positive} {swept} {short}");
}

/// Returns the numbers `a_j` of a configuration whose affine part was subtracted; zeros if it was not.
fn amounts_of(parts: &[(Vec<f64>, DMat3, f64)], f: &[f64], exact: &AffineFree) -> Vec<f64> {
    let mut left = f.to_vec();
    let amount = |(factors, _, _): &(Vec<f64>, DMat3, f64)| {
        let a = left.iter().zip(factors).map(|(f, n)| f * n).sum::<f64>();
        left.iter_mut().zip(factors).for_each(|(f, n)| *f -= a * n);
        a
    };
    let amounts: Vec<f64> = parts.iter().map(amount).collect();
    if left == exact.factors { amounts } else { vec![0.0; parts.len()] }
}

/// The cases have combinations of any kind, with any maps and residuals, patches that all modes move and others, and numbers so large
/// that the rounding of the subtraction decides.
#[test]
fn ratios_without_an_affine_part_are_at_most_exact() {
    let random = &mut Numbers(11);
    let single = |x: f64| f64::from(x as f32);
    let half = |x: f64| f64::from(f32::from_bits((x as f32).to_bits() & 0xffff_0000));
    let (mut taken, mut positive, mut swept) = (0, 0, 0);
    for case in 0..900 {
        let (rank, own) = (5 + random.below(4), usize::from(case % 2 == 0));
        // One mode has strain and no gradient; the others have gradients so large that the rounding of their remaining factors decides.
        let is_parted = case % 5 == 4;
        let norm = |n: &[f64]| n.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut parts: Vec<(Vec<f64>, DMat3, f64)> = Vec::new();
        for _ in 0..1 + case % 2 {
            let mut n: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
            n[own] *= f64::from(u8::from(!is_parted));
            for (other, _, _) in &parts {
                let along: f64 = n.iter().zip(other).map(|(x, u)| x * u).sum();
                n.iter_mut().zip(other).for_each(|(x, u)| *x -= along * u);
            }
            let length = norm(&n);
            let map = DMat3::from_cols_array(&[(); 9].map(|()| random.signed() * [0.3, 1e3][case % 4 / 3]));
            parts.push((n.iter().map(|x| x / length).collect(), map, random.power(-9.0, -1.0)));
        }
        // W or the gradients are so large that the rounding of the remaining factors decides.
        let [steep, wide] = [[1.0, 1.0], [1e10, 1.0], [1.0, 1e13]][case % 3];
        let steep = if is_parted { 2e15 } else { steep };
        let count = rank - own;
        let gradients: Vec<DMat3> = (0..count)
            .map(|k| match is_parted && k == 0 {
                true => DMat3::ZERO,
                false => DMat3::from_cols_array(&[(); 9].map(|()| single(random.signed() * steep))),
            })
            .collect();
        let ellipsoid: Vec<Vec<f64>> = (0..count)
            .map(|i| {
                let is_zero = |k: usize| k < i || is_parted && k > 0;
                (0..count).map(|k| if is_zero(k) { 0.0 } else { half(random.signed() * wide) }).collect()
            })
            .collect();
        let mut certificate = certificate(gradients, ellipsoid);
        // The first mode may not move the patch.
        certificate.local.modes.iter_mut().for_each(|k| *k += own as u32);
        certificate.local.bounds[0].per_error = random.power(-2.0, 2.0);
        let per_error = certificate.local.bounds[0].per_error;
        let rest = [0.0, 1e-16, 1e-9, 1e-2][random.below(4)] / steep;
        let start: Vec<f64> = parts.iter().map(|_| random.signed()).collect();
        let draw = |random: &mut Numbers, spread: f64| -> Vec<f64> {
            let along: Vec<f64> = start.iter().map(|a| a + spread * random.signed()).collect();
            let of_parts = |k: usize| parts.iter().zip(&along).map(|((n, _, _), a)| n[k] * a).sum::<f64>();
            let rest_of = |k: usize, rest: f64| match (is_parted, k == own) {
                (true, true) => 1e-12,
                (true, false) => 0.0,
                (false, _) => rest,
            };
            (0..rank).map(|k| of_parts(k) + rest_of(k, rest * random.signed())).collect()
        };
        let ends = [draw(random, 0.0), draw(random, 0.02)];
        let (mut tables, _) = tables_of(&certificate.local, &vec![0.0; rank], &Metric::identity(rank));
        tables.affine = Some(AffineModes::of_parts(parts.clone()));
        let mut one = LocalInequality::<1>::new();
        assert!(one.set_motion(&tables, &DeformedMotion::new([&ends[0]], 0.0)));
        let allowed = f64::from(one.allowed(&tables, 0));
        let of_ends = [&ends[0], &ends[1]].map(|f| f.as_slice());
        let mut two = LocalInequality::<2>::new();
        assert!(two.set_motion(&tables, &DeformedMotion::new(of_ends, 0.0)));
        let during = f64::from(two.allowed(&tables, 0));
        // Whether the comparison holds at a time of the motion, up to rounding on its smaller side.
        let holds = |ratio: f64, amounts: &[Vec<f64>; 2], t: f64| {
            let mix = |x: f64, y: f64| exact(x) * exact(1.0 - t) + exact(y) * exact(t);
            let a: Vec<Dyadic> = amounts[0].iter().zip(&amounts[1]).map(|(x, y)| mix(*x, *y)).collect();
            let left: Vec<Dyadic> = (own..rank)
                .map(|k| {
                    let taken = parts.iter().zip(&a).map(|((n, _, _), a)| exact(n[k]) * a);
                    mix(ends[0][k], ends[1][k]) - taken.sum::<Dyadic>()
                })
                .collect();
            let map = matrix(|i, j| {
                let own = certificate.gradients.iter().zip(&left).map(|(g, f)| exact(g.col(j)[i]) * f);
                let affine = parts.iter().zip(&a).map(|((_, map, _), a)| exact(map.col(j)[i]) * a);
                own.chain(affine).sum::<Dyadic>() + exact(f64::from(u8::from(i == j)))
            });
            let image = certificate
                .ellipsoid
                .iter()
                .map(|row| row.iter().zip(&left).map(|(w, f)| exact(*w) * f).sum::<Dyadic>());
            let square: Dyadic = image.map(|x| &x * &x).sum();
            let strain = square.to_f64().sqrt();
            let length: f64 = parts.iter().zip(&a).map(|((_, _, e), a)| 2.0 * e * a.to_f64().abs()).sum();
            is_below((ratio * strain + per_error * length) * (1.0 - 1e-9), &map)
        };
        let amounts = [0, 1].map(|end| amounts_of(&parts, &ends[end], &two.ends[end].exact));
        let alone = amounts_of(&parts, &ends[0], &one.ends[0].exact);
        taken += usize::from(alone.iter().any(|a| *a != 0.0));
        if allowed > 0.0 {
            positive += 1;
            assert!(holds(allowed, &[alone.clone(), alone], 0.0), "case {case}: {allowed}");
        }
        if during > 0.0 {
            swept += 1;
            for t in [0.0, 0.25, 0.75, 1.0] {
                assert!(holds(during, &amounts, t), "case {case}: {during} at {t}");
            }
        }
    }
    assert!(taken > 600 && positive > 150 && swept > 90, "{taken} {positive} {swept}");
}

#[test]
fn nan_at_either_end_is_no_proof() {
    assert!(smaller(f64::NAN, 1.0).is_nan() && smaller(1.0, f64::NAN).is_nan());
    assert_eq!((smaller(1.0, 2.0), smaller(2.0, 1.0), smaller(f64::INFINITY, 2.0)), (1.0, 1.0, 2.0));
    // Two terms of W f are beyond the range of single precision, and have opposite signs.
    let large = f64::from(1e14_f32.to_bits() >> 16 << 16);
    let large = f64::from(f32::from_bits(large as u32));
    let certificate = certificate(vec![DMat3::ZERO; 2], vec![vec![large, large], vec![0.0, 1.0]]);
    let (far, near) = ([4e29, -4e29], [1e-16, 1e-16]);
    assert!(allowed(&certificate.local, 2, [&near]) > 0.0);
    for ends in [[&far, &near], [&near, &far], [&far, &far]] {
        let allowed = allowed(&certificate.local, 2, ends.map(|q| q.as_slice()));
        assert!(allowed.is_nan() || allowed <= 0.0, "{allowed}");
    }
}

/// Returns `|W f|`, up to rounding.
fn strain_of(certificate: &Certificate, f: &[f64]) -> f64 {
    let image = certificate.ellipsoid.iter().map(|row| row.iter().zip(f).map(|(w, f)| w * f).sum::<f64>());
    image.map(|x| x * x).sum::<f64>().sqrt()
}

/// Whether a sum is less than the smallest singular value of a map.
fn is_below(sum: f64, map: &Matrix) -> bool {
    is_above(&gram(map), &(exact(sum) * exact(sum)))
}

/// Maps of patches rotate as planes do; the image of the direction across differs.
#[test]
fn flat_patches_allow_at_most_what_is_exact() {
    let random = &mut Numbers(6);
    let (mut flat, mut swept, mut close) = (0, 0, 0);
    for case in 0..600 {
        let rank = 9 + random.below(3);
        // The modes are the entries of the map.
        let mut gradients: Vec<DMat3> = (0..9)
            .map(|e| DMat3::from_cols_array(&std::array::from_fn(|i| f64::from(u8::from(i == e)))))
            .collect();
        gradients.resize(rank, DMat3::ZERO);
        let half = |x: f64| f64::from(f32::from_bits((x as f32).to_bits() & 0xffff_0000));
        let ellipsoid: Vec<Vec<f64>> = (0..rank)
            .map(|i| (0..rank).map(|k| if k >= i { half(random.signed()) } else { 0.0 }).collect())
            .collect();
        let mut certificate = certificate(gradients, ellipsoid);
        let across = (random.vector() + DVec3::X * 1e-3).normalize();
        let flatness = [0.0, 0.02, 0.3][case % 3];
        let bounds = &mut certificate.local.bounds[0];
        (bounds.across, bounds.flatness) = (across.to_array(), flatness);
        // A rotation of the plane that does not move the direction across.
        let axis = (random.vector() + DVec3::Y * 1e-3).normalize();
        let factors = |angle: f64, random: &mut Numbers| -> Vec<f64> {
            let turn = DMat3::from_axis_angle(axis, angle);
            let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
            let map = turn + outer(across - turn * across, across) - DMat3::IDENTITY;
            let mut f = map.to_cols_array().to_vec();
            f.resize_with(rank, || random.signed() * 0.1);
            f.iter().map(|x| x + 0.02 * random.signed()).collect()
        };
        let angle = 3.0 * random.signed();
        let f = factors(angle, random);
        let g = factors(angle + [0.02, 0.5][case % 2] * random.signed(), random);
        let map_of =
            |f: &[f64]| certificate.gradients.iter().zip(f).fold(DMat3::IDENTITY, |m, (g, f)| m + *g * *f);
        // Whether the inequality of either kind holds at f. The image of the direction across is that of the mean of the ends.
        let is_right = |ratio: f64, ends: &[DMat3; 2], at: &[f64]| {
            let ratio = ratio * (1.0 - 1e-3);
            if holds(&certificate, ratio, at) {
                return true;
            }
            let mean = (ends[0] + ends[1]) * 0.5;
            let ([flat], _) = flat_maps(&[mean], across);
            let image = flat * across;
            let map = exact_map(&certificate, at);
            let own: [Dyadic; 3] =
                std::array::from_fn(|i| (0..3).map(|k| &map[i][k] * exact(across[k])).sum());
            let map = matrix(|i, j| &map[i][j] + (exact(image[i]) - &own[i]) * exact(across[j]));
            let turned = (map_of(at) * across - image).length();
            is_below(ratio * strain_of(&certificate, at) + flatness * turned * (1.0 - 1e-3), &map)
        };
        let one = allowed(&certificate.local, rank, [&f]);
        if one > 0.0 {
            assert!(is_right(one, &[map_of(&f); 2], &f), "case {case}: {one} at {f:?}");
            flat += usize::from(!holds(&certificate, one * (1.0 - 1e-3), &f));
            close += usize::from(!is_right(one * 1.1, &[map_of(&f); 2], &f));
        }
        let two = allowed(&certificate.local, rank, [&f, &g]);
        if two > 0.0 {
            for t in [0.0, 0.3, 0.5, 1.0] {
                let at: Vec<f64> = f.iter().zip(&g).map(|(x, y)| x * (1.0 - t) + y * t).collect();
                assert!(is_right(two, &[map_of(&f), map_of(&g)], &at), "case {case}: {two} at {t}");
                swept += usize::from(!holds(&certificate, two * (1.0 - 1e-3), &at));
            }
        }
    }
    assert!(flat > 100 && swept > 200 && close > 200, "{flat} {swept} {close}");
}

/// All z within a radius of a segment.
struct InRegion<'q> {
    ends: [&'q [f64]; 2],
    radius: f64,
}

impl VertexMotion<2> for InRegion<'_> {
    const HAS_ERROR_BOUND: bool = false;

    fn rounding(&self) -> f64 {
        1e-15
    }

    fn overall_aabb(&self, _: &Layout) -> Aabb {
        panic!("no positions are needed")
    }

    fn coarse_coordinates(&self) -> Option<[&[f64]; 2]> {
        Some(self.ends)
    }

    fn region_radius(&self) -> Option<f64> {
        Some(self.radius)
    }

    fn coarse_slack(&self, _: u32) -> Option<DVec3> {
        panic!("no positions are needed")
    }

    fn positions(&self, _: &Layout, _: u32) -> [DVec3; 2] {
        panic!("no positions are needed")
    }

    fn node_aabb(&self, _: &Layout, _: u32) -> Option<Aabb> {
        panic!("no positions are needed")
    }
}

/// Returns `W d`, and the product of the transpose of W with it.
fn strained(ellipsoid: &[Vec<f64>], d: &[f64]) -> [Vec<f64>; 2] {
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let image: Vec<f64> = ellipsoid.iter().map(|row| dot(row, d)).collect();
    let column = |k: usize| ellipsoid.iter().map(|row| row[k]).collect::<Vec<_>>();
    let back = (0..d.len()).map(|k| dot(&column(k), &image)).collect();
    [image, back]
}

fn of_length(d: &[f64], length: f64) -> Vec<f64> {
    let norm = d.iter().map(|x| x * x).sum::<f64>().sqrt();
    d.iter().map(|x| x * length / norm).collect()
}

/// Proofs also hold at the border of the region, in the directions in which the inequality fails soonest.
#[test]
fn proofs_in_regions_hold_in_all_of_them() {
    let random = &mut Numbers(5);
    let (mut proven, mut checked, mut close) = (0, 0, 0);
    for case in 0..400 {
        let rank = 2 + random.below(if case % 20 == 0 { 70 } else { 6 });
        let half = |x: f64| f64::from(f32::from_bits((x as f32).to_bits() & 0xffff_0000));
        let size = if case % 2 == 0 { 0.0 } else { 0.3 / (rank as f64).sqrt() };
        let gradients: Vec<DMat3> = (0..rank)
            .map(|_| DMat3::from_cols_array(&[(); 9].map(|()| f64::from((random.signed() * size) as f32))))
            .collect();
        // In one half of the cases the map is constant, in the other half the strain is small.
        let of_strain = if case % 2 == 0 { 1.0 } else { 1e-3 };
        let ellipsoid: Vec<Vec<f64>> = (0..rank)
            .map(|i| {
                (0..rank).map(|k| if k >= i { half(of_strain * random.signed()) } else { 0.0 }).collect()
            })
            .collect();
        let mut worst: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
        for _ in 0..200 {
            worst = of_length(&strained(&ellipsoid, &worst)[1], 1.0);
        }
        let start = of_length(&worst, random.power(-2.0, 0.0));
        let end = if case % 3 == 0 { start.clone() } else { start.iter().map(|x| x * 1.1).collect() };
        let radius = random.power(-3.0, -0.5);
        let mut certificate = certificate(gradients, ellipsoid);
        let per_factor = [0.0, 0.1][case / 2 % 2];
        certificate.local.bounds[0].per_factor = per_factor;
        let allowed = allowed_during(&certificate.local, rank, &InRegion { ends: [&start, &end], radius });
        if allowed <= 0.0 {
            continue;
        }
        proven += 1;
        let map = |f: &[f64]| {
            certificate.gradients.iter().zip(f).fold(DMat3::IDENTITY, |sum, (g, f)| sum + *g * *f)
        };
        let from = smallest_stretch(&map(&end));
        let slopes: Vec<f64> = (0..rank)
            .map(|k| {
                let mut moved = end.clone();
                moved[k] += 1e-4;
                from - smallest_stretch(&map(&moved))
            })
            .collect();
        let any: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
        // The sum of the factors grows fastest along all axes at once.
        let all: Vec<f64> = end.iter().map(|x| if *x < 0.0 { -1.0 } else { 1.0 }).collect();
        for direction in [worst, slopes, any, all] {
            if direction.iter().all(|x| *x == 0.0) {
                continue;
            }
            let d = of_length(&direction, radius * (1.0 - 1e-9));
            let at: Vec<f64> = end.iter().zip(&d).map(|(x, d)| x + d).collect();
            let is_right = |ratio: f64| {
                let sum = ratio * strain_of(&certificate, &at)
                    + per_factor * at.iter().map(|x| x.abs()).sum::<f64>();
                is_below(sum, &exact_map(&certificate, &at))
            };
            assert!(is_right(allowed * (1.0 - 1e-6)), "case {case}: {allowed} at {at:?}");
            checked += 1;
            close += usize::from(!is_right(allowed * 1.5));
        }
    }
    assert!(proven > 300 && checked > 800 && close > 150, "{proven} {checked} {close}");
}

/// The first mode's map keeps a plane and compresses the direction across it. The second mode compresses one direction of the plane,
/// and the direction across by the amount that costs the most; only the second mode changes in a region.
#[test]
fn flat_patches_in_regions_allow_at_most_what_is_exact() {
    let mut close = 0;
    for flatness in [0.25, 0.5, 0.75] {
        let press = DMat3::from_diagonal(DVec3::new(0.0, 0.0, -0.9375));
        let change = DMat3::from_diagonal(DVec3::new(-1.0, 0.0, -flatness));
        let mut certificate =
            certificate(vec![press, change], vec![vec![1.0, 0.0], vec![0.0, 2.0_f64.powi(-20)]]);
        let bounds = &mut certificate.local.bounds[0];
        (bounds.across, bounds.flatness) = ([0.0, 0.0, 1.0], flatness);
        let metric = Metric::from_scales(crate::MetricKind::Given, vec![1e9, 1.0]).unwrap();
        for radius in [0.01, 0.03, 0.05] {
            let start = [1.0, 0.0];
            let region = InRegion { ends: [&start, &start], radius };
            let allowed = allowed_in(&certificate.local, &metric, &region);
            let at = [1.0, radius * (1.0 - 1e-9)];
            // Without the image of the direction across the ratio would not be allowed.
            assert!(!holds(&certificate, allowed, &at), "{flatness} {radius}");
            let flat = of_map(&DMat3::from_diagonal(DVec3::new(1.0 - at[1], 1.0, 1.0)));
            let turned = 0.9375 + flatness * at[1];
            let is_right =
                |ratio: f64| is_below(ratio * strain_of(&certificate, &at) + flatness * turned, &flat);
            assert!(is_right(allowed * (1.0 - 1e-4)), "{flatness} {radius}: {allowed}");
            close += usize::from(!is_right(allowed * 1.2));
        }
    }
    assert!(close > 4, "{close}");
}

#[test]
fn regions_of_dense_metrics_have_no_proofs() {
    let certificate = certificate(vec![DMat3::ZERO; 2], vec![vec![1.0, 0.5], vec![0.0, 1.0]]);
    let center = vec![0.0; 2];
    let q = [0.1, 0.1];
    let region = |radius: f64| InRegion { ends: [&q, &q], radius };
    let dense = Metric::from_factor(crate::MetricKind::Given, 2, vec![1.0, 0.1, 0.0, 1.0]).unwrap();
    for (metric, has_proofs) in [(dense, false), (Metric::identity(2), true)] {
        let (tables, _) = tables_of(&certificate.local, &center, &metric);
        let mut inequality = LocalInequality::<2>::new();
        assert_eq!(inequality.set_motion(&tables, &region(0.1)), has_proofs);
        // A region of radius 0 is an ordinary motion.
        assert!(inequality.set_motion(&tables, &region(0.0)));
    }
}

/// T of a patch that not all modes move is the sum over its own modes, though two of them cancel.
#[test]
fn a_mode_that_does_not_move_a_patch_changes_nothing() {
    let random = &mut Numbers(31);
    let half = |x: f64| f64::from(f32::from_bits((x as f32).to_bits() & 0xffff_0000));
    let (mut positive, mut none) = (0, 0);
    for case in 0..300 {
        let rank = 2 + case % 15;
        let numbers = |random: &mut Numbers| [(); 9].map(|()| f64::from((0.2 * random.signed()) as f32));
        let mut gradients: Vec<DMat3> = (0..rank).map(|_| DMat3::from_cols_array(&numbers(random))).collect();
        gradients[1] = gradients[0];
        let mut entry = |i: usize, k: usize| if k >= i { half(1e-3 * random.signed()) } else { 0.0 };
        let ellipsoid = (0..rank).map(|i| (0..rank).map(|k| entry(i, k)).collect()).collect();
        let certificate = certificate(gradients, ellipsoid);
        let mut f: Vec<f64> = (0..rank).map(|_| 0.1 * random.signed()).collect();
        let large = random.power(1.0, 7.5);
        (f[0], f[1]) = (large + 0.3 * random.signed(), -large);
        let of_all = allowed(&certificate.local, rank, [&f]);
        let mut of_some = certificate.local.clone();
        of_some.modes.iter_mut().for_each(|k| *k += 1);
        let at = |far: f64| [vec![far], f.clone()].concat();
        assert_eq!(allowed(&of_some, rank + 1, [&at(0.0)]), of_all, "case {case}");
        let found = allowed(&of_some, rank + 1, [&at(1e9)]);
        assert!(found <= of_all, "case {case}");
        if found > 0.0 {
            positive += 1;
            assert!(holds(&certificate, found, &f), "case {case}");
        } else {
            none += 1;
        }
    }
    assert!(positive > 50 && none > 50, "{positive} {none}");
}

#[test]
fn errors_hold_the_rounding_at_the_centre_and_at_q_in_units_of_the_shape() {
    let unit = |k: usize| (0..3).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
    let certificate = certificate(vec![DMat3::ZERO; 3], (0..3).map(unit).collect());
    let (mut tables, _) = tables_of(&certificate.local, &[0.0; 3], &Metric::identity(3));
    let q = [0.1; 3];
    for (center, there, scale) in [(1e9, 1.0, 1.0), (1.0, 1e9, 1.0), (1e9, 1.0, 1e3), (1.0, 1e9, 1e-3)] {
        (tables.scales.reach, tables.scales.scale) = (center, scale);
        let mut inequality = LocalInequality::<1>::new();
        assert!(inequality.set_motion(&tables, &DeformedMotion::new([&q[..]], there)));
        // 2 (r + 1) roundings along each of three axes, for two vertices.
        let least = 2.0 * 3.0_f64.sqrt() * 8.0 * (f64::EPSILON / 2.0) * (center + there) * scale;
        assert!(inequality.error >= least && inequality.error < 25.0 * least, "{center} {there} {scale}");
    }
}

/// Two affine parts cancel up to the map, whose rounding is that of their products.
#[test]
fn maps_of_affine_parts_that_cancel_are_rounded() {
    let random = &mut Numbers(19);
    let mut positive = 0;
    for case in 0..300 {
        let large = random.power(6.0, 13.0);
        let unit = |k: usize| (0..3).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
        let parts = vec![(unit(0), DMat3::IDENTITY * large, 0.0), (unit(1), DMat3::IDENTITY * -large, 0.0)];
        let certificate = certificate(vec![DMat3::ZERO; 3], (0..3).map(unit).collect());
        let first = 1.0 + random.signed().abs();
        let f = [first, first + 0.5 * random.signed() / large, 1e-3];
        let (mut tables, _) = tables_of(&certificate.local, &[0.0; 3], &Metric::identity(3));
        tables.affine = Some(AffineModes::of_parts(parts));
        let mut inequality = LocalInequality::<1>::new();
        assert!(inequality.set_motion(&tables, &DeformedMotion::new([&f[..]], 0.0)));
        let allowed = f64::from(inequality.allowed(&tables, 0));
        if allowed > 0.0 {
            positive += 1;
            let stretch = exact(1.0) + (exact(f[0]) - exact(f[1])) * exact(large);
            assert!(exact(allowed) * exact(f[2]) < stretch, "case {case}: {large:e}");
        }
    }
    assert!(positive > 100, "{positive}");
}

#[test]
fn factors_below_single_precision_still_have_strain() {
    let wide = f64::from(f32::from_bits(9e11_f32.to_bits() & 0xffff_0000));
    let certificate = certificate(vec![DMat3::ZERO], vec![vec![wide]]);
    // It is 0 in single precision.
    let f = [6e-46];
    let found = allowed(&certificate.local, 1, [&f[..]]);
    assert!(found > 0.0 && holds(&certificate, found, &f), "{found:e}");
}

/// The patch does not move with the first mode. What is left of its factors without the affine part is rounding alone.
#[test]
fn factors_without_their_affine_part_are_not_below_zero() {
    let mut certificate = certificate(vec![DMat3::ZERO; 2], vec![vec![1.0, 0.0], vec![0.0, 1.0]]);
    certificate.local.bounds[0].per_factor = 1e8;
    let found = [0, 1].map(|others| {
        let mut local = certificate.local.clone();
        local.modes.iter_mut().for_each(|k| *k += others as u32);
        let with = |x: f64, y: f64| [vec![0.0; others], vec![x, y]].concat();
        let (mut tables, _) = tables_of(&local, &vec![0.0; 2 + others], &Metric::identity(2 + others));
        tables.affine = Some(AffineModes::of_parts(vec![(with(0.6, 0.8), DMat3::ZERO, 0.0)]));
        let (f, mut inequality) = (with(6e5, 8e5), LocalInequality::<1>::new());
        assert!(inequality.set_motion(&tables, &DeformedMotion::new([&f[..]], 0.0)));
        inequality.allowed(&tables, 0)
    });
    assert!(found[0] > 0.0 && found[0] == found[1], "{found:?}");
}
