//! Triangulation of a polygon by ears: triangles of two neighbouring edges and a diagonal that contain no other corner.
//!
//! The module has its own code: known ear clippers drop corners on edges and repeated ones, so that the number of triangles
//! changes, and decide by rounded arithmetic.

use std::collections::VecDeque;

use glam::DVec2;
use sscc::parts::orient2d;

use super::ear_candidates::EarCandidates;
use super::work::{STEPS_OF_EXACT_SIGNS, TooIntricate, Work};

/// Cuts a polygon into triangles of its corners' numbers, with the polygon's orientation (`turn`: 1 left, -1 right); n
/// corners give n - 2 triangles. None if at some step there is no ear, or the last triangle has the opposite
/// orientation: the polygon then crosses itself, or turns the other way.
///
/// A simple polygon that turns this way always has an ear with area. Only polygons that touch themselves, or have repeated
/// corners, also get triangles without area. All decisions are exact.
pub(super) fn cut_ears(
    points: &[DVec2],
    turn: i8,
    work: &mut Work,
) -> Result<Option<Vec<[u32; 3]>>, TooIntricate> {
    let mut ring = Ring::new(points, turn);
    let mut triangles = Vec::with_capacity(points.len().saturating_sub(2));
    // Corners whose ear must be tested: each once, and again when a neighbour was cut off.
    let mut queue: VecDeque<u32> = (0..points.len() as u32).collect();
    let mut is_queued = vec![true; points.len()];
    let mut flat: Vec<u32> = Vec::new();
    let mut spurs: Vec<u32> = (0..points.len() as u32).collect();
    while triangles.len() + 3 < points.len() {
        work.take(1)?;
        let spur = spurs.pop();
        let tip = match spur.or_else(|| queue.pop_front()) {
            // Both sides of a spur are the same segment, which ears beside it must not take for a border.
            Some(corner) if spur.is_some() => {
                if ring.is_cut(corner) || !ring.is_spur(corner) {
                    continue;
                }
                corner
            }
            Some(corner) => {
                is_queued[corner as usize] = false;
                if ring.is_cut(corner) {
                    continue;
                }
                match ring.turn_at(corner) {
                    0 => {
                        flat.push(corner);
                        continue;
                    }
                    side if side != turn || !ring.is_empty(corner, work)? => continue,
                    _ => corner,
                }
            }
            // No ear has area. A corner on the line of its neighbours adds only points of its edges.
            None => match flat.pop() {
                Some(corner) if !ring.is_cut(corner) && ring.turn_at(corner) == 0 => corner,
                Some(_) => continue,
                None => return Ok(None),
            },
        };
        let [before, after] = ring.cut(tip);
        triangles.push([before, tip, after]);
        for corner in [before, after] {
            spurs.push(corner);
            if !std::mem::replace(&mut is_queued[corner as usize], true) {
                queue.push_back(corner);
            }
        }
        // A convex part becomes compact triangles in place of a fan of long ones.
        if queue.front() == Some(&after) {
            queue.rotate_left(1);
        }
    }
    let last = ring.last_triangle();
    let [a, b, c] = last.map(|corner| points[corner as usize]);
    triangles.push(last);
    Ok((orient2d(a, b, c) != -turn).then_some(triangles))
}

/// The remaining corners, in a circular list.
struct Ring<'a> {
    points: &'a [DVec2],
    turn: i8,
    before: Vec<u32>,
    after: Vec<u32>,
    is_cut: Vec<bool>,
    candidates: EarCandidates,
    /// One of the remaining corners.
    some: u32,
}

impl<'a> Ring<'a> {
    fn new(points: &'a [DVec2], turn: i8) -> Self {
        let count = points.len() as u32;
        Self {
            points,
            turn,
            before: (0..count).map(|corner| (corner + count - 1) % count).collect(),
            after: (0..count).map(|corner| (corner + 1) % count).collect(),
            is_cut: vec![false; points.len()],
            candidates: EarCandidates::of(points, turn),
            some: 0,
        }
    }

    fn is_cut(&self, corner: u32) -> bool {
        self.is_cut[corner as usize]
    }

    /// Returns the corner between its neighbours.
    fn ear(&self, corner: u32) -> [u32; 3] {
        [self.before[corner as usize], corner, self.after[corner as usize]]
    }

    fn turn_at(&self, corner: u32) -> i8 {
        let [a, b, c] = self.ear(corner).map(|corner| self.points[corner as usize]);
        orient2d(a, b, c)
    }

    /// Whether the edges of a corner lie on each other, or one of them has no length.
    fn is_spur(&self, corner: u32) -> bool {
        let [a, b, c] = self.ear(corner).map(|corner| self.points[corner as usize]);
        // For collinear points: whether b is between the others, in x or on a vertical line in y.
        let is_between = |k: usize| (a[k] < b[k] && b[k] < c[k]) || (c[k] < b[k] && b[k] < a[k]);
        orient2d(a, b, c) == 0 && !is_between(0) && !(a.x == c.x && is_between(1))
    }

    /// Removes a corner; returns its neighbours.
    fn cut(&mut self, corner: u32) -> [u32; 2] {
        let [before, _, after] = self.ear(corner);
        self.is_cut[corner as usize] = true;
        self.after[before as usize] = after;
        self.before[after as usize] = before;
        self.some = after;
        [before, after]
    }

    fn last_triangle(&self) -> [u32; 3] {
        self.ear(self.some)
    }

    /// Whether no other part of the polygon is in the ear of a corner, which has area.
    fn is_empty(&self, tip: u32, work: &mut Work) -> Result<bool, TooIntricate> {
        let ear = self.ear(tip);
        let [a, b, c] = ear.map(|corner| self.points[corner as usize]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let blocks = |corner: usize, work: &mut Work| {
            let point = self.points[corner];
            let is_in_box = point.cmpge(low).all() && point.cmple(high).all();
            if !is_in_box || self.is_cut[corner] || ear.contains(&(corner as u32)) {
                return Ok(false);
            }
            work.take(STEPS_OF_EXACT_SIGNS)?;
            Ok(self.enters(corner, [a, b, c]))
        };
        Ok(!self.candidates.any_in_box(low, high, work, blocks)?)
    }

    /// Whether a corner is in a closed ear. If it is at a corner of the ear: whether an edge from it goes into the ear.
    fn enters(&self, corner: usize, ear: [DVec2; 3]) -> bool {
        let point = self.points[corner];
        let is_left = |p: DVec2, q: DVec2, r: DVec2| orient2d(p, q, r) * self.turn;
        match ear.iter().position(|p| *p == point) {
            None => (0..3).all(|k| is_left(ear[k], ear[(k + 1) % 3], point) >= 0),
            Some(k) => {
                let (next, last) = (ear[(k + 1) % 3], ear[(k + 2) % 3]);
                [self.before[corner], self.after[corner]].iter().any(|neighbour| {
                    let end = self.points[*neighbour as usize];
                    is_left(point, next, end) > 0 && is_left(point, end, last) > 0
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cuts a polygon that turns left, and checks that the triangles cover it once.
    fn cut(points: &[(f64, f64)]) -> Option<Vec<[u32; 3]>> {
        let points: Vec<DVec2> = points.iter().map(|(x, y)| DVec2::new(*x, *y)).collect();
        let found = cut_ears(&points, 1, &mut Work::new()).unwrap();
        let mirrored: Vec<DVec2> = points.iter().map(|p| DVec2::new(-p.x, p.y)).collect();
        assert_eq!(cut_ears(&mirrored, -1, &mut Work::new()).unwrap(), found);
        if let Some(triangles) = &found {
            assert_eq!(triangles.len(), points.len() - 2);
            let area = |corners: &[DVec2]| {
                (0..corners.len()).map(|k| corners[k].perp_dot(corners[(k + 1) % corners.len()])).sum::<f64>()
            };
            let areas: Vec<f64> =
                triangles.iter().map(|t| area(&t.map(|corner| points[corner as usize]))).collect();
            assert!(areas.iter().all(|area| *area >= 0.0), "{areas:?}");
            assert_eq!(areas.iter().sum::<f64>(), area(&points));
        }
        found
    }

    fn has_area(points: &[(f64, f64)], triangles: &[[u32; 3]]) -> bool {
        let point = |corner: u32| DVec2::from(points[corner as usize]);
        triangles.iter().all(|[a, b, c]| orient2d(point(*a), point(*b), point(*c)) != 0)
    }

    #[test]
    fn concave_polygons_are_cut() {
        let arrow = [(0., 0.), (4., 0.), (4., 4.), (2., 1.), (0., 4.)];
        let found = cut(&arrow).unwrap();
        assert!(has_area(&arrow, &found));
        // Corners on edges get triangles with area.
        let flat =
            [(0., 0.), (2., 0.), (4., 0.), (4., 4.), (3., 2.5), (2., 1.), (1., 2.5), (0., 4.), (0., 2.)];
        let found = cut(&flat).unwrap();
        assert!(has_area(&flat, &found), "{found:?}");
        let square = [(0., 0.), (1., 0.), (2., 0.), (2., 1.), (2., 2.), (1., 2.), (0., 2.), (0., 1.)];
        assert!(has_area(&square, &cut(&square).unwrap()));
    }

    #[test]
    fn repeated_corners_and_keyholes_are_cut() {
        assert!(
            cut(&[(0., 0.), (4., 0.), (4., 0.), (4., 4.), (2., 1.), (2., 1.), (2., 1.), (0., 4.)]).is_some()
        );
        // A square with a hole, joined by a bridge that is passed twice; convex and concave at its ends.
        let keyhole = [
            (0., 0.),
            (6., 0.),
            (6., 6.),
            (0., 6.),
            (0., 0.),
            (2., 2.),
            (2., 4.),
            (4., 4.),
            (4., 2.),
            (2., 2.),
        ];
        assert!(cut(&keyhole).is_some());
        let triangle_hole =
            [(0., 0.), (6., 0.), (6., 6.), (0., 6.), (0., 0.), (2., 2.), (3., 5.), (5., 3.), (2., 2.)];
        assert!(cut(&triangle_hole).is_some());
        // Two squares that touch in a corner; a spur; a slit.
        assert!(
            cut(&[(0., 0.), (1., 0.), (1., 1.), (2., 1.), (2., 2.), (1., 2.), (1., 1.), (0., 1.)]).is_some()
        );
        assert!(cut(&[(0., 0.), (4., 0.), (4., 4.), (2., 1.), (2., 2.), (2., 1.), (0., 4.)]).is_some());
        assert!(cut(&[(2., 2.), (5., 2.), (1., 2.), (1., 1.), (2., 1.)]).is_some());
    }

    #[test]
    fn crossing_polygons_are_not_cut() {
        assert_eq!(cut(&[(0., 0.), (4., 4.), (4., 0.), (0., 4.)]), None);
        assert_eq!(cut(&[(0., 0.), (0., 4.), (4., 4.), (4., 0.), (4., 0.)]), None, "it turns right");
    }

    #[test]
    fn many_corners_take_little_work() {
        // A gear, a long comb and a spiral.
        let count = 6000;
        let gear = |i: usize| {
            let angle = i as f64 * std::f64::consts::TAU / count as f64;
            let radius = if i.is_multiple_of(2) { 1000.0 } else { 990.0 };
            DVec2::new(libm::cos(angle), libm::sin(angle)) * radius
        };
        let comb = |i: usize| match i {
            0 => DVec2::new(-1.0, 30_000.0),
            1 => DVec2::new(-1.0, -1.0),
            _ => DVec2::new(if i.is_multiple_of(2) { 0.0 } else { 50_000.0 }, i as f64),
        };
        let spiral = |i: usize| {
            let (arm, inward) = (count / 2, i >= count / 2);
            let step = if inward { count - 1 - i } else { i };
            let angle = step as f64 * 60.0 / arm as f64;
            DVec2::new(libm::cos(angle), libm::sin(angle)) * (angle + 10.0 - f64::from(u8::from(inward)))
        };
        let shapes: [&dyn Fn(usize) -> DVec2; 3] = [&gear, &comb, &spiral];
        for (number, shape) in shapes.into_iter().enumerate() {
            let points: Vec<DVec2> = (0..count).map(shape).collect();
            let mut work = Work::new();
            let before = work.left();
            let found = cut_ears(&points, 1, &mut work).unwrap();
            assert_eq!(found.map(|triangles| triangles.len()), Some(count - 2), "{number}");
            let steps = before - work.left();
            assert!(steps < 500 * (STEPS_OF_EXACT_SIGNS * count) as u64, "{number}: {steps}");
        }
        let points: Vec<DVec2> = (0..count).map(comb).collect();
        assert_eq!(cut_ears(&points, 1, &mut Work::of(1000)), Err(TooIntricate));
        // Every exact test of a corner in an ear counts: the comb has hundreds for each corner.
        let mut work = Work::new();
        let before = work.left();
        cut_ears(&points, 1, &mut work).unwrap();
        assert!(
            before - work.left() > 200 * (STEPS_OF_EXACT_SIGNS * count) as u64,
            "{}",
            before - work.left()
        );
    }
}
