//! The contact filter: decides which triangle pairs of any mesh count as collisions.

use std::sync::Arc;

use super::TriangleGroups;
use crate::{Error, TriMesh};

/// Two triangles, the lower number first.
pub type Pair = (u32, u32);

/// Whether triangles that share vertices count. Which vertices two triangles share is decided once, at rest, by vertex numbers
/// and welds; positions never change it. They share as many vertices as they have numbers in common, or welded vertices, if
/// these are more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Neighbours {
    /// They do not count (paper, section 3).
    #[default]
    Exclude,
    /// Shared-vertex pairs, which share exactly one vertex, count when they have another point in common than that vertex.
    IncludeOneVertex,
    /// Pairs that share one, two or three vertices count when they have another point in common than these vertices and the
    /// edges between them: a triangle folded onto its neighbour. Doubled faces, which have all their vertices in common, always
    /// count. For discrete queries of meshes without modes: neighbours in one plane touch at no distance that a radius or a
    /// time of impact could measure, so certificates, models and continuous queries refuse it.
    IncludeFolded,
}

names! { Neighbours, "rule for neighbours":
    Exclude = "exclude",
    IncludeOneVertex = "include-one-vertex",
    IncludeFolded = "include-folded",
}

/// Refuses [`Neighbours::IncludeFolded`] for certificates and queries of models.
///
/// # Errors
/// [`Error::FoldedNeighbours`].
pub fn check_models(neighbours: Neighbours) -> Result<(), Error> {
    check_not_folded(neighbours, "certificates and queries of models")
}

/// Refuses [`Neighbours::IncludeFolded`] for continuous queries.
///
/// # Errors
/// [`Error::FoldedNeighbours`].
pub fn check_continuous(neighbours: Neighbours) -> Result<(), Error> {
    check_not_folded(neighbours, "continuous queries")
}

fn check_not_folded(neighbours: Neighbours, queries: &'static str) -> Result<(), Error> {
    if neighbours == Neighbours::IncludeFolded { Err(Error::FoldedNeighbours { queries }) } else { Ok(()) }
}

/// Which pairs of triangles count as collisions when they have a point in common. By default: all that share no vertex.
/// [`ContactFilter::of`] is the default of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ContactFilter {
    /// Whether triangles that share a vertex count.
    pub neighbours: Neighbours,
    /// Whether vertices of exactly equal rest position and modes (for a [`Detector`](crate::Detector): of equal rest position)
    /// are welded, for adjacency only: vertex numbers and positions do not change. Use it for meshes whose vertices are split
    /// along seams.
    pub weld: bool,
    ignored: Vec<Pair>,
    /// None if all pairs of groups count.
    groups: Option<Arc<TriangleGroups>>,
}

impl ContactFilter {
    /// Returns the default filter of a mesh: no pair with a common vertex counts, and equal vertices are welded if the mesh comes
    /// from a format that splits them ([`TriMesh::has_split_vertices`]).
    pub fn of(mesh: &TriMesh) -> Self {
        Self::default().weld(mesh.has_split_vertices())
    }

    /// Creates a filter that welds nothing, ignores no pair and has no groups.
    pub fn new(neighbours: Neighbours) -> Self {
        Self { neighbours, ..Self::default() }
    }

    setters! {
        /// Sets [`ContactFilter::weld`](#structfield.weld).
        weld: bool,
    }

    /// Returns the same filter, which also ignores these pairs (in any order).
    #[must_use]
    pub fn ignoring(mut self, pairs: impl IntoIterator<Item = Pair>) -> Self {
        let pairs = pairs.into_iter().filter(|(a, b)| a != b);
        self.ignored.extend(pairs.map(|(a, b)| (a.min(b), a.max(b))));
        self.ignored.sort_unstable();
        self.ignored.dedup();
        self
    }

    /// Returns the same filter, under which two triangles count only if the pair of their groups does. Groups whose pairs all
    /// count are dropped.
    #[must_use]
    pub fn with_groups(mut self, groups: impl Into<Arc<TriangleGroups>>) -> Self {
        self.groups = Some(groups.into()).filter(|groups| !groups.is_all_counted());
        self
    }

    /// Returns the pairs that never count, sorted.
    pub fn ignored(&self) -> &[Pair] {
        &self.ignored
    }

    /// Returns the groups of triangles. None if all pairs of groups count.
    pub fn groups(&self) -> Option<&Arc<TriangleGroups>> {
        self.groups.as_ref()
    }

    /// Refuses groups of another mesh, and folded neighbours, which no certificate and no continuous query can decide.
    pub(crate) fn check_model(&self, triangles: usize) -> Result<(), Error> {
        self.check_groups(triangles)?;
        check_models(self.neighbours)
    }

    /// Refuses groups of another mesh.
    pub(crate) fn check_groups(&self, triangles: usize) -> Result<(), Error> {
        match self.groups.as_ref().map(|groups| groups.of_triangles().len()) {
            Some(found) if found != triangles => Err(Error::Groups {
                what: format!(
                    "there are {found} group numbers for {triangles} triangles: one for each is needed"
                ),
            }),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_of_another_mesh_are_refused() {
        let groups = TriangleGroups::new(&[0, 1, 1]).unwrap().between_only();
        let filter = ContactFilter::default().with_groups(groups);
        assert!(filter.check_groups(3).is_ok() && ContactFilter::default().check_groups(7).is_ok());
        for triangles in [2, 4] {
            assert!(matches!(filter.check_groups(triangles), Err(Error::Groups { .. })), "{triangles}");
        }
    }

    /// Neither certificates nor continuous queries can decide folded neighbours.
    #[test]
    fn folded_neighbours_are_refused_except_for_discrete_queries_of_meshes() {
        for neighbours in [Neighbours::Exclude, Neighbours::IncludeOneVertex] {
            assert!(check_models(neighbours).is_ok() && check_continuous(neighbours).is_ok());
            assert!(ContactFilter::new(neighbours).check_model(5).is_ok());
        }
        let folded = Neighbours::IncludeFolded;
        for result in
            [check_models(folded), check_continuous(folded), ContactFilter::new(folded).check_model(5)]
        {
            assert!(matches!(result, Err(Error::FoldedNeighbours { .. })));
        }
        assert!(ContactFilter::new(folded).check_groups(5).is_ok());
    }

    /// A filter has the groups it was given, unless all of their pairs count; a model has one for each of its triangles.
    #[test]
    fn filters_keep_groups_of_which_some_pairs_do_not_count() {
        let groups = TriangleGroups::new(&[0, 1, 1]).unwrap();
        assert_eq!(ContactFilter::default().with_groups(groups.clone()).groups(), None);
        let between = groups.between_only();
        let filter = ContactFilter::default().with_groups(between.clone());
        assert_eq!(filter.groups().map(|groups| &**groups), Some(&between));
        assert!(filter.check_model(3).is_ok());
        for triangles in [0, 2, 4] {
            assert!(matches!(filter.check_model(triangles), Err(Error::Groups { .. })), "{triangles}");
        }
    }
}
