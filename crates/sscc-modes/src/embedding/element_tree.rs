//! Hierarchy of AABBs over the elements of a solid, for the nearest element to a point.

use glam::DVec3;
use sscc::parts::Aabb;
use sscc_solid::Solid;

use super::{cube, simplex};

/// Maximum number of elements of a leaf.
const LEAF: usize = 4;

/// Hierarchy by median splits along the longest side.
pub struct ElementTree<'a> {
    solid: &'a Solid,
    /// Elements in the order of the leaves.
    elements: Vec<u32>,
    nodes: Vec<Node>,
}

/// Node; its first child follows it.
struct Node {
    bounds: Aabb,
    /// Range of its elements.
    first: usize,
    end: usize,
    /// The second child; None for a leaf.
    second: Option<usize>,
}

/// Elements that may move a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidates {
    /// The elements that contain the point up to a tolerance, ascending; the nearest one alone if there are none.
    /// Elements count from 0, tetrahedra first.
    pub elements: Vec<u32>,
    /// Distance of the point from the nearest element, for sheared or distorted cubes an upper bound; 0 inside.
    pub distance: f64,
}

impl<'a> ElementTree<'a> {
    /// Builds the hierarchy. Costs O(n log^2 n).
    pub fn new(solid: &'a Solid) -> Self {
        let count = solid.element_count();
        let bounds: Vec<Aabb> = (0..count).map(|element| bounds(solid, element)).collect();
        let mut tree = Self { solid, elements: (0..count as u32).collect(), nodes: Vec::new() };
        tree.split(0, count, &bounds);
        tree
    }

    /// Returns the longest side of the solid's AABB.
    pub fn size(&self) -> f64 {
        let Aabb { lower, upper } = self.nodes[0].bounds;
        (upper - lower).max_element()
    }

    /// Returns the elements at most `tolerance` away from a point, or the nearest one, the first found of several. Distances from
    /// sheared or distorted cubes are upper bounds.
    pub fn candidates(&self, x: DVec3, tolerance: f64) -> Candidates {
        let (mut nearest, mut least, mut inside) = (0, f64::INFINITY, Vec::new());
        let mut stack = vec![(0, distance_aabb(x, &self.nodes[0].bounds))];
        while let Some((index, distance)) = stack.pop() {
            if distance > least.max(tolerance) {
                continue;
            }
            let node = &self.nodes[index];
            if let Some(second) = node.second {
                let mut children =
                    [index + 1, second].map(|child| (child, distance_aabb(x, &self.nodes[child].bounds)));
                if children[0].1 <= children[1].1 {
                    children.reverse(); // the nearer child is searched first
                }
                stack.extend(children);
                continue;
            }
            for element in &self.elements[node.first..node.end] {
                let distance = self.near_point(*element, x).distance(x);
                if distance <= tolerance {
                    inside.push(*element);
                }
                if distance < least {
                    (nearest, least) = (*element, distance);
                }
            }
        }
        inside.sort_unstable();
        let elements = if inside.is_empty() { vec![nearest] } else { inside };
        Candidates { elements, distance: least }
    }

    /// Returns vertices and weights of an element at a point.
    pub fn weights(&self, element: u32, x: DVec3) -> [(u32, f64); 8] {
        let mut found = [(0, 0.0); 8];
        let set = |(to, (vertex, weight)): (&mut (u32, f64), (&u32, f64))| *to = (*vertex, weight);
        match self.cube(element) {
            Err(tet) => {
                let weights = simplex::barycentric(x, corners(self.solid, tet));
                found.iter_mut().zip(tet.iter().zip(weights)).for_each(set);
            }
            Ok(cube) => {
                let local = cube::local_coordinates(x, &corners(self.solid, cube));
                found.iter_mut().zip(cube.iter().zip(cube::weights(local))).for_each(set);
            }
        }
        found
    }

    /// Returns the vertices of an element.
    pub fn vertices(&self, element: u32) -> &[u32] {
        self.cube(element).map_or_else(|tet| &tet[..], |cube| &cube[..])
    }

    fn near_point(&self, element: u32, x: DVec3) -> DVec3 {
        match self.cube(element) {
            Err(tet) => simplex::nearest_point_tetrahedron(x, corners(self.solid, tet)),
            Ok(cube) => cube::near_point(x, &corners(self.solid, cube)),
        }
    }

    /// Returns the corners of a cube, or those of a tetrahedron as the error.
    fn cube(&self, element: u32) -> Result<&[u32; 8], &[u32; 4]> {
        let (element, tets) = (element as usize, self.solid.tets());
        tets.get(element).map_or_else(|| Ok(&self.solid.cubes()[element - tets.len()]), Err)
    }

    /// Adds the node of a range of elements, and all below it.
    fn split(&mut self, first: usize, end: usize, bounds: &[Aabb]) {
        let range = &mut self.elements[first..end];
        let own = range.iter().fold(Aabb::EMPTY, |all, element| all.union(&bounds[*element as usize]));
        let index = self.nodes.len();
        self.nodes.push(Node { bounds: own, first, end, second: None });
        if end - first <= LEAF {
            return;
        }
        let axis = (own.upper - own.lower).max_position();
        let center = |element: &u32| bounds[*element as usize].center()[axis];
        range.sort_unstable_by(|a, b| center(a).total_cmp(&center(b)).then(a.cmp(b)));
        let middle = (first + end) / 2;
        self.split(first, middle, bounds);
        self.nodes[index].second = Some(self.nodes.len());
        self.split(middle, end, bounds);
    }
}

fn bounds(solid: &Solid, element: usize) -> Aabb {
    let vertices = solid.element(element).vertices;
    Aabb::of_points(vertices.iter().map(|v| solid.vertices()[*v as usize]))
}

/// Returns the distance of a point from a box; 0 inside.
fn distance_aabb(x: DVec3, bounds: &Aabb) -> f64 {
    x.distance(x.clamp(bounds.lower, bounds.upper))
}

/// Returns the corners of an element.
pub fn corners<const N: usize>(solid: &Solid, element: &[u32; N]) -> [DVec3; N] {
    element.map(|v| solid.vertices()[v as usize])
}
