//! Selection of tetrahedra within a surface that a file lists.

use crate::element::TET_FACES;

/// Returns which tetrahedra lie within a surface made of their faces: those that cannot be reached from outside without
/// crossing it. Some meshers fill the convex hull of a surface. Returns all tetrahedra if a triangle of the surface is
/// not a face, or if the surface encloses nothing.
pub fn tets_within(tets: &[[u32; 4]], surface: &[[u32; 3]]) -> Vec<bool> {
    let all = vec![true; tets.len()];
    if surface.is_empty() {
        return all;
    }
    let mut walls: Vec<[u32; 3]> = surface.iter().map(|f| sorted(*f)).collect();
    walls.sort_unstable();
    let faces = sorted_faces(tets);
    let is_face = |wall: &[u32; 3]| {
        let at = faces.partition_point(|f| f.0 < *wall);
        faces.get(at).is_some_and(|f| f.0 == *wall)
    };
    if !walls.iter().all(is_face) {
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

/// As [`tets_within`], but also returns the tetrahedra that no chain of common faces joins to those within. What fills the
/// convex hull of a surface has faces of that surface, so those are no filling, but a region whose surface is not listed.
pub(crate) fn tets_within_or_apart(tets: &[[u32; 4]], surface: &[[u32; 3]]) -> Vec<bool> {
    let within = tets_within(tets, surface);
    if within.iter().all(|x| *x) {
        return within;
    }
    let mut neighbours = vec![Vec::new(); tets.len()];
    for two in sorted_faces(tets).windows(2).filter(|two| two[0].0 == two[1].0) {
        neighbours[two[0].1 as usize].push(two[1].1);
        neighbours[two[1].1 as usize].push(two[0].1);
    }
    let mut joined = within.clone();
    let mut reached: Vec<u32> =
        (0..).zip(&within).filter(|(_, within)| **within).map(|(tet, _)| tet).collect();
    while let Some(tet) = reached.pop() {
        for next in &neighbours[tet as usize] {
            if !std::mem::replace(&mut joined[*next as usize], true) {
                reached.push(*next);
            }
        }
    }
    within.iter().zip(&joined).map(|(within, joined)| *within || !*joined).collect()
}

/// Returns the corners of a triangle in ascending order.
pub(crate) fn sorted(mut triangle: [u32; 3]) -> [u32; 3] {
    triangle.sort_unstable();
    triangle
}

/// Returns the faces of all tetrahedra, each with sorted corners and the number of its tetrahedron, in ascending order.
fn sorted_faces(tets: &[[u32; 4]]) -> Vec<([u32; 3], u32)> {
    let mut faces = Vec::with_capacity(4 * tets.len());
    for (tet, number) in tets.iter().zip(0..) {
        faces.extend(TET_FACES.map(|face| (sorted(face.map(|k| tet[k])), number)));
    }
    faces.sort_unstable();
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The faces of the tetrahedron of the vertices 0 to 3.
    const FIRST: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

    #[test]
    fn tetrahedra_outside_the_surface_are_found() {
        // Two tetrahedra on either side of a face; the surface is that of the first.
        let tets = [[0, 1, 2, 3], [0, 2, 1, 4]];
        assert_eq!(tets_within(&tets, &FIRST), [true, false]);
        assert_eq!(tets_within(&tets, &FIRST[..3]), [true, true], "open: it encloses nothing");
        assert_eq!(tets_within(&tets, &[[0, 1, 9]]), [true, true], "no face of a tetrahedron");
        assert_eq!(tets_within(&tets, &[]), [true, true]);
    }

    #[test]
    fn regions_that_no_faces_join_to_the_surface_are_no_filling() {
        let kept = |others: &[[u32; 4]], more: &[[u32; 3]]| {
            let tets = [&[[0, 1, 2, 3]][..], others].concat();
            let surface = [&FIRST[..], more].concat();
            assert!(tets_within(&tets, &surface)[1..].iter().all(|within| !within));
            tets_within_or_apart(&tets, &surface)
        };
        assert_eq!(kept(&[[0, 2, 1, 4]], &[]), [true, false], "a common face");
        assert_eq!(kept(&[[4, 5, 6, 7]], &[]), [true, true], "no common vertex");
        assert_eq!(kept(&[[0, 1, 4, 5]], &[]), [true, true], "a common edge");
        // The last tetrahedron is joined to the surface by the second one alone, also through a face that is listed.
        let chain = [[0, 2, 1, 4], [0, 1, 4, 5]];
        assert_eq!(kept(&chain, &[]), [true, false, false]);
        assert_eq!(kept(&chain, &[[0, 1, 4]]), [true, false, false]);
        assert_eq!(kept(&[[4, 5, 6, 7], [4, 6, 5, 8], [0, 2, 1, 9]], &[]), [true, true, true, false]);
        assert_eq!(tets_within_or_apart(&[[0, 1, 2, 3], [4, 5, 6, 7]], &[]), [true, true]);
    }
}
