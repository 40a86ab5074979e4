//! What an affine map of the modes leaves over, against exact arithmetic.

use num_rational::BigRational;

use super::super::reference::Random;
use super::super::rounding_tests::exact;
use super::super::triangle_pair::{WHOLE, Weights, quarters, sub_pair};
use super::*;
use crate::model::ScaledModel;
use crate::{Metric, Modes, ReducedModel, TriMesh};

/// Corners of small parts of triangles far from the origin are rounded by more than the modes. Where all turns about
/// a point nearby, nothing but that is left over.
#[test]
fn residuals_hold_what_rounding_moves_corners_by() {
    let mut positive = 0;
    for case in 0..400 {
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
        let row = scaled.row;
        let corners = |first: u32| [0, 1, 2].map(|v| first + v);
        let whole = TrianglePair {
            x: corners(0).map(|v| scaled.positions[v as usize]),
            y: corners(3).map(|v| scaled.positions[v as usize]),
            modes_x: corners(0).map(|v| scaled.modes(v)),
            modes_y: corners(3).map(|v| scaled.modes(v)),
        };
        let [x, y] = [(); 2].map(|()| {
            (0..1 + case % 12).fold(WHOLE, |weights: Weights, _| quarters(&weights)[random.below(4)])
        });
        let mut memory = vec![0.0; 18 * row];
        let part = sub_pair(&whole, &x, &y, &mut memory);
        let points = [part.x, part.y].concat();
        let modes = [part.modes_x, part.modes_y].concat();
        let offsets: Vec<DVec3> = points.iter().map(|p| *p - points[0]).collect();
        let mut affine = AffineFit::new(row);
        assert!(affine.fit(&offsets, |v| modes[v]));
        // Both sides exactly: sums over the corners of the whole triangles, whose weights are exact.
        let sum = |weights: DVec3, of: &dyn Fn(usize) -> f64| -> BigRational {
            (0..3).map(|corner| exact(weights[corner]) * exact(of(corner))).sum()
        };
        for a in 0..3 {
            for b in 0..3 {
                let d: [BigRational; 3] = std::array::from_fn(|axis| {
                    sum(y[b], &|v| whole.y[v][axis]) - sum(x[a], &|v| whole.x[v][axis])
                });
                let mut square = exact(0.0);
                for (axis, k) in (0..3).flat_map(|axis| (0..rank).map(move |k| (axis, k))) {
                    let at = axis * row + k;
                    let relative =
                        sum(y[b], &|v| whole.modes_y[v][at]) - sum(x[a], &|v| whole.modes_x[v][at]);
                    let fitted: BigRational =
                        (0..3).map(|j| exact(affine.gradient[(3 * axis + j) * row + k]) * &d[j]).sum();
                    let left = relative - fitted;
                    square += &left * &left;
                }
                let residual = affine.residual_up(affine.residual(a, 3 + b), &scaled.error);
                // One of the two rate errors that the bound grants.
                let allowed = exact(residual) + exact(scaled.error.rate(DVec3::ONE));
                assert!(square <= &allowed * &allowed, "case {case}: {a} {b}");
                positive += usize::from(square > exact(0.0));
            }
        }
    }
    assert!(positive > 3000, "{positive}");
}
