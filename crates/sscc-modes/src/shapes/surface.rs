//! Closed triangle surface with edge collapses and flips.

use glam::DVec3;
use sscc::TriMesh;

/// Closed manifold surface. Collapsed faces stay in the list, but no vertex refers to them.
pub(super) struct Surface {
    /// Positions (model unit), also of vertices that no face uses any more.
    pub points: Vec<DVec3>,
    /// Outward unit normals of the vertices.
    pub normals: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    /// Faces of each vertex.
    around: Vec<Vec<u32>>,
    count: usize,
}

impl Surface {
    /// Creates a surface from positions, outward unit normals, and the faces of a closed manifold.
    pub fn new(points: Vec<DVec3>, normals: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Self {
        let mut around = vec![Vec::new(); points.len()];
        for (face, corners) in faces.iter().enumerate() {
            for v in corners {
                around[*v as usize].push(face as u32);
            }
        }
        Self { points, normals, count: faces.len(), faces, around }
    }

    /// Returns the number of faces.
    pub fn face_count(&self) -> usize {
        self.count
    }

    /// Returns the corners of the faces of a vertex.
    pub fn faces_of(&self, v: u32) -> impl Iterator<Item = [u32; 3]> {
        self.around[v as usize].iter().map(|f| self.faces[*f as usize])
    }

    /// Returns the neighbours of a vertex, each once: in every face the corner after v.
    pub fn neighbours(&self, v: u32) -> impl Iterator<Item = u32> {
        self.faces_of(v).map(move |f| next_corner(f, v))
    }

    /// Returns the number of neighbours; 0 for a removed vertex.
    pub fn valence(&self, v: u32) -> usize {
        self.around[v as usize].len()
    }

    /// Returns the third corner of the face to the left of the edge from a to b.
    pub fn opposite(&self, a: u32, b: u32) -> Option<u32> {
        self.faces_of(a).find(|f| next_corner(*f, a) == b).map(|f| next_corner(f, b))
    }

    /// Whether collapsing an edge preserves the manifold topology: its ends have no common neighbours but the two opposite
    /// corners (the link condition), and those keep at least three neighbours.
    pub fn may_collapse(&self, a: u32, b: u32) -> bool {
        let mut common = self.neighbours(a).filter(|v| self.neighbours(b).any(|w| w == *v));
        let two = common.by_ref().take(2).all(|v| self.valence(v) > 3);
        two && common.next().is_none()
    }

    /// Merges b into a, which removes two faces.
    pub fn collapse(&mut self, a: u32, b: u32) {
        for face in std::mem::take(&mut self.around[b as usize]) {
            let corners = self.faces[face as usize];
            if corners.contains(&a) {
                for v in corners {
                    self.around[v as usize].retain(|f| *f != face);
                }
                self.count -= 1;
            } else {
                self.faces[face as usize] = corners.map(|v| if v == b { a } else { v });
                self.around[a as usize].push(face);
            }
        }
    }

    /// Replaces the edge from a to b by the edge between the opposite corners c (left) and d (right).
    pub fn flip(&mut self, [a, b]: [u32; 2], [c, d]: [u32; 2]) {
        let left = self.around[a as usize].iter().copied().find(|f| has_edge(self.faces[*f as usize], a, b));
        let right = self.around[a as usize].iter().copied().find(|f| has_edge(self.faces[*f as usize], b, a));
        let (Some(left), Some(right)) = (left, right) else { return };
        self.faces[left as usize] = [a, d, c];
        self.faces[right as usize] = [b, c, d];
        self.around[a as usize].retain(|f| *f != right);
        self.around[b as usize].retain(|f| *f != left);
        self.around[c as usize].push(right);
        self.around[d as usize].push(left);
    }

    /// Returns the edges, each once (the smaller end first), in the order of their vertices.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        (0..self.points.len() as u32)
            .flat_map(|a| self.neighbours(a).filter(move |b| a < *b).map(move |b| [a, b]))
            .collect()
    }

    /// Returns the mesh without unused vertices; None if it is not a valid mesh.
    pub fn into_mesh(self) -> Option<TriMesh> {
        let mut number = vec![0; self.points.len()];
        let mut positions = Vec::new();
        for (v, point) in self.points.iter().enumerate() {
            number[v] = positions.len() as u32;
            if !self.around[v].is_empty() {
                positions.push(*point);
            }
        }
        let is_used =
            |(f, corners): &(usize, &[u32; 3])| self.around[corners[0] as usize].contains(&(*f as u32));
        let faces = self.faces.iter().enumerate().filter(is_used);
        TriMesh::new(positions, faces.map(|(_, c)| c.map(|v| number[v as usize])).collect()).ok()
    }
}

/// Returns the corner after v.
fn next_corner([a, b, c]: [u32; 3], v: u32) -> u32 {
    if a == v {
        b
    } else if b == v {
        c
    } else {
        a
    }
}

/// Whether a face has the edge from a to b.
fn has_edge(face: [u32; 3], a: u32, b: u32) -> bool {
    face.contains(&a) && next_corner(face, a) == b
}
