//! Arrays as the arguments of Python and C: any numbers, in small meshes.

use sscc::glam::DVec3;
use sscc::{
    Certificates, CertifyOptions, ContactFilter, Detector, KineticQuery, Method, Metric, MetricKind, Modes,
    Neighbours, Query, ReducedModel, TriMesh,
};

use crate::one_line;

/// The numbers of an input, one after another; zeros after its end.
struct Numbers<'a>(&'a [u8]);

impl Numbers<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    /// Returns the next number. Half of all numbers are small integers, so that triangles touch.
    fn number(&mut self) -> f64 {
        match self.byte() {
            kind @ 0..200 => f64::from(kind % 9) - 4.0,
            200..230 => f64::from(self.byte() as i8) / 16.0,
            230..240 => f64::from_bits(u64::from(self.byte()) << 56 | u64::from(self.byte())),
            _ => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte()))),
        }
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    fn vectors(&mut self, count: usize) -> Vec<DVec3> {
        (0..count).map(|_| self.vector()).collect()
    }
}

/// Creates a mesh, a model, certificates and queries from an input.
///
/// # Panics
/// When queries differ from brute force, or an error is not one line.
pub fn attack(bytes: &[u8]) {
    let numbers = &mut Numbers(bytes);
    let [vertices, faces, rank] = [12, 16, 4].map(|most| usize::from(numbers.byte()) % most + 1);
    let corner = |numbers: &mut Numbers<'_>| u32::from(numbers.byte()) % (vertices as u32 + 1);
    let faces = (0..faces).map(|_| std::array::from_fn(|_| corner(numbers))).collect();
    let Some(mesh) = one_line(TriMesh::new(numbers.vectors(vertices), faces)) else { return };
    let filter = match numbers.byte() % 3 {
        0 => ContactFilter::of(&mesh),
        1 => ContactFilter::new(Neighbours::IncludeOneVertex).weld(true),
        _ => ContactFilter::new(Neighbours::IncludeFolded),
    };
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
    let mut list = |count: usize| -> Vec<f64> { (0..count).map(|_| numbers.number()).collect() };
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
