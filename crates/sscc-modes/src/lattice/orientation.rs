//! Check that each part of a surface is oriented as the boundary of a solid.

use sscc::parts::DisjointSets;

use super::crossings::Interval;
use super::surface::Surface;
use crate::ModesError;

/// Checks each part of the surface that is connected by edges: at the majority of its crossings, lines must pass from
/// outside to inside or back. Triangles that share a vertex may be folded, so single crossings may be inconsistent.
///
/// # Errors
/// When a part lies within another body, or is inside out.
pub(super) fn check_orientation(
    surface: &Surface,
    inside: &[Vec<Interval>; 3],
    odd: &[u32],
) -> Result<(), ModesError> {
    if odd.is_empty() {
        return Ok(());
    }
    let mut parts = DisjointSets::new(surface.faces.len());
    for (face, others) in (0_u32..).zip(&surface.across) {
        others.iter().for_each(|other| parts.unite(face, *other));
    }
    let mut excess = vec![0_i64; surface.faces.len()];
    for end in inside.iter().flatten().flat_map(|interval| [interval.enter, interval.leave]) {
        excess[parts.find(end.1) as usize] -= 1;
    }
    for triangle in odd {
        excess[parts.find(*triangle) as usize] += 1;
    }
    match (0_u32..).zip(&excess).find(|(_, excess)| **excess > 0) {
        Some((triangle, _)) => Err(ModesError::Nested { triangle }),
        None => Ok(()),
    }
}
