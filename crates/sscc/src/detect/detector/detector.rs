//! The detector for given positions: exact collisions of any deforming triangle mesh, with itself or with another one.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use super::clearance_search::ClearanceSearch;
use super::components::Components;
use super::detector_search::{DetectorSearch, Refit};
use super::given_motion::GivenMotion;
use crate::arithmetic::check_arithmetic;
use crate::detect::answer::Statistics;
use crate::detect::context::Context;
use crate::detect::layout::Layout;
use crate::detect::narrow_phase::{DiscreteHits, SweptHits};
use crate::filter::{PairFilter, check_continuous, weld_classes, weld_classes_of_positions};
use crate::hierarchy::Hierarchy;
use crate::{CancelToken, ContactFilter, Error, Impact, Pair, ReducedModel, TriMesh, limits};

/// Finds the colliding triangles of a mesh at given positions. It builds a bounding volume hierarchy (BVH) once and refits it
/// for each answer; if the cost of the hierarchy has grown too much, it rebuilds it. It owns its memory, so that repeated answers
/// about collisions allocate nothing, unless it rebuilds the hierarchy. One detector serves one thread; clones share the data
/// that does not change.
///
/// Two triangles are listed exactly when they count under the contact filter (by default when they share no vertex) and have a
/// point in common at the given f64 positions. Touching counts. See `docs/guarantees.md`.
///
/// ```
/// use glam::DVec3;
/// use sscc::{Detector, TriMesh};
///
/// # fn main() -> Result<(), sscc::Error> {
/// // Two triangles one unit apart.
/// let rest = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
/// let mesh = TriMesh::new(rest.clone(), vec![[0, 1, 2], [3, 4, 5]])?;
/// let mut detector = Detector::new(&mesh);
/// assert!(detector.discrete(&rest)?.is_empty());
///
/// // The second one falls through the first.
/// let fallen: Vec<DVec3> = rest.iter().map(|x| *x - DVec3::Z * (2.0 * x.z)).collect();
/// assert!(detector.discrete(&fallen)?.is_empty());
/// let impacts = detector.continuous(&rest, &fallen)?;
/// assert_eq!((impacts.len(), impacts[0].pair), (1, (0, 1)));
/// assert!((impacts[0].time - 0.5).abs() < 1e-9);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Detector {
    pub(super) context: Context,
    vertex_count: usize,
    pub(super) discrete: DetectorSearch<1, DiscreteHits>,
    pub(super) swept: DetectorSearch<2, SweptHits>,
    /// Created by the first search for near pairs.
    pub(super) clearance: Option<Box<ClearanceSearch>>,
    /// The connected components of the mesh with welded vertices; found by the first query of enclosed components.
    pub(super) components: Option<Arc<Components>>,
    pub(super) statistics: Statistics,
    /// Whether the hierarchy has been searched for self-collisions.
    is_used: bool,
}

/// Shows the last answer only.
impl fmt::Debug for Detector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Detector")
            .field("vertex_count", &self.vertex_count)
            .field("statistics", &self.statistics)
            .finish_non_exhaustive()
    }
}

impl Detector {
    /// Creates a detector for a mesh, with its default contact filter ([`ContactFilter::of`]): pairs count that share no vertex;
    /// equal vertices are welded if the file format splits vertices. Apart from that, the rest positions determine only the
    /// hierarchy. Building it takes about as long as two answers.
    pub fn new(mesh: &TriMesh) -> Self {
        Self::welded(mesh, &ContactFilter::of(mesh))
    }

    /// Creates a detector with the given contact filter. [`ContactFilter::weld`] welds vertices of exactly equal rest position,
    /// also if they move apart later: triangles that meet there at rest are adjacent and never count.
    ///
    /// # Errors
    /// When the filter's groups are of another mesh.
    pub fn with_filter(mesh: &TriMesh, filter: &ContactFilter) -> Result<Self, Error> {
        filter.check_groups(mesh.faces().len())?;
        Ok(Self::welded(mesh, filter))
    }

    fn welded(mesh: &TriMesh, filter: &ContactFilter) -> Self {
        let classes = filter.weld.then(|| weld_classes_of_positions(mesh.rest_positions()));
        Self::build(mesh, classes.as_deref(), filter)
    }

    fn build(mesh: &TriMesh, classes: Option<&[u32]>, filter: &ContactFilter) -> Self {
        let positions = mesh.rest_positions();
        let filter = PairFilter::with_classes(mesh.faces(), classes, filter);
        let hierarchy = Hierarchy::build_by_median(mesh.faces(), positions);
        let layout = Arc::new(Layout::of_positions(positions.len(), &hierarchy, &filter));
        let context = Context {
            hierarchy: Arc::new(hierarchy),
            filter: Arc::new(filter),
            exceptions: Arc::new([]),
            layout,
            cancel: None,
        };
        Self {
            context,
            vertex_count: positions.len(),
            discrete: DetectorSearch::default(),
            swept: DetectorSearch::default(),
            clearance: None,
            components: None,
            statistics: Statistics::default(),
            is_used: false,
        }
    }

    /// Returns the same detector, which checks regularly whether the token cancels it; with `None` it no longer checks.
    #[must_use]
    pub fn cancelled_by(mut self, token: impl Into<Option<CancelToken>>) -> Self {
        self.context.cancel = token.into();
        self
    }

    /// The maximum number of pairs of an answer without a limit: 2^26, which bounds its memory to 512 MiB (1 GiB of impacts).
    /// A mesh of n triangles that collapses to a point has about n^2 / 2 pairs.
    pub const MAX_PAIRS: usize = 1 << 26;

    /// Returns all colliding pairs at these positions (one for each vertex of the mesh, model unit), sorted: triangle indices
    /// `i < j`.
    ///
    /// # Errors
    /// When there are not as many positions as vertices, or one is not finite or beyond
    /// [`limits::LARGEST`](crate::limits::LARGEST); when this thread's arithmetic is not that of IEEE 754
    /// ([`Error::Arithmetic`]); when there are more than [`Detector::MAX_PAIRS`] pairs; when the search was cancelled.
    pub fn discrete(&mut self, positions: &[DVec3]) -> Result<&[Pair], Error> {
        self.discrete_at_most(positions, Self::MAX_PAIRS)?;
        self.check_complete()?;
        Ok(&self.discrete.narrow.0.list)
    }

    /// Returns at most `limit` colliding pairs, sorted; which ones is not fixed. Where the limit stopped the search,
    /// [`Statistics::complete`] is false: there may be more.
    ///
    /// # Errors
    /// As [`Detector::discrete`], but not because of the number of pairs.
    pub fn discrete_at_most(&mut self, positions: &[DVec3], limit: usize) -> Result<&[Pair], Error> {
        let motion = self.check([positions])?;
        self.mask_adjacent();
        self.begin_discrete(&motion, positions, Refit::All);
        let result = self.discrete.find(&self.context, &motion, limit);
        self.statistics.set_search(&mut self.discrete, result.is_ok());
        result?;
        self.discrete.narrow.0.list.sort_unstable();
        Ok(&self.discrete.narrow.0.list)
    }

    /// Returns one colliding pair, if there is any; which one is not fixed.
    ///
    /// # Errors
    /// As [`Detector::discrete_at_most`].
    pub fn first(&mut self, positions: &[DVec3]) -> Result<Option<Pair>, Error> {
        Ok(self.discrete_at_most(positions, 1)?.first().copied())
    }

    /// Returns the number of colliding pairs.
    ///
    /// # Errors
    /// As [`Detector::discrete`].
    pub fn count(&mut self, positions: &[DVec3]) -> Result<usize, Error> {
        Ok(self.discrete(positions)?.len())
    }

    /// Returns all pairs that collide while every vertex moves on a straight line from its position at the start to that at the
    /// end, sorted by pair, each with its time of impact, with the guarantee of [`Query::continuous`](crate::Query::continuous).
    ///
    /// # Errors
    /// As [`Detector::discrete`], for both sets of positions; when the filter has [`Neighbours::IncludeFolded`](crate::Neighbours).
    pub fn continuous(&mut self, x_t0: &[DVec3], x_t1: &[DVec3]) -> Result<&[Impact], Error> {
        self.statistics = self.statistics.forget();
        check_continuous(self.context.filter.neighbours())?;
        let motion = self.check([x_t0, x_t1])?;
        self.mask_adjacent();
        self.begin_swept(&motion, x_t0, Refit::All);
        let result = self.swept.find(&self.context, &motion, Self::MAX_PAIRS);
        self.statistics.set_search(&mut self.swept, result.is_ok());
        result?;
        self.check_complete()?;
        self.swept.narrow.0.list.sort_unstable_by_key(|impact| impact.pair);
        Ok(&self.swept.narrow.0.list)
    }

    /// Returns the cost of the last answer.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Clears the statistics of the last answer, and checks the arithmetic and the positions.
    ///
    /// # Errors
    /// Those of [`Detector::discrete`] that concern the arithmetic and the positions.
    pub(super) fn check<'x, const E: usize>(
        &mut self,
        positions: [&'x [DVec3]; E],
    ) -> Result<GivenMotion<'x, E>, Error> {
        self.statistics = self.statistics.forget();
        check_arithmetic()?;
        for x in positions {
            check_count(x.len(), self.vertex_count)?;
            if let Some(vertex) = x.iter().position(|x| !limits::contains(*x)) {
                return Err(Error::Position { vertex, position: x[vertex].to_array() });
            }
        }
        Ok(GivenMotion::new(positions, &self.context.layout))
    }

    /// Starts a discrete search; rebuilds the hierarchy by these positions if its cost has grown too much.
    pub(super) fn begin_discrete(&mut self, motion: &GivenMotion<'_, 1>, positions: &[DVec3], refit: Refit) {
        if !self.discrete.begin(&self.context, motion, refit) {
            self.rebuild(positions);
            self.discrete.begin(&self.context, motion, refit);
        }
    }

    /// Starts a swept search; rebuilds the hierarchy by the positions at the start if its cost has grown too much.
    pub(super) fn begin_swept(&mut self, motion: &GivenMotion<'_, 2>, x_t0: &[DVec3], refit: Refit) {
        if !self.swept.begin(&self.context, motion, refit) {
            self.rebuild(x_t0);
            self.swept.begin(&self.context, motion, refit);
        }
    }

    /// Checks that the last search was complete.
    ///
    /// # Errors
    /// When the maximum number of pairs stopped the last search.
    pub(super) fn check_complete(&self) -> Result<(), Error> {
        Self::check_limit(usize::MAX, self.statistics.complete)
    }

    /// Checks a search with the smaller one of a limit and [`Detector::MAX_PAIRS`], of a detector, a query or a shape.
    ///
    /// # Errors
    /// When the maximum stopped the search.
    pub(crate) fn check_limit(limit: usize, is_complete: bool) -> Result<(), Error> {
        let most = Self::MAX_PAIRS;
        let is_allowed = is_complete || limit <= most;
        if with_mutant!(is_allowed, IncompleteAnswersWithoutError, true) {
            Ok(())
        } else {
            Err(Error::TooManyPairs { most })
        }
    }

    /// Computes the masks of adjacent triangles at the second search with a hierarchy, so that a detector that is used once saves
    /// the time.
    fn mask_adjacent(&mut self) {
        if self.is_used {
            self.context.layout.buckets.mask_adjacent(&self.context.filter);
        }
        self.is_used = true;
    }

    /// Rebuilds the hierarchy by these positions.
    pub(super) fn rebuild(&mut self, positions: &[DVec3]) {
        let filter = &self.context.filter;
        let hierarchy = Hierarchy::build_by_median(filter.faces(), positions);
        let layout = Arc::new(Layout::of_positions(positions.len(), &hierarchy, filter));
        self.context.layout = layout;
        self.context.hierarchy = Arc::new(hierarchy);
        self.discrete = DetectorSearch::default();
        self.swept = DetectorSearch::default();
        self.clearance = None;
        self.is_used = false;
        self.statistics.rebuilds += 1;
    }
}

/// Creates a detector whose vertices are welded by the given classes: vertices with the same number are one vertex for
/// adjacency, as in skinned meshes, where vertices of equal rest position may move apart.
///
/// # Errors
/// When there are not as many classes as vertices, or the filter's groups are of another mesh.
pub fn detector_with_weld_classes(
    mesh: &TriMesh,
    classes: &[u32],
    filter: &ContactFilter,
) -> Result<Detector, Error> {
    if classes.len() != mesh.rest_positions().len() {
        let (name, wanted) = ("the number of weld classes", "the number of vertices of the mesh");
        return Err(Error::Option { name, value: classes.len() as f64, wanted });
    }
    filter.check_groups(mesh.faces().len())?;
    // Classes are numbered by vertices, which bounds the memory of tables by class.
    let mut first = HashMap::new();
    let vertices = classes.iter().enumerate();
    let classes: Vec<u32> = vertices.map(|(v, class)| *first.entry(*class).or_insert(v as u32)).collect();
    Ok(Detector::build(mesh, Some(&classes), filter))
}

/// Creates a detector for positions of a model, which welds vertices as queries do: those of equal rest position and modes.
///
/// # Errors
/// When the filter's groups are of another mesh.
pub(crate) fn detector_of_model(model: &ReducedModel, filter: &ContactFilter) -> Result<Detector, Error> {
    filter.check_groups(model.mesh().faces().len())?;
    let classes = filter.weld.then(|| weld_classes(model));
    Ok(Detector::build(model.mesh(), classes.as_deref(), filter))
}

/// Checks the number of positions.
///
/// # Errors
/// When the number of positions is not that of the vertices.
fn check_count(found: usize, vertices: usize) -> Result<(), Error> {
    if found == vertices { Ok(()) } else { Err(Error::PositionCount { found, vertices }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_pairs_than_the_maximum_are_an_error() {
        let corners = |z: f64| [DVec3::ZERO, DVec3::X, DVec3::new(0.2, 0.7, z)];
        let mesh = TriMesh::new([corners(0.0), corners(0.1)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let mut detector = Detector::new(&mesh);
        assert_eq!(detector.discrete(mesh.rest_positions()).unwrap(), [(0, 1)]);
        detector.check_complete().unwrap();
        detector.discrete_at_most(mesh.rest_positions(), 0).unwrap();
        let most = Detector::MAX_PAIRS;
        assert!(matches!(detector.check_complete(), Err(Error::TooManyPairs { most: m }) if m == most));
        // A caller that gives a limit knows that there may be more.
        let errors =
            [most - 1, most, most + 1, usize::MAX].map(|limit| Detector::check_limit(limit, false).is_err());
        assert_eq!(errors, [false, false, true, true]);
    }
}
