//! The number of connected components of a mesh that lie inside another one.

use std::sync::Arc;

use glam::DVec3;

use super::boxes::Boxes;
use super::components::Components;
use super::detector::Detector;
use crate::Error;
use crate::geometry::crossing;

/// The number of connected components of a mesh that lie inside another mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Enclosed {
    /// The number of connected components of the mesh.
    pub components: usize,
    /// The number of components that lie inside the other mesh.
    pub inside: usize,
}

impl Detector {
    /// Counts the connected components of this mesh that lie inside the other one, and those of the other mesh inside this one, at
    /// positions at which [`Detector::against`] finds no pair: then each component is inside or outside as a whole.
    ///
    /// Only closed parts have an inside: triangles that common edges join, directly or through others, and that run along every edge as
    /// often in one direction as in the other. A component, closed or not, is inside if the winding number of the closed parts of the
    /// other mesh about it is not 0. The winding number is computed exactly. Vertices that the contact filter welds are one vertex, unless the
    /// vertices of any weld have different positions: then no vertices of that mesh are welded.
    ///
    /// # Errors
    /// As [`Detector::discrete_at_most`], for the positions of both meshes.
    pub fn enclosed(
        &mut self,
        positions: &[DVec3],
        other: &mut Detector,
        other_positions: &[DVec3],
    ) -> Result<[Enclosed; 2], Error> {
        self.check([positions])?;
        other.check([other_positions])?;
        let enclosed = self.count_enclosed(positions, other, other_positions);
        self.statistics.finish(enclosed)
    }

    /// Counts as [`Detector::enclosed`], at positions that were checked.
    ///
    /// # Errors
    /// When a token cancels.
    fn count_enclosed(
        &mut self,
        positions: &[DVec3],
        other: &mut Detector,
        other_positions: &[DVec3],
    ) -> Result<[Enclosed; 2], Error> {
        let components = [self.components_at(positions), other.components_at(other_positions)];
        let [one, two] = components.each_ref().map(|components| &**components);
        if with_mutant!(
            !one.has_closed() && !two.has_closed(),
            OneOpenMeshHasNone,
            !one.has_closed() || !two.has_closed()
        ) {
            return Ok([one, two].map(|all| Enclosed { components: all.count(), inside: 0 }));
        }
        let one = Side { boxes: Boxes::new(&self.context, positions), components: one };
        let two = Side { boxes: Boxes::new(&other.context, other_positions), components: two };
        Ok([two.enclose(&one)?, one.enclose(&two)?])
    }

    /// Returns the connected components. If the vertices of any weld have different positions, no vertices are welded.
    pub(super) fn components_at(&mut self, positions: &[DVec3]) -> Arc<Components> {
        let filter = &self.context.filter;
        let triangles = 0..filter.faces().len() as u32;
        let mut of_classes = vec![None; filter.class_count()];
        let are_together = triangles.clone().zip(filter.faces()).all(|(t, face)| {
            face.iter().zip(filter.vertex_classes(t)).all(|(v, class)| {
                let x = positions[*v as usize];
                *of_classes[class as usize].get_or_insert(x) == x
            })
        });
        if !with_mutant!(are_together, WeldsStayTogether, true) {
            return Arc::new(Components::new(filter.faces()));
        }
        let welded = || triangles.map(|t| filter.vertex_classes(t)).collect::<Vec<_>>();
        Arc::clone(self.components.get_or_insert_with(|| Arc::new(Components::new(&welded()))))
    }
}

/// A mesh at given positions.
pub(super) struct Side<'x> {
    pub boxes: Boxes<'x>,
    pub components: &'x Components,
}

impl Side<'_> {
    /// Counts the components of `other` that are inside.
    ///
    /// # Errors
    /// When the token cancels.
    fn enclose(&self, other: &Self) -> Result<Enclosed, Error> {
        let mut inside = 0;
        if self.components.has_closed() {
            for triangle in other.components.triangles() {
                inside += usize::from(self.winding_number(other.boxes.corners(*triangle)[0])? != 0);
            }
        }
        Ok(Enclosed { components: other.components.count(), inside })
    }

    /// Returns the winding number of the closed parts about a point.
    pub(super) fn winding_number(&self, point: DVec3) -> Result<i32, Error> {
        self.winding_number_of(point, |triangle| self.components.is_closed(triangle))
    }

    /// Returns the winding number about a point of the triangles for which `is_counted` holds.
    pub(super) fn winding_number_of(
        &self,
        point: DVec3,
        is_counted: impl Fn(u32) -> bool,
    ) -> Result<i32, Error> {
        let (mut open, mut winding) = (vec![0], 0);
        while let Some(n) = open.pop() {
            let aabb = &self.boxes.of_nodes[n as usize];
            let is_between = |axis: usize| aabb.lower[axis] <= point[axis] && point[axis] <= aabb.upper[axis];
            if !(is_between(0)
                && is_between(1)
                && point.z <= with_mutant!(aabb.upper.z, RaysMissTheirBoxes, aabb.lower.z))
            {
                continue;
            }
            if !self.boxes.is_leaf(n) {
                open.extend(self.boxes.parts(n));
                continue;
            }
            if self.boxes.context.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let counted = self.boxes.triangles(n).iter().filter(|t| is_counted(**t));
            winding += counted.map(|t| crossing(point, &self.boxes.corners(*t))).sum::<i32>();
        }
        Ok(winding)
    }
}
