//! The contact filter applied to one mesh: the relation of any two triangles, and the exact test that follows from it.

use std::sync::Arc;

use glam::DVec3;

use super::TriangleGroups;
use super::common_corners::{ClassedCorners, intersect_beyond_common_corners};
use super::contact_filter::{ContactFilter, Neighbours, Pair};
use super::weld::weld_classes;
use crate::geometry::intersect_shared_vertex_pair;
use crate::{ReducedModel, intersect_triangle_triangle};

/// The relation of two triangles under a contact filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Relation {
    /// They share no vertex: they count when they have any point in common.
    NonAdjacent,
    /// They share the vertex of this class alone, and such pairs count when they have another point in common.
    SharedVertex(u32),
    /// They share one, two or three vertices, and such pairs count when they have a point in common beyond these and the edges
    /// between them. Only discrete queries of meshes without modes have them.
    Foldable,
    /// They never count, because they are adjacent or the pair of their groups does not count.
    Adjacent,
}

/// The groups of two meshes with one table.
#[derive(Clone, Copy)]
pub(crate) struct GroupsBetween<'f>([&'f TriangleGroups; 2]);

impl GroupsBetween<'_> {
    /// Whether a triangle of the first mesh and one of the second count.
    #[inline]
    pub(crate) fn is_counted(&self, (a, b): Pair) -> bool {
        let Self([first, second]) = self;
        let [g, h] = [first.of_triangles()[a as usize], second.of_triangles()[b as usize]];
        with_mutant!(first.is_counted(g, h), GroupsBetweenForgotten, true)
    }
}

/// A contact filter applied to one mesh.
#[derive(Clone, Debug)]
pub(crate) struct PairFilter {
    pub(super) faces: Vec<[u32; 3]>,
    /// The vertex class of each corner: the lowest vertex that it is welded to; without welding the vertex itself.
    pub(super) classes: Vec<[u32; 3]>,
    neighbours: Neighbours,
    /// The excluded pairs, sorted.
    excluded: Vec<Pair>,
    /// Group numbers, one for each face. None if all pairs of groups count.
    groups: Option<Arc<TriangleGroups>>,
}

impl PairFilter {
    /// Applies the filter to a model. Callers check that its groups, if any, are those of the model
    /// ([`ContactFilter::check_groups`]).
    pub(crate) fn new(model: &ReducedModel, filter: &ContactFilter) -> Self {
        let classes = filter.weld.then(|| weld_classes(model));
        Self::with_classes(model.mesh().faces(), classes.as_deref(), filter)
    }

    /// Applies the filter to a mesh whose vertices are welded by these classes (`None`: not at all), whether or not the filter
    /// welds vertices.
    pub(crate) fn with_classes(faces: &[[u32; 3]], classes: Option<&[u32]>, filter: &ContactFilter) -> Self {
        let of_class = |i: u32, classes: &[u32]| with_mutant!(classes[i as usize], WeldClassesForgotten, i);
        let of_face = |face: &[u32; 3]| face.map(|i| classes.map_or(i, |classes| of_class(i, classes)));
        Self {
            faces: faces.to_vec(),
            classes: faces.iter().map(of_face).collect(),
            neighbours: filter.neighbours,
            excluded: filter.ignored().to_vec(),
            groups: filter.groups().map(Arc::clone),
        }
    }

    /// Returns the same filter, which also excludes these pairs: exceptions, which radii of certificates do not cover.
    pub(crate) fn excluding(mut self, pairs: &[Pair]) -> Self {
        self.excluded.extend_from_slice(pairs);
        self.excluded.sort_unstable();
        self
    }

    /// Returns the faces of the mesh.
    #[inline]
    pub(crate) fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Returns the groups of triangles. None if all pairs of groups count.
    pub(crate) fn groups(&self) -> Option<&TriangleGroups> {
        self.groups.as_deref()
    }

    /// Returns the groups of this mesh and of another one; `None` if they have no common table.
    pub(crate) fn groups_against<'f>(&'f self, other: &'f Self) -> Option<GroupsBetween<'f>> {
        let groups = GroupsBetween([self.groups()?, other.groups()?]);
        groups.0[0].is_common_with(groups.0[1]).then_some(groups)
    }

    /// Returns which triangles that share vertices count.
    pub(crate) fn neighbours(&self) -> Neighbours {
        self.neighbours
    }

    /// Returns the number below which all vertex classes lie.
    pub(crate) fn class_count(&self) -> usize {
        self.classes.iter().flatten().max().map_or(0, |class| *class as usize + 1)
    }

    /// Returns the vertex classes of a triangle's corners.
    #[inline]
    pub(crate) fn vertex_classes(&self, triangle: u32) -> [u32; 3] {
        self.classes[triangle as usize]
    }

    /// Whether all pairs count but those that share a vertex class, excluded pairs aside.
    #[inline]
    pub(crate) fn is_adjacency_alone(&self) -> bool {
        self.neighbours == Neighbours::Exclude && self.groups.is_none()
    }

    /// Returns the relation of two triangles, whether or not their pair is excluded.
    #[inline]
    pub(crate) fn relation(&self, a: u32, b: u32) -> Relation {
        if let Some(groups) = &self.groups
            && with_mutant!(!groups.is_pair_counted(a, b), GroupsForgotten, false)
        {
            return Relation::Adjacent;
        }
        let (classes_a, classes_b) = (self.classes[a as usize], self.classes[b as usize]);
        if classes_a.iter().any(|class| classes_b.contains(class)) {
            self.relation_of_neighbours(a, b)
        } else {
            Relation::NonAdjacent
        }
    }

    /// Returns the relation of two triangles that share a vertex class. It depends on numbers and classes alone: positions that
    /// are given later never change it.
    fn relation_of_neighbours(&self, a: u32, b: u32) -> Relation {
        match self.neighbours {
            Neighbours::Exclude => Relation::Adjacent,
            Neighbours::IncludeFolded => Relation::Foldable,
            Neighbours::IncludeOneVertex => {
                let [class, second] = first_common(self.classes[a as usize], self.classes[b as usize]);
                // Two vertices of one class are two common ones: they may move apart later.
                let [_, second_number] = first_common(self.faces[a as usize], self.faces[b as usize]);
                match (class, second.or(with_mutant!(second_number, VertexNumbersForgotten, None))) {
                    (Some(class), None) => Relation::SharedVertex(class),
                    _ => Relation::Adjacent,
                }
            }
        }
    }

    /// Whether a pair is excluded, whatever its relation.
    #[inline]
    pub(crate) fn is_excluded(&self, a: u32, b: u32) -> bool {
        !self.excluded.is_empty()
            && self
                .excluded
                .binary_search(&with_mutant!((a.min(b), a.max(b)), ExcludedInOneOrder, (a, b)))
                .is_ok()
    }

    /// Whether two triangles with these corners collide and count by their relation. The test is exact. Callers check
    /// [`Self::is_excluded`].
    pub(crate) fn collide(&self, pair: Pair, corners_a: &[DVec3; 3], corners_b: &[DVec3; 3]) -> bool {
        self.collide_as(self.relation(pair.0, pair.1), pair, corners_a, corners_b)
    }

    /// Whether two triangles of this relation collide, as [`Self::collide`].
    #[inline]
    pub(crate) fn collide_as(
        &self,
        relation: Relation,
        pair: Pair,
        corners_a: &[DVec3; 3],
        corners_b: &[DVec3; 3],
    ) -> bool {
        match relation {
            Relation::Adjacent => false,
            Relation::NonAdjacent => intersect_triangle_triangle(corners_a, corners_b),
            Relation::SharedVertex(class) if self.is_vertex_shared(class, pair, corners_a, corners_b) => {
                self.collide_as_shared_vertex_pair(class, pair, corners_a, corners_b)
            }
            Relation::SharedVertex(_) | Relation::Foldable => {
                let classed = |triangle: u32, positions| ClassedCorners {
                    positions,
                    classes: self.classes[triangle as usize],
                };
                // One common vertex may be at two positions. The points between these positions do not belong to the vertex.
                let edges_are_common = relation == Relation::Foldable;
                let [a, b] = [classed(pair.0, corners_a), classed(pair.1, corners_b)];
                intersect_beyond_common_corners(a, b, edges_are_common)
            }
        }
    }

    /// Whether all corners of this class, of both triangles, are at one position. Vertices that are welded by rest
    /// positions can move apart where positions are given.
    pub(super) fn is_vertex_shared(
        &self,
        class: u32,
        (a, b): Pair,
        corners_a: &[DVec3; 3],
        corners_b: &[DVec3; 3],
    ) -> bool {
        let (classes_a, classes_b) = (self.classes[a as usize], self.classes[b as usize]);
        let corners = classes_a.iter().zip(corners_a).chain(classes_b.iter().zip(corners_b));
        let mut shared = corners.filter(|(other, _)| **other == class).map(|(_, corner)| corner);
        let first = shared.next();
        with_mutant!(shared.all(|corner| Some(corner) == first), WeldedVerticesStayTogether, true)
    }

    fn collide_as_shared_vertex_pair(
        &self,
        class: u32,
        (a, b): Pair,
        corners_a: &[DVec3; 3],
        corners_b: &[DVec3; 3],
    ) -> bool {
        match (self.opposite_edge(a, class), self.opposite_edge(b, class)) {
            (Some(edge_a), Some(edge_b)) => {
                let shared = self.classes[a as usize].iter().position(|other| *other == class).unwrap_or(0);
                intersect_shared_vertex_pair(
                    corners_a[shared],
                    edge_a.map(|i| corners_a[i]),
                    edge_b.map(|i| corners_b[i]),
                )
            }
            // All corners of one face are of the class.
            _ => false,
        }
    }
}

/// Returns the first value that two lists have in common, and the first other common value.
fn first_common(a: [u32; 3], b: [u32; 3]) -> [Option<u32>; 2] {
    let mut common = a.into_iter().filter(|x| b.contains(x));
    let first = common.next();
    [first, common.find(|x| Some(*x) != first)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ignored_pairs_have_no_order() {
        let faces = [[0, 1, 2], [3, 4, 5], [6, 7, 8]];
        let filter = PairFilter::with_classes(&faces, None, &ContactFilter::default().ignoring([(2, 0)]));
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            assert_eq!([filter.is_excluded(a, b), filter.is_excluded(b, a)], [(a, b) == (0, 2); 2]);
        }
    }

    /// Two faces whose corners are all welded to one vertex have no other point in common than that vertex.
    #[test]
    fn points_at_their_common_vertex_do_not_collide() {
        let filter = ContactFilter::new(Neighbours::IncludeOneVertex);
        let filter = PairFilter::with_classes(&[[0, 1, 2], [3, 4, 5]], Some(&[0; 6]), &filter);
        assert_eq!(filter.relation(0, 1), Relation::SharedVertex(0));
        assert!(!filter.collide((0, 1), &[DVec3::ONE; 3], &[DVec3::ONE; 3]));
    }

    /// Only where all pairs without common vertices count, and no others, searches need no relations.
    #[test]
    fn relations_follow_from_adjacency_alone_without_groups_and_shared_vertices() {
        let groups = TriangleGroups::new(&[0, 1]).unwrap().between_only();
        for neighbours in [Neighbours::Exclude, Neighbours::IncludeOneVertex, Neighbours::IncludeFolded] {
            let plain = ContactFilter::new(neighbours).ignoring([(0, 1)]);
            let grouped = plain.clone().with_groups(groups.clone());
            let [plain, grouped] =
                [plain, grouped].map(|f| PairFilter::with_classes(&[[0, 1, 2], [3, 4, 5]], None, &f));
            assert_eq!(plain.is_adjacency_alone(), neighbours == Neighbours::Exclude);
            assert!(!grouped.is_adjacency_alone());
            assert_eq!((plain.groups(), grouped.groups()), (None, Some(&groups)));
        }
    }

    /// Two triangles with one to three corners of a class share a vertex only where all these corners are at one position.
    #[test]
    fn vertices_are_shared_where_all_corners_of_the_class_are_together() {
        let filter = ContactFilter::new(Neighbours::IncludeOneVertex);
        for of_class in 0..64_usize {
            let is_of_class = |i: usize| (of_class >> i) & 1 == 1;
            if of_class & 0b111 == 0 || of_class >> 3 == 0 {
                continue;
            }
            let classes: Vec<u32> = (0..6).map(|i| if is_of_class(i as usize) { 9 } else { i }).collect();
            let filter = PairFilter::with_classes(&[[0, 1, 2], [3, 4, 5]], Some(&classes), &filter);
            for aside in 0..64_usize {
                let corner = |i: usize| if (aside >> i) & 1 == 1 { DVec3::X } else { DVec3::ZERO };
                let [a, b] = [0, 3].map(|first| [first, first + 1, first + 2].map(corner));
                let expected = aside & of_class == 0 || aside & of_class == of_class;
                assert_eq!(filter.is_vertex_shared(9, (0, 1), &a, &b), expected, "{of_class:b} {aside:b}");
            }
        }
    }
}
