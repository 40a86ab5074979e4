//! Clearance queries: the triangle pairs of one mesh, or between two meshes, that are nearer than a distance.

use glam::DVec3;

use super::against::in_common_frame;
use super::clearance_search::ClearanceSearch;
use super::detector::{Detector, detector_of_model};
use super::detector_search::{DetectorSearch, Refit};
use super::given_motion::GivenMotion;
use crate::detect::narrow_phase::NearPair;
use crate::detect::vertex_motion::VertexMotion;
use crate::filter::Rings;
use crate::{ContactFilter, Error, Pair, Progress, ReducedModel};

/// A distance that triangles should keep, and the number of rings of neighbours that need not keep it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    distance: f64,
    rings: u32,
}

impl Clearance {
    /// Returns the clearance of this distance (model unit). Triangles with a common vertex need not keep it.
    ///
    /// # Errors
    /// When the distance is not positive and finite.
    pub fn new(distance: f64) -> Result<Self, Error> {
        if distance > 0.0 && distance.is_finite() {
            return Ok(Self { distance, rings: 1 });
        }
        Err(Error::Option { name: "clearance", value: distance, wanted: "positive and finite" })
    }

    /// Returns the same clearance for triangles of one mesh that are not within `rings` rings of each other on the surface: 1 for
    /// triangles with a common vertex (these never count), 2 also for triangles with a common neighbour, and so on.
    #[must_use]
    pub fn beyond_rings(self, rings: u32) -> Self {
        Self { rings, ..self }
    }

    /// Returns the distance (model unit).
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Returns the number of rings of neighbours that need not keep the distance.
    pub fn rings(&self) -> u32 {
        self.rings
    }
}

/// A model with more near pairs than this at one configuration (384 MiB of them) is refused.
const MAX_PAIRS_OF_MODEL: usize = 1 << 24;

/// Returns all pairs of a model that count and are nearer than a clearance at q, sorted.
///
/// # Errors
/// When q is not a configuration of the model, the filter's groups are of another mesh, this thread's arithmetic is not that of
/// IEEE 754 ([`Error::Arithmetic`]), there are more than 2^24 such pairs (including those within the rings), or `progress`
/// cancels.
pub(crate) fn near_pairs_of_model(
    model: &ReducedModel,
    filter: &ContactFilter,
    q: &[f64],
    clearance: &Clearance,
    progress: &dyn Progress,
) -> Result<Vec<Pair>, Error> {
    let positions = model.positions(q)?;
    let mut detector = detector_of_model(model, filter)?.cancelled_by(progress.cancel_token().cloned());
    detector.within_at_most(&positions, clearance, MAX_PAIRS_OF_MODEL)?;
    Ok(detector.near_pairs().iter().map(|near| near.pair).collect())
}

impl Detector {
    /// Returns all pairs that count and are nearer than a clearance at these positions, sorted by pair. The listed distances are less
    /// than the clearance, and have the error of [`distance_triangle_triangle`](crate::distance_triangle_triangle). Pairs that
    /// collide have distance 0. Triangles with a common vertex never count here.
    ///
    /// ```
    /// use glam::DVec3;
    /// use sscc::{Clearance, Detector, TriMesh};
    ///
    /// # fn main() -> Result<(), sscc::Error> {
    /// // Two triangles one unit apart.
    /// let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    /// let mesh = TriMesh::new(positions.clone(), vec![[0, 1, 2], [3, 4, 5]])?;
    /// let mut detector = Detector::new(&mesh);
    /// assert!(detector.within(&positions, &Clearance::new(0.5)?)?.is_empty());
    /// let near = detector.within(&positions, &Clearance::new(1.5)?)?;
    /// assert_eq!((near.len(), near[0].pair, near[0].distance), (1, (0, 1), 1.0));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Detector::discrete`]; the maximum number of pairs includes those within the rings, which are not listed.
    pub fn within(&mut self, positions: &[DVec3], clearance: &Clearance) -> Result<&[NearPair], Error> {
        self.within_at_most(positions, clearance, Self::MAX_PAIRS)?;
        Ok(self.near_pairs())
    }

    /// Finds all near pairs, if there are at most `most` of them, including those within the rings, which are then removed.
    fn within_at_most(
        &mut self,
        positions: &[DVec3],
        clearance: &Clearance,
        most: usize,
    ) -> Result<(), Error> {
        let motion = self.check([positions])?.widened(clearance.distance);
        self.begin_clearance(&motion, positions, Refit::All, clearance);
        let (context, near) = (&self.context, &mut self.clearance);
        let Some(ClearanceSearch { search, .. }) = near.as_deref_mut() else { return Ok(()) };
        let mut result = search.find(context, &motion, most);
        self.statistics.set_search(search, result.is_ok());
        let list = &mut search.narrow.hits.list;
        list.sort_unstable_by_key(|near| near.pair);
        if clearance.rings > 1 && result.is_ok() {
            let mut rings = Rings::new(&context.filter, clearance.rings);
            list.retain(|NearPair { pair: (a, b), .. }| {
                // The rings of one triangle may take as long as those of all others.
                if context.is_cancelled() {
                    result = Err(Error::Cancelled);
                }
                result.is_ok() && !rings.contain(&context.filter, *a, *b)
            });
        }
        self.statistics.complete &= result.is_ok();
        result?;
        self.check_complete().map_err(|_| Error::TooManyNearPairs { most })
    }

    /// Returns all pairs (triangle of this mesh at `positions`, triangle of the other at `other_positions`) nearer than a clearance,
    /// sorted. Pairs count as for [`Detector::against`]; the rings of the clearance have no effect between meshes.
    ///
    /// # Errors
    /// As [`Detector::discrete`], for the positions of both meshes.
    pub fn within_against(
        &mut self,
        positions: &[DVec3],
        other: &mut Detector,
        other_positions: &[DVec3],
        clearance: &Clearance,
    ) -> Result<&[NearPair], Error> {
        let motions = [self.check([positions])?, other.check([other_positions])?];
        let motions = in_common_frame(motions).map(|motion| motion.widened(clearance.distance));
        self.begin_clearance(&motions[0], positions, Refit::Nodes, clearance);
        other.begin_clearance(&motions[1], other_positions, Refit::Nodes, clearance);
        let contexts = [&self.context, &other.context];
        if let (Some(one), Some(two)) = (&mut self.clearance, &mut other.clearance) {
            let result = one.search.find_between(&mut two.search, contexts, &motions, Self::MAX_PAIRS);
            self.statistics.set_search(&mut one.search, result.is_ok());
            result?;
            one.search.narrow.hits.list.sort_unstable_by_key(|near| near.pair);
        }
        self.check_complete().map_err(|_| Error::TooManyNearPairs { most: Self::MAX_PAIRS })?;
        Ok(self.near_pairs())
    }

    /// Returns the pairs of the last search for near pairs.
    pub(crate) fn near_pairs(&self) -> &[NearPair] {
        self.clearance.as_ref().map_or(&[], |near| &near.search.narrow.hits.list)
    }

    /// Starts a search for near pairs; rebuilds the hierarchy by these positions if its cost has grown too much.
    fn begin_clearance(
        &mut self,
        motion: &GivenMotion<'_, 1>,
        positions: &[DVec3],
        refit: Refit,
        clearance: &Clearance,
    ) {
        for is_last in [false, true] {
            let margin = motion.margin();
            // The cost of a hierarchy grows with the margin, so costs are compared for equal margins only.
            let near = self.clearance.take().filter(|near| near.margin == margin);
            let mut near = near
                .unwrap_or_else(|| Box::new(ClearanceSearch { margin, search: DetectorSearch::default() }));
            near.search.narrow.distance = clearance.distance;
            let is_good = near.search.begin(&self.context, motion, refit);
            self.clearance = Some(near);
            if is_good || is_last {
                return;
            }
            self.rebuild(positions);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TriMesh;

    #[test]
    fn clearances_are_positive_numbers_and_an_incomplete_list_is_an_error() {
        for distance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Clearance::new(distance).is_err(), "{distance}");
        }
        let plate = |x: f64| [DVec3::ZERO, DVec3::Y, DVec3::Z].map(|p| p * 1000.0 + DVec3::X * x);
        let positions = [plate(0.0), plate(300.0)].concat();
        let mesh = TriMesh::new(positions.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let mut detector = Detector::new(&mesh);
        let clearance = Clearance::new(500.0).unwrap();
        assert_eq!(detector.within(&positions, &clearance).unwrap().len(), 1);
        let found = detector.within_at_most(&positions, &clearance, 0);
        assert!(matches!(found, Err(Error::TooManyNearPairs { most: 0 })));
    }
}
