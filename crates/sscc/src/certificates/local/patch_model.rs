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
