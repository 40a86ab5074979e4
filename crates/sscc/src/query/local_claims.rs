//! The pairs of nodes that a single local certificate proves free, for audits.

use super::local_proofs::LocalProofs;
use super::query::Query;
use crate::Error;
use crate::detect::vertex_motion::DeformedMotion;
#[cfg(test)]
use crate::detect::vertex_motion::VertexMotion;
use crate::hierarchy::NodePair;

impl Query {
    /// Returns the pairs of nodes that the local certificate of this number proves free at q, or on straight lines from the first to the
    /// second q: its node with itself, and with other nodes. There are none if the query uses no local certificates.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub(crate) fn local_claims<const E: usize>(
        &mut self,
        index: usize,
        q: [&[f64]; E],
    ) -> Result<Vec<NodePair>, Error> {
        let mut reach = 0.0_f64;
        for q in q {
            reach = reach.max(self.measure(q)?.reach);
        }
        let Some(tables) = self.context.locals.as_deref() else { return Ok(Vec::new()) };
        Ok(LocalProofs::new(tables).claims(tables, &DeformedMotion::new(q, reach), index))
    }

    /// Returns the pairs of [`Query::local_claims`] during a motion, for tests of regions.
    #[cfg(test)]
    fn local_claims_during<const E: usize, M: VertexMotion<E>>(
        &self,
        index: usize,
        motion: &M,
    ) -> Vec<NodePair> {
        let Some(tables) = self.context.locals.as_deref() else { return Vec::new() };
        LocalProofs::new(tables).claims(tables, motion, index)
    }
}

#[cfg(test)]
mod tests;
