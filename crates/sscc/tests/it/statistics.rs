//! Statistics are those of the last call, also of one that ended with an error.

use glam::DVec3;
use sscc::parts::body_penetration;
use sscc::{
    CancelToken, Certificates, CertifyOptions, Clearance, ContactFilter, Detector, Error, KineticQuery,
    Modes, Neighbours, Query, ReducedModel, ResolveOptions, Statistics, TriMesh,
};

/// Returns two triangles one unit apart, and a mode that lowers the second.
fn model() -> ReducedModel {
    let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let lowers = |row, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 };
    ReducedModel::new(mesh, Modes::from_matrix(6, 1, lowers).unwrap()).unwrap()
}

const CALLS: [&str; 7] = ["discrete", "continuous", "within", "nearest", "safe scale", "sweep", "resolve"];

/// Makes one call of [`CALLS`].
fn call(name: &str, query: &mut Query, q: &[f64]) -> Result<(), Error> {
    match name {
        "discrete" => query.discrete(q).map(drop),
        "continuous" => query.continuous(&[2.0], q).map(drop),
        "within" => query.within(q, &Clearance::new(0.1)?).map(drop),
        "nearest" => query.nearest(q, 1).map(drop),
        "safe scale" => query.safe_scale(q).map(drop),
        "sweep" => query.sweep(q, 0, 2.0).map(drop),
        _ => query.resolve(q, &ResolveOptions::default()).map(drop),
    }
}

#[test]
fn a_refused_configuration_leaves_no_statistics() {
    let model = model();
    let plain = CertifyOptions::default();
    let clearance = plain.clone().clearance(Clearance::new(0.1).unwrap());
    for options in [plain, clearance] {
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let mut query = Query::new(&model, &certificates).unwrap();
        for name in CALLS {
            // The second triangle has passed the first.
            call(name, &mut query, &[2.5]).unwrap();
            assert!(query.statistics().norm > 0.0 && query.statistics().complete, "{name}");
            assert!(call(name, &mut query, &[f64::NAN]).is_err(), "{name}");
            assert_eq!(query.statistics(), Statistics::default(), "{name}");
        }
    }
}

#[test]
fn a_refused_configuration_leaves_no_statistics_of_a_kinetic_query() {
    let model = model();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
    assert!(kinetic.discrete(&[2.5]).unwrap().is_empty());
    assert!(kinetic.statistics().norm > 0.0 && kinetic.statistics().complete);
    assert!(kinetic.discrete(&[f64::NAN]).is_err());
    assert_eq!(kinetic.statistics(), Statistics::default());
}

/// The start is free by the root's radius, but the call fails after that.
#[test]
fn an_error_after_a_proof_leaves_none() {
    let model = model();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap();
    assert!(query.discrete(&[0.25]).unwrap().is_empty());
    assert!(query.statistics().root_certified && query.statistics().complete);
    assert!(query.sweep(&[0.25], 7, 1.0).is_err());
    assert!(!query.statistics().root_certified && !query.statistics().complete);
    let colliding = ResolveOptions::default().start(vec![1.0]);
    assert_eq!(query.resolve(&[0.25], &colliding), Err(Error::ResolveStart));
    assert!(!query.statistics().root_certified && !query.statistics().complete);
}

/// Returns a closed cube of 12 triangles.
fn cube(lower: f64, size: f64) -> TriMesh {
    let corner = |k: usize| DVec3::from_array([0, 1, 2].map(|axis| lower + size * (k >> axis & 1) as f64));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    TriMesh::new((0..8).map(corner).collect(), faces).unwrap()
}

#[test]
fn answers_of_detectors_are_complete_unless_they_failed() {
    let [outer, inner] = [cube(0.0, 4.0), cube(1.0, 1.0)];
    let [p, q] = [outer.rest_positions(), inner.rest_positions()];
    let [mut x, mut y] = [&outer, &inner].map(Detector::new);
    assert_eq!(x.enclosed(p, &mut y, q).unwrap()[1].inside, 1);
    assert!(x.statistics().complete);
    let penetration = body_penetration([&mut x, &mut y], [p, q]).unwrap();
    assert!(penetration.volume > 0.9 && x.statistics().complete);
    assert!(x.nearest_against(p, &mut y, q).unwrap().is_some() && x.statistics().complete);

    let open = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
    let mut z = Detector::new(&open);
    let refused = body_penetration([&mut x, &mut z], [p, open.rest_positions()]);
    assert_eq!(refused, Err(Error::OpenMesh("second")));
    assert!(!x.statistics().complete);

    let stop = CancelToken::new();
    stop.cancel();
    let mut x = x.cancelled_by(stop);
    assert_eq!(x.enclosed(p, &mut y, q), Err(Error::Cancelled));
    assert!(!x.statistics().complete);
}

#[test]
fn a_refused_kind_of_query_leaves_no_statistics() {
    let mesh = cube(0.0, 1.0);
    let folded = ContactFilter::new(Neighbours::IncludeFolded);
    let mut detector = Detector::with_filter(&mesh, &folded).unwrap();
    assert!(detector.discrete(mesh.rest_positions()).is_ok() && detector.statistics().complete);
    assert!(detector.continuous(mesh.rest_positions(), mesh.rest_positions()).is_err());
    assert_eq!(detector.statistics(), Statistics::default());
}
