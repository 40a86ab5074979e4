//! `Query::resolve`: a free configuration near a colliding one.
//!
//! The search begins at the last free configuration on the straight line from a free start to q, and steps back towards q.
//! Pairs that intersect have no separating direction. But at a free configuration every near pair has one, and the
//! configurations at which this direction separates the pair are those in a few half-spaces
//! ([`separations`](super::separations)). A step goes to the nearest point to q within the half-spaces of all pairs that
//! limit the step ([`projection`](super::projection)). A continuous query along the step finds these pairs: its impacts
//! add half-spaces, until there are no impacts. Then the step is free, and a discrete query checks its end. There the
//! directions are those of other closest points, so another step can come nearer to q. The search ends when no step
//! comes nearer.

use super::answer::{ResolveOptions, Resolved};
use super::walk::Walk;
use crate::Error;
use crate::query::query::Query;

/// The search begins at this share of the way to the first contact, where near pairs have gaps that determine directions.
const START: f64 = 0.99;

/// The gaps that pairs keep, as shares of the displacement from where the search begins to q: a larger one at first,
/// because directions change less where gaps are larger.
const MARGINS: [f64; 2] = [1e-3, 1e-5];

/// The largest number of steps for each of [`MARGINS`].
const MAX_STEPS: usize = 32;

/// The steps with one of [`MARGINS`] end when a step reduces the distance to q by at most this share.
const MIN_GAIN: f64 = 1e-3;

impl Query {
    /// Returns a free configuration near q, in the metric of the scope: q itself if it is free. Otherwise it is the end of a
    /// free polyline from the start, and no farther from q than the last free configuration on the straight line from there.
    /// The search is local: a nearer one may exist. `docs/guarantees.md` states the full guarantee.
    ///
    /// Takes as long as some tens to hundreds of continuous queries, and allocates; its memory does not grow with the
    /// number of steps. The last answer of the query is lost; [`Query::statistics`] are those of the last search.
    ///
    /// ```
    /// # use glam::DVec3;
    /// use sscc::{Certificates, CertifyOptions, Modes, Query, ReducedModel, ResolveOptions, TriMesh};
    ///
    /// # fn main() -> Result<(), sscc::Error> {
    /// # let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    /// # let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
    /// # let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 })?;
    /// # let model = ReducedModel::new(mesh, modes)?;
    /// # let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
    /// // Two triangles touch at q = 1. The nearest free q is just before.
    /// let mut query = Query::new(&model, &certificates)?;
    /// let resolved = query.resolve(&[1.0], &ResolveOptions::default())?;
    /// let q = resolved.q.expect("the centre is free");
    /// assert!(query.discrete(&q)?.is_empty());
    /// assert!(0.9 < q[0] && q[0] < 1.0 && resolved.change < 0.1);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Query::discrete`], for q and the start; when a given start collides.
    pub fn resolve(&mut self, q: &[f64], options: &ResolveOptions) -> Result<Resolved, Error> {
        self.forget();
        let resolved = self.resolve_by_walk(q, options);
        self.statistics.finish(resolved)
    }

    /// Resolves q; the caller notes whether that succeeded.
    fn resolve_by_walk(&mut self, q: &[f64], options: &ResolveOptions) -> Result<Resolved, Error> {
        let (model, center) = (&self.context.model, self.context.scope.center.clone());
        model.check_coordinates(q)?;
        if let Some(start) = &options.start {
            model.check_coordinates(start)?;
        }
        let mut walk = Walk::new(self, q, options.start.clone().unwrap_or(center), options.all);
        let is_start_free = walk.is_here_free()?;
        if !is_start_free && options.start.is_some() {
            return Err(Error::ResolveStart);
        }
        if walk.is_free(q)? {
            return Ok(Resolved::free(q));
        }
        if !is_start_free {
            return Ok(Resolved::NONE);
        }
        let (last, safe_scale_change) = walk.approach(START)?;
        let displacement = walk.displacement();
        for margin in MARGINS {
            for _ in 0..MAX_STEPS {
                let before = walk.distance();
                walk.step(margin * displacement)?;
                if walk.distance() >= before * (1.0 - MIN_GAIN) {
                    break;
                }
            }
        }
        let change = walk.distance();
        let is_nearer = change < safe_scale_change;
        let q = Some(if is_nearer { walk.into_configuration() } else { last });
        Ok(Resolved { q, change: change.min(safe_scale_change), safe_scale_change })
    }
}
