//! Reader for strips of triangles (the element `tristrips`).

use super::header::{Element, Number};
use super::rows::{corner_list, read_row};
use super::values::Values;
use crate::polygons::Polygons;
use crate::{FormatError, Place};

/// Reads the strips of an element, for this number of vertices.
pub(super) fn read(
    element: &Element,
    values: &mut Values<'_>,
    vertices: usize,
    polygons: &mut Polygons,
) -> Result<(), FormatError> {
    let (wanted, item) = corner_list(element)?;
    for _ in 0..element.count {
        let mut strip = Strip::default();
        read_row(element, values, wanted, |values| {
            let place = values.place();
            let corner = values.signed_integer(item)?;
            if ends_strip(corner, item, vertices) {
                strip = Strip::default();
                return Ok(());
            }
            let corner = u64::try_from(corner).map_err(|_| {
                FormatError::new(place.clone(), format!("{corner} is neither a vertex nor -1"))
            })?;
            strip.push(corner, place, polygons)
        })?;
    }
    Ok(())
}

/// Whether a number ends a strip: -1, or the largest number of an unsigned type if it is no vertex.
fn ends_strip(number: i64, item: Number, vertices: usize) -> bool {
    match item.range() {
        Some((0, largest)) => number == largest && number as u64 >= vertices as u64,
        _ => number == -1,
    }
}

/// The corners of a strip so far.
#[derive(Default)]
struct Strip {
    count: usize,
    /// The last two corners.
    last: [u64; 2],
}

impl Strip {
    fn push(&mut self, corner: u64, place: Place, polygons: &mut Polygons) -> Result<(), FormatError> {
        let [a, b] = self.last;
        self.last = [b, corner];
        self.count += 1;
        if self.count < 3 || a == b || b == corner || a == corner {
            return Ok(());
        }
        // The first triangle has its corners in order.
        let triangle = if self.count % 2 == 1 { [a, b, corner] } else { [b, a, corner] };
        polygons.push(&triangle, place)
    }
}
