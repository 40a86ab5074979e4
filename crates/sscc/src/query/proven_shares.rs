//! The share of a shape that each kind of proof covers at q.

use super::local_proofs::LocalProofs;
use super::query::Query;
use crate::Error;
use crate::detect::vertex_motion::DeformedMotion;

/// Shares of the triangles, by the kind of proof at some q that no two triangles of their patch collide. A patch is a bucket of the
/// hierarchy (at most 64 triangles), or a larger node that is proven as a whole. The three shares add up to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ProvenShares {
    /// Triangles of patches that are proven by a radius, which `|z|` does not reach.
    pub radius: f64,
    /// Triangles of patches that are proven only by a local certificate, which a query evaluates.
    pub local: f64,
    /// Triangles of patches without a proof: a query searches these patches.
    pub search: f64,
}

impl ProvenShares {
    /// Returns the share of the triangles that each kind of proof of a query covers at q, for each patch with itself. Pairs of
    /// patches have proofs of their own, which are not counted. It takes no longer than a query, and allocates.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn of(query: &mut Query, q: &[f64]) -> Result<Self, Error> {
        let configuration = query.measure(q)?;
        let context = &query.context;
        let Some(parts) = context.used_certificates() else {
            return Ok(ProvenShares { search: 1.0, ..ProvenShares::default() });
        };
        let mut locals = context.locals.as_deref().map(|tables| (LocalProofs::new(tables), tables));
        if let Some((proofs, tables)) = &mut locals
            && proofs.begin(tables, &DeformedMotion::new([q], configuration.reach))
        {
            proofs.prove(tables, &context.detect.hierarchy, &parts.node_radii, configuration.norm);
        }
        let nodes = context.detect.hierarchy.nodes();
        let mut shares = ProvenShares::default();
        let mut stack = vec![0_u32];
        while let Some(n) = stack.pop() {
            let node = &nodes[n as usize];
            let is_local =
                || locals.as_ref().is_some_and(|(proofs, tables)| proofs.is_node_proven(tables, n));
            let share = if configuration.norm < parts.node_radii[n as usize] {
                &mut shares.radius
            } else if is_local() {
                &mut shares.local
            } else if node.fits_in_bucket() {
                &mut shares.search
            } else {
                stack.extend(node.children());
                continue;
            };
            *share += f64::from(node.triangle_count) / f64::from(nodes[0].triangle_count);
        }
        Ok(shares)
    }
}
