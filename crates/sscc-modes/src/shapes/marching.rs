//! Surface of an implicit solid by marching tetrahedra.
//!
//! Each cube of a lattice is split along its diagonal into six tetrahedra, in the same way for all cubes. The faces of
//! neighbouring cubes therefore match, the surface cuts a tetrahedron in at most one triangle or quadrilateral, and the
//! surface is closed and manifold without ambiguous cases.

use glam::DVec3;

use super::implicit::Implicit;
use super::surface::Surface;

/// Tetrahedra of a cube, each a path from corner 0 to corner 7. Bits number the corners: 1 for a step along x, 2 along y,
/// 4 along z. The first three tetrahedra have positive volume, the others negative.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 2, 3, 7], [0, 4, 6, 7], [0, 1, 5, 7]];

/// Minimum distance of a cut from the ends of a lattice edge, relative to its length, so that cuts do not coincide.
const MIN_SHARE: f64 = 0.1;

/// Placeholder for no vertex.
const NONE: u32 = u32::MAX;

/// Lattice of `size` points, `spacing` (model unit) apart, the first one at `low`.
pub(super) struct Lattice {
    /// Corner with the smallest coordinates.
    pub low: DVec3,
    /// Distance of neighbouring points (model unit).
    pub spacing: f64,
    /// Number of points along each axis.
    pub size: [usize; 3],
}

impl Lattice {
    /// Returns the surface where the function changes its sign, oriented outward. The solid must lie within the lattice.
    pub fn extract(&self, solid: &Implicit) -> Surface {
        let [nx, ny, nz] = self.size;
        let steps = [1, nx, nx * ny];
        let point = |i: usize| {
            let at = [i % nx, i / nx % ny, i / (nx * ny)].map(|k| k as f64);
            self.low + DVec3::from_array(at) * self.spacing
        };
        let values: Vec<f64> = (0..nx * ny * nz).map(|i| solid.sample(point(i)).0).collect();
        let corner = |cube: usize, bits: usize| {
            cube + (0..3).map(|axis| (bits >> axis & 1) * steps[axis]).sum::<usize>()
        };

        // Vertex on the lattice edge from a point in the direction given by bits.
        let mut vertex_of = vec![[NONE; 8]; values.len()];
        let (mut points, mut normals) = (Vec::new(), Vec::new());
        let mut faces = Vec::new();
        for cube in 0..values.len() {
            let inner = [cube % nx + 1 < nx, cube / nx % ny + 1 < ny, cube / (nx * ny) + 1 < nz];
            if inner != [true; 3] {
                continue;
            }
            let inside: [bool; 8] = std::array::from_fn(|bits| values[corner(cube, bits)] < 0.0);
            if inside == [inside[0]; 8] {
                continue;
            }
            for (number, path) in TETRAHEDRA.iter().enumerate() {
                let mut vertex = |from: usize, to: usize| {
                    // Numbers of corners ascend along a path, so the smaller corner comes first.
                    let (from, to) = (from.min(to), from.max(to));
                    let (a, b) = (corner(cube, from), corner(cube, to));
                    let entry = &mut vertex_of[a][to ^ from];
                    if *entry == NONE {
                        *entry = points.len() as u32;
                        let share = values[a] / (values[a] - values[b]);
                        let cut = point(a).lerp(point(b), share.clamp(MIN_SHARE, 1.0 - MIN_SHARE));
                        let (on_surface, normal) = solid.project(cut);
                        points.push(on_surface);
                        normals.push(normal);
                    }
                    *entry
                };
                let positive = number < 3;
                // Corners inside the solid come first.
                let mut order = [0, 1, 2, 3];
                order.sort_by_key(|&i| !inside[path[i]]);
                let [a, b, c, d] = order.map(|i| path[i]);
                let cuts = match order.iter().filter(|&&i| inside[path[i]]).count() {
                    1 => vec![[vertex(a, b), vertex(a, c), vertex(a, d)]],
                    2 => {
                        let [ac, ad, bd, bc] = [vertex(a, c), vertex(a, d), vertex(b, d), vertex(b, c)];
                        vec![[ac, ad, bd], [ac, bd, bc]]
                    }
                    3 => vec![[vertex(a, d), vertex(b, d), vertex(c, d)]],
                    _ => continue,
                };
                let outward = positive == is_even(order);
                faces.extend(cuts.into_iter().map(|[i, j, k]| if outward { [i, j, k] } else { [i, k, j] }));
            }
        }
        Surface::new(points, normals, faces)
    }
}

/// Whether a permutation is even.
fn is_even(order: [usize; 4]) -> bool {
    let inversions = (0..4).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|&(j, i)| order[j] > order[i]);
    inversions.count() % 2 == 0
}
