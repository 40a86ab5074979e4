//! Collects the polygons of a file.

use glam::DVec3;

use super::Soup;
use super::triangulation::LargerPolygon;
use crate::{FormatError, Place};

/// Polygons so far, as fans. OBJ allows indices before their vertices, so `finish` checks them.
pub(crate) struct Polygons {
    triangles: Vec<[u32; 3]>,
    larger: Vec<LargerPolygon>,
    /// Largest index, from 0, and its place.
    largest: Option<(u64, Place)>,
    /// Number of the first vertex in the format: 0 or 1. Only for messages.
    first: u64,
}

impl Polygons {
    pub fn new(first: u64) -> Self {
        Self { triangles: Vec::new(), larger: Vec::new(), largest: None, first }
    }

    /// The number of triangles so far.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Returns all polygons as fans, after checking the indices.
    pub fn into_fans(self, vertices: usize) -> Result<Vec<[u32; 3]>, FormatError> {
        self.check(vertices)?;
        Ok(self.triangles)
    }

    /// Adds one polygon (indices from 0).
    pub fn push(&mut self, corners: &[u64], place: Place) -> Result<(), FormatError> {
        let (Some(&largest), [first, rest @ ..]) = (corners.iter().max(), corners) else {
            return Err(too_few(0, place));
        };
        if rest.len() < 2 {
            return Err(too_few(corners.len(), place));
        }
        if self.largest.as_ref().is_none_or(|(known, _)| largest > *known) {
            self.largest = Some((largest, place));
        }
        if rest.len() > 2 {
            self.larger.push(LargerPolygon { start: self.triangles.len(), triangles: rest.len() - 1 });
        }
        // An index beyond 32 bits is truncated here, but `largest` keeps it, and `check` rejects it.
        self.triangles.extend(rest.windows(2).map(|pair| [*first as u32, pair[0] as u32, pair[1] as u32]));
        Ok(())
    }

    /// Returns the polygons with the given vertices, after checking the indices.
    pub fn finish(self, positions: Vec<DVec3>) -> Result<Soup, FormatError> {
        self.check(positions.len())?;
        Ok(Soup { larger: self.larger, ..Soup::of_triangles(positions, self.triangles) })
    }

    /// Returns an error if there are no vertices, or an index names none of them.
    fn check(&self, vertices: usize) -> Result<(), FormatError> {
        if vertices == 0 {
            return Err(FormatError::whole("the mesh has no vertices"));
        }
        match &self.largest {
            Some((index, place)) if *index >= vertices as u64 => {
                let (index, first) = (index.saturating_add(self.first), self.first);
                let cause =
                    format!("the face names vertex {index} (counted from {first}), but there are {vertices}");
                Err(FormatError::new(place.clone(), cause))
            }
            _ => Ok(()),
        }
    }
}

fn too_few(corners: usize, place: Place) -> FormatError {
    FormatError::new(place, format!("a face needs at least 3 corners, this one has {corners}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fans_go_around_the_first_corner() {
        let mut polygons = Polygons::new(0);
        polygons.push(&[4, 1, 2], Place::Line(1)).unwrap();
        polygons.push(&[4, 1, 2, 3, 0], Place::Line(2)).unwrap();
        let soup = polygons.finish(vec![DVec3::ZERO; 5]).unwrap();
        assert_eq!(soup.fans, [[4, 1, 2], [4, 1, 2], [4, 2, 3], [4, 3, 0]]);
        assert_eq!(soup.larger, [LargerPolygon { start: 1, triangles: 3 }]);
        assert_eq!(soup.into_mesh().unwrap().faces(), [[4, 1, 2], [4, 1, 2], [4, 2, 3], [4, 3, 0]]);
    }

    #[test]
    fn indices_are_checked_against_all_vertices() {
        for index in [3, u64::from(u32::MAX), 1 << 32, u64::MAX] {
            let mut polygons = Polygons::new(1);
            polygons.push(&[0, 1, index], Place::Line(7)).unwrap();
            let Err(error) = polygons.finish(vec![DVec3::ZERO; 3]) else { panic!("{index}") };
            assert_eq!(*error.place(), Place::Line(7));
            let mut polygons = Polygons::new(1);
            polygons.push(&[0, 1, index], Place::Line(7)).unwrap();
            assert_eq!(*polygons.into_fans(3).unwrap_err().place(), Place::Line(7));
        }
    }

    #[test]
    fn two_corners_are_no_face() {
        for corners in [&[][..], &[0], &[0, 1]] {
            assert!(Polygons::new(0).push(corners, Place::Whole).is_err());
        }
    }
}
