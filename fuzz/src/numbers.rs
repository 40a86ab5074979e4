//! Arguments of functions from the bytes of an input: any numbers, and small meshes.

use sscc::glam::DVec3;
use sscc::{ContactFilter, Neighbours, TriMesh};

use crate::one_line;

/// The numbers of an input, one after another; zeros after its end.
pub struct Numbers<'a>(pub &'a [u8]);

impl Numbers<'_> {
    /// Returns the next byte.
    pub fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    /// Returns the next number. Half of all numbers are small integers, so that triangles touch.
    pub fn number(&mut self) -> f64 {
        match self.byte() {
            kind @ 0..200 => f64::from(kind % 9) - 4.0,
            200..230 => f64::from(self.byte() as i8) / 16.0,
            230..240 => f64::from_bits(u64::from(self.byte()) << 56 | u64::from(self.byte())),
            _ => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte()))),
        }
    }

    /// Returns the next three numbers.
    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    /// Returns this many vectors.
    pub fn vectors(&mut self, count: usize) -> Vec<DVec3> {
        (0..count).map(|_| self.vector()).collect()
    }

    /// Returns this many numbers.
    pub fn list(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.number()).collect()
    }

    /// Returns a number of vertices, a number of modes, and a mesh of this many vertices; None if it is refused.
    pub fn mesh(&mut self) -> (usize, usize, Option<TriMesh>) {
        let [vertices, faces, rank] = [12, 16, 4].map(|most| usize::from(self.byte()) % most + 1);
        let faces = (0..faces).map(|_| std::array::from_fn(|_| self.corner(vertices))).collect();
        (vertices, rank, one_line(TriMesh::new(self.vectors(vertices), faces)))
    }

    fn corner(&mut self, vertices: usize) -> u32 {
        u32::from(self.byte()) % (vertices as u32 + 1)
    }

    /// Returns one of three contact filters.
    pub fn filter(&mut self, mesh: &TriMesh) -> ContactFilter {
        match self.byte() % 3 {
            0 => ContactFilter::of(mesh),
            1 => ContactFilter::new(Neighbours::IncludeOneVertex).weld(true),
            _ => ContactFilter::new(Neighbours::IncludeFolded),
        }
    }
}
