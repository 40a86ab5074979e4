//! Faces that a file lists beside the elements of a solid: those that belong to no element, as triangles.

use std::ops::Range;

use sscc_solid::VolumeMesh;

use crate::polygons::Polygons;
use crate::{FormatError, Place};

/// What a file states about its listed faces in addition to [`VolumeMesh::surface`], which has all of them as triangles:
/// polygons as fans, and triangles of second order without the middles of their edges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ListedFaces {
    /// Faces other than plain triangles, in ascending order of their first triangles.
    larger: Vec<LargerFace>,
    /// A line about faces of a kind that is not read.
    unread: Option<String>,
}

/// A face that is more than its first triangle.
#[derive(Clone, Debug, PartialEq)]
struct LargerFace {
    /// Number of its first triangle.
    start: usize,
    kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// A polygon with this number of triangles.
    Polygon(usize),
    /// A triangle of second order: the middles of its edges 0 1, 1 2 and 2 0.
    SecondOrder([u32; 3]),
}

impl ListedFaces {
    /// Adds a polygon of these triangles, which come after those of all faces before it.
    pub(super) fn add_polygon(&mut self, triangles: Range<usize>) {
        if triangles.len() > 1 {
            let kind = Kind::Polygon(triangles.len());
            self.larger.push(LargerFace { start: triangles.start, kind });
        }
    }

    /// Adds the middles of the edges of a triangle, which comes after those of all faces before it.
    pub(super) fn add_middles(&mut self, triangle: usize, middles: [u32; 3]) {
        self.larger.push(LargerFace { start: triangle, kind: Kind::SecondOrder(middles) });
    }

    /// Adds faces of a kind that is not read: the error that they are where there are no elements.
    pub(super) fn add_unread(&mut self, error: &FormatError) {
        self.unread = Some(format!("{error}; such faces are left out"));
    }

    /// Returns a line about faces of a kind that is not read.
    pub(super) fn unread(&self) -> Option<&str> {
        self.unread.as_deref()
    }

    /// Returns lines about the listed faces that are no faces of the elements of a solid, whose modes do not move them.
    pub fn left_out(&self, solid: &VolumeMesh) -> Vec<String> {
        let triangles = |(fan, middles): &Face<'_>| if middles.is_some() { 4 } else { fan.len() };
        let free: usize = self.free_faces(solid).iter().map(triangles).sum();
        let of_free = (free > 0).then(|| {
            format!(
                "{free} triangles of the file belong to no element of the solid: they have no elasticity and are left out"
            )
        });
        of_free.into_iter().chain(self.unread.clone()).chain(self.other_middles(solid)).collect()
    }

    /// Returns a line about listed faces of second order that have the corners of a face of an element, but other middles.
    pub(super) fn other_middles(&self, solid: &VolumeMesh) -> Option<String> {
        let of_second_order = self.larger.iter().filter_map(|face| match face.kind {
            Kind::SecondOrder(middles) => Some((*solid.surface().get(face.start)?, middles)),
            Kind::Polygon(_) => None,
        });
        let (faces, parts): (Vec<_>, Vec<_>) =
            of_second_order.map(|(face, middles)| (face, quarters(face, middles))).unzip();
        let (is_face, is_part) = (solid.has_faces(&faces), solid.has_faces(parts.as_flattened()));
        let of_parts = is_part.as_chunks::<4>().0;
        let is_other = |(is_face, parts): &(&bool, &[bool; 4])| **is_face && parts.contains(&false);
        let count = is_face.iter().zip(of_parts).filter(is_other).count();
        (count > 0).then(|| {
            format!("{count} faces of 6 nodes have the corners of faces of elements, but other nodes between them: their own \
                     nodes are left out")
        })
    }

    /// Returns the triangles of the listed faces that belong to no element of a solid, with lines about polygons whose
    /// triangles the file does not determine.
    pub(super) fn free_triangles(
        &self,
        solid: &VolumeMesh,
    ) -> Result<(Vec<[u32; 3]>, Vec<String>), FormatError> {
        let mut polygons = Polygons::new(0);
        for (fan, middles) in self.free_faces(solid) {
            match middles {
                Some(middles) => {
                    let mut parts = fan.iter().flat_map(|triangle| quarters(*triangle, middles));
                    parts.try_for_each(|part| polygons.push(&part.map(u64::from), Place::Whole))?;
                }
                None => polygons.push(&corners(fan), Place::Whole)?,
            }
        }
        if polygons.triangle_count() == 0 {
            return Ok((Vec::new(), Vec::new()));
        }
        let (mesh, warnings) = polygons.finish(solid.vertices().to_vec())?.into_mesh_with_warnings()?;
        let of_free_faces = |warning: String| format!("of the faces that belong to no element, {warning}");
        Ok((mesh.faces().to_vec(), warnings.into_iter().map(of_free_faces).collect()))
    }

    /// Returns the listed faces that belong to no element.
    fn free_faces<'a>(&self, solid: &'a VolumeMesh) -> Vec<Face<'a>> {
        let (fans, is_found) = (solid.surface(), solid.has_faces(solid.surface()));
        let mut larger = self.larger.iter().peekable();
        let (mut free, mut start) = (Vec::new(), 0);
        while start < fans.len() {
            let (count, middles) = match larger.next_if(|face| face.start == start).map(|face| &face.kind) {
                None => (1, None),
                Some(Kind::Polygon(count)) => (*count, None),
                Some(Kind::SecondOrder(middles)) => (1, Some(*middles)),
            };
            let places = start..(start + count).min(fans.len());
            start = places.end;
            if !is_found[places.clone()].iter().all(|is_found| *is_found) {
                free.push((&fans[places], middles));
            }
        }
        // A quadrilateral on two tetrahedra may have the other diagonal.
        let others: Vec<[u32; 3]> = free.iter().filter_map(|(fan, _)| other_halves(fan)).flatten().collect();
        let is_found = solid.has_faces(&others);
        let mut of_quadrilaterals = is_found.as_chunks::<2>().0.iter();
        free.retain(|(fan, _)| {
            let is_found = other_halves(fan).and_then(|_| of_quadrilaterals.next());
            is_found != Some(&[true, true])
        });
        free
    }
}

/// The fan of a listed face, and of a face of second order the middles of its edges.
type Face<'a> = (&'a [[u32; 3]], Option<[u32; 3]>);

/// Returns the corners of a fan.
fn corners(fan: &[[u32; 3]]) -> Vec<u64> {
    let first = fan.iter().take(1).flat_map(|[a, b, _]| [*a, *b]);
    first.chain(fan.iter().map(|[.., c]| *c)).map(u64::from).collect()
}

/// Returns the triangles of a quadrilateral on either side of its other diagonal.
fn other_halves(fan: &[[u32; 3]]) -> Option<[[u32; 3]; 2]> {
    match fan {
        [[a, b, c], [_, _, d]] => Some([[*a, *b, *d], [*b, *c, *d]]),
        _ => None,
    }
}

/// Returns the triangles of a triangle of second order, in the order of a file without elements.
fn quarters([a, b, c]: [u32; 3], [ab, bc, ca]: [u32; 3]) -> [[u32; 3]; 4] {
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}
