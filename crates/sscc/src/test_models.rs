//! Random models for tests within the crate.

use glam::DVec3;
pub(crate) use sscc_testing::Numbers as Random;

use crate::{Metric, MetricKind, Modes, ReducedModel, TriMesh};

/// Returns two strips of triangles beside each other, or two halves of one strip, with smooth modes, some noise and a metric that
/// is not diagonal; and the number of triangles of a strip or half.
pub(crate) fn strips(random: &mut Random, case: usize) -> (ReducedModel, u32) {
    let half = 2 + case as u32 % 4;
    let gap = 0.05 + 0.5 * random.signed().abs();
    let p: Vec<DVec3> = (0..2 * (half + 2))
        .map(|i| {
            let (i, side) = (i % (half + 2), f64::from(i / (half + 2)));
            DVec3::new(f64::from(i) * 0.3, f64::from(i % 2) * 0.5, side * gap) + random.vector() * 0.05
        })
        .collect();
    let strip = |first: u32| (0..half).map(move |i| [first + i, first + i + 1, first + i + 2]);
    // Every third case is one strip.
    let second = if case.is_multiple_of(3) { half } else { half + 2 };
    let faces: Vec<[u32; 3]> = strip(0).chain(strip(second)).collect();
    let rank = 1 + case % 4;
    let ways: Vec<[DVec3; 3]> =
        (0..rank).map(|_| [random.vector(), random.vector(), random.vector()]).collect();
    let noise = 0.1 * random.signed().max(0.0);
    let modes = p.iter().flat_map(|x| {
        ways.iter().map(|[w, u, v]| *w * x.dot(*u) + *v + random.vector() * noise).collect::<Vec<_>>()
    });
    let modes = Modes::new(rank, modes.collect()).unwrap();
    let mesh = TriMesh::new(p, faces).unwrap();
    let mut factor = vec![0.0; rank * rank];
    for i in 0..rank {
        (i..rank).for_each(|j| {
            factor[i * rank + j] = if i == j { 1.0 + random.signed() * 0.5 } else { random.signed() }
        });
    }
    let metric = Metric::from_factor(MetricKind::Given, rank, factor).unwrap();
    (ReducedModel::with_metric(mesh, modes, metric).unwrap(), half)
}

/// Returns a flat square of `side` cells of length 1 along each side, two triangles each.
pub(crate) fn square(side: u32) -> TriMesh {
    let row = side + 1;
    let at = |i: u32| DVec3::new(f64::from(i % row), f64::from(i / row), 0.0);
    let cells = (0..side * side).map(|i| i / side * row + i % side);
    let faces = cells.flat_map(|i| [[i, i + 1, i + row], [i + 1, i + row + 1, i + row]]).collect();
    TriMesh::new((0..row * row).map(at).collect(), faces).unwrap()
}
