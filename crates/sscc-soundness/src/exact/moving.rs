//! Tests whether two triangles whose corners move on straight lines have a common point at some time.
//!
//! A time is a double. Corners at that time are multiples of a power of two, which intervals enclose and big integers hold
//! exactly. An interval of times is free if a direction separates both triangles at its ends: corners are between their
//! positions at the ends. Otherwise the interval is halved, after an exact test at its middle.

use super::interval::Interval;
use super::number::Number;
use super::point::Triangle;
use super::separation::{best_direction, is_separated};
use super::triangles::edges_meet;
use super::vectors::Vector;
use super::whole::{Unit, Whole};
use super::work;

/// Whether two moving triangles meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The triangles never meet.
    Free,
    /// The triangles meet at this time.
    Contact(f64),
    /// The search ended without a result.
    Unknown,
}

/// Number of intervals of time that are tested before the search ends without a result.
const MAX_INTERVALS: usize = 160;

/// Intervals shorter than this are not halved.
const SHORTEST: f64 = 1.0 / (1_u64 << 40) as f64;

/// A time as `numerator / denominator`, where the denominator is a power of two.
struct Time {
    numerator: f64,
    denominator: f64,
}

impl Time {
    /// Returns a time. Panics for times that are neither 0 nor at least 2^-900.
    fn of(t: f64) -> Self {
        let mut denominator = 1.0;
        while (t * denominator).fract() != 0.0 {
            denominator *= 2.0;
        }
        Self { numerator: t * denominator, denominator }
    }
}

/// Returns the corners at a time, multiplied by the denominator of the time.
fn at<N: Number>(
    ends: [&Triangle; 2],
    time: &Time,
    number: &impl Fn(f64) -> N,
    plain: &impl Fn(f64) -> N,
) -> [Vector<N>; 3] {
    let (numerator, denominator) = (plain(time.numerator), plain(time.denominator));
    let rest = denominator.minus(&numerator);
    std::array::from_fn(|i| {
        std::array::from_fn(|c| {
            let [from, to] = ends.map(|t| number(t[i][c]));
            from.times(&rest).plus(&to.times(&numerator))
        })
    })
}

fn interval_at(ends: [&Triangle; 2], t: f64) -> [Vector<Interval>; 3] {
    match t {
        0.0 => ends[0].map(|p| p.map(Interval::of)),
        1.0 => ends[1].map(|p| p.map(Interval::of)),
        _ => at(ends, &Time { numerator: t, denominator: 1.0 }, &Interval::of, &Interval::of),
    }
}

/// Whether two moving triangles have a common point at a time, exactly.
pub fn meet_at(a: [&Triangle; 2], b: [&Triangle; 2], t: f64) -> bool {
    edges_meet(&interval_at(a, t), &interval_at(b, t)).unwrap_or_else(|| {
        work::count();
        let corners = a.iter().chain(&b).flat_map(|t| t.iter());
        let (unit, time) = (Unit::of(corners), Time::of(t));
        let number = |x: f64| unit.whole(x);
        let plain = |x: f64| -> Whole { Unit::of(&[[1.0; 3]]).whole(x) };
        let [a, b] = [a, b].map(|ends| at(ends, &time, &number, &plain));
        edges_meet(&a, &b).expect("whole numbers decide")
    })
}

fn is_free_between(a: [&Triangle; 2], b: [&Triangle; 2], [from, to]: [f64; 2]) -> bool {
    let plain = |ends: [&Triangle; 2], t: f64| -> Triangle {
        std::array::from_fn(|i| std::array::from_fn(|c| ends[0][i][c] * (1.0 - t) + ends[1][i][c] * t))
    };
    let [x, y] = [a, b].map(|ends| [plain(ends, from), plain(ends, to)]);
    let middle = 0.5 * (from + to);
    best_direction([&plain(a, middle), &plain(b, middle)], &x, &y).is_some_and(|n| {
        let [x, y] = [a, b].map(|ends| [from, to].map(|t| interval_at(ends, t)));
        is_separated(&x, &y, &n)
    })
}

/// Searches for a common point of two moving triangles, each given at times 0 and 1, from time 0 to `until`.
pub fn free_until(a: [&Triangle; 2], b: [&Triangle; 2], until: f64) -> Verdict {
    if until == 1.0 && is_free_between(a, b, [0.0, 1.0]) {
        return Verdict::Free;
    }
    for t in [0.0, until] {
        if meet_at(a, b, t) {
            return Verdict::Contact(t);
        }
    }
    let mut waiting = vec![[0.0, until]];
    let mut tried = 0;
    while let Some([from, to]) = waiting.pop() {
        if is_free_between(a, b, [from, to]) {
            continue;
        }
        tried += 1;
        if tried > MAX_INTERVALS || to - from < SHORTEST {
            return Verdict::Unknown;
        }
        let middle = 0.5 * (from + to);
        if meet_at(a, b, middle) {
            return Verdict::Contact(middle);
        }
        waiting.extend([[middle, to], [from, middle]]);
    }
    Verdict::Free
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: Triangle = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];

    fn at_height(z: f64) -> Triangle {
        [[0.25, 0.25, z], [0.75, 0.25, z], [0.25, 0.75, z]]
    }

    #[test]
    fn a_falling_triangle_meets_the_floor_in_time() {
        let falls = |from: f64, to: f64, until: f64| {
            free_until([&FLOOR, &FLOOR], [&at_height(from), &at_height(to)], until)
        };
        assert_eq!(falls(1.0, 1e-300, 1.0), Verdict::Free);
        assert_eq!(falls(1.0, 0.0, 1.0), Verdict::Contact(1.0));
        assert_eq!(falls(3.0, -1.0, 0.75), Verdict::Contact(0.75));
        assert_eq!(falls(3.0, -1.0, 0.749), Verdict::Free);
        assert!(matches!(falls(1.0, -1.0, 1.0), Verdict::Contact(t) if t == 0.5));
        // The contact is at time 1/3, which is not a double.
        assert_eq!(falls(1.0, -2.0, 1.0), Verdict::Unknown);
    }

    #[test]
    fn a_contact_at_a_single_time_is_found() {
        let from = [[0.25, 0.25, 1.0], [0.5, 0.25, 2.0], [0.25, 0.5, 2.0]];
        let to = [[0.25, 0.25, -1.0], [0.5, 0.25, 2.0], [0.25, 0.5, 2.0]];
        assert!(meet_at([&FLOOR, &FLOOR], [&from, &to], 0.5));
        assert!(!meet_at([&FLOOR, &FLOOR], [&from, &to], 0.5_f64.next_down()));
    }
}
