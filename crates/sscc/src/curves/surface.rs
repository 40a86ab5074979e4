//! A triangle mesh at given positions.

use glam::DVec3;

use crate::{Error, limits};

/// Faces and positions of a triangle mesh.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Three vertex numbers for each face. Vertices that are welded have one number.
    pub faces: &'a [[u32; 3]],
    /// A position for each vertex (model unit).
    pub positions: &'a [DVec3],
}

impl Surface<'_> {
    /// Returns the corners of a triangle.
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.faces[triangle as usize].map(|i| self.positions[i as usize])
    }

    /// Checks the positions of all vertices and the vertex numbers of all faces.
    pub(super) fn check(&self) -> Result<(), Error> {
        if let Some(vertex) = self.positions.iter().position(|p| !limits::contains(*p)) {
            return Err(Error::Position { vertex, position: self.positions[vertex].to_array() });
        }
        let vertices = self.positions.len();
        for (face, corners) in self.faces.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&i| i as usize >= vertices) {
                return Err(Error::FaceIndex { face, vertex, vertices });
            }
        }
        Ok(())
    }

    /// Checks that a pair's triangle exists.
    pub(super) fn check_triangle(&self, pair: usize, triangle: u32) -> Result<(), Error> {
        let triangles = self.faces.len();
        if triangle as usize >= triangles {
            Err(Error::PairIndex { pair, triangle, triangles })
        } else {
            Ok(())
        }
    }
}
