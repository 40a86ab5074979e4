//! Pairs of triangles that touch exactly, nearly, or not at all.

use crate::exact::{Point, Triangle};
use crate::random::Random;

/// Number of ways to draw a pair.
const KINDS: usize = 7;

fn plus(p: Point, q: Point) -> Point {
    std::array::from_fn(|c| p[c] + q[c])
}

/// Returns a triangle near the origin: with corners on a grid of integers, at random positions, thin, or without area.
pub fn triangle(random: &mut Random) -> Triangle {
    let grid = 1 + random.below(4);
    let mut t: Triangle = match random.below(3) {
        0 => std::array::from_fn(|_| std::array::from_fn(|_| random.whole(grid))),
        1 => {
            let (a, b, thin) = (random.point(), random.point(), random.power(-17.0, -2.0));
            let by = random.point();
            [a, b, std::array::from_fn(|c| 0.5 * (a[c] + b[c]) + thin * by[c])]
        }
        _ => std::array::from_fn(|_| random.point()),
    };
    match random.below(24) {
        0 => t[2] = t[1],
        1 => t = [t[0]; 3],
        2 => t[2] = std::array::from_fn(|c| 2.0 * t[1][c] - t[0][c]),
        3..6 => t.iter_mut().for_each(|p| p[2] = 0.0),
        _ => {}
    }
    t
}

/// Returns a point of a triangle: a corner, on an edge, or inside, with weights that are multiples of 1/8.
fn point_of(random: &mut Random, t: &Triangle) -> Point {
    let w = random.of(&[
        [1.0, 0.0, 0.0],
        [0.5, 0.5, 0.0],
        [0.25, 0.75, 0.0],
        [0.5, 0.25, 0.25],
        [0.125, 0.375, 0.5],
    ]);
    let first = random.below(3);
    std::array::from_fn(|c| (0..3).map(|i| w[i] * t[(first + i) % 3][c]).sum())
}

/// Returns a number within a few units in the last place of another one.
fn beside(random: &mut Random, x: f64) -> f64 {
    match random.below(6) {
        0 => x.next_up(),
        1 => x.next_down(),
        2 => x + x * f64::EPSILON * random.whole(8),
        _ => x,
    }
}

/// Returns two triangles.
pub fn pair(random: &mut Random) -> (Triangle, Triangle) {
    let a = triangle(random);
    let mut b = triangle(random);
    match random.below(KINDS) {
        // A point of the second triangle is at a point of the first.
        0..3 => {
            let (p, q) = (point_of(random, &a), point_of(random, &b));
            let by: Point = std::array::from_fn(|c| p[c] - q[c]);
            b = b.map(|x| plus(x, by));
        }
        // The second triangle is in the plane of the first, up to rounding.
        3 => {
            b = std::array::from_fn(|_| {
                let [x, y] = [random.signed(), random.signed()];
                let (s, t) = (random.of(&[0.0, 1.0, 0.5, -0.25, x]), random.of(&[0.0, 1.0, 0.25, y]));
                std::array::from_fn(|c| a[0][c] + s * (a[1][c] - a[0][c]) + t * (a[2][c] - a[0][c]))
            })
        }
        // The second triangle is a copy of the first, moved by a small distance.
        4 => {
            let far = random.power(-16.0, 0.0);
            let by = random.point().map(|x| x * far);
            b = a.map(|p| plus(p, by));
        }
        _ => {}
    }
    if random.one_in(2) {
        b.iter_mut().flatten().for_each(|x| *x = beside(random, *x));
    }
    if random.one_in(8) {
        let far = random.power(0.0, 15.0);
        let by = random.point().map(|x| x * far);
        return (a.map(|p| plus(p, by)), b.map(|p| plus(p, by)));
    }
    (a, b)
}

/// Returns a factor of lengths: usually 1, else extreme.
pub fn scale(random: &mut Random) -> f64 {
    match random.below(12) {
        0 => random.power(-323.0, -200.0),
        1 => random.power(-200.0, 0.0),
        2 => random.power(0.0, 45.0),
        _ => 1.0,
    }
}
