//! The triangles of the pairs of an answer, at its positions: the data for curves and penetration depths.
//!
//! An answer copies them instead of all positions, so that its size depends only on its pairs.

use std::cmp::Ordering;

use glam::DVec3;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sscc::limits;

use crate::errors::value;

/// The bytes of a pickled triangle: its number, three vertex numbers, three positions.
const RECORD: usize = 4 + 3 * 4 + 9 * 8;

/// Triangles of one mesh.
#[derive(Clone)]
pub struct CollidingTriangles {
    /// The numbers of the triangles, ascending.
    numbers: Vec<u32>,
    faces: Vec<[u32; 3]>,
    corners: Vec<[DVec3; 3]>,
}

impl CollidingTriangles {
    /// Copies the triangles with these numbers. Repeated numbers are copied once.
    pub fn of(faces: &[[u32; 3]], positions: &[DVec3], numbers: impl Iterator<Item = u32>) -> Self {
        let mut numbers: Vec<u32> = numbers.collect();
        numbers.sort_unstable();
        numbers.dedup();
        let faces: Vec<[u32; 3]> = numbers.iter().map(|triangle| faces[*triangle as usize]).collect();
        let corners = faces.iter().map(|face| face.map(|i| positions[i as usize])).collect();
        Self { numbers, faces, corners }
    }

    /// Returns the index of a triangle, which is its number in [`Self::mesh`]; None if it is not one of these
    /// triangles.
    pub fn place(&self, triangle: u32) -> Option<u32> {
        self.numbers.binary_search(&triangle).ok().map(|place| place as u32)
    }

    /// Returns the corners of a triangle.
    pub fn corners(&self, triangle: u32) -> Option<&[DVec3; 3]> {
        self.corners.get(self.place(triangle)? as usize)
    }

    /// Returns the number of the triangle at an index.
    pub fn number(&self, place: u32) -> u32 {
        self.numbers[place as usize]
    }

    /// Returns the triangles as a mesh: faces and positions. Vertices at the same position are replaced by the lowest of
    /// them, so that curves do not end where a file splits vertices. The order of the vertices is that of the whole mesh.
    pub fn mesh(&self) -> (Vec<[u32; 3]>, Vec<DVec3>) {
        let compare = |x: &DVec3, y: &DVec3| {
            x.to_array().partial_cmp(&y.to_array()).unwrap_or(Ordering::Equal) // positions are finite
        };
        let (faces, corners) = (self.faces.as_flattened(), self.corners.as_flattened());
        let mut lowest: Vec<(DVec3, u32)> = corners.iter().copied().zip(faces.iter().copied()).collect();
        lowest.sort_unstable_by(|(x, i), (y, j)| compare(x, y).then(i.cmp(j)));
        lowest.dedup_by(|(x, _), (y, _)| compare(x, y).is_eq());
        // Positions are in the order of their lowest vertices.
        let mut order: Vec<u32> = (0..lowest.len() as u32).collect();
        order.sort_unstable_by_key(|at| lowest[*at as usize].1);
        let mut vertex = vec![0; lowest.len()];
        order.iter().zip(0..).for_each(|(at, number)| vertex[*at as usize] = number);
        let corner = |x: &DVec3| vertex[lowest.partition_point(|(y, _)| compare(y, x).is_lt())];
        let positions = order.iter().map(|at| lowest[*at as usize].0).collect();
        (self.corners.iter().map(|corners| corners.each_ref().map(corner)).collect(), positions)
    }

    /// Returns the pickled form.
    pub fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let mut bytes = Vec::with_capacity(RECORD * self.numbers.len());
        for ((number, face), corners) in self.numbers.iter().zip(&self.faces).zip(&self.corners) {
            bytes.extend_from_slice(&number.to_le_bytes());
            face.iter().for_each(|vertex| bytes.extend_from_slice(&vertex.to_le_bytes()));
            let coordinates = corners.iter().flat_map(DVec3::to_array);
            coordinates.for_each(|coordinate| bytes.extend_from_slice(&coordinate.to_le_bytes()));
        }
        PyBytes::new(py, &bytes)
    }

    /// Returns the triangles of a pickled form.
    ///
    /// # Errors
    /// If the bytes do not have this form, the numbers do not ascend, or a position is out of range.
    pub fn from_bytes(bytes: &Bound<'_, PyBytes>) -> PyResult<Self> {
        let damaged = || value("the pickled answer is damaged: its bytes are not those of triangles");
        let (records, []) = bytes.as_bytes().as_chunks::<RECORD>() else { return Err(damaged()) };
        let mut triangles = Self { numbers: Vec::new(), faces: Vec::new(), corners: Vec::new() };
        for record in records {
            let (integers, coordinates) = record.split_at(16);
            let [number, a, b, c] = std::array::from_fn(|i| u32::from_le_bytes(integers.as_chunks().0[i]));
            let coordinate = |i: usize| f64::from_le_bytes(coordinates.as_chunks().0[i]);
            let corners = [0, 3, 6].map(|i| DVec3::new(coordinate(i), coordinate(i + 1), coordinate(i + 2)));
            if triangles.numbers.last().is_some_and(|last| *last >= number)
                || !corners.iter().all(|corner| limits::contains(*corner))
            {
                return Err(damaged());
            }
            triangles.numbers.push(number);
            triangles.faces.push([a, b, c]);
            triangles.corners.push(corners);
        }
        Ok(triangles)
    }
}
