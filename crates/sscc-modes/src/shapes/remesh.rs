//! Decimation and relaxation of a surface that follows an implicit solid.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::implicit::Implicit;
use super::surface::Surface;

/// Minimum cosine between the normal of a face and the normals of the solid at its corners.
const MIN_COSINE: f64 = 0.5;

/// Maximum number of neighbours of a vertex; more give narrow triangles.
const MAX_VALENCE: usize = 8;

/// Collapses the shortest edges first, to points of the solid's surface, until `faces` faces remain or no edge can be
/// collapsed. Edges count as longer where the radius of curvature is below `bend` (model unit), so that thin parts get
/// smaller triangles.
pub(super) fn decimate(surface: &mut Surface, solid: &Implicit, faces: usize, bend: f64) {
    // Squared lengths are not negative, so their bits have the same order as the lengths.
    let entry = |s: &Surface, [a, b]: [u32; 2]| {
        let [i, j] = [a, b].map(|v| v as usize);
        let normal_change = s.normals[i].distance_squared(s.normals[j]);
        let length = s.points[i].distance_squared(s.points[j]) + bend * bend * normal_change;
        Reverse((length.to_bits(), a.min(b), a.max(b)))
    };
    let mut queue: BinaryHeap<_> = surface.edges().into_iter().map(|e| entry(surface, e)).collect();
    while surface.face_count() > faces {
        let Some(next) = queue.pop() else { return };
        let Reverse((_, a, b)) = next;
        let is_current = surface.opposite(a, b).is_some() && entry(surface, [a, b]) == next;
        let is_full = surface.valence(a) + surface.valence(b) > MAX_VALENCE + 4;
        if !is_current || is_full || !surface.may_collapse(a, b) {
            continue;
        }
        let middle = solid.project(0.5 * (surface.points[a as usize] + surface.points[b as usize]));
        let cosine = outward_cosine(surface, [a, b], middle).min(outward_cosine(surface, [b, a], middle));
        if cosine > MIN_COSINE {
            surface.collapse(a, b);
            (surface.points[a as usize], surface.normals[a as usize]) = middle;
            let changed: Vec<u32> = surface.neighbours(a).collect();
            queue.extend(changed.into_iter().map(|n| entry(surface, [a, n])));
        }
    }
}

/// Iterates edge flips towards Delaunay triangles and a step of every vertex along the surface, towards the mean of its
/// neighbours. The number of faces is unchanged.
pub(super) fn relax(surface: &mut Surface, solid: &Implicit, iterations: usize) {
    for _ in 0..iterations {
        for [a, b] in surface.edges() {
            flip_if_better(surface, [a, b]);
        }
        for v in 0..surface.points.len() as u32 {
            if surface.valence(v) == 0 {
                continue;
            }
            let here = surface.points[v as usize];
            let sum: DVec3 = surface.neighbours(v).map(|n| surface.points[n as usize]).sum();
            let step = sum / surface.valence(v) as f64 - here;
            let normal = surface.normals[v as usize];
            let moved = solid.project(here + 0.5 * (step - normal * normal.dot(step)));
            let before = outward_cosine(surface, [v, v], (here, normal));
            if outward_cosine(surface, [v, v], moved) > before.min(MIN_COSINE) {
                (surface.points[v as usize], surface.normals[v as usize]) = moved;
            }
        }
    }
}

/// Returns the minimum cosine between the normal of a face and those of the solid at its corners, over the faces of `moved`
/// without `other`, if `moved` has this position and normal.
fn outward_cosine(surface: &Surface, [moved, other]: [u32; 2], (point, normal): (DVec3, DVec3)) -> f64 {
    let faces = surface.faces_of(moved).filter(|f| moved == other || !f.contains(&other));
    faces.fold(1.0, |minimum, face| {
        let at = |v: u32| if v == moved { point } else { surface.points[v as usize] };
        let outward = |v: u32| if v == moved { normal } else { surface.normals[v as usize] };
        let [a, b, c] = face.map(at);
        let own = (b - a).cross(c - a).normalize_or_zero();
        face.map(outward).iter().fold(minimum, |minimum, n| minimum.min(n.dot(own)))
    })
}

/// Flips an edge if the opposite angles sum to more than 180 degrees, the new normals are within 60 degrees of the mean
/// of the old ones, and no vertex gets too many or too few neighbours.
fn flip_if_better(surface: &mut Surface, [a, b]: [u32; 2]) {
    let (Some(c), Some(d)) = (surface.opposite(a, b), surface.opposite(b, a)) else { return };
    let valences = [a, b, c, d].map(|v| surface.valence(v));
    let is_full = valences[2].max(valences[3]) >= MAX_VALENCE;
    if is_full || valences[0].min(valences[1]) <= 4 || surface.opposite(c, d).is_some() {
        return;
    }
    let [pa, pb, pc, pd] = [a, b, c, d].map(|v| surface.points[v as usize]);
    let at_c = ((pa - pc).cross(pb - pc).length(), (pa - pc).dot(pb - pc));
    let at_d = ((pa - pd).cross(pb - pd).length(), (pa - pd).dot(pb - pd));
    let sine_of_sum = at_c.0 * at_d.1 + at_c.1 * at_d.0;
    let old = (pb - pa).cross(pc - pa).normalize() + (pa - pb).cross(pd - pb).normalize();
    let new = [(pd - pa).cross(pc - pa), (pc - pb).cross(pd - pb)];
    let is_flat = new.iter().all(|n| n.dot(old) > MIN_COSINE * n.length() * old.length());
    if sine_of_sum < -1e-9 * (at_c.0 * at_d.0) && is_flat {
        surface.flip([a, b], [c, d]);
    }
}
