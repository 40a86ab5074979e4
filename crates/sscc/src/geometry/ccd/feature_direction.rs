//! Separating directions that follow two features (vertex, edge, face) of two moving triangles, as polynomials of time.
//!
//! The closest points of two disjoint triangles lie on a pair of features, and the direction between these points is
//! perpendicular to both features: a difference of two vertices, the part of such a difference that is perpendicular to
//! an edge, the cross product of two edges, or the normal of a face. While vertices move linearly, such a direction
//! (multiplied by the squared length of the edge, in the second case) is a polynomial in t of degree 1 to 3, and so
//! are, one degree higher, the gaps of vertices along it. As long as the same two features are closest, the direction
//! follows them and separates the two triangles, however narrow the gap between them and however fast both rotate. The Bernstein
//! coefficients of the gaps prove it ([`bernstein`](super::bernstein)).

use glam::DVec3;

use super::bernstein::{Polynomial, cross, dot, subtract};
use super::bounded_float::BoundedFloat;
use super::dyadic::Dyadic;
use super::moving_triangle::MovingTriangle;
use super::number::{Bounds, Number};

/// Both triangles at one time or on an interval of time, relative to the first corner of a: the corners of a, then
/// those of b.
struct Corners<T>([[Polynomial<T>; 3]; 6]);

/// The index of the first corner of a.
const A: usize = 0;

/// The index of the first corner of b.
const B: usize = 3;

/// A pair of features, one of a and one of b, by the numbers of vertices (0, 1, 2) and of edges (edge i begins at vertex
/// i).
#[derive(Clone, Copy, Debug, PartialEq)]
enum FeaturePair {
    /// The face of a and a vertex of b.
    FaceA,
    /// A vertex of a and the face of b.
    FaceB,
    /// An edge of each.
    Edges(usize, usize),
    /// A vertex of a and an edge of b.
    VertexEdge(usize, usize),
    /// An edge of a and a vertex of b.
    EdgeVertex(usize, usize),
    /// A vertex of each.
    Vertices(usize, usize),
}

/// A direction that follows a pair of features.
#[derive(Clone, Copy, Debug)]
pub(super) struct FeatureDirection {
    features: FeaturePair,
    /// Whether the direction is opposite to that of [`Corners::direction`].
    is_reversed: bool,
    /// The direction at one time, rounded.
    pub(super) vector: DVec3,
}

/// Bounds of the gap of two triangles along the direction of a pair of features at one time, 0 where it is negative.
struct FeatureGap {
    features: FeaturePair,
    is_reversed: bool,
    gap: Bounds,
}

impl FeaturePair {
    /// Returns all pairs of features of two triangles.
    fn all() -> impl Iterator<Item = Self> {
        let pairs = (0..9).map(|ij| (ij / 3, ij % 3)).flat_map(|(i, j)| {
            [Self::Edges(i, j), Self::VertexEdge(i, j), Self::EdgeVertex(i, j), Self::Vertices(i, j)]
        });
        [Self::FaceA, Self::FaceB].into_iter().chain(pairs)
    }
}

impl FeatureDirection {
    /// Whether the direction provably separates both triangles from `t` to `s`, for all corners whose distances along
    /// each axis are within `slack` of those of the given ones. The signs of coefficients prove it; exact numbers
    /// decide those that rounded ones do not.
    pub(super) fn separates(&self, [a, b]: [&MovingTriangle; 2], slack: f64, [t, s]: [f64; 2]) -> bool {
        let rounded = Corners::<BoundedFloat>::between(a, b, t, s).is_separated_along(self, slack);
        rounded.unwrap_or_else(|| {
            Corners::<Dyadic>::between(a, b, t, s).is_separated_along(self, slack) == Some(true)
        })
    }
}

/// Returns a direction between two features along which the gap of the two triangles at time `t` exceeds `tolerance`.
/// Of the directions for which rounded numbers prove this, it is the one with the widest gap; if there are none, exact
/// numbers search among the undecided ones. None if the distance of the triangles, which is the widest gap of all pairs
/// of features, is at most `tolerance`, up to 1e-14 of it.
pub(super) fn find_gap_above(
    tolerance: f64,
    a: &MovingTriangle,
    b: &MovingTriangle,
    t: f64,
) -> Option<FeatureDirection> {
    let rounded = Corners::<BoundedFloat>::at(a, b, t);
    let gaps: Vec<FeatureGap> = FeaturePair::all().flat_map(|features| rounded.gaps(features)).collect();
    if let Some(found) = rounded.find_gap_above(tolerance, &gaps) {
        return Some(found);
    }
    let mut undecided: Vec<FeaturePair> =
        gaps.iter().filter(|entry| entry.gap.upper > tolerance).map(|entry| entry.features).collect();
    if undecided.is_empty() {
        return None;
    }
    undecided.dedup();
    let exact = Corners::<Dyadic>::at(a, b, t);
    let gaps: Vec<FeatureGap> = undecided.into_iter().flat_map(|features| exact.gaps(features)).collect();
    exact.find_gap_above(tolerance, &gaps)
}

impl<T: Number> Corners<T> {
    /// Creates the corners at one time, as polynomials of degree 0.
    fn at(a: &MovingTriangle, b: &MovingTriangle, t: f64) -> Self {
        Self::map(a, b, |from, to| Polynomial::constant(interpolate(from, to, t)))
    }

    /// Creates the corners on the interval from `t` to `s`.
    fn between(a: &MovingTriangle, b: &MovingTriangle, t: f64, s: f64) -> Self {
        Self::map(a, b, |from, to| Polynomial::linear(interpolate(from, to, t), interpolate(from, to, s)))
    }

    /// Creates the corners, whose coordinates `f` returns from their values at times 0 and 1.
    fn map(a: &MovingTriangle, b: &MovingTriangle, f: impl Fn(&T, &T) -> Polynomial<T>) -> Self {
        Self(std::array::from_fn(|i| {
            let triangle = if i < B { a } else { b };
            std::array::from_fn(|axis| {
                let [from, to] = [(triangle.t0, a.t0), (triangle.t1, a.t1)]
                    .map(|(corners, origin)| T::difference(corners[i % 3][axis], origin[0][axis]));
                f(&from, &to)
            })
        }))
    }

    /// Returns edge i of the triangle whose corners begin at `first`.
    fn edge(&self, first: usize, i: usize) -> [Polynomial<T>; 3] {
        subtract(&self.0[first + (i + 1) % 3], &self.0[first + i])
    }

    /// Returns the direction of a pair of features. Where it contains a vertex and no face, the direction is that from a to b.
    fn direction(&self, features: FeaturePair) -> [Polynomial<T>; 3] {
        let between = |i: usize, j: usize| subtract(&self.0[B + j], &self.0[A + i]);
        let perpendicular = |d: [Polynomial<T>; 3], e: [Polynomial<T>; 3]| {
            let (square, along) = (dot(&e, &e), dot(&d, &e));
            std::array::from_fn(|axis| d[axis].times(&square).minus(&e[axis].times(&along)))
        };
        match features {
            FeaturePair::FaceA => cross(&self.edge(A, 0), &self.edge(A, 1)),
            FeaturePair::FaceB => cross(&self.edge(B, 0), &self.edge(B, 1)),
            FeaturePair::Edges(i, j) => cross(&self.edge(A, i), &self.edge(B, j)),
            FeaturePair::VertexEdge(i, j) => perpendicular(between(i, j), self.edge(B, j)),
            FeaturePair::EdgeVertex(i, j) => perpendicular(between(i, j), self.edge(A, i)),
            FeaturePair::Vertices(i, j) => between(i, j),
        }
    }

    /// Returns the gaps of all nine pairs of a vertex of a and one of b along a direction.
    fn gaps_of_vertices(&self, dir: &[Polynomial<T>; 3]) -> [Polynomial<T>; 9] {
        let projected: [Polynomial<T>; 6] = std::array::from_fn(|i| dot(dir, &self.0[i]));
        std::array::from_fn(|ij| projected[B + ij % 3].minus(&projected[A + ij / 3]))
    }

    /// Returns the gaps of the triangles along the direction of a pair of features and along its opposite, at the time of these
    /// corners.
    fn gaps(&self, features: FeaturePair) -> [FeatureGap; 2] {
        let dir = self.direction(features);
        let square = dot(&dir, &dir);
        let vertices = self.gaps_of_vertices(&dir).map(|gap| gap.coefficients()[0].clone());
        let minimum =
            |gaps: &[T]| gaps[1..].iter().fold(gaps[0].clone(), |smallest, gap| smallest.minimum(gap));
        let opposite = vertices.each_ref().map(|gap| T::zero().minus(gap));
        [(false, minimum(&vertices)), (true, minimum(&opposite))].map(|(is_reversed, gap)| FeatureGap {
            features,
            is_reversed,
            gap: gap.over_root(&square.coefficients()[0]),
        })
    }

    /// Returns the direction of the widest of some gaps, if that is certainly wider than the tolerance.
    fn find_gap_above(&self, tolerance: f64, gaps: &[FeatureGap]) -> Option<FeatureDirection> {
        let widest = gaps.iter().max_by(|a, b| a.gap.lower.total_cmp(&b.gap.lower))?;
        let FeatureGap { features, is_reversed, gap } = *widest;
        (gap.lower > tolerance).then(|| {
            let vector = T::direction(&self.direction(features).map(|n| n.coefficients()[0].clone()));
            FeatureDirection { features, is_reversed, vector: if is_reversed { -vector } else { vector } }
        })
    }

    /// Whether all gaps along a direction n exceed `slack sum_c |n_c|` during the interval, by their coefficients. None if the
    /// error bounds do not decide it.
    fn is_separated_along(&self, direction: &FeatureDirection, slack: f64) -> Option<bool> {
        let dir = self.direction(direction.features);
        let gaps = self.gaps_of_vertices(&dir);
        let change = (slack > 0.0).then(|| {
            let sum = dir.iter().fold(T::zero(), |sum, n| sum.plus(&n.magnitude()));
            let each = T::from_f64(with_mutant!(slack, FeaturesWithoutSlack, 0.0));
            Polynomial::constant(sum.times(&each)).elevated(gaps[0].degree())
        });
        let mut all = Some(true);
        for gap in gaps {
            let gap = if direction.is_reversed { gap.reversed() } else { gap };
            let gap = match &change {
                Some(change) => gap.minus(change),
                None => gap,
            };
            let skipped = with_mutant!(0, FeaturesByEnds, gap.coefficients().len() - 1);
            for coefficient in gap.coefficients().iter().skip(skipped) {
                match coefficient.is_positive() {
                    Some(true) => {}
                    Some(false) => return Some(false),
                    None => all = None,
                }
            }
        }
        all
    }
}

fn interpolate<T: Number>(from: &T, to: &T, t: f64) -> T {
    from.plus(&to.minus(from).times(&T::from_f64(t)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::distance_triangle_triangle;
    use crate::test_models::Random;

    /// The distance is the widest gap along directions of features, whichever features are closest.
    #[test]
    fn the_widest_gap_is_the_distance() {
        let random = &mut Random(11);
        let mut apart = 0;
        for case in 0..400 {
            let place = random.vector() * 2.5;
            let mut corners = |by: DVec3| [(); 3].map(|()| random.vector() + by);
            let a = MovingTriangle { t0: corners(DVec3::ZERO), t1: corners(DVec3::ZERO) };
            let b = MovingTriangle { t0: corners(place), t1: corners(place) };
            let t = [0.0, 0.375, 1.0][case % 3];
            let [at_a, at_b] = [&a, &b].map(|x| [0, 1, 2].map(|i| x.t0[i] + (x.t1[i] - x.t0[i]) * t));
            let distance = distance_triangle_triangle(&at_a, &at_b);
            if distance < 0.01 {
                continue;
            }
            apart += 1;
            let found = find_gap_above(distance * (1.0 - 1e-8), &a, &b, t);
            let dir = found.expect("a gap of nearly the distance").vector.normalize();
            let lowest = at_b.iter().map(|p| dir.dot(*p)).fold(f64::INFINITY, f64::min);
            let highest = at_a.iter().map(|p| dir.dot(*p)).fold(f64::NEG_INFINITY, f64::max);
            assert!((lowest - highest - distance).abs() < 1e-6, "case {case}: {found:?} {distance}");
            let wider = find_gap_above(distance * (1.0 + 1e-8), &a, &b, t);
            assert!(wider.is_none(), "case {case}: {wider:?} {distance}");
        }
        assert!(apart > 100, "{apart}");
    }

    /// Along the difference d of two points the gap is `d.d`, and the slack changes it by itself times the sum of the
    /// largest magnitudes of the components of d. Between two times the Bernstein coefficients of the gap are products
    /// of d at these times.
    #[test]
    fn gaps_along_features_exceed_the_slack() {
        let random = &mut Random(12);
        for case in 0..100 {
            let from = random.vector() + DVec3::from_array([1.5, -1.5, 1.5]);
            let to = from + random.vector() * 0.4;
            let place = random.vector();
            let (a, b) =
                (MovingTriangle::vertex(place, DVec3::ZERO), MovingTriangle::vertex(place + from, to));
            for [t, s] in [[0.0, 1.0], [0.25, 0.5]] {
                let direction = find_gap_above(0.1, &a, &b, t).expect("points that are apart");
                let [p, q] = [t, s].map(|t| from + (to - from) * t);
                let narrowest = p.dot(p).min(p.dot(q)).min(q.dot(q));
                let limit = narrowest / p.abs().max(q.abs()).element_sum();
                for (share, separates) in [(0.0, true), (1.0 - 1e-9, true), (1.0 + 1e-9, false), (4.0, false)]
                {
                    let found = direction.separates([&a, &b], limit * share, [t, s]);
                    assert_eq!(found, separates, "case {case}: {share} of {limit}");
                }
            }
        }
    }

    /// A point passes through another one. The direction between them separates them up to the contact, but not in an
    /// interval that contains it.
    #[test]
    fn feature_directions_are_tested_in_the_whole_interval() {
        let rests = MovingTriangle { t0: [DVec3::ZERO; 3], t1: [DVec3::ZERO; 3] };
        let moves = MovingTriangle { t0: [DVec3::X; 3], t1: [DVec3::NEG_X; 3] };
        let direction = find_gap_above(0.5, &rests, &moves, 0.0).unwrap();
        for (until, separates) in [(0.25, true), (0.45, true), (0.75, false), (1.0, false)] {
            assert_eq!(direction.separates([&rests, &moves], 0.0, [0.0, until]), separates, "{until}");
        }
    }
}
