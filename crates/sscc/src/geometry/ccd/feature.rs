//! Directions between two features (vertex, edge, face) of two moving triangles, as polynomials in time.
//!
//! The closest points of two disjoint triangles lie on a pair of features, and the direction between these points is
//! perpendicular to both features: a difference of two vertices, the part of such a difference that is perpendicular to
//! an edge, the cross product of two edges, or the normal of a face. While vertices move linearly, such a direction
//! (multiplied by the squared length of the edge, in the second case) is a polynomial in t of degree 1 to 3, and so
//! are, one degree higher, the gaps of vertices along it. As long as the same two features are closest, the direction
//! follows them and separates the two triangles, however narrow the gap between them and however fast both turn.
//!
//! On an interval of time, polynomials are written in its Bernstein basis; where all coefficients are positive, so is
//! the polynomial. Coefficients are kept multiplied by their binomial, which changes no sign and makes products
//! of polynomials plain convolutions.

use glam::DVec3;

use super::moving_triangle::MovingTriangle;
use super::number::{Bounded, Dyadic, Number};

/// The largest degree of a polynomial: that of a gap along the direction perpendicular to an edge.
const DEGREE: usize = 4;

/// A polynomial on an interval of time: Bernstein coefficients times their binomials.
#[derive(Clone)]
struct Form<T> {
    degree: usize,
    coefficients: [T; DEGREE + 1],
}

/// Both triangles at one time or on an interval of time, relative to the first corner of x: the corners of x, then
/// those of y.
struct Corners<T>([[Form<T>; 3]; 6]);

/// Where the corners of each triangle begin.
const X: usize = 0;
const Y: usize = 3;

/// A pair of features, one of x and one of y, by the numbers of vertices (0, 1, 2) and of edges (that begin at these
/// vertices).
#[derive(Clone, Copy, Debug, PartialEq)]
enum Feature {
    /// The face of x and a vertex of y.
    FaceX,
    /// A vertex of x and the face of y.
    FaceY,
    /// An edge of each.
    Edges(usize, usize),
    /// A vertex of x and an edge of y.
    VertexEdge(usize, usize),
    /// An edge of x and a vertex of y.
    EdgeVertex(usize, usize),
    /// A vertex of each.
    Vertices(usize, usize),
}

/// A direction that follows a pair of features.
#[derive(Clone, Copy, Debug)]
pub(super) struct Following {
    feature: Feature,
    /// Whether the direction is that from y to x.
    reversed: bool,
    /// The direction at one time, rounded.
    pub(super) vector: DVec3,
}

/// How far two triangles are apart along the direction of a pair of features at one time: bounds, 0 where they are not
/// apart.
struct Gap {
    feature: Feature,
    reversed: bool,
    lower: f64,
    upper: f64,
}

impl Feature {
    /// All pairs of features of two triangles.
    fn all() -> impl Iterator<Item = Self> {
        let pairs = (0..9).map(|k| (k / 3, k % 3)).flat_map(|(i, j)| {
            [Self::Edges(i, j), Self::VertexEdge(i, j), Self::EdgeVertex(i, j), Self::Vertices(i, j)]
        });
        [Self::FaceX, Self::FaceY].into_iter().chain(pairs)
    }
}

impl Following {
    /// Whether the direction provably separates both triangles all the time from `t` to `s`: by the signs of
    /// coefficients, which are decided exactly where rounding leaves them undecided.
    pub(super) fn separates(&self, x: &MovingTriangle, y: &MovingTriangle, t: f64, s: f64) -> bool {
        let rounded = Corners::<Bounded>::between(x, y, t, s).separated_along(self);
        rounded.unwrap_or_else(|| Corners::<Dyadic>::between(x, y, t, s).separated_along(self) == Some(true))
    }
}

/// A direction between two features along which the two triangles are farther apart than `tolerance` at time `t`: of those
/// for which rounded numbers prove this the one with the widest gap, else the one that exact numbers find. None when
/// their distance is at most `tolerance`, up to 1e-14 of it: the distance is the widest gap of all pairs of features.
pub(super) fn farther_than(
    tolerance: f64,
    x: &MovingTriangle,
    y: &MovingTriangle,
    t: f64,
) -> Option<Following> {
    let rounded = Corners::<Bounded>::at(x, y, t);
    let gaps: Vec<Gap> = Feature::all().flat_map(|feature| rounded.gaps(feature)).collect();
    if let Some(found) = rounded.farther_than(tolerance, &gaps) {
        return Some(found);
    }
    let mut undecided: Vec<Feature> =
        gaps.iter().filter(|gap| gap.upper > tolerance).map(|gap| gap.feature).collect();
    if undecided.is_empty() {
        return None;
    }
    undecided.dedup();
    let exact = Corners::<Dyadic>::at(x, y, t);
    let gaps: Vec<Gap> = undecided.into_iter().flat_map(|feature| exact.gaps(feature)).collect();
    exact.farther_than(tolerance, &gaps)
}

impl<T: Number> Form<T> {
    fn constant(x: T) -> Self {
        let mut coefficients = std::array::from_fn(|_| T::zero());
        coefficients[0] = x;
        Self { degree: 0, coefficients }
    }

    fn linear(from: T, to: T) -> Self {
        let mut form = Self::constant(from);
        (form.degree, form.coefficients[1]) = (1, to);
        form
    }

    /// Combines the coefficients of two polynomials of the same degree.
    fn map2(&self, other: &Self, f: impl Fn(&T, &T) -> T) -> Self {
        debug_assert_eq!(self.degree, other.degree);
        let mut result = self.clone();
        for i in 0..=self.degree {
            result.coefficients[i] = f(&self.coefficients[i], &other.coefficients[i]);
        }
        result
    }

    fn plus(&self, other: &Self) -> Self {
        self.map2(other, T::plus)
    }

    fn minus(&self, other: &Self) -> Self {
        self.map2(other, T::minus)
    }

    fn times(&self, other: &Self) -> Self {
        let mut product = Self::constant(T::zero());
        product.degree = self.degree + other.degree;
        for (i, a) in self.coefficients[..=self.degree].iter().enumerate() {
            for (j, b) in other.coefficients[..=other.degree].iter().enumerate() {
                product.coefficients[i + j] = product.coefficients[i + j].plus(&a.times(b));
            }
        }
        product
    }
}

impl<T: Number> Corners<T> {
    /// At one time: polynomials of degree 0.
    fn at(x: &MovingTriangle, y: &MovingTriangle, t: f64) -> Self {
        Self::map(x, y, |from, to| Form::constant(lerp(from, to, t)))
    }

    /// From `t` to `s`.
    fn between(x: &MovingTriangle, y: &MovingTriangle, t: f64, s: f64) -> Self {
        Self::map(x, y, |from, to| Form::linear(lerp(from, to, t), lerp(from, to, s)))
    }

    /// Each coordinate, given its values at times 0 and 1.
    fn map(x: &MovingTriangle, y: &MovingTriangle, f: impl Fn(&T, &T) -> Form<T>) -> Self {
        Self(std::array::from_fn(|i| {
            let triangle = if i < Y { x } else { y };
            std::array::from_fn(|k| {
                let [from, to] = [(triangle.t0, x.t0), (triangle.t1, x.t1)]
                    .map(|(corners, origin)| T::difference(corners[i % 3][k], origin[0][k]));
                f(&from, &to)
            })
        }))
    }

    /// Edge i of the triangle whose corners begin at `first`.
    fn edge(&self, first: usize, i: usize) -> [Form<T>; 3] {
        subtract(&self.0[first + (i + 1) % 3], &self.0[first + i])
    }

    /// The direction of a pair of features. Where it contains a vertex and no face, the direction is that from x to y.
    fn direction(&self, feature: Feature) -> [Form<T>; 3] {
        let between = |i: usize, j: usize| subtract(&self.0[Y + j], &self.0[X + i]);
        let perpendicular = |d: [Form<T>; 3], e: [Form<T>; 3]| {
            let (square, along) = (dot(&e, &e), dot(&d, &e));
            std::array::from_fn(|k| d[k].times(&square).minus(&e[k].times(&along)))
        };
        match feature {
            Feature::FaceX => cross(&self.edge(X, 0), &self.edge(X, 1)),
            Feature::FaceY => cross(&self.edge(Y, 0), &self.edge(Y, 1)),
            Feature::Edges(i, j) => cross(&self.edge(X, i), &self.edge(Y, j)),
            Feature::VertexEdge(i, j) => perpendicular(between(i, j), self.edge(Y, j)),
            Feature::EdgeVertex(i, j) => perpendicular(between(i, j), self.edge(X, i)),
            Feature::Vertices(i, j) => between(i, j),
        }
    }

    /// The gaps of all nine pairs of a vertex of x and one of y along a direction.
    fn gaps_of_vertices(&self, n: &[Form<T>; 3]) -> [Form<T>; 9] {
        let projected: [Form<T>; 6] = std::array::from_fn(|i| dot(n, &self.0[i]));
        std::array::from_fn(|k| projected[Y + k % 3].minus(&projected[X + k / 3]))
    }

    /// How far the triangles are apart along the direction of a feature and along its opposite, at the time of these
    /// corners.
    fn gaps(&self, feature: Feature) -> [Gap; 2] {
        let n = self.direction(feature);
        let square = dot(&n, &n);
        let vertices = self.gaps_of_vertices(&n).map(|gap| gap.coefficients[0].clone());
        let minimum = |gaps: &[T]| gaps[1..].iter().fold(gaps[0].clone(), |least, gap| least.minimum(gap));
        let opposite = vertices.each_ref().map(|gap| T::zero().minus(gap));
        [(false, minimum(&vertices)), (true, minimum(&opposite))].map(|(reversed, gap)| {
            let [lower, upper] = gap.over_root(&square.coefficients[0]);
            Gap { feature, reversed, lower, upper }
        })
    }

    /// The direction of the widest of some gaps, if that is certainly wider than the tolerance.
    fn farther_than(&self, tolerance: f64, gaps: &[Gap]) -> Option<Following> {
        let widest = gaps.iter().max_by(|a, b| a.lower.total_cmp(&b.lower))?;
        let Gap { feature, reversed, lower, .. } = *widest;
        (lower > tolerance).then(|| {
            let vector = T::direction(&self.direction(feature).map(|n| n.coefficients[0].clone()));
            Following { feature, reversed, vector: if reversed { -vector } else { vector } }
        })
    }

    /// Whether all gaps along a direction are positive during the interval, by their coefficients. None where the error
    /// bounds leave that undecided.
    fn separated_along(&self, direction: &Following) -> Option<bool> {
        let mut all = Some(true);
        for gap in self.gaps_of_vertices(&self.direction(direction.feature)) {
            for coefficient in &gap.coefficients[..=gap.degree] {
                let forwards = if direction.reversed { &T::zero().minus(coefficient) } else { coefficient };
                match forwards.is_positive() {
                    Some(true) => {}
                    Some(false) => return Some(false),
                    None => all = None,
                }
            }
        }
        all
    }
}

fn lerp<T: Number>(from: &T, to: &T, t: f64) -> T {
    from.plus(&to.minus(from).times(&T::from_f64(t)))
}

fn subtract<T: Number>(a: &[Form<T>; 3], b: &[Form<T>; 3]) -> [Form<T>; 3] {
    std::array::from_fn(|k| a[k].minus(&b[k]))
}

fn dot<T: Number>(a: &[Form<T>; 3], b: &[Form<T>; 3]) -> Form<T> {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

fn cross<T: Number>(a: &[Form<T>; 3], b: &[Form<T>; 3]) -> [Form<T>; 3] {
    let minor = |i: usize, j: usize| a[i].times(&b[j]).minus(&a[j].times(&b[i]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}
