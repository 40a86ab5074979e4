//! Choice among the elements that contain a vertex of the surface: where parts of the solid overlap, a vertex moves with
//! the part of its neighbours on the surface.

use std::collections::VecDeque;

use sscc::TriMesh;

use super::element_tree::{Candidates, ElementTree};

/// Returns the element of each vertex of the surface. `candidates` belong to the vertices `used`, ascending; other vertices
/// have none. Vertices with one candidate decide first, then their neighbours take the candidate that shares most vertices
/// of the solid with the element of the neighbour, and so on.
pub fn choose(
    tree: &ElementTree<'_>,
    surface: &TriMesh,
    used: &[u32],
    candidates: &[Candidates],
) -> Vec<Option<u32>> {
    let mut neighbours = vec![Vec::new(); surface.rest_positions().len()];
    for [a, b, c] in surface.faces() {
        for (v, w) in [(a, b), (b, c), (c, a)] {
            neighbours[*v as usize].push(*w);
            neighbours[*w as usize].push(*v);
        }
    }
    let of = |v: u32| used.binary_search(&v).map_or(&[][..], |at| &candidates[at].elements);
    let mut chosen = vec![None; neighbours.len()];
    let mut queue = VecDeque::new();
    for v in used.iter().filter(|v| of(**v).len() == 1) {
        chosen[*v as usize] = of(*v).first().copied();
        queue.push_back(*v);
    }
    // Parts of the surface without such a vertex begin with the first candidate of some vertex.
    for start in used {
        while let Some(v) = queue.pop_front() {
            let Some(element) = chosen[v as usize] else { continue };
            let own = tree.vertices(element);
            for w in &neighbours[v as usize] {
                if chosen[*w as usize].is_some() {
                    continue;
                }
                let shared = |e: &u32| tree.vertices(*e).iter().filter(|vertex| own.contains(vertex)).count();
                // Of equal candidates, the first one is taken.
                chosen[*w as usize] = of(*w).iter().copied().rev().max_by_key(|e| shared(e));
                queue.push_back(*w);
            }
        }
        if chosen[*start as usize].is_none() {
            chosen[*start as usize] = of(*start).first().copied();
            queue.push_back(*start);
        }
    }
    chosen
}
