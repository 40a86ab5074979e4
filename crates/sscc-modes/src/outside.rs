//! Vertices of a surface that are outside the solid in which it is embedded.

use std::fmt;

/// Vertices of a surface that are outside the solid that moves them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outside {
    /// Number of these vertices; 0 if the solid encloses the surface.
    pub count: usize,
    /// Number of vertices of the surface, without those that belong to no triangle.
    pub of: usize,
    /// The vertex farthest outside, from 0.
    pub vertex: u32,
    /// Its distance from the nearest element (model unit), for sheared or distorted cubes an upper bound.
    pub distance: f64,
    /// That element, from 0, tetrahedra first.
    pub element: u32,
    /// Longest side of the solid's AABB (model unit).
    pub size: f64,
}

/// One line about the vertices outside.
impl fmt::Display for Outside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, of, vertex, distance, element, size } = self;
        let share = 100.0 * distance / size;
        write!(
            f,
            "{count} of {of} vertices of the surface are outside the solid; the farthest, vertex {vertex}, is \
             {distance:.3e} from the nearest element, {element} (both counted from 0; {share:.1}% of the size of the \
             solid, {size:.3e})"
        )
    }
}
