//! The public questions that `arrays` does not ask, with any numbers: detectors of one and of two meshes, sweeps, resolves,
//! samples, shapes in the world, curves, other methods, groups and clearances.

use sscc::glam::{DMat3, DVec3};
use sscc::limits::contains;
use sscc::parts::{
    Aabb, Pose, PosedShape, ProvenShares, Surface, SweptShape, body_penetration, contact_curves,
    contact_curves_between, intersection_triangle_triangle, largest_depth, penetration_triangle_triangle,
    surroundings_between_meshes,
};
use sscc::{
    AuditOptions, Certificates, CertifyOptions, Clearance, ContactFilter, Detector, KineticQuery, Method,
    Metric, MetricKind, ModeRange, Modes, MovingTriangle, Pair, Query, ReducedModel, ResolveOptions, TriMesh,
    TriangleGroups, audit, distance_triangle_triangle, impact_triangle_triangle,
};

use crate::numbers::Numbers;
use crate::one_line;

/// Creates two meshes and a model from an input, and asks.
///
/// # Panics
/// When answers contradict each other, or an error is not one line.
pub fn attack(bytes: &[u8]) {
    let numbers = &mut Numbers(bytes);
    let (vertices, rank, mesh) = numbers.mesh();
    let Some(mesh) = mesh else { return };
    let filter = numbers.filter(&mesh);
    match numbers.byte() % 4 {
        0 => of_meshes(numbers, &mesh, &filter),
        1 => of_triangles(numbers),
        kind => {
            let Some(modes) = one_line(Modes::new(rank, numbers.vectors(vertices * rank))) else { return };
            let Some(model) = one_line(ReducedModel::new(mesh, modes)) else { return };
            if kind == 2 {
                of_shapes(numbers, &model);
            } else {
                of_model(numbers, &model, filter);
            }
        }
    }
}

fn of_triangles(numbers: &mut Numbers<'_>) {
    let mut corners = || -> [DVec3; 3] { std::array::from_fn(|_| numbers.vector()) };
    let [a, b] = [(); 2].map(|()| MovingTriangle { t0: corners(), t1: corners() });
    if ![&a, &b].iter().all(|side| side.t0.iter().chain(&side.t1).all(|p| contains(*p))) {
        return;
    }
    let touch = sscc::intersect_triangle_triangle(&a.t0, &b.t0);
    assert_eq!(intersection_triangle_triangle(&a.t0, &b.t0).is_some(), touch);
    assert_eq!(penetration_triangle_triangle(&a.t0, &b.t0).is_some(), touch);
    assert!(!touch || distance_triangle_triangle(&a.t0, &b.t0) == 0.0);
    let impact = impact_triangle_triangle(&a, &b, 1e-6);
    assert!(impact.is_some() || !touch && !sscc::intersect_triangle_triangle(&a.t1, &b.t1));
}

fn of_meshes(numbers: &mut Numbers<'_>, mesh: &TriMesh, filter: &ContactFilter) {
    let groups: Vec<u32> = mesh.faces().iter().map(|_| u32::from(numbers.byte() % 4)).collect();
    let mut chosen = filter.clone();
    if numbers.byte() % 2 == 0
        && let Some(groups) = one_line(TriangleGroups::new(&groups))
    {
        let pair = [(); 2].map(|()| u32::from(numbers.byte() % 5));
        let Some(groups) = one_line(groups.ignoring([pair])) else { return };
        chosen = filter.clone().with_groups(groups);
    }
    let detectors = [&chosen, filter].map(|filter| one_line(Detector::with_filter(mesh, filter)));
    let [Some(mut one), Some(mut two)] = detectors else { return };
    let count = mesh.rest_positions().len();
    let [x, y, x_t1, y_t1] = [(); 4].map(|()| numbers.vectors(count));
    let rings = u32::from(numbers.byte() % 5);
    let pairs = one_line(one.discrete(&x).map(<[_]>::to_vec)).unwrap_or_default();
    one_line(one.surroundings(&pairs, rings).map(drop));
    one_line(contact_curves(mesh.faces(), &x, &pairs).map(drop));
    if let Some(nearest) = one_line(one.nearest(&x, rings)).flatten() {
        assert!(nearest.distance >= 0.0);
    }
    if let Some(clearance) = one_line(Clearance::new(numbers.number())) {
        let clearance = clearance.beyond_rings(rings);
        one_line(one.within(&x, &clearance).map(<[_]>::len));
        one_line(one.within_against(&x, &mut two, &y, &clearance).map(<[_]>::len));
    }
    let between = one_line(one.against(&x, &mut two, &y).map(<[_]>::to_vec));
    if let Some(nearest) = one_line(one.nearest_against(&x, &mut two, &y)).flatten() {
        let is_free = between.as_ref().is_some_and(Vec::is_empty);
        assert!(!is_free || nearest.distance > 0.0, "free, and at distance {}", nearest.distance);
    }
    let between = between.unwrap_or_default();
    one_line(surroundings_between_meshes([&one, &two], &between, rings).map(drop));
    let surfaces = [&x, &y].map(|positions| Surface { faces: mesh.faces(), positions });
    one_line(contact_curves_between(surfaces[0], surfaces[1], &between).map(drop));
    one_line(one.enclosed(&x, &mut two, &y).map(drop));
    one_line(body_penetration([&mut one, &mut two], [&x, &y]).map(drop));
    let impacts = one.continuous_against([&x, &x_t1], &mut two, [&y, &y_t1]).map(<[_]>::to_vec);
    if let Some(impacts) = one_line(impacts) {
        assert!(between.iter().all(|pair| impacts.iter().any(|impact| impact.pair == *pair)));
    }
}

fn of_shapes(numbers: &mut Numbers<'_>, model: &ReducedModel) {
    let shapes = [(); 2].map(|()| one_line(PosedShape::without_certificates(model)));
    let [Some(mut one), Some(mut two)] = shapes else { return };
    let pose = |numbers: &mut Numbers<'_>| {
        let rotation = match numbers.byte() % 2 {
            0 => DMat3::from_rotation_z(numbers.number() % 7.0),
            _ => DMat3::from_cols(numbers.vector(), numbers.vector(), numbers.vector()),
        };
        Pose { rotation, translation: numbers.vector() }
    };
    let poses: [Pose; 4] = [(); 4].map(|()| pose(numbers));
    let q: [Vec<f64>; 4] = [(); 4].map(|()| numbers.list(model.rank()));
    let around = Aabb { lower: numbers.vector(), upper: numbers.vector() };
    if one_line(one.place(&q[0], &poses[0])).is_none() || one_line(two.place(&q[1], &poses[1])).is_none() {
        return;
    }
    let mut pairs: Vec<Pair> = Vec::new();
    one_line(one.colliding(&mut two, around, &mut pairs));
    for &(a, b) in &pairs {
        assert!(sscc::intersect_triangle_triangle(&one.corners(a), &two.corners(b)));
    }
    let mut vertices = Vec::new();
    one_line(one.vertices_below(numbers.vector(), numbers.number(), &mut vertices));
    one_line(one.displacement_bound(&q[2]));
    let swept = [&one, &two].map(|shape| one_line(SweptShape::new(shape)));
    let [Some(mut one), Some(mut two)] = swept else { return };
    if one_line(one.place([&q[0], &q[2]], [&poses[0], &poses[2]])).is_none()
        || one_line(two.place([&q[1], &q[3]], [&poses[1], &poses[3]])).is_none()
    {
        return;
    }
    let mut impacts = Vec::new();
    if one_line(one.impacts(&mut two, around, &mut impacts)).is_some() {
        assert!(pairs.iter().all(|pair| impacts.iter().any(|impact| impact.pair == *pair)));
    }
    let mut near = Vec::new();
    one_line(one.near(&mut two, around, numbers.number(), 100, &mut near));
}

fn of_model(numbers: &mut Numbers<'_>, model: &ReducedModel, filter: ContactFilter) {
    let rank = model.rank();
    let mut options = CertifyOptions::default().filter(filter).threads(1);
    let kind = numbers.byte();
    if kind & 1 != 0 {
        options = options.center(numbers.list(rank));
    }
    if kind & 2 != 0 {
        options = options.ignore_rest(u32::from(kind >> 4)).budget(usize::from(numbers.byte()));
    }
    if kind & 4 != 0 {
        options =
            options.epsilon(numbers.number()).reach(numbers.number()).max_exceptions(usize::from(kind >> 4));
    }
    let metric = match kind >> 5 {
        0 => Metric::from_weights(MetricKind::Given, &numbers.list(rank)),
        1 => Metric::from_scales(MetricKind::Given, numbers.list(rank).into_iter().map(f64::abs).collect()),
        2 => Metric::from_factor(MetricKind::Given, rank, numbers.list(rank * rank)),
        3 => Metric::mass(model.mesh(), model.modes()),
        _ => Ok(model.metric().clone()),
    };
    let Some(metric) = one_line(metric) else { return };
    options = options.metric(metric);
    let rings = u32::from(numbers.byte() % 5);
    let clearance = one_line(Clearance::new(numbers.number())).map(|clearance| clearance.beyond_rings(rings));
    if kind & 8 != 0 {
        options = options.clearance(clearance);
    }
    let Some(certificates) = one_line(Certificates::compute(model, &options, &())) else { return };
    let [q, to] = [(); 2].map(|()| numbers.list(rank));
    one_line(certificates.clamp(&q).map(drop));
    one_line(certificates.norm(&q));
    let Some(mut query) = one_line(Query::new(model, &certificates)) else { return };
    if let Some(clearance) = &clearance {
        one_line(query.within(&q, clearance).map(<[_]>::len));
    }
    one_line(query.nearest(&q, rings));
    if certificates.clearance().is_some() {
        return;
    }
    let pairs = one_line(query.discrete(&q).map(<[_]>::to_vec));
    assert_eq!(one_line(query.first(&q)).map(|first| first.is_none()), pairs.as_ref().map(Vec::is_empty));
    assert_eq!(one_line(query.count(&q)), pairs.as_ref().map(Vec::len));
    let batch = query.batch_at_most(&[&q, &to], usize::from(kind), Some(1), &());
    if let (Some(pairs), Some(batch)) = (&pairs, one_line(batch)) {
        assert_eq!(batch[0].pairs.len(), pairs.len().min(kind.into()));
    }
    if let Some(time) = one_line(query.time_of_impact(&q, &to)) {
        assert!(time == Some(0.0) || pairs.as_ref().is_none_or(Vec::is_empty), "{time:?}, q = {q:?}");
    }
    for method in [Method::Traditional, Method::BdTree] {
        let Some(mut other) = one_line(Query::with_method(model, &certificates, method)) else { return };
        assert_eq!(one_line(other.discrete(&q).map(<[_]>::to_vec)), pairs, "{method:?}, q = {q:?}");
    }
    if let Some(pairs) = &pairs {
        assert!(largest_depth(model, &q, pairs) >= 0.0);
        if let Some(mut kinetic) = one_line(KineticQuery::new(model, &certificates)) {
            let impacts = one_line(kinetic.continuous(&q, &to).map(<[_]>::to_vec));
            let is_listed = |pair: &Pair| impacts.iter().flatten().any(|impact| impact.pair == *pair);
            assert!(impacts.is_none() || pairs.iter().all(is_listed));
        }
    }
    one_line(ProvenShares::of(&mut query, &q).map(drop));
    let mode = usize::from(numbers.byte()) % (rank + 1);
    one_line(query.sweep(&q, mode, numbers.number()).map(drop));
    let ranges = [ModeRange { mode, low: numbers.number(), high: numbers.number() }];
    one_line(query.sweep_modes(&q, &ranges, Some(1), &()).map(drop));
    one_line(query.sweep_intervals(&q, &ranges, 4, Some(1), &()).map(drop));
    let resolve = ResolveOptions::default().all(kind & 16 != 0);
    let resolve = if kind & 32 != 0 { resolve.start(to.clone()) } else { resolve };
    let resolved = one_line(query.resolve(&q, &resolve));
    if let Some(free) = resolved.and_then(|resolved| resolved.q) {
        let left = one_line(query.discrete(&free).map(<[_]>::to_vec)).unwrap_or_default();
        assert!(left.iter().all(|pair| certificates.exceptions().contains(pair)), "{left:?} at {free:?}");
    }
    one_line(query.resolve_batch(&[&q, &to], &resolve, Some(1), &()).map(drop));
    one_line(query.free_samples(&[&q, &to], Some(&resolve), Some(1), &()).map(drop));
    let attacks = AuditOptions::default().samples(3).seed(u64::from(kind)).threads(1);
    if let Some(report) = one_line(audit(model, &certificates, &attacks, &())) {
        assert!(report.violations.is_empty(), "{:?}", report.violations);
    }
}
