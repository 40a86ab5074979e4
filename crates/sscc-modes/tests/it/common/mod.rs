//! Surfaces for tests.

use glam::DVec3;
use sscc::TriMesh;

/// Generator of pseudo-random numbers.
pub struct Random(pub u64);

impl Random {
    /// Returns a number between -1 and 1.
    pub fn number(&mut self) -> f64 {
        sscc::parts::next_bits(&mut self.0) as i64 as f64 / 2.0_f64.powi(63)
    }

    /// Returns a vector in the cube from -1 to 1.
    pub fn vector(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| self.number()))
    }
}

fn valid(positions: Vec<DVec3>, faces: Vec<[u32; 3]>) -> TriMesh {
    TriMesh::new(positions, faces).expect("a test surface is a valid mesh")
}

/// Maps every vertex; faces are unchanged.
pub fn moved(mesh: &TriMesh, map: impl Fn(DVec3) -> DVec3) -> TriMesh {
    valid(mesh.rest_positions().iter().map(|p| map(*p)).collect(), mesh.faces().to_vec())
}

/// Returns the surface of the cube from -1 to 1, with n x n squares on each side and shared vertices.
pub fn cube(n: i32) -> TriMesh {
    let mut positions: Vec<DVec3> = Vec::new();
    let mut faces = Vec::new();
    let mut index = |p: DVec3| match positions.iter().position(|q| *q == p) {
        Some(i) => i as u32,
        None => {
            positions.push(p);
            positions.len() as u32 - 1
        }
    };
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let mut corner = |i: i32, j: i32| {
                    let mut p = [0.0; 3];
                    p[axis] = side;
                    p[(axis + 1) % 3] = side * f64::from(2 * i - n) / f64::from(n);
                    p[(axis + 2) % 3] = f64::from(2 * j - n) / f64::from(n);
                    index(DVec3::from_array(p))
                };
                let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                // The diagonals point towards the axes, which keeps the symmetry of the cube.
                let is_diagonal = (2 * i + 1 < n) == (2 * j + 1 < n);
                faces.extend(if is_diagonal { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
            }
        }
    }
    valid(positions, faces)
}

/// Returns the unit sphere: a projected cube.
pub fn sphere() -> TriMesh {
    moved(&cube(6), DVec3::normalize)
}

/// Returns a closed surface without symmetry.
pub fn bumpy(seed: u64) -> TriMesh {
    let mut random = Random(seed);
    let radii: Vec<f64> = (0..cube(5).rest_positions().len()).map(|_| 1.0 + 0.4 * random.number()).collect();
    let sphere = moved(&cube(5), DVec3::normalize);
    let positions = sphere.rest_positions().iter().zip(&radii).map(|(p, r)| *p * *r).collect();
    valid(positions, sphere.faces().to_vec())
}

/// Returns a bent patch in the plane z = 0, on which xx, xy, yy, x, y, 1 are linearly independent.
pub fn plane() -> TriMesh {
    let bottom = |p: &[u32; 3], q: &[DVec3]| p.iter().all(|v| q[*v as usize].z == -1.0);
    let cube = cube(5);
    let faces = cube.faces().iter().filter(|f| bottom(f, cube.rest_positions())).copied().collect();
    let flat = |p: &DVec3| DVec3::new(p.x + 0.3 * p.y * p.y, p.y + 0.1 * p.x, 0.0);
    valid(cube.rest_positions().iter().map(flat).collect(), faces)
}
