//! The spring has the documented properties.

use std::collections::HashMap;

use glam::DVec3;
use robust::{Coord3D, orient3d};
use sscc::TriMesh;
use sscc_modes::shapes::spring;

const TUBE_RADIUS: f64 = 0.03;
const AROUND: usize = 16;

#[test]
fn the_spring_is_closed_oriented_and_connected() {
    let mesh = spring();
    assert_eq!(mesh.faces().len(), 16_000);
    assert_eq!(mesh.rest_positions().len(), 8_000);
    assert_eq!(mesh.used_vertices().len(), 8_000);

    let mut directed: HashMap<(u32, u32), usize> = HashMap::new();
    for [a, b, c] in mesh.faces() {
        for edge in [(*a, *b), (*b, *c), (*c, *a)] {
            *directed.entry(edge).or_default() += 1;
        }
    }
    for ((a, b), count) in &directed {
        assert_eq!(*count, 1, "edge {a}-{b} twice in one direction");
        assert!(directed.contains_key(&(*b, *a)), "edge {a}-{b} has one triangle only");
    }
    let edges = directed.len() / 2;
    assert_eq!(8_000 + 16_000 - edges as i64, 0, "Euler characteristic of a torus");

    let mut neighbours = vec![Vec::new(); 8_000];
    for (a, b) in directed.into_keys() {
        neighbours[a as usize].push(b);
    }
    let (mut reached, mut open) = (vec![false; 8_000], vec![0_u32]);
    while let Some(v) = open.pop() {
        if !std::mem::replace(&mut reached[v as usize], true) {
            open.extend(&neighbours[v as usize]);
        }
    }
    assert!(reached.into_iter().all(|r| r), "one component");
    assert!(neighbours.iter().all(|n| n.len() == 6), "a regular mesh");
}

#[test]
fn the_spring_is_oriented_outward_and_has_the_right_size() {
    let mesh = spring();
    let p = mesh.rest_positions();
    let volume: f64 = corners(&mesh).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
    // Area of the 16-gon in a circle of the tube's radius, times the length of the centreline.
    let rings: Vec<DVec3> =
        p.chunks_exact(AROUND).map(|ring| ring.iter().sum::<DVec3>() / AROUND as f64).collect();
    let length: f64 = (0..rings.len()).map(|i| (rings[i] - rings[(i + 1) % rings.len()]).length()).sum();
    let section = AROUND as f64 / 2.0 * TUBE_RADIUS * TUBE_RADIUS * (std::f64::consts::TAU / 16.0).sin();
    assert!((volume / (section * length) - 1.0).abs() < 0.02, "{volume} {}", section * length);

    let low = p.iter().copied().reduce(DVec3::min).unwrap();
    let high = p.iter().copied().reduce(DVec3::max).unwrap();
    assert!((low + high).abs().max_element() < 1e-12, "centred");
    assert!((0.9..1.0).contains(&(high.z - low.z)) && (0.41..0.43).contains(&(high.x - low.x)));

    for [a, b, c] in corners(&mesh) {
        let sides = [(b - a).length(), (c - b).length(), (a - c).length()];
        let longest = sides.into_iter().fold(0.0, f64::max);
        let height = (b - a).cross(c - a).length() / longest;
        assert!(height > 0.25 * longest, "a sliver: {sides:?}");
    }
}

#[test]
fn neighbouring_coils_are_one_tube_radius_apart() {
    let mesh = spring();
    let p = mesh.rest_positions();
    let rings = p.len() / AROUND;
    let mut smallest = f64::INFINITY;
    for (i, a) in p.iter().enumerate() {
        for (j, b) in p.iter().enumerate().skip(i) {
            let along = (j - i) / AROUND;
            // 16 rings are 12 tube radii of arc; closer vertices are on the same coil.
            if (16..=rings - 16).contains(&along) {
                smallest = smallest.min(a.distance_squared(*b));
            }
        }
    }
    let gap = smallest.sqrt() / TUBE_RADIUS;
    assert!((0.9..1.15).contains(&gap), "{gap} tube radii");
}

#[test]
fn the_spring_does_not_intersect_itself_at_rest() {
    let mesh = spring();
    let (tested, intersecting) = self_intersections(&mesh);
    assert_eq!(intersecting, 0);
    assert!(tested > 2_000, "{tested} pairs had overlapping AABBs");

    // The test finds intersections in a spring with one half folded onto the other.
    let folded = mesh.rest_positions().iter().map(|p| DVec3::new(p.x.abs(), p.y, p.z)).collect();
    let (_, intersecting) = self_intersections(&TriMesh::new(folded, mesh.faces().to_vec()).unwrap());
    assert!(intersecting > 100, "{intersecting}");
}

/// A hash of all bits detects changes of the shape and differences between machines.
#[test]
fn the_spring_has_the_same_bits_on_every_machine() {
    let mesh = spring();
    let hash = mesh
        .rest_positions()
        .iter()
        .flat_map(|p| p.to_array())
        .fold(0xcbf2_9ce4_8422_2325_u64, |h, x| (h ^ x.to_bits()).wrapping_mul(0x100_0000_01b3));
    assert_eq!(hash, 0x74df_8623_8459_79dd, "{hash:#018x}");
    assert_eq!(mesh, spring());
}

fn corners(mesh: &TriMesh) -> impl Iterator<Item = [DVec3; 3]> {
    mesh.faces().iter().map(|f| f.map(|v| mesh.rest_positions()[v as usize]))
}

/// Returns the number of pairs of non-adjacent triangles with overlapping AABBs, and how many of them intersect.
fn self_intersections(mesh: &TriMesh) -> (usize, usize) {
    let faces: Vec<[DVec3; 3]> = corners(mesh).collect();
    let boxes: Vec<(DVec3, DVec3)> =
        faces.iter().map(|[a, b, c]| (a.min(*b).min(*c), a.max(*b).max(*c))).collect();
    let mut order: Vec<usize> = (0..faces.len()).collect();
    order.sort_by(|i, j| boxes[*i].0.z.total_cmp(&boxes[*j].0.z));
    let (mut tested, mut intersecting) = (0, 0);
    for (at, &i) in order.iter().enumerate() {
        for &j in order[at + 1..].iter().take_while(|j| boxes[**j].0.z <= boxes[i].1.z) {
            let is_disjoint = boxes[i].0.cmpgt(boxes[j].1).any() || boxes[j].0.cmpgt(boxes[i].1).any();
            let are_adjacent = mesh.faces()[i].iter().any(|v| mesh.faces()[j].contains(v));
            if !is_disjoint && !are_adjacent {
                tested += 1;
                let meet = edges_meet(faces[i], faces[j]) || edges_meet(faces[j], faces[i]);
                intersecting += usize::from(meet);
            }
        }
    }
    (tested, intersecting)
}

/// Whether an edge of `a` meets the triangle `b`, touching included. Signs are exact. A segment in the plane of the
/// triangle may be reported although it does not meet the triangle.
fn edges_meet(a: [DVec3; 3], b: [DVec3; 3]) -> bool {
    let side = |p: DVec3, q: DVec3, r: DVec3, s: DVec3| {
        let [p, q, r, s] = [p, q, r, s].map(|x| Coord3D { x: x.x, y: x.y, z: x.z });
        orient3d(p, q, r, s)
    };
    let one_side = |sides: &[f64]| sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0);
    (0..3).any(|i| {
        let (p, q) = (a[i], a[(i + 1) % 3]);
        let ends = [side(b[0], b[1], b[2], p), side(b[0], b[1], b[2], q)];
        let around = [side(p, q, b[0], b[1]), side(p, q, b[1], b[2]), side(p, q, b[2], b[0])];
        let passes = around.iter().all(|s| *s >= 0.0) || around.iter().all(|s| *s <= 0.0);
        !one_side(&ends) && passes
    })
}
