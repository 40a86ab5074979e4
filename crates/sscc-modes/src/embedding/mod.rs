//! Embeds a surface in a coarser solid: each vertex of the surface moves with the element that contains it, or with the
//! nearest one (barycentric in tetrahedra, trilinear in cubes).

mod choice;
mod cube;
mod element_tree;
mod simplex;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
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

/// Number of vertices between two reports of the progress.
const BATCH: usize = 4096;

/// Maximum number of candidates of all vertices together: 512 MiB of memory.
const MAX_CANDIDATES: usize = 1 << 27;

/// Computes the weights of all vertices of the surface. Vertices without faces do not move.
///
/// # Errors
/// When a vertex is farther from the solid than a tenth of the longest side of the solid's AABB, the elements overlap so much
/// that the vertices have more than [`MAX_CANDIDATES`] candidates, or the work is cancelled.
pub(crate) fn embed(
    solid: &Solid,
    surface: &TriMesh,
    progress: &dyn Progress,
) -> Result<(Interpolation, Outside), ModesError> {
    let points = surface.rest_positions();
    let tree = ElementTree::new(solid);
    let size = tree.size();
    let used = surface.used_vertices();
    let positions: Vec<DVec3> = used.iter().map(|v| points[*v as usize]).collect();
    let candidates = find_candidates(&tree, &positions, MAX_CANDIDATES, progress)?;
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

/// Returns the candidates of each point, at most `max` in all.
///
/// # Errors
/// When there are more, or the work is cancelled.
fn find_candidates(
    tree: &ElementTree<'_>,
    points: &[DVec3],
    max: usize,
    progress: &dyn Progress,
) -> Result<Vec<Candidates>, ModesError> {
    let tolerance = INSIDE * tree.size();
    let count = AtomicUsize::new(0);
    // Where all elements overlap, one point alone has as many candidates as there are elements.
    let of = |x: &DVec3| -> Result<Candidates, ModesError> {
        check_cancelled(progress)?;
        let found = tree.candidates(*x, tolerance);
        let own = found.elements.len();
        if count.fetch_add(own, Ordering::Relaxed) + own > max {
            return Err(ModesError::OverlappingElements { max });
        }
        Ok(found)
    };
    let mut candidates = Vec::with_capacity(points.len());
    for (batch, some) in points.chunks(BATCH).enumerate() {
        progress.report(batch * BATCH, points.len());
        let found: Result<Vec<Candidates>, ModesError> = some.par_iter().map(of).collect();
        candidates.extend(found?);
    }
    Ok(candidates)
}
