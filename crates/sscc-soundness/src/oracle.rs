//! Oracle for the colliding pairs of triangles of a shape: exact tests of all pairs whose AABBs overlap. Its contact filter
//! is written from `docs/guarantees.md`, not from the code of the core.

use std::collections::{BTreeMap, BTreeSet};

use crate::exact::{Point, Triangle, meet, meet_beyond_corner};

/// Two triangles, the lower number first.
pub type Pair = (u32, u32);

/// Whether a pair of triangles counts, and which common points count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    Counts,
    /// Common points other than the common corner count. Holds the index of this corner in each triangle.
    BeyondCorner(usize, usize),
    Never,
}

/// Decides which pairs of triangles count.
#[derive(Clone, Debug)]
pub struct Oracle {
    faces: Vec<[u32; 3]>,
    /// The weld class of each vertex.
    classes: Vec<u32>,
    with_one_vertex: bool,
    ignored: BTreeSet<Pair>,
}

impl Oracle {
    /// Creates an oracle for which triangles with a common vertex never count, or, with `with_one_vertex`, count beyond one
    /// common vertex.
    pub fn new(faces: &[[u32; 3]], vertices: usize, with_one_vertex: bool) -> Self {
        let classes = (0..vertices as u32).collect();
        Self { faces: faces.to_vec(), classes, with_one_vertex, ignored: BTreeSet::new() }
    }

    /// Welds vertices with equal rest position and modes.
    pub fn welded(mut self, points: &[Point], modes: &[Point]) -> Self {
        let rank = modes.len() / points.len();
        // Adding 0 makes both zeros equal.
        let key = |v: usize| -> Vec<u64> {
            let numbers = points[v..=v].iter().chain(&modes[v * rank..(v + 1) * rank]).flatten();
            numbers.map(|x| (x + 0.0).to_bits()).collect()
        };
        let mut first = BTreeMap::new();
        self.classes = (0..points.len()).map(|v| *first.entry(key(v)).or_insert(v as u32)).collect();
        self
    }

    /// Excludes the pairs that collide at these positions.
    pub fn ignoring_at(mut self, positions: &[Point]) -> Self {
        self.ignored = self.pairs(positions).into_iter().collect();
        self
    }

    fn relation(&self, (a, b): Pair) -> Relation {
        let [numbers_a, numbers_b] = [a, b].map(|t| self.faces[t as usize]);
        let [classes_a, classes_b] =
            [numbers_a, numbers_b].map(|face| face.map(|v| self.classes[v as usize]));
        // A repeated vertex of a degenerate face counts once.
        let common = |x: [u32; 3], y: [u32; 3]| -> usize {
            (0..3).filter(|i| y.contains(&x[*i]) && !x[..*i].contains(&x[*i])).count()
        };
        match common(numbers_a, numbers_b).max(common(classes_a, classes_b)) {
            0 => Relation::Counts,
            1 if self.with_one_vertex => {
                let places = (0..9).map(|n| (n / 3, n % 3));
                let place = places.clone().find(|(i, j)| classes_a[*i] == classes_b[*j]);
                let (i, j) = place.expect("a common class");
                Relation::BeyondCorner(i, j)
            }
            _ => Relation::Never,
        }
    }

    /// Whether a pair counts at all.
    pub fn counts(&self, pair: Pair) -> bool {
        self.relation(pair) != Relation::Never && !self.ignored.contains(&pair)
    }

    /// Whether a pair counts, and its triangles have no common vertex.
    pub fn counts_whole(&self, pair: Pair) -> bool {
        self.relation(pair) == Relation::Counts && !self.ignored.contains(&pair)
    }

    /// Returns the corners of a triangle.
    pub fn triangle(&self, positions: &[Point], t: u32) -> Triangle {
        self.faces[t as usize].map(|v| positions[v as usize])
    }

    /// Whether a pair counts and collides, exactly.
    fn collides(&self, positions: &[Point], (a, b): Pair) -> bool {
        let [x, y] = [a, b].map(|t| self.triangle(positions, t));
        match self.relation((a, b)) {
            Relation::Never => false,
            _ if self.ignored.contains(&(a, b)) => false,
            Relation::Counts => meet(&x, &y),
            Relation::BeyondCorner(i, j) => {
                let others = |t: &Triangle, i: usize| [t[(i + 1) % 3], t[(i + 2) % 3]];
                meet_beyond_corner(x[i], others(&x, i), others(&y, j))
            }
        }
    }

    /// Returns all pairs that count and collide, sorted.
    pub fn pairs(&self, positions: &[Point]) -> Vec<Pair> {
        let boxes: Vec<Bounds> =
            (0..self.faces.len() as u32).map(|t| Bounds::of(&self.triangle(positions, t))).collect();
        let mut found = Vec::new();
        overlapping(&boxes, |pair| {
            if self.collides(positions, pair) {
                found.push(pair);
            }
        });
        found.sort_unstable();
        found
    }

    /// Whether no pair counts and collides.
    pub fn is_free(&self, positions: &[Point]) -> bool {
        self.pairs(positions).is_empty()
    }

    /// Returns all pairs without a common vertex that count, and whose AABBs of both ends of a motion overlap.
    pub fn candidates(&self, ends: [&[Point]; 2]) -> Vec<Pair> {
        let boxes: Vec<Bounds> = (0..self.faces.len() as u32)
            .map(|t| Bounds::of(&self.triangle(ends[0], t)).with(&Bounds::of(&self.triangle(ends[1], t))))
            .collect();
        let mut found = Vec::new();
        overlapping(&boxes, |pair| {
            if self.counts_whole(pair) {
                found.push(pair);
            }
        });
        found.sort_unstable();
        found
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    lower: Point,
    upper: Point,
}

impl Bounds {
    /// Returns the AABB of some points.
    pub fn of(points: &[Point]) -> Self {
        let mut bounds = Self { lower: [f64::INFINITY; 3], upper: [f64::NEG_INFINITY; 3] };
        for p in points {
            for c in 0..3 {
                bounds.lower[c] = bounds.lower[c].min(p[c]);
                bounds.upper[c] = bounds.upper[c].max(p[c]);
            }
        }
        bounds
    }

    /// Returns the AABB of both.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            lower: std::array::from_fn(|c| self.lower[c].min(other.lower[c])),
            upper: std::array::from_fn(|c| self.upper[c].max(other.upper[c])),
        }
    }

    /// Returns the longest side.
    pub fn size(&self) -> f64 {
        (0..3).map(|c| self.upper[c] - self.lower[c]).fold(0.0, f64::max)
    }

    fn is_apart(&self, other: &Self) -> bool {
        (0..3).any(|c| self.upper[c] < other.lower[c] || other.upper[c] < self.lower[c])
    }
}

/// Calls `each` for all pairs of AABBs that overlap. Sweeps along the longest axis of their common AABB.
fn overlapping(boxes: &[Bounds], mut each: impl FnMut(Pair)) {
    let Some(all) = boxes.iter().copied().reduce(|a, b| a.with(&b)) else { return };
    let length = |c: &usize| all.upper[*c] - all.lower[*c];
    let axis = (0..3).max_by(|c, d| length(c).total_cmp(&length(d))).unwrap_or(0);
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    order.sort_by(|a, b| boxes[*a as usize].lower[axis].total_cmp(&boxes[*b as usize].lower[axis]));
    for (i, &a) in order.iter().enumerate() {
        let x = &boxes[a as usize];
        for &b in &order[i + 1..] {
            let y = &boxes[b as usize];
            // Both zeros are equal in this comparison, as in comparisons of coordinates.
            if y.lower[axis] > x.upper[axis] {
                break;
            }
            if !x.is_apart(y) {
                each((a.min(b), a.max(b)));
            }
        }
    }
}

/// Returns all pairs of a triangle of one mesh and a triangle of another that have a common point, sorted.
pub fn pairs_between(x: &[Triangle], y: &[Triangle]) -> Vec<Pair> {
    let boxes: Vec<Bounds> = x.iter().chain(y).map(|t| Bounds::of(t)).collect();
    let count = x.len() as u32;
    let mut found = Vec::new();
    overlapping(&boxes, |(a, b)| {
        if a < count && b >= count && meet(&x[a as usize], &y[(b - count) as usize]) {
            found.push((a, b - count));
        }
    });
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_count_by_common_vertices_and_welds() {
        // Two triangles pass through each other, and a corner of each is at the same position.
        let points: Vec<Point> = vec![
            [0.0, 0.0, 0.0],
            [2.0, -1.0, 0.0],
            [2.0, 1.0, 0.0],
            [0.0, 0.0, -0.0],
            [1.0, 0.0, 1.0],
            [1.0, 0.0, -1.0],
        ];
        let split = [[0, 1, 2], [3, 4, 5]];
        let joined = [[0, 1, 2], [0, 4, 5]];
        let modes = points.clone();
        let plain = Oracle::new(&split, 6, false);
        assert_eq!(plain.pairs(&points), [(0, 1)]);
        assert!(plain.clone().ignoring_at(&points).is_free(&points));
        assert!(plain.welded(&points, &modes).is_free(&points));
        assert!(Oracle::new(&joined, 6, false).is_free(&points));
        assert_eq!(Oracle::new(&joined, 6, true).pairs(&points), [(0, 1)]);
        let welded = Oracle::new(&split, 6, true).welded(&points, &modes);
        assert_eq!(welded.pairs(&points), [(0, 1)]);
        let mut moved = points;
        moved[5] = [0.5, 0.0, 2.0];
        assert!(welded.is_free(&moved));
        assert_eq!(welded.candidates([&moved, &moved]), []);
    }

    #[test]
    fn two_meshes_meet_by_triangle() {
        let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let above = floor.map(|p: Point| [p[0], p[1], 1.0]);
        assert_eq!(pairs_between(&[above, floor], &[floor]), [(1, 0)]);
        assert_eq!(pairs_between(&[above], &[floor]), []);
    }
}
