//! The reason why certificates have a root radius of 0.

use sscc::parts::default_exceptions;
use sscc::{Certificates, Error, Progress, Query, ReducedModel};

use crate::CertificateRequest;

/// The reason for a root's radius of 0, found by queries at the centre and at rest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ZeroRadius {
    /// More pairs collide at the centre than may be exceptions.
    Colliding {
        /// The largest number of exceptions.
        max_exceptions: usize,
        /// Whether `--ignore-rest` is absent, and would reduce the pairs to at most `max_exceptions`.
        can_ignore_rest: bool,
    },
    /// More pairs are nearer than the clearance at the centre than may be exceptions.
    Near {
        /// The largest number of exceptions.
        max_exceptions: usize,
        /// Number of rings beyond which pairs count.
        rings: u32,
    },
    /// Only exceptions collide at the centre, but two of these triangles are too close for a bound above 0. With a
    /// clearance only exceptions are nearer than it, but two of the triangles are hardly farther apart.
    TooClose {
        /// Triangles of the smallest part with radius 0, sorted.
        triangles: Vec<u32>,
        /// Whether the certificates have a clearance.
        has_clearance: bool,
    },
}

impl ZeroRadius {
    /// Finds the reason; None if the root's radius is not 0. Costs up to two discrete queries, or one query of the
    /// clearance.
    ///
    /// # Errors
    /// When the certificates are of another model, more than [`sscc::Detector::MAX_PAIRS`] pairs are nearer than the
    /// clearance, or `progress` cancels.
    pub fn find(
        model: &ReducedModel,
        certificates: &Certificates,
        request: &CertificateRequest,
        progress: &dyn Progress,
    ) -> Result<Option<Self>, Error> {
        if certificates.root_radius() > 0.0 {
            return Ok(None);
        }
        let mut query = Query::new(model, certificates)?.cancelled_by(progress.cancel_token().cloned());
        let center = certificates.center();
        if let Some(clearance) = certificates.clearance() {
            let near = query.within(center, &clearance)?.iter();
            let is_other = |pair| certificates.exceptions().binary_search(pair).is_err();
            let others = near.filter(|near| is_other(&near.pair)).count();
            let default = default_exceptions(model.mesh().faces().len());
            let max_exceptions = request.max_exceptions.unwrap_or(default);
            return Ok(Some(match others {
                0 => Self::TooClose { triangles: smallest_zero_node(certificates), has_clearance: true },
                _ => Self::Near { max_exceptions, rings: clearance.rings() },
            }));
        }
        let mut others = query.discrete(center)?.to_vec();
        others.retain(|pair| certificates.exceptions().binary_search(pair).is_err());
        if others.is_empty() {
            let triangles = smallest_zero_node(certificates);
            return Ok(Some(Self::TooClose { triangles, has_clearance: false }));
        }
        let default = default_exceptions(model.mesh().faces().len());
        let max_exceptions = request.max_exceptions.unwrap_or(default);
        let at_rest = query.discrete(&vec![0.0; model.rank()])?;
        let left = others.iter().filter(|pair| at_rest.binary_search(pair).is_err()).count();
        let can_ignore_rest = request.ignore_rest.is_none() && left <= max_exceptions;
        Ok(Some(Self::Colliding { max_exceptions, can_ignore_rest }))
    }
}

/// Returns the triangles of the smallest node with radius 0. Nodes within a bucket are skipped, because they repeat the
/// bucket's radius.
fn smallest_zero_node(certificates: &Certificates) -> Vec<u32> {
    let hierarchy = &certificates.parts().hierarchy;
    let nodes = hierarchy.nodes();
    let mut is_own = vec![true; nodes.len()];
    for (n, node) in nodes.iter().enumerate() {
        let has_own_children = is_own[n] && (n == 0 || !node.fits_in_bucket());
        node.children().for_each(|child| is_own[child as usize] = has_own_children);
    }
    let has_zero_radius = |n: &usize| is_own[*n] && certificates.parts().node_radii[*n] <= 0.0;
    let smallest = (0..nodes.len()).filter(has_zero_radius).min_by_key(|n| nodes[*n].triangle_count);
    let mut triangles = smallest.map(|n| hierarchy.triangles(&nodes[n]).to_vec()).unwrap_or_default();
    triangles.sort_unstable();
    triangles
}
