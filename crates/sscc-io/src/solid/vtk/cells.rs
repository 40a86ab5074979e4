//! Cells of VTK as elements and faces.

use glam::DVec3;

use super::super::builder::Builder;
use super::super::volume_or_surface::VolumeOrSurface;
use crate::{FormatError, Place};

/// The cells of a grid, by their types of VTK.
#[derive(Default)]
pub(super) struct Cells {
    pub types: Vec<u64>,
    /// End of each cell in `connectivity`.
    pub ends: Vec<u64>,
    pub connectivity: Vec<u64>,
}

/// Builds the solid, or the surface of a grid without solid cells.
pub(super) fn build(points: Vec<DVec3>, cells: &Cells) -> Result<VolumeOrSurface, FormatError> {
    let mut builder = Builder::new(0);
    for (number, point) in points.into_iter().enumerate() {
        builder.vertex(point, Place::Part(format!("point {number} (counted from 0)")))?;
    }
    let material = builder.default_material();
    let mut start = 0;
    for (number, (kind, end)) in cells.types.iter().zip(&cells.ends).enumerate() {
        let place = Place::Cell(number);
        let corners = usize::try_from(*end).ok().and_then(|end| cells.connectivity.get(start..end));
        let Some(corners) = corners else {
            let cause = format!("its end in the connectivity is {end}, out of order or too large");
            return Err(FormatError::new(place, cause));
        };
        start += corners.len();
        add(&mut builder, *kind, corners, material, place)?;
    }
    if start != cells.connectivity.len() {
        let cause = format!(
            "the cells name {start} points, the connectivity has {}: the file is damaged",
            cells.connectivity.len()
        );
        return Err(FormatError::whole(cause));
    }
    builder.finish_any()
}

/// Adds a cell by its type.
fn add(
    builder: &mut Builder,
    kind: u64,
    corners: &[u64],
    material: u32,
    place: Place,
) -> Result<(), FormatError> {
    match kind {
        // Empty cells, vertices and lines have no surface.
        0..=4 | 21 | 35 | 68 | 75 => Ok(()),
        5 => builder.face(exactly::<3>(kind, corners, &place)?, place),
        6 => strip(builder, corners, &place),
        7 => builder.polygon(corners, place),
        8 => {
            let [a, b, c, d] = exactly(kind, corners, &place)?;
            builder.face([a, b, d, c], place)
        }
        9 => builder.face(exactly::<4>(kind, corners, &place)?, place),
        10 => builder.tet(exactly(kind, corners, &place)?, material, place),
        11 => {
            let [a, b, c, d, e, f, g, h] = exactly(kind, corners, &place)?;
            builder.cube([a, b, d, c, e, f, h, g], material, place)
        }
        12 => builder.cube(exactly(kind, corners, &place)?, material, place),
        22 => builder.face_of_second_order(exactly(kind, corners, &place)?, place),
        24 => {
            // The middles of the last two edges are exchanged in gmsh's order.
            let [a, b, c, d, ab, bc, ca, ad, bd, cd] = exactly(kind, corners, &place)?;
            builder.tet10([a, b, c, d, ab, bc, ca, ad, cd, bd], material, place)
        }
        23 | 28 | 30 | 34 | 36 | 69 | 70 | 76 | 77 => {
            builder.unread_faces(&format!("cell type {kind}"), place);
            Ok(())
        }
        other => {
            let cause = format!(
                "{} is not supported: solid cells must be tetrahedra of 4 or 10 nodes (10, 24), hexahedra of 8 (12) or voxels (11); \
                 split the others, as ParaView's filter Tetrahedralize does",
                described(other)
            );
            Err(FormatError::new(place, cause))
        }
    }
}

/// Adds the triangles of a strip, all facing the same side.
fn strip(builder: &mut Builder, corners: &[u64], place: &Place) -> Result<(), FormatError> {
    for (number, window) in corners.windows(3).enumerate() {
        let [a, b, c] = [window[0], window[1], window[2]];
        builder.face(if number % 2 == 0 { [a, b, c] } else { [b, a, c] }, place.clone())?;
    }
    Ok(())
}

fn exactly<const N: usize>(kind: u64, corners: &[u64], place: &Place) -> Result<[u64; N], FormatError> {
    corners.try_into().map_err(|_| {
        let cause = format!("a cell of type {kind} has {N} points, this one has {}", corners.len());
        FormatError::new(place.clone(), cause)
    })
}

fn described(kind: u64) -> String {
    let name = match kind {
        13 => "a wedge",
        14 => "a pyramid",
        25 => "a hexahedron of 20 nodes",
        26 => "a wedge of second order",
        27 => "a pyramid of second order",
        29 => "a hexahedron of 27 nodes",
        42 => "a polyhedron",
        71 => "a tetrahedron of higher order",
        72 => "a hexahedron of higher order",
        _ => return format!("cell type {kind}"),
    };
    format!("{name} (cell type {kind})")
}
