//! Shapes of several buckets that bend, rotate and touch themselves far from rest, as plain numbers.

use glam::{DMat3, DVec3};

/// A generator of pseudo-random numbers (LCG).
pub struct Numbers(pub u64);

impl Numbers {
    /// Returns a number in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (self.0 >> 11) as f64 / 2.0_f64.powi(52) - 1.0
    }

    /// Returns a number in 0 .. n.
    pub fn below(&mut self, n: usize) -> usize {
        (((self.signed() + 1.0) * 0.5 * n as f64) as usize).min(n - 1)
    }

    /// Returns `10^x` for x between the two exponents.
    pub fn power(&mut self, from: f64, to: f64) -> f64 {
        10.0_f64.powf(from + (to - from) * 0.5 * (self.signed() + 1.0))
    }

    /// Returns a vector in the cube [-1, 1)^3.
    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// Kind of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A disk with a radial slit: the parts beside the slit touch the part at its end.
    SlitDisk,
    /// The surface of a box.
    Box,
    /// A flat sheet.
    Sheet,
    /// A strip along a helix.
    Helix,
    /// A strip bent into a ring that is nearly closed.
    Ring,
    /// A bar with teeth.
    Comb,
    /// A strip along a curve that comes near itself.
    Coil,
}

impl Shape {
    /// All kinds.
    pub const ALL: [Self; 7] =
        [Self::SlitDisk, Self::Box, Self::Sheet, Self::Helix, Self::Ring, Self::Comb, Self::Coil];
}

/// A mesh and modes.
pub struct FlexibleShape {
    /// Rest positions.
    pub positions: Vec<DVec3>,
    /// Vertices of triangles.
    pub faces: Vec<[u32; 3]>,
    /// The number of modes.
    pub rank: usize,
    /// Displacements of the vertices by the modes, in vertex-major order.
    pub displacements: Vec<DVec3>,
    /// Whether the first twelve modes are affine maps: nine gradients `e_c p_j` at `3 c + j`, then three translations.
    pub is_affine: bool,
}

/// Grids of `columns x rows` squares, as triangles; `vertex` has the number of a grid point.
fn grid(columns: u32, rows: u32, vertex: impl Fn(u32, u32) -> u32) -> Vec<[u32; 3]> {
    let square = |i: u32, j: u32| {
        let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1)];
        [[a, b, c], [b, d, c]]
    };
    (0..columns).flat_map(|i| (0..rows).flat_map(move |j| square(i, j))).collect()
}

fn surface(random: &mut Numbers, shape: Shape) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    use std::f64::consts::TAU;
    let strip = |columns: u32, rows: u32, at: &dyn Fn(f64, f64) -> DVec3| {
        let share = |i: u32, n: u32| f64::from(i) / f64::from(n);
        let points = (0..=columns).flat_map(|i| (0..=rows).map(move |j| (i, j)));
        let p = points.map(|(i, j)| at(share(i, columns), share(j, rows))).collect();
        (p, grid(columns, rows, |i, j| i * (rows + 1) + j))
    };
    let size = 0.7 + 0.3 * random.signed();
    let long = |n: f64| (n * size) as u32;
    match shape {
        Shape::SlitDisk => {
            let gap = random.power(-3.0, -1.0);
            strip(long(40.0), 6, &|u, v| {
                let angle = gap + (TAU - 2.0 * gap) * u;
                let r = 0.05 + v;
                DVec3::new(r * angle.cos(), r * angle.sin(), 0.05 * (3.0 * v).sin())
            })
        }
        Shape::Box => {
            let (n, sides) = (4 + random.below(4) as u32, DVec3::new(1.0, size, 0.3));
            let mut p: Vec<DVec3> = Vec::new();
            let mut faces = Vec::new();
            for side in 0..6_usize {
                let axis = side % 3;
                let height = f64::from(side < 3);
                let mut at = |i: u32, j: u32| {
                    let mut x = DVec3::ZERO;
                    x[axis] = height;
                    x[(axis + 1) % 3] = f64::from(i) / f64::from(n);
                    x[(axis + 2) % 3] = f64::from(j) / f64::from(n);
                    let found = p.iter().position(|y| *y == x);
                    found.unwrap_or_else(|| {
                        p.push(x);
                        p.len() - 1
                    }) as u32
                };
                let numbers: Vec<u32> =
                    (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect();
                faces.extend(grid(n, n, |i, j| numbers[(i * (n + 1) + j) as usize]));
            }
            p.iter_mut().for_each(|x| *x *= sides);
            (p, faces)
        }
        Shape::Sheet => strip(long(16.0), 10, &|u, v| DVec3::new(u, 0.7 * v, 0.0)),
        Shape::Helix => {
            let (turns, pitch) = (1.5 + size, random.power(-1.3, -0.5));
            strip(long(70.0), 2, &|u, v| {
                let angle = turns * TAU * u;
                DVec3::new(angle.cos(), angle.sin(), pitch * turns * u + 0.5 * pitch * v)
            })
        }
        Shape::Ring => {
            let gap = random.power(-4.0, -0.5);
            strip(long(60.0), 3, &|u, v| {
                let angle = (TAU - gap) * u;
                DVec3::new(angle.cos(), angle.sin(), 0.4 * v)
            })
        }
        Shape::Comb => {
            let (teeth, gap) = (4 + random.below(4) as u32, random.power(-3.0, -1.0));
            let (mut p, mut faces) = strip(4 * teeth, 2, &|u, v| DVec3::new(u, 0.1 * v, 0.0));
            for tooth in 0..teeth {
                let first = p.len() as u32;
                let (from, wide) = (4 * tooth, 3);
                // Rows of a tooth begin at the upper edge of the bar.
                let rows = 5;
                for i in 0..=wide {
                    let base = p[((from + i) * 3 + 2) as usize];
                    for j in 1..=rows {
                        let lean = (1.0 / f64::from(teeth * 4) - gap / f64::from(teeth)) * f64::from(j)
                            / f64::from(rows);
                        p.push(
                            base + DVec3::new(if i == wide { lean } else { 0.0 }, 0.1 * f64::from(j), 0.0),
                        );
                    }
                }
                faces.extend(grid(wide, rows, |i, j| {
                    if j == 0 { (from + i) * 3 + 2 } else { first + i * rows + j - 1 }
                }));
            }
            (p, faces)
        }
        Shape::Coil => {
            let (turns, flat) = (random.power(0.0, 0.6), random.power(-1.3, 0.0));
            strip(long(80.0), 2, &|u, v| {
                let s = turns * TAU * u;
                DVec3::new((2.0 * s).sin(), (3.0 * s + 0.5).sin(), flat * (s + 1.0).sin() + 0.1 * v)
            })
        }
    }
}

/// Returns a mode, as a function of position and vertex.
fn mode(random: &mut Numbers, k: usize, is_affine: bool, noise: f64) -> impl FnMut(DVec3) -> DVec3 + use<> {
    let [w, a, b] = [random.vector(), random.vector(), random.vector()];
    let matrix = DMat3::from_cols(random.vector(), random.vector(), random.vector());
    let (kind, waves) = (random.below(8), random.power(-0.3, 0.7));
    let mut own = Numbers(random.0 ^ 0x9e37_79b9);
    random.signed();
    move |x: DVec3| {
        if is_affine && k < 12 {
            let unit = DVec3::AXES[if k < 9 { k / 3 } else { k - 9 }];
            return if k < 9 { unit * x[k % 3] } else { unit };
        }
        let bend = w * (waves * x.dot(a) + b.x).sin();
        let bump = |center: DVec3, wide: f64| (1.0 - (x - center).length_squared() / (wide * wide)).max(0.0);
        let smooth = match kind {
            // Only one part moves.
            0 => w * bump(a, 0.8).powi(2),
            // A displacement around an axis that grows with the angle closes rings and slits.
            1 => DVec3::new(-x.y, x.x, 0.0) * x.y.atan2(x.x),
            2 => matrix * x + b * x.length_squared(),
            3 => bend + w * 1e3,
            4 => a.cross(x) * (b.dot(x)),
            _ => bend,
        };
        let noise = own.vector() * noise;
        if smooth == DVec3::ZERO { smooth } else { smooth + noise }
    }
}

impl FlexibleShape {
    /// Returns the shape number `seed` of a kind. It has at least `rank` modes; some shapes have twelve affine modes in addition.
    pub fn new(seed: u64, shape: Shape, rank: usize) -> Self {
        let random = &mut Numbers(seed.wrapping_mul(0xd1b5_4a32_d192_ed03) ^ 77);
        let (mut positions, mut faces) = surface(random, shape);
        let jitter = random.power(-6.0, -2.5);
        positions.iter_mut().for_each(|p| *p += random.vector() * jitter);
        if random.below(4) == 0 {
            // Adds duplicates, and triangles without area.
            for _ in 0..3 {
                let [a, b, c] = faces[random.below(faces.len())];
                let odd = [[a, b, c], [c, b, a], [a, a, b], [a, a, a]];
                faces.push(odd[random.below(4)]);
            }
        }
        let is_affine = random.below(2) == 0;
        let rank = if is_affine { 12 + rank } else { rank };
        let noise = if random.below(2) == 0 { 0.0 } else { random.power(-9.0, -2.0) };
        let mut modes: Vec<_> = (0..rank).map(|k| mode(random, k, is_affine, noise)).collect();
        let mut displacements: Vec<DVec3> = positions
            .iter()
            .flat_map(|p| modes.iter_mut().map(|mode| mode(*p)).collect::<Vec<_>>())
            .collect();
        if random.below(3) == 0 {
            // Some corners get vertices of their own, as at texture seams.
            for corner in faces.iter_mut().flatten() {
                if random.below(6) == 0 {
                    let v = *corner as usize;
                    positions.push(positions[v]);
                    displacements.extend_from_within(v * rank..(v + 1) * rank);
                    *corner = positions.len() as u32 - 1;
                }
            }
        }
        Self { positions, faces, rank, displacements, is_affine }
    }

    /// Returns the shape with all lengths multiplied by a factor, also those of modes.
    #[must_use]
    pub fn scaled(mut self, size: f64) -> Self {
        self.positions.iter_mut().for_each(|p| *p *= size);
        self.displacements.iter_mut().for_each(|u| *u *= size);
        self
    }

    /// Returns a q that rotates the shape about an axis by an angle (radians); None if the shape has no affine modes.
    pub fn turned(&self, axis: DVec3, angle: f64) -> Option<Vec<f64>> {
        if !self.is_affine {
            return None;
        }
        let turn = DMat3::from_axis_angle(axis.normalize(), angle) - DMat3::IDENTITY;
        let mut q = vec![0.0; self.rank];
        (0..9).for_each(|k| q[k] = turn.col(k % 3)[k / 3]);
        Some(q)
    }
}
