//! Boxes of trilinear cubes, for tests.

use faer::Mat;
use glam::DVec3;

use super::basis::Basis;
use super::space::Space;
use super::tall_matrix::Random;
use crate::sparse::BlockSparse;

/// Poisson's ratio.
const NU: f64 = 0.3;

/// Young's modulus.
const YOUNG: f64 = 1.0;

/// A box of unit cubes of density 1.
pub(crate) struct Lattice {
    pub stiffness: BlockSparse,
    pub mass: BlockSparse,
    pub positions: Vec<DVec3>,
    pub rigid: Mat<f64>,
}

impl Lattice {
    /// Creates a free box of x by y by z nodes.
    pub fn free(x: usize, y: usize, z: usize) -> Self {
        Self::new([x, y, z], |_| false, |_| true)
    }

    /// Creates the box with all nodes at x = 0 fixed.
    pub fn clamped(x: usize, y: usize, z: usize) -> Self {
        Self::new([x, y, z], |p| p[0] == 0, |_| true)
    }

    /// Creates a box with fixed nodes, and with the cubes whose lowest node is `present`.
    pub fn new(
        nodes: [usize; 3],
        fixed: impl Fn([usize; 3]) -> bool,
        present: impl Fn([usize; 3]) -> bool,
    ) -> Self {
        let at = |p: [usize; 3]| (p[2] * nodes[1] + p[1]) * nodes[0] + p[0];
        let place = |i: usize| [i % nodes[0], i / nodes[0] % nodes[1], i / nodes[0] / nodes[1]];
        let all = nodes[0] * nodes[1] * nodes[2];
        let corners = |p: [usize; 3]| -> [usize; 8] {
            std::array::from_fn(|c| at([p[0] + (c & 1), p[1] + (c >> 1 & 1), p[2] + (c >> 2)]))
        };
        let cubes: Vec<[usize; 8]> = (0..all)
            .map(place)
            .filter(|p| (0..3).all(|k| p[k] + 1 < nodes[k]) && present(*p))
            .map(corners)
            .collect();
        let mut used = vec![false; all];
        cubes.iter().flatten().for_each(|i| used[*i] = true);
        let (mut number, mut positions) = (vec![u32::MAX; all], Vec::new());
        for i in (0..all).filter(|i| used[*i] && !fixed(place(*i))) {
            number[i] = positions.len() as u32;
            let [x, y, z] = place(i);
            positions.push(DVec3::new(x as f64, y as f64, z as f64));
        }
        let cubes: Vec<[u32; 8]> = cubes.iter().map(|c| c.map(|i| number[i])).collect();
        let pattern = BlockSparse::with_pattern(positions.len(), cubes.iter().map(|c| &c[..]));
        let (mut stiffness, mut mass) = (pattern.clone(), pattern);
        let (k, m) = cube();
        for cube in &cubes {
            for (a, i) in cube.iter().enumerate().filter(|(_, i)| **i != u32::MAX) {
                for (b, j) in cube.iter().enumerate().filter(|(_, j)| **j != u32::MAX) {
                    stiffness.add(*i, *j, &k[a][b]);
                    mass.add(*i, *j, &m[a][b]);
                }
            }
        }
        let free = positions.len() == used.iter().filter(|u| **u).count();
        let mut rigid = Mat::from_fn(3 * positions.len(), if free { 6 } else { 0 }, |row, k| {
            let axis = DVec3::AXES[k % 3];
            let motion = if k < 3 { axis } else { axis.cross(positions[row / 3]) };
            motion[row % 3]
        });
        let empty = Mat::zeros(rigid.nrows(), 0);
        let space = Space::new(&mass, empty.as_ref());
        space.orthonormalise(&mut rigid, &Basis::new(empty.nrows(), 0), &mut Random(0)).unwrap();
        Self { stiffness, mass, positions, rigid }
    }
}

/// Blocks between the corners of an element.
type Element = [[[f64; 9]; 8]; 8];

/// Stiffness and mass of a unit cube, with 2 x 2 x 2 Gauss points.
fn cube() -> (Element, Element) {
    let (lambda, mu) = (YOUNG * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), YOUNG / (2.0 + 2.0 * NU));
    let (mut k, mut m) = ([[[0.0; 9]; 8]; 8], [[[0.0; 9]; 8]; 8]);
    for point in 0..8 {
        let at: [f64; 3] = std::array::from_fn(|d| 0.5 + [-0.5, 0.5][point >> d & 1] / 3.0_f64.sqrt());
        let part = |c: usize, d: usize| if c >> d & 1 == 1 { at[d] } else { 1.0 - at[d] };
        let shape = |c: usize| part(c, 0) * part(c, 1) * part(c, 2);
        let gradient = |c: usize, d: usize| {
            let sign = if c >> d & 1 == 1 { 1.0 } else { -1.0 };
            sign * part(c, (d + 1) % 3) * part(c, (d + 2) % 3)
        };
        for a in 0..8 {
            for b in 0..8 {
                let along: f64 = (0..3).map(|d| gradient(a, d) * gradient(b, d)).sum();
                for entry in 0..9 {
                    let (i, j) = (entry / 3, entry % 3);
                    let equal = if i == j { 1.0 } else { 0.0 };
                    k[a][b][entry] += 0.125
                        * (lambda * gradient(a, i) * gradient(b, j)
                            + mu * gradient(a, j) * gradient(b, i)
                            + mu * equal * along);
                    m[a][b][entry] += 0.125 * equal * shape(a) * shape(b);
                }
            }
        }
    }
    (k, m)
}

/// Returns the dense matrix.
pub(crate) fn dense(matrix: &BlockSparse) -> Mat<f64> {
    super::dense::full(matrix)
}

/// Returns a matrix of random numbers between -1 and 1.
pub(crate) fn random_matrix(rows: usize, columns: usize) -> Mat<f64> {
    Random(42).matrix(rows, columns)
}

/// Returns a symmetric matrix of random numbers; those on the diagonal are scaled by `diagonal`.
pub(crate) fn random_blocks(pattern: &BlockSparse, seed: u64, diagonal: f64) -> BlockSparse {
    let mut matrix = pattern.combined(0.0, pattern, 0.0);
    let mut random = Random(seed);
    for i in 0..pattern.rows() {
        for j in pattern.columns(i).iter().copied().filter(|j| *j as usize >= i) {
            let block: [f64; 9] = std::array::from_fn(|_| random.next());
            let mirrored = std::array::from_fn(|k| block[k % 3 * 3 + k / 3]);
            if j as usize == i {
                let entry = |k: usize| {
                    if [0, 4, 8].contains(&k) { diagonal * block[k] } else { block[k] + mirrored[k] }
                };
                matrix.add(j, j, &std::array::from_fn(entry));
            } else {
                matrix.add(i as u32, j, &block);
                matrix.add(j, i as u32, &mirrored);
            }
        }
    }
    matrix
}
