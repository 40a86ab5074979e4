//! Small random models, with unusual meshes and modes of every kind.

pub mod exact;
pub mod pair_trees;

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DMat3, DVec3};
use sscc::parts::Scope;
use sscc::{
    CancelToken, CertifyOptions, ContactFilter, Metric, MetricKind, Modes, Neighbours, ReducedModel, TriMesh,
};

/// A generator of pseudo-random numbers.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        let mut this = Self(seed.wrapping_mul(0xd1b5_4a32_d192_ed03));
        this.bits();
        this
    }

    pub fn bits(&mut self) -> u64 {
        sscc::parts::next_bits(&mut self.0)
    }

    /// Returns a number in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        sscc::parts::next_uniform(&mut self.0)
    }

    /// Returns a number in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.uniform() - 1.0
    }

    /// Returns an integer in 0 .. n.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Returns `10^x` for a random x between the two exponents.
    pub fn power(&mut self, from: f64, to: f64) -> f64 {
        10.0_f64.powf(from + (to - from) * self.uniform())
    }

    /// Returns barycentric weights; one point in four is a corner or lies on an edge.
    pub fn weights(&mut self) -> DVec3 {
        let mut w = DVec3::new(self.uniform(), self.uniform(), self.uniform());
        if self.below(4) == 0 {
            w[self.below(3)] = 0.0;
            if self.below(2) == 0 {
                w = DVec3::AXES[self.below(3)];
            }
        }
        let sum = w.x + w.y + w.z;
        if sum > 0.0 { w / sum } else { DVec3::X }
    }
}

/// Vertices and faces.
pub type Soup = (Vec<DVec3>, Vec<[u32; 3]>);

/// Returns a mesh of 4 to 64 triangles, and a few more.
pub fn random_mesh(random: &mut Random) -> Soup {
    let (mut p, mut faces) = match random.below(7) {
        0 => soup(random),
        1 => sphere(random),
        2 => strip(random),
        3 => fan(random),
        4 => sheets(random),
        5 => integer_soup(random),
        _ => curled_strip(random),
    };
    if random.below(4) == 0 {
        // Duplicates and triangles without area.
        for _ in 0..1 + random.below(3) {
            let [a, b, c] = faces[random.below(faces.len())];
            faces.push(match random.below(4) {
                0 => [a, b, c],
                1 => [c, b, a],
                2 => [a, a, b],
                _ => {
                    p.push(p[a as usize] * 0.5 + p[b as usize] * 0.5);
                    [a, b, p.len() as u32 - 1]
                }
            });
        }
    }
    if random.below(4) == 0 {
        // Unused vertices, first and last.
        p.push(random.vector() * 1e3);
        p.insert(0, random.vector() * 1e3);
        faces.iter_mut().flatten().for_each(|v| *v += 1);
    }
    let (scale, offset) = match random.below(8) {
        0 => (random.power(-20.0, 20.0), DVec3::ZERO),
        1 => (1.0, random.vector() * random.power(0.0, 8.0)),
        _ => (1.0, DVec3::ZERO),
    };
    p.iter_mut().for_each(|p| *p = *p * scale + offset);
    (p, faces)
}

/// Returns triangles without common vertices.
fn soup(random: &mut Random) -> Soup {
    let count = 4 + random.below(14);
    let size = random.power(-3.0, -0.3);
    let mut p = Vec::new();
    for _ in 0..count {
        let center = random.vector();
        p.extend([(); 3].map(|()| center + random.vector() * size));
    }
    (p, (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

/// Returns triangles on a coarse grid, with many exact contacts, coplanar and parallel parts.
fn integer_soup(random: &mut Random) -> Soup {
    let count = 4 + random.below(12);
    let mut p = Vec::new();
    for t in 0..count {
        let center = DVec3::new((t % 3) as f64, (t / 3) as f64, 0.0) * 4.0;
        p.extend([(); 3].map(|()| center + (random.vector() * 2.2).round()));
    }
    (p, (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

/// Returns a tetrahedron or an octahedron, subdivided and projected to a sphere.
fn sphere(random: &mut Random) -> Soup {
    let octahedron = random.below(2) == 0;
    let (mut p, mut faces) = if octahedron {
        let p = vec![DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
        let f = vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        (p, f)
    } else {
        let p = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]];
        let p = p.map(|c: [i32; 3]| DVec3::from_array(c.map(f64::from)).normalize()).to_vec();
        (p, vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    };
    for _ in 0..1 + usize::from(!octahedron && random.below(4) == 0) {
        let mut next = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |a: u32, b: u32| {
                let m = (p[a as usize] + p[b as usize]).normalize();
                match p.iter().position(|x| *x == m) {
                    Some(i) => i as u32,
                    None => {
                        p.push(m);
                        p.len() as u32 - 1
                    }
                }
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = next;
    }
    let axes = DVec3::new(1.0, random.power(-1.0, 0.0), random.power(-2.0, 0.0));
    p.iter_mut().for_each(|p| *p *= axes);
    (p, faces)
}

/// Returns an open, slightly uneven strip.
fn strip(random: &mut Random) -> Soup {
    let steps = 3 + random.below(10);
    let noise = random.power(-9.0, -1.0);
    let p = (0..=steps)
        .flat_map(|i| [0.0, 1.0].map(|y| DVec3::new(i as f64, y, 0.0)))
        .map(|p| p + random.vector() * noise)
        .collect();
    (p, strip_faces(steps))
}

fn strip_faces(steps: usize) -> Vec<[u32; 3]> {
    let quad = |i: u32| [[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 1, 2 * i + 2, 2 * i + 3]];
    (0..steps as u32).flat_map(quad).collect()
}

/// Returns a strip that is bent nearly to a ring, so that its ends are close.
fn curled_strip(random: &mut Random) -> Soup {
    let steps = 6 + random.below(14);
    let gap = random.power(-6.0, -0.5);
    let p = (0..=steps)
        .flat_map(|i| {
            let (sin, cos) = ((std::f64::consts::TAU - gap) * i as f64 / steps as f64).sin_cos();
            [0.0, 0.4].map(|y| DVec3::new(cos, y, sin))
        })
        .collect();
    (p, strip_faces(steps))
}

/// Returns many triangles around one edge, and some beside it.
fn fan(random: &mut Random) -> Soup {
    let blades = 3 + random.below(8);
    let mut p = vec![DVec3::ZERO, DVec3::Z];
    let mut faces = Vec::new();
    for i in 0..blades {
        let (sin, cos) = (std::f64::consts::TAU * i as f64 / blades as f64).sin_cos();
        let first = p.len() as u32;
        let out = DVec3::new(cos, sin, 0.0);
        p.extend([out + DVec3::Z * 0.5, out * 2.0, out * 2.0 + DVec3::Z]);
        faces.extend([[0, 1, first], [first, first + 1, first + 2]]);
    }
    (p, faces)
}

/// Returns two sheets with a narrow gap.
fn sheets(random: &mut Random) -> Soup {
    let n = 2 + u32::from(random.below(4) == 0);
    let gap = random.power(-9.0, -0.5);
    let mut p = Vec::new();
    let mut faces = Vec::new();
    for sheet in 0..2 {
        let first = p.len() as u32;
        for i in 0..=n {
            for j in 0..=n {
                p.push(DVec3::new(f64::from(i), f64::from(j), f64::from(sheet) * gap));
            }
        }
        for i in 0..n {
            for j in 0..n {
                let a = first + i * (n + 1) + j;
                faces.extend([[a, a + 1, a + n + 1], [a + 1, a + n + 2, a + n + 1]]);
            }
        }
    }
    (p, faces)
}

/// Returns modes of one of many kinds, in vertex-major order.
pub fn random_modes(random: &mut Random, p: &[DVec3], rank: usize) -> Vec<DVec3> {
    let kind = random.below(9);
    let mut columns: Vec<Vec<DVec3>> = (0..rank)
        .map(|k| {
            let matrix = DMat3::from_cols(random.vector(), random.vector(), random.vector());
            let (w, shift) = (random.vector(), random.vector());
            let smooth = |x: DVec3| matrix * x + shift + DVec3::new(x.y * x.z, x.x * x.x, x.x * x.y) * w;
            p.iter()
                .map(|&x| match kind {
                    0 | 1 => random.vector(),
                    2 | 3 => smooth(x),
                    // Displacements in a plane.
                    4 => random.vector() * DVec3::new(1.0, 0.0, 1.0),
                    // Rigid motions.
                    5 => {
                        if k % 2 == 0 {
                            w.cross(x)
                        } else {
                            shift
                        }
                    }
                    // Displacements with a large common part.
                    6 => shift * 1e8 + random.vector(),
                    // Few vertices move.
                    7 if random.below(3) > 0 => DVec3::ZERO,
                    7 => random.vector() * random.power(-6.0, 0.0),
                    // Nearly rigid motions.
                    _ => w.cross(x) + random.vector() * 1e-6,
                })
                .collect()
        })
        .collect();
    for k in 1..rank {
        match random.below(12) {
            0 => columns[k] = columns[random.below(k)].clone(),
            1 => columns[k].fill(DVec3::ZERO),
            2 => {
                let size = random.power(-8.0, 8.0);
                columns[k].iter_mut().for_each(|u| *u *= size);
            }
            _ => {}
        }
    }
    (0..p.len()).flat_map(|v| columns.iter().map(move |c| c[v])).collect()
}

/// Returns the model number `seed`.
pub fn random_model(seed: u64) -> ReducedModel {
    let random = &mut Random::new(seed);
    let (mut p, mut faces) = random_mesh(random);
    let rank = match random.below(4) {
        0 => 1 + random.below(3),
        1 => 1 + random.below(40),
        _ => 1 + random.below(8),
    };
    let mut modes = random_modes(random, &p, rank);
    if random.below(4) == 0 {
        split_vertices(random, &mut p, &mut faces, &mut modes);
    }
    let modes = Modes::new(rank, modes).unwrap();
    let mesh = TriMesh::new(p, faces).unwrap();
    let metric = match random.below(5) {
        0 => Metric::identity(rank),
        1 => Metric::mass(&mesh, &modes).unwrap(),
        2 => {
            let scales = (0..rank).map(|_| random.power(-6.0, 6.0)).collect();
            Metric::from_scales(MetricKind::Given, scales).unwrap()
        }
        3 => dense_metric(random, &mesh, &modes),
        _ => Metric::displacement(&mesh, &modes).unwrap(),
    };
    ReducedModel::with_metric(mesh, modes, metric).unwrap()
}

/// Gives some corners new vertices, as along the seams of a graphics format.
fn split_vertices(random: &mut Random, p: &mut Vec<DVec3>, faces: &mut [[u32; 3]], modes: &mut Vec<DVec3>) {
    let rank = modes.len() / p.len();
    for corner in faces.iter_mut().flatten() {
        if random.below(3) == 0 {
            let v = *corner as usize;
            p.push(p[v]);
            modes.extend_from_within(v * rank..(v + 1) * rank);
            *corner = p.len() as u32 - 1;
        }
    }
}

/// Returns a metric whose unit ball is rotated and stretched.
fn dense_metric(random: &mut Random, mesh: &TriMesh, modes: &Modes) -> Metric {
    let rank = modes.rank();
    let scales = Metric::displacement(mesh, modes).unwrap().scales();
    let g: Vec<f64> = (0..rank * rank).map(|_| random.signed()).collect();
    let entry = |i: usize, j: usize| -> f64 {
        let inner: f64 = (0..rank).map(|k| g[k * rank + i] * g[k * rank + j]).sum();
        (inner + if i == j { 0.01 } else { 0.0 }) * scales[i] * scales[j]
    };
    let matrix: Vec<f64> = (0..rank * rank).map(|e| entry(e / rank, e % rank)).collect();
    Metric::from_matrix(MetricKind::Given, rank, &matrix).unwrap()
}

/// Returns a strip of several buckets along a curve that comes near itself, or crosses itself; some of its corners have new
/// vertices. Modes are functions of position.
pub fn winding_strip(random: &mut Random, seed: u64) -> ReducedModel {
    let steps = 60 + random.below(60);
    let (turns, flat, noise) = (random.power(0.0, 0.7), random.power(-1.5, 0.0), random.power(-3.0, -1.0));
    let mut p: Vec<DVec3> = (0..=steps)
        .flat_map(|i| {
            let s = turns * std::f64::consts::TAU * i as f64 / steps as f64;
            let x = DVec3::new((2.0 * s).sin(), (3.0 * s + 0.5).sin(), flat * (s + 1.0).sin());
            [x, x + DVec3::Z * 0.1]
        })
        .map(|x| x + random.vector() * noise * 0.1)
        .collect();
    let mut faces: Vec<[u32; 3]> = (0..2 * steps as u32).map(|i| [i, i + 1, i + 2]).collect();
    if seed.is_multiple_of(3) {
        for corner in faces.iter_mut().flatten().filter(|_| random.below(6) == 0) {
            p.push(p[*corner as usize]);
            *corner = p.len() as u32 - 1;
        }
    }
    let rank = 1 + random.below(4);
    let ways: Vec<[DVec3; 2]> = (0..rank).map(|_| [random.vector(), random.vector()]).collect();
    let bend = |x: DVec3| ways.iter().map(move |[way, along]| *way * (2.0 * x.dot(*along)).sin());
    let modes = Modes::new(rank, p.iter().flat_map(|x| bend(*x)).collect()).unwrap();
    ReducedModel::new(TriMesh::new(p, faces).unwrap(), modes).unwrap()
}

/// Options, and the values that tests need.
pub struct RandomOptions {
    pub options: CertifyOptions,
    pub filter: ContactFilter,
    pub ignore_rest: bool,
}

/// Returns options of any kind, by the number of the model.
pub fn random_options(seed: u64, model: &ReducedModel) -> CertifyOptions {
    random_choices(seed, model).options
}

/// Returns options of any kind with their values.
pub fn random_choices(seed: u64, model: &ReducedModel) -> RandomOptions {
    let random = &mut Random::new(seed + 3_000_000);
    let center = (random.below(4) == 0).then(|| {
        let size = random.power(-3.0, 0.5);
        model.metric().scales().iter().map(|s| random.signed() * size / s).collect()
    });
    let filter = ContactFilter::new([Neighbours::Exclude, Neighbours::IncludeOneVertex][random.below(2)])
        .weld(random.below(2) == 0);
    let ignore_rest = random.below(3) == 0;
    let options = CertifyOptions::default()
        .center(center)
        .filter(filter.clone())
        .ignore_rest(ignore_rest.then_some(0))
        .max_exceptions([None, Some(0), Some(1000)][random.below(3)])
        // The budget is larger than the default, because these models are small.
        .budget(16)
        .threads(1);
    RandomOptions { options, filter, ignore_rest }
}

/// Whether two faces share a vertex number.
pub fn are_adjacent(mesh: &TriMesh, a: u32, b: u32) -> bool {
    let [a, b] = [a, b].map(|t| mesh.faces()[t as usize]);
    a.iter().any(|i| b.contains(i))
}

/// Returns `center + S^-1 z`.
pub fn at(scope: &Scope, z: &[f64]) -> Vec<f64> {
    scope.metric.unscaled(z).unwrap().iter().zip(&scope.center).map(|(d, c)| c + d).collect()
}

/// Returns the smallest z found that brings two points of the triangles together, which are not at a common vertex (for
/// relative modes of full rank).
pub fn critical_z(
    model: &ReducedModel,
    scope: &Scope,
    faces: (u32, u32),
    random: &mut Random,
) -> Option<Vec<f64>> {
    let [x, y] = [faces.0, faces.1].map(|f| model.mesh().faces()[f as usize]);
    // One point is on the edge opposite to a common vertex.
    let own = |v: u32| {
        if y.iter().any(|w| model.position(v, &scope.center) == model.position(*w, &scope.center)) {
            0.0
        } else {
            1.0
        }
    };
    let mask = DVec3::from_array(x.map(own));
    let mask = if mask == DVec3::ZERO { DVec3::ONE } else { mask };
    let normalised = |w: DVec3| w / (w.x + w.y + w.z).max(1e-300);
    let solve = |weights: [DVec3; 2]| -> Option<(f64, Vec<f64>)> {
        let mut d = DVec3::ZERO;
        let mut b = vec![DVec3::ZERO; model.rank()];
        for (face, weights, sign) in [(x, normalised(weights[0] * mask), -1.0), (y, weights[1], 1.0)] {
            for (&v, w) in face.iter().zip(weights.to_array()) {
                d += model.position(v, &scope.center) * (sign * w);
                for (b, u) in b.iter_mut().zip(model.modes().of_vertex(v)) {
                    *b += *u * (sign * w);
                }
            }
        }
        // Each component of `B S^-1` solves a system with the transpose of S.
        let b = scaled_rows(scope, &b);
        let gram = b.iter().fold(DMat3::ZERO, |g, b| g + DMat3::from_cols(*b * b.x, *b * b.y, *b * b.z));
        let trace = gram.x_axis.x + gram.y_axis.y + gram.z_axis.z;
        let y = (gram + DMat3::from_diagonal(DVec3::splat(1e-14 * trace))).inverse() * d;
        let z: Vec<f64> = b.iter().map(|b| -b.dot(y)).collect();
        let met = b.iter().zip(&z).fold(d, |x, (b, z)| x + *b * *z);
        let norm = z.iter().map(|z| z * z).sum::<f64>().sqrt();
        (norm.is_finite() && met.length() <= 1e-6 * d.length()).then_some((norm, z))
    };
    let mut best: Option<(f64, Vec<f64>, [DVec3; 2])> = None;
    let mut width = 0.3;
    for i in 0..60 {
        let weights = match &best {
            Some((_, _, at)) if i > 15 => {
                at.map(|w| normalised((w + random.vector() * width).max(DVec3::ZERO)))
            }
            _ => [random.weights(), random.weights()],
        };
        width *= 0.93;
        if let Some((norm, z)) = solve(weights)
            && best.as_ref().is_none_or(|b| norm < b.0)
        {
            best = Some((norm, z, weights));
        }
    }
    best.map(|b| b.1)
}

/// Computes `B S^-1`, column by column from the first mode on.
fn scaled_rows(scope: &Scope, b: &[DVec3]) -> Vec<DVec3> {
    let Some(s) = scope.metric.dense_factor() else {
        return b.iter().zip(scope.metric.scales()).map(|(b, s)| *b / s).collect();
    };
    let rank = b.len();
    let mut a: Vec<DVec3> = Vec::with_capacity(rank);
    for k in 0..rank {
        let known: DVec3 = (0..k).map(|j| a[j] * s[j * rank + k]).sum();
        a.push((b[k] - known) / s[k * rank + k]);
    }
    a
}

/// Returns a token that cancels after `looks` checks, to end computations that take too long.
pub fn after(looks: usize) -> CancelToken {
    let asked = AtomicUsize::new(0);
    CancelToken::when(move || asked.fetch_add(1, Ordering::Relaxed) >= looks)
}
