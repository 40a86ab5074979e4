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
