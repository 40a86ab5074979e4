//! Selection of tetrahedra within a surface that a file lists.

use crate::element::TET_FACES;

/// Returns which tetrahedra lie within a surface made of their faces: those that cannot be reached from outside without
/// crossing it. Some meshers fill the convex hull of a surface. Returns all tetrahedra if a triangle of the surface is
/// not a face, or if the surface encloses nothing.
pub fn tets_within(tets: &[[u32; 4]], surface: &[[u32; 3]]) -> Vec<bool> {
    let all = vec![true; tets.len()];
    let sorted = |mut face: [u32; 3]| {
        face.sort_unstable();
        face
    };
    let mut walls: Vec<[u32; 3]> = surface.iter().map(|f| sorted(*f)).collect();
    walls.sort_unstable();
    let mut faces: Vec<([u32; 3], u32)> = Vec::with_capacity(4 * tets.len());
    for (index, tet) in tets.iter().enumerate() {
        faces.extend(TET_FACES.map(|f| (sorted(f.map(|k| tet[k])), index as u32)));
    }
    faces.sort_unstable();
    let is_face = |wall: &[u32; 3]| {
        let at = faces.partition_point(|f| f.0 < *wall);
        faces.get(at).is_some_and(|f| f.0 == *wall)
    };
    if walls.is_empty() || !walls.iter().all(is_face) {
        return all;
    }
    let mut within = all.clone();
    let mut neighbours = vec![Vec::new(); tets.len()];
    let mut reached = Vec::new();
    for same in faces.chunk_by(|a, b| a.0 == b.0) {
        let wall = walls.binary_search(&same[0].0).is_ok();
        match same {
            [a, b] if !wall => {
                neighbours[a.1 as usize].push(b.1);
                neighbours[b.1 as usize].push(a.1);
            }
            [one] if !wall => reached.push(one.1),
            _ => {}
        }
    }
    while let Some(tet) = reached.pop() {
        if std::mem::replace(&mut within[tet as usize], false) {
            reached.extend(neighbours[tet as usize].iter().copied());
        }
    }
    if within.iter().any(|x| *x) { within } else { all }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tetrahedra_outside_the_surface_are_found() {
        // Two tetrahedra on either side of a face; the surface is that of the first.
        let tets = [[0, 1, 2, 3], [0, 2, 1, 4]];
        let first = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        assert_eq!(tets_within(&tets, &first), [true, false]);
        assert_eq!(tets_within(&tets, &first[..3]), [true, true], "open: it encloses nothing");
        assert_eq!(tets_within(&tets, &[[0, 1, 9]]), [true, true], "no face of a tetrahedron");
        assert_eq!(tets_within(&tets, &[]), [true, true]);
    }
}
