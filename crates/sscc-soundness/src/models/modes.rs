//! Random modes: smooth, local, affine, closing, nearly equal to another mode, cancelling, noisy, and zero.

use super::surfaces::Surface;
use crate::exact::Point;
use crate::random::Random;

/// Displacement of each vertex in one mode.
type Mode = Vec<Point>;

fn along(n: Point, amount: f64) -> Point {
    n.map(|x| x * amount)
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn each(surface: &Surface, mut of: impl FnMut(usize, Point) -> Point) -> Mode {
    surface.points.iter().enumerate().map(|(v, p)| of(v, *p)).collect()
}

fn affine(random: &mut Random, surface: &Surface) -> Mode {
    let (a, b, axis) = (random.point(), random.point(), random.below(3));
    match random.below(4) {
        0 => each(surface, |_, _| a),
        // A rotation, to first order.
        1 => each(surface, |_, p| {
            [a[1] * p[2] - a[2] * p[1], a[2] * p[0] - a[0] * p[2], a[0] * p[1] - a[1] * p[0]]
        }),
        2 => each(surface, |_, p| along(a, p[axis])),
        _ => each(surface, |_, p| along(a, dot(b, p))),
    }
}

/// Returns a mode that moves parts towards each other by exact amounts.
fn closing(random: &mut Random, surface: &Surface) -> Mode {
    let (axis, step) = (random.below(3), random.of(&[1.0, 0.5, 0.125]));
    let chosen = random.below(surface.parts.iter().max().map_or(1, |part| part + 1));
    each(surface, |v, _| {
        let mut u = [0.0; 3];
        u[axis] = if surface.parts[v] == chosen { -step } else { 0.0 };
        u
    })
}

fn smooth(random: &mut Random, surface: &Surface) -> Mode {
    let (w, a, shift, waves) = (random.point(), random.point(), random.signed(), random.power(-0.5, 1.0));
    match random.below(4) {
        0 => each(surface, |_, p| along(w, (waves * dot(a, p) + shift).sin())),
        1 => each(surface, |_, p| along(w, (shift * p[1].atan2(p[0])).sin())),
        2 => each(surface, |_, p| along(w, dot(a, p) * dot(a, p))),
        _ => {
            let distance = |p: Point| (0..3).map(|c| (p[c] - a[c]) * (p[c] - a[c])).sum::<f64>();
            each(surface, |_, p| along(w, (1.0 - distance(p)).max(0.0)))
        }
    }
}

fn single(random: &mut Random, surface: &Surface) -> Mode {
    let (vertex, w) = (random.below(surface.points.len()), random.point());
    each(surface, |v, _| if v == vertex { w } else { [0.0; 3] })
}

/// Returns modes in vertex-major order, the pairs of nearly equal modes, and the number of modes.
pub fn random(random: &mut Random, surface: &Surface) -> (Vec<Point>, Vec<(usize, usize)>, usize) {
    let large = if random.one_in(40) { 200 } else { 48 };
    let rank = random.of(&[1, 2, 2, 3, 4, 6, 8, 8, 12, 20, large]);
    let mut modes: Vec<Mode> = Vec::new();
    let mut twins = Vec::new();
    for k in 0..rank {
        let mut mode = match random.below(16) {
            0..4 => affine(random, surface),
            4 | 5 => closing(random, surface),
            6 => single(random, surface),
            7 => each(surface, |_, _| [0.0; 3]),
            8 => {
                let mut noise = random.clone();
                random.bits();
                each(surface, |_, _| noise.point())
            }
            9..12 if k > 0 => {
                let twin = random.below(k);
                twins.push((twin, k));
                let noise = if random.one_in(4) { 0.0 } else { random.power(-14.0, -2.0) };
                let common = if random.one_in(2) { random.power(0.0, 9.0) } else { 0.0 };
                let mut own = random.clone();
                random.bits();
                let old = modes[twin].clone();
                each(surface, |v, _| {
                    let by = own.point();
                    std::array::from_fn(|c| old[v][c] + noise * by[c] + common)
                })
            }
            _ => smooth(random, surface),
        };
        if random.one_in(3) {
            let size = random.power(-6.0, 6.0);
            mode.iter_mut().for_each(|u| *u = along(*u, size));
        }
        modes.push(mode);
    }
    let vertex = |v: usize| modes.iter().map(move |mode| mode[v]);
    ((0..surface.points.len()).flat_map(vertex).collect(), twins, rank)
}
