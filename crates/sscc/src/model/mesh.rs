//! A triangle mesh at rest.

use glam::DVec3;

use crate::arithmetic::check_arithmetic;
use crate::{Error, limits};

/// A triangle mesh: rest positions (V, model unit) and faces (N, three vertex indices each).
///
/// Any triangle soup is valid: closed, open, or with edges of more than two triangles. Special cases:
/// - a vertex that no face uses is not part of the shape: it never collides, and no AABB contains it;
/// - two faces with the same three vertices are adjacent (they share a vertex), so by default they never collide;
/// - a face of zero area (a repeated index, or collinear corners) is the closed segment or point that its corners span,
///   and collides as such.
#[derive(Clone, Debug, PartialEq)]
pub struct TriMesh {
    rest_positions: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    has_split_vertices: bool,
}

impl TriMesh {
    /// Creates a mesh from rest positions (model unit) and faces (indices into them).
    ///
    /// # Errors
    /// When this thread's arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]), there is no face, a face names a
    /// vertex that does not exist, a coordinate is not finite or larger in magnitude than [`limits::LARGEST`], or there
    /// are more than `u32::MAX` vertices or faces.
    pub fn new(rest_positions: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Result<Self, Error> {
        check_arithmetic()?;
        if faces.is_empty() {
            return Err(Error::NoFaces);
        }
        for (what, count) in [("vertices", rest_positions.len()), ("faces", faces.len())] {
            if u32::try_from(count).is_err() {
                return Err(Error::TooMany { what, count });
            }
        }
        if let Some(vertex) = rest_positions.iter().position(|p| !limits::contains(*p)) {
            return Err(Error::Position { vertex, position: rest_positions[vertex].to_array() });
        }
        for (face, corners) in faces.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&i| i as usize >= rest_positions.len()) {
                return Err(Error::FaceIndex { face, vertex, vertices: rest_positions.len() });
            }
        }
        Ok(Self { rest_positions, faces, has_split_vertices: false })
    }

    /// Returns the same mesh, marked as from a format or a source that splits vertices along seams: adjacent triangles may share
    /// positions, but no vertex numbers. Detectors and certificates weld its equal vertices by default
    /// ([`ContactFilter::of`](crate::ContactFilter::of)). Functions that read such formats call it.
    #[must_use]
    pub fn with_split_vertices(mut self) -> Self {
        self.has_split_vertices = true;
        self
    }

    /// Whether vertices may be split along seams ([`TriMesh::with_split_vertices`]).
    pub fn has_split_vertices(&self) -> bool {
        self.has_split_vertices
    }

    /// Returns the same mesh with other rest positions (model unit), one for each vertex.
    ///
    /// # Errors
    /// When there are fewer or more positions than vertices, one is not finite or beyond [`limits::LARGEST`], or this
    /// thread's arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]).
    pub fn with_rest_positions(&self, rest_positions: Vec<DVec3>) -> Result<Self, Error> {
        let (found, vertices) = (rest_positions.len(), self.rest_positions.len());
        if found != vertices {
            return Err(Error::PositionCount { found, vertices });
        }
        let mesh = Self::new(rest_positions, self.faces.clone())?;
        Ok(Self { has_split_vertices: self.has_split_vertices, ..mesh })
    }

    /// Returns the rest positions, one for each vertex, including unused ones (model unit).
    pub fn rest_positions(&self) -> &[DVec3] {
        &self.rest_positions
    }

    /// Returns the faces, three vertex indices each, in the given order.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Returns the vertices that at least one face uses, in ascending order.
    pub fn used_vertices(&self) -> Vec<u32> {
        let mut used = vec![false; self.rest_positions.len()];
        for &i in self.faces.iter().flatten() {
            used[i as usize] = true;
        }
        (0..used.len() as u32).filter(|&i| used[i as usize]).collect()
    }
}
