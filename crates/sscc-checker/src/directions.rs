//! Directions that separate triangles, edges, or quarters of triangles.

use std::collections::HashMap;

use crate::counted::Simplices;
use crate::dyadic::{Dyadic, Vector};
use crate::points::{Radius, Triangle, along, are_apart};
use crate::scaled::ScaledModel;

/// The memory for values along directions that all threads may keep together, in bytes. Values beyond it are computed again, so that
/// no proof exhausts the memory. Lists of triangles of usual leaves and ranks need less.
const MAX_KEPT: usize = 1 << 27;
/// Bytes for each value that a table and the allocator add, about.
const PER_VALUE: usize = 24;

/// The directions of a list of triangles, and what they separate below a radius.
pub(crate) struct Directions<'a> {
    model: &'a ScaledModel,
    radius: &'a Radius,
    all: Vec<Direction>,
    /// The memory of the values that they keep, and its limit, in bytes.
    kept: usize,
    limit: usize,
}

/// A direction, and the positions and modes of vertices along it that have been computed.
struct Direction {
    dir: Vector,
    errors: [Dyadic; 2],
    vertices: HashMap<u32, Vec<Dyadic>>,
    apart: HashMap<[u32; 2], bool>,
}

impl<'a> Directions<'a> {
    /// Creates an empty list for one of a number of threads.
    pub(crate) fn new(model: &'a ScaledModel, radius: &'a Radius, threads: usize) -> Self {
        Self { model, radius, all: Vec::new(), kept: 0, limit: MAX_KEPT / threads.max(1) }
    }

    pub(crate) fn clear(&mut self) {
        (self.all, self.kept) = (Vec::new(), 0);
    }

    pub(crate) fn len(&self) -> usize {
        self.all.len()
    }

    /// Adds a direction at an index, in place of all that are not before it.
    pub(crate) fn set(&mut self, index: usize, dir: Vector) {
        self.all.truncate(index);
        let errors = self.model.errors(&dir);
        self.all.push(Direction { dir, errors, vertices: HashMap::new(), apart: HashMap::new() });
    }

    /// Whether a direction separates two simplices, that is, all nine pairs of their corners.
    pub(crate) fn separate(&mut self, index: usize, [x, y]: Simplices) -> bool {
        if self.kept > self.limit {
            self.kept = 0;
            for direction in &mut self.all {
                (direction.vertices, direction.apart) = (HashMap::new(), HashMap::new());
            }
        }
        let Direction { dir, errors, vertices, apart } = &mut self.all[index];
        for i in x.into_iter().chain(y) {
            vertices.entry(i).or_insert_with(|| {
                let row = along(self.model.point(i), dir);
                self.kept += row.iter().map(|x| x.size() + PER_VALUE).sum::<usize>();
                row
            });
        }
        x.into_iter().flat_map(|i| y.map(|j| [i, j])).all(|pair @ [i, j]| {
            *apart.entry(pair).or_insert_with(|| {
                self.kept += PER_VALUE;
                are_apart(&vertices[&i], &vertices[&j], errors, self.radius)
            })
        })
    }

    /// Whether a direction separates two triangles, or quarters of them.
    pub(crate) fn separate_corners(&self, index: usize, pair: [Triangle<'_>; 2]) -> bool {
        let Direction { dir, errors, .. } = &self.all[index];
        let [x, y] = pair.map(|triangle| triangle.map(|corner| along(corner, dir)));
        x.iter().all(|i| y.iter().all(|j| are_apart(i, j, errors, self.radius)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::scope::Scope;

    /// Values that are computed again, because many threads share the memory for them, give the same answers.
    #[test]
    fn answers_do_not_depend_on_the_kept_values() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / 2_f64.powi(53)
        };
        let (triangles, rank) = (20, 3);
        let positions = (0..3 * triangles).map(|i| [random(), random(), (i / 3) as f64]).collect();
        let faces = (0..triangles).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let modes = (0..9 * triangles as usize * rank).map(|_| random() - 0.5).collect();
        let model = Model::new(positions, faces, modes, rank).unwrap();
        let scaled = &ScaledModel::new(&model, &Scope::of_factor(vec![1.0; rank], rank), &|| false).unwrap();
        let radius = &scaled.radius(1.5);
        let [mut many, mut none] = [1, usize::MAX].map(|threads| Directions::new(scaled, radius, threads));
        let (mut apart, mut largest) = (0, 0);
        for step in 0..400 {
            if step % 20 == 0 {
                let (index, dir) = (many.len().min(3), [random() - 0.5, random() - 0.5, 1.0].map(Dyadic::of));
                many.set(index, dir.clone());
                none.set(index, dir);
            }
            let [a, b] = [random(), random()].map(|x| (x * f64::from(triangles)) as u32);
            let pair = [a, b].map(|t| model.faces[t as usize]);
            let index = (random() * many.len() as f64) as usize;
            let found = many.separate(index, pair);
            assert_eq!(none.separate(index, pair), found);
            let corners = pair.map(|simplex| simplex.map(|i| scaled.point(i)));
            assert_eq!(many.separate_corners(index, corners), found);
            apart += usize::from(found);
            largest = largest.max(none.kept);
        }
        assert!((50..350).contains(&apart), "{apart}");
        // The values of six vertices and nine pairs are needed at once.
        assert!(many.kept > 10 * largest && largest < 6 * (rank + 1) * 256, "{} {largest}", many.kept);
    }
}
