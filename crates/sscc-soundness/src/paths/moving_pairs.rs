//! The time of impact of two moving triangles. A pair that the core reports as free is attacked by bisection of time,
//! exactly. If that ends without a result, the roots of all polynomials that could be a first contact decide. A time of
//! impact is attacked in the times before it, and the distance at that time is compared with the tolerance.

use num_rational::BigRational;
use sscc::{Impact, MovingTriangle, impact_triangle_triangle};
use sscc_testing::{first_contact, squared_distance};

use super::share::some;
use super::triangle_pairs::corners;
use crate::exact::{Triangle, Verdict, free_until, meet};
use crate::models::pairs;
use crate::random::Random;
use crate::tally::Tally;

/// A triangle at both ends of a motion.
pub type Ends = [Triangle; 2];

/// Runs some thousand pairs.
pub fn run(random: &mut Random, tally: &mut Tally, share: f64) {
    for _ in 0..some(1000, share) {
        let (a, b) = ends(random);
        let scale = pairs::scale(random);
        let [a, b] = [a, b].map(|ends| ends.map(|t| t.map(|p| p.map(|x| x * scale))));
        let [x, y] = [&a, &b].map(moving);
        let found = impact_triangle_triangle(&x, &y, Impact::TOLERANCE);
        tally.answer();
        tally.reach_if(a[0][0] == a[0][1] || b[0][0] == b[0][1], "no area");
        // The computation of roots takes a thousand times longer.
        let effort = if random.one_in(200) { Effort::Roots } else { Effort::Halving };
        match found {
            None => attack_free(tally, &a, &b, effort),
            Some(time) => {
                tally.reach("colliding");
                attack_impact(random, tally, &a, &b, time, effort);
            }
        }
    }
}

/// Methods of an attack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Bisection of time.
    Halving,
    /// Bisection of time, then roots of polynomials if it does not decide.
    Roots,
}

/// Returns a moving triangle of the core.
pub fn moving([t0, t1]: &Ends) -> MovingTriangle {
    MovingTriangle { t0: corners(t0), t1: corners(t1) }
}

/// Returns two moving triangles: from one pair to another one, with permuted corners, or with common translations.
fn ends(random: &mut Random) -> (Ends, Ends) {
    let (a0, b0) = pairs::pair(random);
    let (a1, b1) = pairs::pair(random);
    let by = random.point();
    let shifted = |t: Triangle, by: [f64; 3]| t.map(|p| std::array::from_fn(|c| p[c] + by[c]));
    let (a, b) = match random.below(6) {
        0 => ([a0, a0], [b0, b1]),
        1 => ([a0, shifted(a0, by)], [b0, shifted(b0, by.map(|x| -x))]),
        2 => ([a0, shifted(a0, by)], [b0, shifted(b0, by)]),
        3 => {
            ([a0, a0], [shifted(b0, [0.0, 0.0, 2.0]), shifted(b0, [0.0, 0.0, random.of(&[-2.0, 0.0, 1.0])])])
        }
        4 => ([a0, [a0[1], a0[2], a0[0]]], [b0, b0]),
        _ => ([a0, a1], [b0, b1]),
    };
    if random.one_in(2) { (a, b) } else { ([a[1], a[0]], [b[1], b[0]]) }
}

/// Attacks a pair that the core reports as free.
pub fn attack_free(tally: &mut Tally, a: &Ends, b: &Ends, effort: Effort) {
    let contact = match free_until([&a[0], &a[1]], [&b[0], &b[1]], 1.0) {
        Verdict::Free => {
            tally.reach("proven free");
            None
        }
        Verdict::Contact(t) => Some(t),
        Verdict::Unknown if effort == Effort::Roots => {
            tally.reach("decided by roots");
            first_contact(&moving(a), &moving(b)).map(|_| f64::NAN)
        }
        Verdict::Unknown => {
            tally.reach("undecided");
            None
        }
    };
    if let Some(t) = contact {
        tally.false_negative(|| {
            format!("reported as free, but they meet at t={t} (NaN: at a root): {a:?} {b:?}")
        });
    }
}

/// Attacks a time of impact.
pub fn attack_impact(random: &mut Random, tally: &mut Tally, a: &Ends, b: &Ends, time: f64, effort: Effort) {
    if !(0.0..=1.0).contains(&time) {
        tally.wrong(|| format!("the time of impact {time} is not in [0, 1]: {a:?} {b:?}"));
        return;
    }
    tally.reach("impact checked");
    // Denominators of smaller times are too large for a double.
    if time > 1e-60 {
        let until =
            if effort == Effort::Roots { time.next_down() } else { time * (1.0 - random.power(-9.0, -1.0)) };
        if let Verdict::Contact(t) = free_until([&a[0], &a[1]], [&b[0], &b[1]], until) {
            tally.false_negative(|| {
                format!("they meet at {t}, before the time of impact {time}: {a:?} {b:?}")
            });
        }
    }
    let is_start = time == 0.0 && meet(&a[0], &b[0]);
    if effort == Effort::Roots && !is_start {
        check_distance(tally, a, b, time);
    }
}

/// Checks that the distance at the time of impact is within the tolerance.
fn check_distance(tally: &mut Tally, a: &Ends, b: &Ends, time: f64) {
    // Coordinates are relative to the first corner of a at the same end.
    let of_end = |end: usize| {
        let origin = a[end][0];
        let corners = a[end].iter().chain(&b[end]);
        corners.flat_map(move |p| (0..3).map(move |c| (p[c] - origin[c]).abs())).fold(0.0, f64::max)
    };
    let share = (Impact::TOLERANCE + 1e-15) * (1.0 + 1e-9);
    let number = |x: f64| BigRational::from_float(x).expect("finite");
    let allowed = number(of_end(0).max(of_end(1))) * number(share);
    let square = squared_distance(&moving(a), &moving(b), time);
    tally.reach("distance checked");
    if square > &allowed * &allowed {
        tally.wrong(|| format!("at the time of impact {time} they are too far apart: {a:?} {b:?}"));
    }
}
