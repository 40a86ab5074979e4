//! The positions and modes of a model about the centre of its certificates, in units of half the size of the shape and of
//! the largest displacement by each mode.

use glam::DVec3;

use crate::ReducedModel;
use crate::geometry::Aabb;

/// Positions in the unit of half the shape's size, about the middle of the shape's AABB, and the sizes of modes.
pub(crate) struct PatchModel<'m> {
    model: &'m ReducedModel,
    pub(super) positions: Vec<DVec3>,
    scales: FactorScales,
}

/// The scales of factors, which are displacements by each mode in the unit of half the shape's size.
#[derive(Clone, Debug)]
pub(crate) struct FactorScales {
    /// For each mode its largest displacement over half the size of the shape.
    pub(crate) sizes: Vec<f64>,
    /// One over half the size of the shape.
    pub(crate) scale: f64,
    /// An upper bound of the magnitude of every term of every position at the centre.
    pub(crate) reach: f64,
}

impl FactorScales {
    /// Computes the scales. None if a number is out of the range of the inequality: the centre is no configuration of
    /// the model, the shape has no size, the scale or its inverse is not a normal number, or the size of a mode is
    /// neither 0 nor normal.
    pub(crate) fn new(model: &ReducedModel, center: &[f64]) -> Option<Self> {
        Self::with_middle(model, center).map(|(scales, _)| scales)
    }

    /// Returns the scales and the middle of the shape.
    fn with_middle(model: &ReducedModel, center: &[f64]) -> Option<(Self, DVec3)> {
        let reach = model.check_coordinates(center).ok()?;
        let points = model.mesh().used_vertices().into_iter().map(|v| model.position(v, center));
        let Aabb { lower, upper } = Aabb::of_points(points);
        let middle = lower * 0.5 + upper * 0.5;
        let scale = 1.0 / (upper - middle).max(middle - lower).max_element();
        let sizes: Vec<f64> =
            (0..model.rank()).map(|k| model.mode_displacement_bound(k, 1.0) * scale).collect();
        let is_normal = |x: f64| x == 0.0 || x.is_normal();
        let is_fit =
            scale.is_normal() && (1.0 / scale).is_normal() && sizes.iter().all(|size| is_normal(*size));
        is_fit.then_some((Self { sizes, scale, reach }, middle))
    }
}

impl<'m> PatchModel<'m> {
    /// Scales the positions. None if [`FactorScales::new`] returns None.
    pub(crate) fn new(model: &'m ReducedModel, center: &[f64]) -> Option<Self> {
        let (scales, middle) = FactorScales::with_middle(model, center)?;
        let mut positions = vec![DVec3::ZERO; model.mesh().rest_positions().len()];
        for v in model.mesh().used_vertices() {
            positions[v as usize] = (model.position(v, center) - middle) * scales.scale;
        }
        Some(Self { model, positions, scales })
    }

    /// Returns the number of modes.
    pub(crate) fn rank(&self) -> usize {
        self.scales.sizes.len()
    }

    /// Returns the vertices that faces use.
    pub(crate) fn used_vertices(&self) -> Vec<u32> {
        self.model.mesh().used_vertices()
    }

    /// Returns the position of a vertex: within a cube with sides of length 2, up to rounding.
    pub(crate) fn position(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize]
    }

    /// Calls `f` with each mode that moves a vertex, and its displacement over the mode's largest one.
    pub(crate) fn for_each_mode(&self, vertex: u32, mut f: impl FnMut(usize, DVec3)) {
        for (k, u) in self.model.modes().of_vertex(vertex).iter().enumerate() {
            if *u != DVec3::ZERO && self.scales.sizes[k] > 0.0 {
                f(k, *u / self.model.mode_displacement_bound(k, 1.0));
            }
        }
    }

    /// Lists the modes that move one of these vertices, ascending. None if there are more than `most`.
    pub(super) fn moving_modes(&self, vertices: &[u32], most: usize, modes: &mut Vec<u32>) -> Option<()> {
        modes.clear();
        let rank = self.scales.sizes.len();
        let mut is_moving = vec![false; rank];
        for v in with_mutant!(vertices, LocalModesOfOneVertex, &vertices[..1]) {
            for (is_moving, u) in is_moving.iter_mut().zip(self.model.modes().of_vertex(*v)) {
                *is_moving |= *u != DVec3::ZERO;
            }
        }
        modes.extend(
            (0..rank as u32).filter(|k| is_moving[*k as usize] && self.scales.sizes[*k as usize] > 0.0),
        );
        (modes.len() <= most).then_some(())
    }

    /// Writes the displacements of a vertex by these modes, each divided by the mode's largest one, as three rows.
    pub(super) fn write_modes(&self, vertex: u32, modes: &[u32], rows: &mut [f64]) {
        let row_len = rows.len() / 3;
        let of_vertex = self.model.modes().of_vertex(vertex);
        for (i, k) in modes.iter().enumerate() {
            let size = self.model.mode_displacement_bound(*k as usize, 1.0);
            let u = of_vertex[*k as usize] / size;
            [rows[i], rows[row_len + i], rows[2 * row_len + i]] = u.to_array();
        }
    }
}

#[cfg(test)]
mod tests {
    use sscc_testing::Numbers;

    use super::*;
    use crate::{Modes, TriMesh};

    const RANK: usize = 5;

    /// The shape is far from the origin, and a vertex still farther away belongs to no face. The second mode
    /// moves nothing, the third one vertex, and the fourth all but the first vertex.
    #[test]
    fn positions_and_modes_are_in_units_of_the_shape() {
        let random = &mut Numbers(4);
        for case in 0..100 {
            let used = 3 * (2 + random.below(4));
            let size = random.power(-3.0, 3.0);
            let middle = (random.vector() + 2.0) * (10.0 * size);
            let mut rest: Vec<DVec3> = (0..used).map(|_| middle + random.vector() * size).collect();
            rest.push(middle * 1e6);
            let faces = (0..used as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let is_moved = |v: usize, k: usize| match k {
                1 => false,
                2 => v + 1 == used,
                3 => v > 0,
                _ => true,
            };
            let mut modes = Vec::new();
            for (v, k) in (0..=used).flat_map(|v| (0..RANK).map(move |k| (v, k))) {
                let u = random.vector() * 10.0_f64.powi(k as i32 - 2);
                modes.push(if is_moved(v, k) { u } else { DVec3::ZERO });
            }
            let largest = |k: usize| {
                let of_mode = modes.iter().skip(k).step_by(RANK);
                of_mode.map(|u| u.abs().max_element()).fold(0.0, f64::max)
            };
            let mesh = TriMesh::new(rest, faces).unwrap();
            let model = ReducedModel::new(mesh, Modes::new(RANK, modes.clone()).unwrap()).unwrap();
            let center: Vec<f64> = (0..RANK).map(|_| 0.1 * size * random.signed()).collect();
            let positions: Vec<DVec3> = (0..used as u32).map(|v| model.position(v, &center)).collect();
            let lower = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
            let upper = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
            let (middle, half) = ((lower + upper) / 2.0, (upper - lower).max_element() / 2.0);

            let patch = PatchModel::new(&model, &center).unwrap();
            assert!((patch.scales.scale * half - 1.0).abs() < 1e-11, "case {case}");
            assert_eq!(patch.scales.reach, model.check_coordinates(&center).unwrap());
            for k in 0..RANK {
                let found = patch.scales.sizes[k] * half;
                assert!((found - largest(k)).abs() <= 1e-11 * largest(k), "case {case}: {k} {found}");
            }
            let mut farthest = 0.0_f64;
            for (v, x) in positions.iter().enumerate() {
                let found = patch.position(v as u32);
                assert!((found * half - (*x - middle)).length() < 1e-11 * half, "case {case}: {v} {found}");
                farthest = farthest.max(found.abs().max_element());
            }
            // Errors of gaps and positions are those of coordinates of at most 1.
            assert!((farthest - 1.0).abs() < 1e-11, "case {case}: {farthest}");
            assert_eq!((patch.position(used as u32), patch.rank()), (DVec3::ZERO, RANK));

            let displacement = |v: usize, k: usize| modes[v * RANK + k] / largest(k);
            for v in 0..used {
                let mut found = Vec::new();
                patch.for_each_mode(v as u32, |k, u| found.push((k, u)));
                let moving = (0..RANK).filter(|k| is_moved(v, *k));
                let expected: Vec<_> = moving.map(|k| (k, displacement(v, k))).collect();
                assert_eq!(found, expected, "case {case}: {v}");
            }
            for vertices in [&[0][..], &[1], &[0, used as u32 - 1], &[1, 2, 0]] {
                let is_moving = |k: &u32| vertices.iter().any(|v| is_moved(*v as usize, *k as usize));
                let expected: Vec<u32> = (0..RANK as u32).filter(is_moving).collect();
                let mut found = Vec::new();
                assert!(patch.moving_modes(vertices, expected.len(), &mut found).is_some(), "{vertices:?}");
                assert_eq!(found, expected, "case {case}: {vertices:?}");
                assert!(patch.moving_modes(vertices, expected.len() - 1, &mut found).is_none());
                let mut rows = vec![9.0; 24];
                patch.write_modes(vertices[0], &expected, &mut rows);
                for (e, found) in rows.into_iter().enumerate() {
                    let of_mode = |k: &u32| displacement(vertices[0] as usize, *k as usize)[e / 8];
                    assert_eq!(found, expected.get(e % 8).map_or(9.0, of_mode), "case {case}: {e}");
                }
            }
        }
    }

    /// Returns a triangle of a size, which the first mode stretches, and the second one moves by a distance.
    fn triangle(size: f64, distance: f64) -> ReducedModel {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p * size);
        let modes = corners.iter().flat_map(|p| [*p, DVec3::splat(distance)]).collect();
        let mesh = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        ReducedModel::new(mesh, Modes::new(2, modes).unwrap()).unwrap()
    }

    /// A mode whose size is 0 in the unit of the shape has the factor 0: no patch may have a part of it.
    #[test]
    fn modes_whose_size_underflows_do_not_count() {
        let size = 2.0_f64.powi(190);
        let model = triangle(size, 2.0_f64.powi(-900));
        let patch = PatchModel::new(&model, &[0.0; 2]).unwrap();
        assert_eq!(patch.scales.sizes, [2.0, 0.0]);
        let mut found = Vec::new();
        patch.moving_modes(&[0, 1, 2], 2, &mut found).unwrap();
        assert_eq!(found, [0]);
        patch.for_each_mode(1, |k, _| assert_eq!(k, 0));
        // This one has a size, but few digits.
        assert!(FactorScales::new(&triangle(size, 2.0_f64.powi(-850)), &[0.0; 2]).is_none());
    }

    /// Half the size of the shape and its inverse are normal numbers.
    #[test]
    fn shapes_that_are_too_small_have_no_scales() {
        let is_fit = |size: f64| FactorScales::new(&triangle(size, size), &[0.0; 2]).is_some();
        assert!(is_fit(1.0) && is_fit(4.0 * f64::MIN_POSITIVE));
        assert!(!is_fit(f64::MIN_POSITIVE));
        let corners = vec![DVec3::ONE; 3];
        let mesh = TriMesh::new(corners.clone(), vec![[0, 1, 2]]).unwrap();
        let point = ReducedModel::new(mesh, Modes::new(1, corners).unwrap()).unwrap();
        assert!(FactorScales::new(&point, &[0.0]).is_none() && FactorScales::new(&point, &[]).is_none());
    }
}
