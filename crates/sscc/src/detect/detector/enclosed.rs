//! Which parts of a mesh lie inside another one.

use glam::DVec3;

use super::boxes::Boxes;
use super::components::Components;
use super::detector::Detector;
use crate::Error;
use crate::geometry::crossing;

/// How many connected components of a mesh lie inside another mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Enclosed {
    /// Number of the connected components of the mesh.
    pub components: usize,
    /// How many of them lie inside.
    pub inside: usize,
}

impl Detector {
    /// How many connected components of this mesh lie inside the other one, and of the other inside this one, at positions at which
    /// [`Detector::against`] finds no pair: then each component is inside or outside as a whole.
    ///
    /// A mesh has an inside where its surface is closed: in each connected component of it, triangles run along every edge as
    /// often in one direction as in the other. Its other components are left out. A component is inside where the closed surface
    /// winds about it, which is computed exactly. Vertices are one where the contact filter welds them, as long as they are at one
    /// position.
    ///
    /// # Errors
    /// As [`Detector::discrete`], for both.
    pub fn enclosed(
        &mut self,
        positions: &[DVec3],
        other: &mut Detector,
        other_positions: &[DVec3],
    ) -> Result<[Enclosed; 2], Error> {
        self.check([positions])?;
        other.check([other_positions])?;
        let sides = [(self, positions), (other, other_positions)];
        let [one, two] = sides.map(|(x, positions)| {
            let filter = &x.context.filter;
            let components = x.components.get_or_insert_with(|| Components::new(filter));
            let is_closed = components.closed_triangles(filter, positions);
            Side { boxes: Boxes::new(&x.context, positions), components, is_closed }
        });
        Ok([two.enclose(&one), one.enclose(&two)])
    }
}

/// A mesh at given positions.
struct Side<'x> {
    boxes: Boxes<'x>,
    components: &'x Components,
    /// For each triangle whether it is part of a closed component.
    is_closed: Vec<bool>,
}

impl Side<'_> {
    /// Counts the components of `other` that are inside.
    fn enclose(&self, other: &Self) -> Enclosed {
        let corner = |t: u32| other.boxes.corners(t)[0];
        let is_inside = |t: &u32| self.winding_number(corner(*t)) != 0;
        let inside = match self.is_closed.contains(&true) {
            true => other.components.triangles().filter(is_inside).count(),
            false => 0,
        };
        Enclosed { components: other.components.count(), inside }
    }

    /// The winding number of the closed components about a point.
    fn winding_number(&self, point: DVec3) -> i32 {
        let (mut open, mut winding) = (vec![0], 0);
        while let Some(n) = open.pop() {
            let aabb = &self.boxes.of_nodes[n as usize];
            let is_below = |axis: usize| aabb.lower[axis] <= point[axis] && point[axis] <= aabb.upper[axis];
            if !(is_below(0) && is_below(1) && point.z <= aabb.upper.z) {
                continue;
            }
            if self.boxes.is_leaf(n) {
                let closed = self.boxes.triangles(n).iter().filter(|t| self.is_closed[**t as usize]);
                winding += closed.map(|t| crossing(point, &self.boxes.corners(*t))).sum::<i32>();
            } else {
                open.extend(self.boxes.parts(n));
            }
        }
        winding
    }
}
