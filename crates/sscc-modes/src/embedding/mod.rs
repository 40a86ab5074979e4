//! Embeds a surface in a coarser solid: each vertex of the surface moves with the element that contains it, or with the
//! nearest one (barycentric in tetrahedra, trilinear in cubes).

mod choice;
mod cube;
mod element_tree;
mod simplex;
#[cfg(test)]
mod tests;

use rayon::prelude::*;
use sscc::{Progress, TriMesh};
use sscc_solid::Solid;

use crate::cancel::check_cancelled;
use crate::interpolation::Interpolation;
use crate::{ModesError, Outside};
use choice::choose;
use element_tree::{Candidates, ElementTree};

/// Maximum distance of a surface vertex from the solid, relative to the longest side of the solid's AABB.
const MAX_DISTANCE: f64 = 0.1;

/// Maximum distance, relative to that side, of vertices that count as inside; rounding errors are smaller.
const INSIDE: f64 = 1e-9;

/// Number of vertices between two checks of the progress.
const BATCH: usize = 4096;

/// Computes the weights of all vertices of the surface. Vertices without faces do not move.
///
/// # Errors
/// When a vertex is farther from the solid than a tenth of the longest side of the solid's AABB, or the work is
/// cancelled.
pub(crate) fn embed(
    solid: &Solid,
    surface: &TriMesh,
    progress: &dyn Progress,
) -> Result<(Interpolation, Outside), ModesError> {
    let points = surface.rest_positions();
    let tree = ElementTree::new(solid);
    let size = tree.size();
    let used = surface.used_vertices();
    let mut candidates = Vec::with_capacity(used.len());
    for (batch, some) in used.chunks(BATCH).enumerate() {
        check_cancelled(progress)?;
        progress.report(batch * BATCH, used.len());
        let of = |v: &u32| tree.candidates(points[*v as usize], INSIDE * size);
        candidates.par_extend(some.par_iter().map(of));
    }
    let chosen = choose(&tree, surface, &used, &candidates);
    let mut vertices = vec![[(0, 0.0); 8]; points.len()];
    let mut outside = Outside { count: 0, of: used.len(), vertex: 0, distance: 0.0, element: 0, size };
    for (v, Candidates { elements, distance }) in used.iter().zip(candidates) {
        let element = chosen[*v as usize].unwrap_or(elements[0]);
        vertices[*v as usize] = tree.weights(element, points[*v as usize]);
        outside.count += usize::from(distance > INSIDE * size);
        if distance > outside.distance {
            (outside.vertex, outside.distance, outside.element) = (*v, distance, element);
        }
    }
    // NaN must fail this test, too.
    let is_near = outside.distance <= MAX_DISTANCE * size;
    if is_near { Ok((Interpolation { vertices }, outside)) } else { Err(ModesError::OutsideSolid(outside)) }
}
