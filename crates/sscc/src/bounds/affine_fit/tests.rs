//! Residuals of an affine map of the modes, against exact arithmetic.

use sscc_testing::{Dyadic, cases, threshold};

use super::*;
use crate::bounds::pair_corners::PairCorners;
use crate::bounds::sub_triangle::{SubPair, UNDIVIDED, Weights, quarter};
use crate::bounds::tests::random::Random;
use crate::bounds::tests::rounding::exact;
use crate::model::ScaledModel;
use crate::{Metric, Modes, ReducedModel, TriMesh};

/// Corners of small sub-triangles far from the origin are rounded by more than the modes. If the triangles rotate about a point
/// nearby, residuals are this rounding alone.
#[test]
fn residuals_hold_what_rounding_moves_corners_by() {
    let mut positive = 0;
    for case in 0..cases(400) {
        let random = &mut Random::new(case);
        let (rank, far) = (1 + random.below(4), random.power(3.0, 7.0));
        let middle = random.vector() * far;
        let p: Vec<DVec3> = (0..6).map(|v| middle + random.vector() + DVec3::X * f64::from(v / 3)).collect();
        let turns: Vec<DVec3> = (0..rank).map(|_| random.vector()).collect();
        let modes = p.iter().flat_map(|p| turns.iter().map(move |turn| turn.cross(*p - middle))).collect();
        let mesh = TriMesh::new(p, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let modes = Modes::new(rank, modes).unwrap();
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(rank)).unwrap();
        let scaled = ScaledModel::new(&model, model.metric(), &vec![0.0; rank]);
        let row_len = scaled.row_len;
        let pair = PairCorners::of(&scaled, [0, 1, 2], [3, 4, 5]);
        let [a, b] = [(); 2].map(|()| {
            (0..1 + case % 12).fold(UNDIVIDED, |weights: Weights, _| quarter(&weights)[random.below(4)])
        });
        let mut memory = vec![0.0; 18 * row_len];
        let part = SubPair { a, b, ..SubPair::UNDIVIDED }.corners(&pair, &mut memory);
        let points = [part.corners.a, part.corners.b].concat();
        let modes = [part.modes_a, part.modes_b].concat();
        let offsets: Vec<DVec3> = points.iter().map(|p| *p - points[0]).collect();
        let mut affine = AffineFit::new(row_len);
        affine.instructions = InstructionSet::Baseline;
        assert!(affine.fit(&offsets, |i| modes[i]));
        let bits = |affine: &AffineFit| -> Vec<u64> {
            let residuals = affine.residuals.iter().chain([&affine.frobenius, &affine.longest]);
            affine.gradient.iter().chain(residuals).map(|x| x.to_bits()).collect()
        };
        let in_baseline = bits(&affine);
        affine.instructions = InstructionSet::default();
        assert!(affine.fit(&offsets, |i| modes[i]));
        assert_eq!(in_baseline, bits(&affine));
        // Computes both sides exactly, as sums over the corners of the triangles, whose weights are exact.
        let sum = |weights: DVec3, of: &dyn Fn(usize) -> f64| -> Dyadic {
            (0..3).map(|corner| exact(weights[corner]) * exact(of(corner))).sum()
        };
        for i in 0..3 {
            for j in 0..3 {
                let d: [Dyadic; 3] = std::array::from_fn(|axis| {
                    sum(b[j], &|v| pair.corners.b[v][axis]) - sum(a[i], &|v| pair.corners.a[v][axis])
                });
                let mut square = exact(0.0);
                for (axis, k) in (0..3).flat_map(|axis| (0..rank).map(move |k| (axis, k))) {
                    let at = axis * row_len + k;
                    let relative = sum(b[j], &|v| pair.modes_b[v][at]) - sum(a[i], &|v| pair.modes_a[v][at]);
                    let fitted: Dyadic =
                        (0..3).map(|c| exact(affine.gradient[(3 * axis + c) * row_len + k]) * &d[c]).sum();
                    let left = relative - fitted;
                    square += &left * &left;
                }
                let residual = affine.residual_up(affine.squared_residual(i, 3 + j), &scaled.rounding);
                // The rounding bound of one of the two points.
                let allowed = exact(residual) + exact(scaled.rounding.per_norm(DVec3::ONE));
                assert!(square <= &allowed * &allowed, "case {case}: {i} {j}");
                positive += usize::from(square > exact(0.0));
            }
        }
    }
    assert!(positive > threshold(3000), "{positive}");
}

/// Residuals are those of the gradient that the fit returns, whose strain is the rate of the bound: residuals of another map
/// would prove nothing, even if they are usually larger.
#[test]
fn residuals_are_those_of_the_gradient() {
    for case in 0..200 {
        let random = &mut Random::new(case);
        let (count, rank) = (6 + random.below(20), 1 + random.below(12));
        let row_len = padded_rank(rank);
        // Some points lie nearly in a plane.
        let thin = DVec3::new(1.0, if case % 2 == 0 { 1.0 } else { random.power(-6.0, 0.0) }, 1.0);
        let points: Vec<DVec3> = (0..count).map(|_| random.vector() * thin).collect();
        let offsets: Vec<DVec3> = points.iter().map(|p| *p - points[0]).collect();
        let mut modes = vec![vec![0.0; 3 * row_len]; count];
        for (at, x) in modes.iter_mut().flat_map(|rows| rows.iter_mut().enumerate()) {
            if at % row_len < rank {
                *x = random.uniform() - 0.5;
            }
        }
        let mut affine = AffineFit::new(row_len);
        assert!(affine.fit(&offsets, |i| modes[i].as_slice()));
        for (i, j) in (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j))) {
            let d = offsets[j] - offsets[i];
            let mut square = 0.0;
            for (c, k) in (0..3).flat_map(|c| (0..row_len).map(move |k| (c, k))) {
                let at = c * row_len + k;
                let fitted: f64 = (0..3).map(|l| affine.gradient()[(3 * c + l) * row_len + k] * d[l]).sum();
                square += (modes[j][at] - modes[i][at] - fitted).powi(2);
            }
            let found = affine.squared_residual(i, j);
            assert!(
                (found - square).abs() <= 1e-9 * square.max(1.0),
                "case {case}: {i} {j}: {found:e}, not {square:e}"
            );
        }
    }
}

/// Points of a plane do not determine the gradient across it. It is completed such that turns of the plane have no strain.
#[test]
fn planes_turn_without_strain() {
    for case in 0..50 {
        let normal = Random::new(case).vector().normalize();
        let (along, across) = normal.any_orthonormal_pair();
        let hexagon = (0..6).map(|i| std::f64::consts::FRAC_PI_3 * f64::from(i));
        let offsets: Vec<DVec3> =
            hexagon.map(|angle| along * (angle.cos() - 1.0) + across * angle.sin()).collect();
        // Three modes turn the plane about the axes; rows have four numbers.
        let modes: Vec<[f64; 12]> = offsets
            .iter()
            .map(|p| {
                let turned = DVec3::AXES.map(|axis| axis.cross(*p));
                std::array::from_fn(|at| if at % 4 < 3 { turned[at % 4][at / 4] } else { 0.0 })
            })
            .collect();
        let mut affine = AffineFit::new(4);
        assert!(affine.fit(&offsets, |i| modes[i].as_slice()));
        let gram = crate::bounds::strain::strain_gram(affine.gradient(), 4);
        let strain: f64 = (0..6).map(|i| gram[i][i]).sum();
        let size = dot(affine.gradient(), affine.gradient());
        assert!(size > 1.0 && strain <= 1e-6 * size, "case {case}: {strain:e} of {size:e}");
    }
}

/// The gradient of modes that are affine is found, for points of any size that fill space: reduced along each
/// axis by the ridge, and across the flattest direction completed by the share that the ridge takes.
#[test]
fn gradients_of_affine_modes_are_found() {
    let sides = DVec3::new(1.0, 0.9, 0.8);
    let (rank, row_len) = (6, 8);
    for (case, size) in [1e-40, 1e-3, 1.0, 7.0, 1e40].into_iter().enumerate() {
        let random = &mut Random::new(case as u64);
        let corner =
            |i: usize| DVec3::from_array([0, 1, 2].map(|axis| (i >> axis & 1) as f64)) * sides * size;
        let offsets: Vec<DVec3> = (0..8).map(corner).collect();
        let at_first: Vec<DVec3> = (0..rank).map(|_| random.vector()).collect();
        // The images of the axes, for each mode.
        let images: Vec<[DVec3; 3]> =
            (0..rank).map(|_| std::array::from_fn(|_| random.vector() / size)).collect();
        let modes: Vec<Vec<f64>> = offsets
            .iter()
            .map(|d| {
                let mut rows = vec![0.0; 3 * row_len];
                for k in 0..rank {
                    let u = at_first[k] + images[k][0] * d.x + images[k][1] * d.y + images[k][2] * d.z;
                    for c in 0..3 {
                        rows[c * row_len + k] = u[c];
                    }
                }
                rows
            })
            .collect();
        let mut affine = AffineFit::new(row_len);
        assert!(affine.fit(&offsets, |i| modes[i].as_slice()));
        // In units of the squared size: the moments of eight points, half a side from their mean, and the
        // ridge.
        let moments = sides * sides * 2.0;
        let ridge = 1e-4 * moments.element_sum();
        let kept = moments / (moments + ridge);
        let undetermined = ridge / (moments.z + ridge);
        for (k, c, j) in (0..9 * rank).map(|at| (at / 9, at / 3 % 3, at % 3)) {
            let fitted = images[k][j][c] * kept[j];
            let completed = if j == 2 && c != 2 { images[k][c].z * kept[c] * undetermined } else { 0.0 };
            let found = affine.gradient()[(3 * c + j) * row_len + k];
            let expected = fitted - completed;
            assert!((found - expected).abs() * size <= 1e-9, "size {size:e}: {found:e}, not {expected:e}");
        }
    }
}
