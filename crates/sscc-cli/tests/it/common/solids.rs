//! Solids of small cubes, made for tests: a bridge, a comb and an octopus, in the formats of other programs.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use glam::DVec3;
use sscc::TriMesh;
use sscc_solid::{Material, Solid};

/// A cube of side 1, by its corner with the smallest coordinates.
pub type Cell = [i32; 3];

/// A deck on two feet.
pub fn bridge() -> Vec<Cell> {
    let deck = (0..8).flat_map(|x| [[x, 0, 1], [x, 1, 1]]);
    deck.chain([0, 7].into_iter().flat_map(|x| [[x, 0, 0], [x, 1, 0]])).collect()
}

/// A spine with three teeth below it.
pub fn comb() -> Vec<Cell> {
    let teeth = [0, 2, 4].into_iter().flat_map(|x| [[x, 0, 0], [x, 0, 1]]);
    (0..5).map(|x| [x, 0, 2]).chain(teeth).collect()
}

/// A body with four arms; [`crossing`] lets two of them cross.
pub fn octopus() -> Vec<Cell> {
    let body = (0..8).map(|k| [k & 1, k >> 1 & 1, k >> 2]);
    let long = (2..8).flat_map(|t| [[t, 0, 0], [0, t, 0]]);
    body.chain(long).chain((-4..0).flat_map(|t| [[t, 1, 0], [1, t, 0]])).collect()
}

/// Bends the two long arms of the octopus towards each other.
pub fn crossing(p: DVec3) -> DVec3 {
    let bent = |t: f64| 0.25 * (t - 2.0).max(0.0).powi(2);
    p + DVec3::new(bent(p.y), bent(p.x), 0.0)
}

/// Returns the solid of these cells, six tetrahedra each, with its vertices mapped.
pub fn solid(cells: &[Cell], map: impl Fn(DVec3) -> DVec3) -> Solid {
    let (mut numbers, mut vertices, mut tets) = (BTreeMap::new(), Vec::new(), Vec::new());
    for cell in cells {
        for ([a, b, c], is_even) in [
            ([0, 1, 2], true),
            ([1, 2, 0], true),
            ([2, 0, 1], true),
            ([0, 2, 1], false),
            ([1, 0, 2], false),
            ([2, 1, 0], false),
        ] {
            let mut corner = *cell;
            let mut number = |corner: Cell| {
                *numbers.entry(corner).or_insert_with(|| {
                    vertices.push(map(DVec3::from_array(corner.map(f64::from))));
                    vertices.len() as u32 - 1
                })
            };
            let mut tet = [number(corner); 4];
            for (k, axis) in [a, b, c].into_iter().enumerate() {
                corner[axis] += 1;
                tet[k + 1] = number(corner);
            }
            if !is_even {
                tet.swap(2, 3);
            }
            tets.push(tet);
        }
    }
    Solid::uniform(vertices, tets, vec![], Material::default()).unwrap()
}

/// Returns the surface with each triangle split into four.
pub fn subdivided(mesh: &TriMesh) -> TriMesh {
    let (mut middles, mut points) = (BTreeMap::new(), mesh.rest_positions().to_vec());
    let mut faces = Vec::new();
    for &[a, b, c] in mesh.faces() {
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]) / 2.0);
                points.len() as u32 - 1
            })
        };
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        faces.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    TriMesh::new(points, faces).unwrap()
}

/// Returns a surface as OBJ.
pub fn obj(mesh: &TriMesh) -> String {
    let mut text = String::new();
    mesh.rest_positions().iter().for_each(|p| writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap());
    mesh.faces().iter().for_each(|f| writeln!(text, "f {} {} {}", f[0] + 1, f[1] + 1, f[2] + 1).unwrap());
    text
}

/// Returns a solid of tetrahedra as VegaFEM writes it.
pub fn veg(solid: &Solid) -> String {
    let mut text = format!("*VERTICES\n{} 3 0 0\n", solid.vertices().len());
    for (n, p) in solid.vertices().iter().enumerate() {
        writeln!(text, "{} {} {} {}", n + 1, p.x, p.y, p.z).unwrap();
    }
    writeln!(text, "\n*ELEMENTS\nTET\n{} 4 0", solid.tets().len()).unwrap();
    for (n, [a, b, c, d]) in solid.tets().iter().enumerate() {
        writeln!(text, "{} {} {} {} {}", n + 1, a + 1, b + 1, c + 1, d + 1).unwrap();
    }
    text + "\n*MATERIAL soft\nENU, 1000, 1e8, 0.4\n\n*REGION\nallElements, soft\n"
}

/// Returns a solid of tetrahedra as a Medit file.
pub fn medit(solid: &Solid) -> String {
    let mut text = format!("MeshVersionFormatted 1\nDimension 3\nVertices\n{}\n", solid.vertices().len());
    solid.vertices().iter().for_each(|p| writeln!(text, "{} {} {} 0", p.x, p.y, p.z).unwrap());
    writeln!(text, "Tetrahedra\n{}", solid.tets().len()).unwrap();
    for [a, b, c, d] in solid.tets() {
        writeln!(text, "{} {} {} {} 0", a + 1, b + 1, c + 1, d + 1).unwrap();
    }
    text + "End\n"
}
