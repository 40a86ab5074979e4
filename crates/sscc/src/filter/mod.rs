//! Which pairs of triangles count: neighbours, welded vertices, pairs to be ignored.

use std::cmp::Ordering;

use glam::DVec3;

use crate::{ReducedModel, TriMesh, intersect_beyond_vertex, intersect_triangle_triangle};

/// Two triangles, the lower number first.
pub type Pair = (u32, u32);

/// What is asked of triangles that share a vertex. Those that share two or three never count: they always touch along
/// an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Neighbours {
    /// They do not count (paper, section 3).
    #[default]
    Exclude,
    /// Those that share exactly one vertex count when they have another point in common than that vertex.
    IncludeOneVertex,
}

impl Neighbours {
    /// The name used on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exclude => "exclude",
            Self::IncludeOneVertex => "include-one-vertex",
        }
    }

    /// The rule of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Exclude, Self::IncludeOneVertex].into_iter().find(|rule| rule.name() == name)
    }
}

/// Which pairs of triangles count as collisions when they have a point in common. By default: all that share
/// no vertex.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PairRule {
    /// What is asked of triangles that share a vertex.
    pub neighbours: Neighbours,
    /// Whether vertices of exactly equal rest position and modes are one vertex, for adjacency only: numbers
    /// and positions stay the file's. For files that split vertices along seams (STL, glTF).
    pub weld: bool,
    ignored: Vec<Pair>,
}

impl PairRule {
    /// A rule that ignores no pair.
    pub fn new(neighbours: Neighbours, weld: bool) -> Self {
        Self { neighbours, weld, ignored: Vec::new() }
    }

    /// The same rule, which also ignores these pairs for good (in any order).
    #[must_use]
    pub fn ignoring(mut self, pairs: impl IntoIterator<Item = Pair>) -> Self {
        let pairs = pairs.into_iter().filter(|(i, j)| i != j);
        self.ignored.extend(pairs.map(|(i, j)| (i.min(j), i.max(j))));
        self.ignored.sort_unstable();
        self.ignored.dedup();
        self
    }

    /// The pairs that never count, sorted.
    pub fn ignored(&self) -> &[Pair] {
        &self.ignored
    }
}

/// How two triangles stand to each other under a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Relation {
    /// They count when they have any point in common.
    Apart,
    /// They count when they have a point in common beside the vertex of this class.
    OneVertex(u32),
    /// They never count.
    Adjacent,
}

/// A rule applied to one mesh.
#[derive(Clone, Debug)]
pub(crate) struct PairFilter {
    faces: Vec<[u32; 3]>,
    /// The vertex class of each corner: the least vertex that it is welded to; without welds itself.
    classes: Vec<[u32; 3]>,
    neighbours: Neighbours,
    /// Sorted.
    left_out: Vec<Pair>,
}

impl PairFilter {
    pub(crate) fn new(model: &ReducedModel, rule: &PairRule) -> Self {
        let faces = model.mesh().faces().to_vec();
        let classes = if rule.weld {
            let classes = weld_classes(model);
            faces.iter().map(|face| face.map(|v| classes[v as usize])).collect()
        } else {
            faces.clone()
        };
        Self { faces, classes, neighbours: rule.neighbours, left_out: rule.ignored.clone() }
    }

    /// The same, which also leaves out these pairs: for certificates, which do not speak of exceptions.
    pub(crate) fn leaving_out(mut self, pairs: &[Pair]) -> Self {
        self.left_out.extend_from_slice(pairs);
        self.left_out.sort_unstable();
        self
    }

    /// Vertex classes are numbers below this.
    pub(crate) fn class_count(&self) -> usize {
        self.classes.iter().flatten().max().map_or(0, |class| *class as usize + 1)
    }

    /// The vertex classes of a triangle.
    #[inline]
    pub(crate) fn classes(&self, triangle: u32) -> [u32; 3] {
        self.classes[triangle as usize]
    }

    #[inline]
    pub(crate) fn relation(&self, a: u32, b: u32) -> Relation {
        let (x, y) = (self.classes[a as usize], self.classes[b as usize]);
        if x.iter().any(|v| y.contains(v)) { self.between_neighbours(x, y) } else { Relation::Apart }
    }

    fn between_neighbours(&self, x: [u32; 3], y: [u32; 3]) -> Relation {
        let mut shared = x.into_iter().filter(|v| y.contains(v));
        match (shared.next(), self.neighbours) {
            (Some(v), Neighbours::IncludeOneVertex) if shared.all(|w| w == v) => Relation::OneVertex(v),
            _ => Relation::Adjacent,
        }
    }

    /// Whether a pair that would count is left out.
    #[inline]
    pub(crate) fn leaves_out(&self, a: u32, b: u32) -> bool {
        !self.left_out.is_empty() && self.left_out.binary_search(&(a.min(b), a.max(b))).is_ok()
    }

    /// Whether two triangles with these corners collide, exactly, under the rule. Pairs left out are the caller's.
    pub(crate) fn collide(&self, pair: Pair, x: &[DVec3; 3], y: &[DVec3; 3]) -> bool {
        self.collide_as(self.relation(pair.0, pair.1), pair, x, y)
    }

    /// The same where their relation is known.
    #[inline]
    pub(crate) fn collide_as(&self, relation: Relation, pair: Pair, x: &[DVec3; 3], y: &[DVec3; 3]) -> bool {
        match relation {
            Relation::Adjacent => false,
            Relation::Apart => intersect_triangle_triangle(x, y),
            Relation::OneVertex(v) => self.collide_beyond(v, pair, x, y),
        }
    }

    fn collide_beyond(&self, v: u32, (a, b): Pair, x: &[DVec3; 3], y: &[DVec3; 3]) -> bool {
        match (self.opposite(a, v), self.opposite(b, v)) {
            (Some(e), Some(f)) => {
                let at = self.classes[a as usize].iter().position(|w| *w == v).unwrap_or(0);
                intersect_beyond_vertex(x[at], e.map(|i| x[i]), f.map(|i| y[i]))
            }
            // A face that is the vertex alone.
            _ => false,
        }
    }

    /// The pairs of hulls, given by three vertices each, at least one of which meets wherever the pair counts. Two
    /// triangles that meet beside a common vertex do so on the edge opposite to it of one of them: follow the
    /// ray from the vertex through a common point until it leaves the first of the two.
    pub(crate) fn hulls(&self, a: u32, b: u32) -> impl Iterator<Item = ([u32; 3], [u32; 3])> {
        let (x, y) = (self.faces[a as usize], self.faces[b as usize]);
        self.hulls_of_corners(a, b).map(move |(i, j)| (i.map(|i| x[i]), j.map(|j| y[j])))
    }

    /// The same, by the corners (0 to 2) of each triangle.
    pub(crate) fn hulls_of_corners(&self, a: u32, b: u32) -> impl Iterator<Item = ([usize; 3], [usize; 3])> {
        let whole = [0, 1, 2];
        let edge = |[i, j]: [usize; 2]| [i, j, j];
        let hulls = match self.relation(a, b) {
            Relation::Adjacent => [None, None],
            Relation::Apart => [Some((whole, whole)), None],
            Relation::OneVertex(v) => match (self.opposite(a, v), self.opposite(b, v)) {
                (Some(e), Some(f)) => {
                    [Some((edge(e), whole)), right_or!(Some((whole, edge(f))), OneHullOfTwo, None)]
                }
                _ => [None, None],
            },
        };
        hulls.into_iter().flatten()
    }

    /// The corners (0 to 2) of a face that are not of the class v: two, or one twice.
    fn opposite(&self, face: u32, v: u32) -> Option<[usize; 2]> {
        let classes = self.classes[face as usize];
        let mut others = (0..3).filter(|&i| classes[i] != v);
        let first = others.next()?;
        Some([first, others.next().unwrap_or(first)])
    }
}

/// For each vertex the least one with exactly the same position and modes (+0 and -0 are the same number).
pub(crate) fn weld_classes(model: &ReducedModel) -> Vec<u32> {
    let (mesh, modes): (&TriMesh, _) = (model.mesh(), model.modes());
    let compare = |a: &u32, b: &u32| -> Ordering {
        let of = |v: u32| {
            std::iter::once(&mesh.rest_positions()[v as usize])
                .chain(modes.of_vertex(v))
                .flat_map(|x| x.to_array())
        };
        // No number here is NaN.
        of(*a).partial_cmp(of(*b)).unwrap_or(Ordering::Equal)
    };
    let mut sorted: Vec<u32> = (0..mesh.rest_positions().len() as u32).collect();
    sorted.sort_by(|a, b| compare(a, b).then(a.cmp(b)));
    let mut classes: Vec<u32> = (0..sorted.len() as u32).collect();
    for equal in sorted.chunk_by(|a, b| compare(a, b) == Ordering::Equal) {
        equal.iter().for_each(|&v| classes[v as usize] = equal[0]);
    }
    classes
}
