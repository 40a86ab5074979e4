//! Surfaces: layers that nearly touch, rolls, needles, flat and collinear meshes, soups on a grid of integers, and the flexible
//! shapes of the core's own tests.

use sscc_testing::{FlexibleShape, Shape};

use crate::exact::Point;
use crate::random::Random;

/// A surface whose vertices are divided into parts.
pub struct Surface {
    pub name: String,
    pub points: Vec<Point>,
    pub faces: Vec<[u32; 3]>,
    /// The number of each vertex's part: its layer, or its triangle in a soup; 0 on surfaces of one part.
    pub parts: Vec<usize>,
    /// A length that scales the noise, such as the distance of layers. Noise usually stays below it.
    pub gap: f64,
}

/// Returns a grid of squares, each made of two triangles. `at` maps two coordinates in [0, 1] to a position.
fn sheet(columns: usize, rows: usize, at: impl Fn(f64, f64) -> Point) -> (Vec<Point>, Vec<[u32; 3]>) {
    let mut points = Vec::new();
    for i in 0..=columns {
        for j in 0..=rows {
            points.push(at(i as f64 / columns as f64, j as f64 / rows as f64));
        }
    }
    let vertex = |i: usize, j: usize| (i * (rows + 1) + j) as u32;
    let mut faces = Vec::new();
    for i in 0..columns {
        for j in 0..rows {
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1)];
            faces.extend(if (i + j) % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] });
        }
    }
    (points, faces)
}

fn layers(random: &mut Random, least: usize) -> Surface {
    let count = 2 + random.below(4);
    let side = (((least / count) as f64 / 2.0).sqrt().ceil() as usize).max(2);
    let smallest = if random.one_in(5) { -15.0 } else { -8.0 };
    let gap = random.power(smallest, -0.5);
    let wave = if random.one_in(2) { 0.0 } else { random.power(-3.0, -0.7) };
    let turn = if random.one_in(2) { 0.0 } else { random.signed() };
    let mut surface = Surface {
        name: format!("{count} layers at {gap:.0e}"),
        points: vec![],
        faces: vec![],
        parts: vec![],
        gap,
    };
    for layer in 0..count {
        let (points, faces) = sheet(side, side, |u, v| {
            let z = layer as f64 * gap + wave * (5.0 * u + 3.0 * v).sin();
            let (s, c) = turn.sin_cos();
            [c * u - s * z, v, s * u + c * z]
        });
        let first = surface.points.len() as u32;
        surface.parts.extend(points.iter().map(|_| layer));
        surface.points.extend(points);
        surface.faces.extend(faces.into_iter().map(|face| face.map(|v| v + first)));
    }
    surface
}

fn roll(random: &mut Random, least: usize) -> Surface {
    let (turns, gap) = (random.power(0.0, 0.6), random.power(-2.2, -0.7));
    let rows = 2 + random.below(4);
    let (points, faces) = sheet((least / (2 * rows)).max(4), rows, |u, v| {
        let angle = turns * std::f64::consts::TAU * u;
        let radius = 0.3 + gap * turns * u;
        [radius * angle.cos(), radius * angle.sin(), 0.5 * v]
    });
    Surface {
        name: format!("roll at {gap:.0e}"),
        parts: vec![0; points.len()],
        points,
        faces,
        gap: 0.1 * gap,
    }
}

fn needles(random: &mut Random, least: usize) -> Surface {
    let thin = random.power(-12.0, -3.0);
    let (points, faces) = sheet((least / 4).max(4), 2, |u, v| {
        let bend = (3.0 * u).sin();
        let radius = 0.4 + 0.6 * u;
        [(9.0 * u).cos() * radius + thin * v, (9.0 * u).sin() * radius, 0.1 * bend + 0.5 * v * thin.sqrt()]
    });
    Surface { name: format!("needles {thin:.0e}"), parts: vec![0; points.len()], points, faces, gap: thin }
}

/// Returns a folded sheet in one plane, or along one line.
fn flat(random: &mut Random, least: usize) -> Surface {
    let (folds, is_line) = (random.of(&[1.0, 1.0, 2.0, 3.0]), random.one_in(5));
    let side = ((least as f64 / 2.0).sqrt().ceil() as usize).max(4);
    let slope = if random.one_in(2) { [0.0, 0.0] } else { [random.signed(), random.signed()] };
    let (points, faces) = sheet(side, side, |u, v| {
        let x = if folds > 1.0 { (folds * std::f64::consts::PI * u).cos() } else { u };
        let y = if is_line { 0.0 } else { v };
        [x, y, slope[0] * x + slope[1] * y]
    });
    let kind = if is_line { "collinear" } else { "flat" };
    Surface { name: format!("{kind} mesh"), parts: vec![0; points.len()], points, faces, gap: 1e-3 }
}

/// Returns small triangles with corners on a grid of integers, which have exact contacts of every kind.
fn soup(random: &mut Random, least: usize) -> Surface {
    let size = 2 + ((least as f64).cbrt() as usize) * (1 + random.below(4));
    let mut points: Vec<Point> = Vec::new();
    let mut faces = Vec::new();
    for _ in 0..least {
        let middle: Point = std::array::from_fn(|_| random.whole(size));
        let corner = |random: &mut Random| -> Point { std::array::from_fn(|c| middle[c] + random.whole(1)) };
        let first = points.len() as u32;
        points.extend([corner(random), corner(random), corner(random)]);
        let old = random.below(points.len()) as u32;
        faces.push(if random.one_in(3) { [first, first + 1, old] } else { [first, first + 1, first + 2] });
    }
    let parts = (0..points.len()).map(|v| v / 3).collect();
    Surface { name: format!("soup of {size}"), points, faces, parts, gap: 1e-3 }
}

fn flexible(random: &mut Random) -> Surface {
    let kind = random.of(&Shape::ALL);
    let FlexibleShape { positions, faces, .. } = FlexibleShape::new(random.bits(), kind, 1);
    let points: Vec<Point> = positions.iter().map(|p| p.to_array()).collect();
    Surface { name: format!("{kind:?}"), parts: vec![0; points.len()], points, faces, gap: 1e-3 }
}

/// Returns a random surface of about `least` triangles or more; flexible shapes have their own number of triangles.
pub fn random(random: &mut Random, least: usize) -> Surface {
    let mut surface = match random.below(16) {
        0..4 => layers(random, least),
        4..7 => roll(random, least),
        7 => needles(random, least),
        8 => flat(random, least),
        9 => soup(random, least),
        _ => flexible(random),
    };
    if random.one_in(3) {
        let most = if random.one_in(6) { 1.0 } else { 0.1 * surface.gap };
        let noise = most * random.power(-9.0, 0.0);
        surface.points.iter_mut().for_each(|p| {
            let by = random.point();
            *p = std::array::from_fn(|c| p[c] + noise * by[c]);
        });
        surface.name += &format!(" noise {noise:.0e}");
    }
    if random.one_in(4) {
        for _ in 0..1 + random.below(6) {
            let [a, b, c] = random.of(&surface.faces);
            surface.faces.push(random.of(&[[a, b, c], [c, b, a], [a, a, b], [a, a, a]]));
        }
        surface.name += " doubled";
    }
    surface
}
