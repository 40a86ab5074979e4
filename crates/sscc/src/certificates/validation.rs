//! Validation of certificates that were read from a file: whether their parts fit together.
//!
//! The file's hash proves that no byte was changed, not that the bytes are certificates. `compatibility.rs` checks that
//! they belong to a model.

use super::{CertificateParts, Certificates};
use crate::Error;

/// Creates certificates from their parts, as read from a file whose integrity has been checked. Parts that do not fit together
/// are refused.
impl TryFrom<CertificateParts> for Certificates {
    type Error = Error;

    fn try_from(parts: CertificateParts) -> Result<Self, Error> {
        check_scope(&parts).and_then(|()| check_radii(&parts)).map_err(|cause| damaged(cause.to_owned()))?;
        if let Err(cause) = parts.pair_tree.pairs(&parts.hierarchy) {
            return Err(damaged(format!("pair tree: {cause}")));
        }
        match parts.local.check(&parts.hierarchy, parts.scope.metric.rank()) {
            Ok(()) => Ok(Self::new(parts)),
            Err(cause) => Err(damaged(format!("local certificates: {cause}"))),
        }
    }
}

fn damaged(cause: String) -> Error {
    Error::Certificates(cause)
}

fn check_scope(parts: &CertificateParts) -> Result<(), &'static str> {
    let scope = &parts.scope;
    if scope.center.len() != scope.metric.rank() {
        return Err("centre and metric are of different ranks");
    }
    if scope.center.iter().any(|x| !x.is_finite()) {
        return Err("the centre is not finite");
    }
    let (exceptions, ignored) = (&scope.exceptions, scope.filter.ignored());
    if !exceptions.is_sorted_by(|a, b| a < b) || exceptions.iter().any(|(a, b)| a >= b) {
        return Err("exceptions are not sorted pairs");
    }
    if exceptions.iter().any(|pair| ignored.binary_search(pair).is_ok()) {
        return Err("a pair is an exception and ignored");
    }
    if scope.clearance.is_some() && !parts.local.nodes.is_empty() {
        return Err("they have local certificates in addition to a clearance");
    }
    if let Some(groups) = scope.filter.groups() {
        if groups.of_triangles().len() != parts.hierarchy.order().len() {
            return Err("the number of group numbers is not the number of triangles");
        }
        let triangles = groups.of_triangles().len();
        if exceptions.iter().any(|&(a, b)| (b as usize) < triangles && !groups.is_pair_counted(a, b)) {
            return Err("a pair is an exception, but its groups do not count");
        }
    }
    Ok(())
}

fn check_radii(parts: &CertificateParts) -> Result<(), &'static str> {
    let nodes = parts.hierarchy.nodes();
    if parts.node_radii.len() != nodes.len() {
        return Err("the number of node radii is not the number of nodes");
    }
    let children = nodes[0].child_count as usize;
    if parts.root_pair_radii.len() != children * children.saturating_sub(1) / 2 {
        return Err("the number of root pair radii is not the number of pairs of the root's children");
    }
    // NaN must fail these tests, too.
    let mut radii = parts.node_radii.iter().chain(&parts.root_pair_radii);
    if radii.any(|radius| with_mutant!(radius.is_nan(), NanRadiusAccepted, false) || *radius < 0.0) {
        return Err("a radius is negative or not a number");
    }
    if parts.global_radius.is_nan() || parts.global_radius <= 0.0 {
        return Err("the global radius is not positive");
    }
    if !(parts.epsilon > 0.0 && parts.epsilon < 1.0) {
        return Err("epsilon is not between 0 and 1");
    }
    if parts.root_pair_radii.iter().any(|radius| *radius < parts.node_radii[0]) {
        return Err("the root's radius exceeds that of a pair of its children");
    }
    for (node, radius) in nodes.iter().zip(&parts.node_radii) {
        let is_below = |child: u32| parts.node_radii[child as usize] < *radius;
        if with_mutant!(node.children().any(is_below), NodeRadiusAboveChildAccepted, false) {
            return Err("a node's radius exceeds that of a child");
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;

    use super::*;
    use crate::certificates::test_models::ring;
    use crate::certificates::{Digest, Scope};
    use crate::{CertifyOptions, ContactFilter, Modes, Pair, ReducedModel, TriMesh, TriangleGroups};

    fn certify(model: &ReducedModel, budget: usize) -> Certificates {
        Certificates::compute(model, &CertifyOptions::default().budget(budget), &()).unwrap()
    }

    #[test]
    fn wrong_numbers_are_refused() {
        let good = certify(&ring(40, 2, 0.4), 64).parts().clone();
        let is_good = |change: &dyn Fn(&mut CertificateParts)| {
            let mut parts = good.clone();
            change(&mut parts);
            Certificates::try_from(parts).is_ok()
        };
        assert!(is_good(&|_| ()));
        for bad in [f64::NAN, -1.0] {
            assert!(
                !is_good(&|p| p.node_radii[0] = bad) && !is_good(&|p| p.root_pair_radii[0] = bad),
                "{bad}"
            );
            assert!(!is_good(&|p| *p.node_radii.last_mut().unwrap() = bad), "{bad}");
        }
        assert!([f64::NAN, -1.0, 0.0].iter().all(|bad| !is_good(&|p| p.global_radius = *bad)));
        assert!([f64::NAN, -1.0, 0.0, 1.0, 2.0].iter().all(|bad| !is_good(&|p| p.epsilon = *bad)));
        assert!(!is_good(&|p| p.node_radii.push(1.0)) && !is_good(&|p| _ = p.node_radii.pop()));
        assert!(!is_good(&|p| p.root_pair_radii.push(1.0)) && !is_good(&|p| _ = p.root_pair_radii.pop()));
    }

    #[test]
    fn exceptions_are_sorted_pairs_that_count() {
        let good = certify(&ring(40, 2, 0.4), 64).parts().clone();
        let with = |exceptions: &[Pair], filter: &ContactFilter| {
            let (exceptions, filter) = (exceptions.to_vec(), filter.clone());
            let scope = Arc::new(Scope { exceptions, filter, ..(*good.scope).clone() });
            Certificates::try_from(CertificateParts { scope, ..good.clone() }).is_ok()
        };
        let plain = &good.scope.filter;
        assert!(with(&[(0, 1), (0, 2)], plain));
        for bad in [&[(0, 2), (0, 1)][..], &[(0, 1), (0, 1)], &[(1, 0)], &[(1, 1)]] {
            assert!(!with(bad, plain), "{bad:?}");
        }
        // Triangles of different groups count. Whether a triangle exists is checked with the model.
        let groups: Vec<u32> = (0..80).map(|t| t % 2).collect();
        let filter = plain.clone().with_groups(TriangleGroups::new(&groups).unwrap().between_only());
        assert!(with(&[(0, 1)], &filter) && !with(&[(0, 2)], &filter) && with(&[(0, 80)], &filter));
    }

    #[test]
    fn exceptions_of_triangles_that_do_not_exist_fit_no_model() {
        // Two triangles that cross at rest.
        let p = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [1, 1, 1], [2, 1, 1]];
        let p = p.map(|p| DVec3::from_array(p.map(f64::from))).to_vec();
        let mesh = TriMesh::new(p, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(1, vec![DVec3::X; 6]).unwrap()).unwrap();
        let certificates = certify(&model, 0);
        assert_eq!((certificates.rest_collisions(), certificates.exceptions()), (1, &[(0, 1)][..]));
        assert!(certificates.check_model(&model).is_ok());
        let mut parts = certificates.parts().clone();
        let scope = Scope { exceptions: vec![(0, 2)], ..(*parts.scope).clone() };
        (parts.digest, parts.scope) = (Digest::of(&model, &scope), Arc::new(scope));
        let forged = Certificates::try_from(parts).unwrap();
        assert!(matches!(forged.check_model(&model), Err(Error::Certificates(_))));
    }
}
