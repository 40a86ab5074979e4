//! Arrays as the arguments of Python and C: any numbers, in small meshes.

use sscc::{
    Certificates, CertifyOptions, ContactFilter, Detector, KineticQuery, Method, Metric, MetricKind, Modes,
    Query, ReducedModel,
};

use crate::numbers::Numbers;
use crate::one_line;

/// Creates a mesh, a model, certificates and queries from an input.
///
/// # Panics
/// When queries differ from brute force, or an error is not one line.
pub fn attack(bytes: &[u8]) {
    let numbers = &mut Numbers(bytes);
    let (vertices, rank, mesh) = numbers.mesh();
    let Some(mesh) = mesh else { return };
    let filter = numbers.filter(&mesh);
    if let Some(mut detector) = one_line(Detector::with_filter(&mesh, &filter)) {
        for _ in 0..2 {
            let (x, y) = (numbers.vectors(vertices), numbers.vectors(vertices));
            one_line(detector.discrete(&x).map(<[_]>::len));
            one_line(detector.continuous(&x, &y).map(<[_]>::len));
        }
    }
    let Some(modes) = one_line(Modes::new(rank, numbers.vectors(vertices * rank))) else { return };
    let Some(model) = one_line(ReducedModel::new(mesh, modes)) else { return };
    query(numbers, &model, filter);
}

fn query(numbers: &mut Numbers<'_>, model: &ReducedModel, filter: ContactFilter) {
    let rank = model.rank();
    let mut list = |count: usize| numbers.list(count);
    let matrix = list(rank * rank);
    let metric = one_line(Metric::from_matrix(MetricKind::Given, rank, &matrix));
    let options = CertifyOptions::default().metric(metric).center(list(rank)).filter(filter).threads(1);
    let Some(certificates) = one_line(Certificates::compute(model, &options, &())) else { return };
    let methods = [Method::Certified, Method::BruteForce];
    let [mut query, mut oracle] = methods.map(|method| {
        Query::with_method(model, &certificates, method).expect("the model's own certificates")
    });
    let mut kinetic = KineticQuery::new(model, &certificates).ok();
    let mut last = list(rank);
    for _ in 0..4 {
        let q = list(rank);
        let exact = one_line(oracle.discrete(&q).map(<[_]>::to_vec));
        let found = one_line(query.discrete(&q).map(<[_]>::to_vec));
        assert_eq!(found, exact, "q = {q:?}");
        if let Some(kinetic) = &mut kinetic {
            assert_eq!(one_line(kinetic.discrete(&q).map(<[_]>::to_vec)), exact, "kinetic, q = {q:?}");
        }
        one_line(query.continuous(&last, &q).map(<[_]>::len));
        one_line(query.safe_scale(&q));
        last = q;
    }
}
