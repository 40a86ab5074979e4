//! Decimation and relaxation of a surface that follows an implicit solid.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::implicit::Implicit;
use super::surface::Surface;

/// A face must look outward: the cosine between its normal and those of the solid at its corners is at least this.
const MIN_COSINE: f64 = 0.5;

/// Vertices of more neighbours than this have narrow triangles.
const MAX_VALENCE: usize = 8;

/// Collapses the shortest edges first, to points of the solid's surface, down to `faces` faces (or a little above,
/// when no edge is left that may be collapsed). Where the surface bends more than with radius `bend` (model unit),
/// edges count as longer, so that thin parts get smaller triangles.
pub(super) fn decimate(surface: &mut Surface, solid: &Implicit, faces: usize, bend: f64) {
    // Squared lengths are not negative, so their bits have the same order.
    let entry = |s: &Surface, [a, b]: [u32; 2]| {
        let [i, j] = [a, b].map(|v| v as usize);
        let turn = s.normals[i].distance_squared(s.normals[j]);
        let length = s.points[i].distance_squared(s.points[j]) + bend * bend * turn;
        Reverse((length.to_bits(), a.min(b), a.max(b)))
    };
    let mut queue: BinaryHeap<_> = surface.edges().into_iter().map(|e| entry(surface, e)).collect();
    while surface.face_count() > faces {
        let Some(next) = queue.pop() else { return };
        let Reverse((_, a, b)) = next;
        let current = surface.opposite(a, b).is_some() && entry(surface, [a, b]) == next;
        let narrow = surface.valence(a) + surface.valence(b) > MAX_VALENCE + 4;
        if !current || narrow || !surface.may_collapse(a, b) {
            continue;
        }
        let middle = solid.project(0.5 * (surface.points[a as usize] + surface.points[b as usize]));
        let cosine = outwardness(surface, [a, b], middle).min(outwardness(surface, [b, a], middle));
        if cosine > MIN_COSINE {
            surface.collapse(a, b);
            (surface.points[a as usize], surface.normals[a as usize]) = middle;
            let changed: Vec<u32> = surface.neighbours(a).collect();
            queue.extend(changed.into_iter().map(|n| entry(surface, [a, n])));
        }
    }
}

/// Rounds of edge flips towards Delaunay triangles, each followed by a step of every vertex towards the mean of
/// its neighbours, along the surface. Keeps the number of faces.
pub(super) fn relax(surface: &mut Surface, solid: &Implicit, rounds: usize) {
    for _ in 0..rounds {
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
            let before = outwardness(surface, [v, v], (here, normal));
            if outwardness(surface, [v, v], moved) > before.min(MIN_COSINE) {
                (surface.points[v as usize], surface.normals[v as usize]) = moved;
            }
        }
    }
}

/// How well the faces of `moved`, apart from those with `other`, look outward when it has this position and normal:
/// the least cosine between the normal of a face and those of the solid at its corners.
fn outwardness(surface: &Surface, [moved, other]: [u32; 2], (point, normal): (DVec3, DVec3)) -> f64 {
    let faces = surface.faces_of(moved).filter(|f| moved == other || !f.contains(&other));
    faces.fold(1.0, |least, face| {
        let at = |v: u32| if v == moved { point } else { surface.points[v as usize] };
        let outward = |v: u32| if v == moved { normal } else { surface.normals[v as usize] };
        let [a, b, c] = face.map(at);
        let own = (b - a).cross(c - a).normalize_or_zero();
        face.map(outward).iter().fold(least, |least, n| least.min(n.dot(own)))
    })
}

/// Flips the edge when the angles opposite add up to more than half a turn, and the new faces fold less than
/// about 45 degrees against the old ones.
fn flip_if_better(surface: &mut Surface, [a, b]: [u32; 2]) {
    let (Some(c), Some(d)) = (surface.opposite(a, b), surface.opposite(b, a)) else { return };
    let valences = [a, b, c, d].map(|v| surface.valence(v));
    let full = valences[2].max(valences[3]) >= MAX_VALENCE;
    if full || valences[0].min(valences[1]) <= 4 || surface.opposite(c, d).is_some() {
        return;
    }
    let [pa, pb, pc, pd] = [a, b, c, d].map(|v| surface.points[v as usize]);
    let at_c = ((pa - pc).cross(pb - pc).length(), (pa - pc).dot(pb - pc));
    let at_d = ((pa - pd).cross(pb - pd).length(), (pa - pd).dot(pb - pd));
    let sine_of_sum = at_c.0 * at_d.1 + at_c.1 * at_d.0;
    let old = (pb - pa).cross(pc - pa).normalize() + (pa - pb).cross(pd - pb).normalize();
    let new = [(pd - pa).cross(pc - pa), (pc - pb).cross(pd - pb)];
    let flat = new.iter().all(|n| n.dot(old) > MIN_COSINE * n.length() * old.length());
    if sine_of_sum < -1e-9 * (at_c.0 * at_d.0) && flat {
        surface.flip([a, b], [c, d]);
    }
}
