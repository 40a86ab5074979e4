//! Grid of cubic cells around a surface.

use glam::DVec3;

use super::surface::Surface;
use crate::ModesError;

/// Default number of cells that the solid touches. The wavelengths of the lowest few dozen modes are then many cells,
/// and the computation takes seconds.
pub(super) const DEFAULT_CELLS: f64 = 20_000.0;

/// Maximum number of cells that the solid touches; nodes and links of more need gigabytes.
const MAX_CELLS: f64 = 5e6;

/// Maximum number of cells that the surface touches. Each has 64 samples and up to 48 pieces of lines.
const MAX_SURFACE_CELLS: f64 = 1e6;

/// Maximum number of incidences of triangles and cells, of which each takes 16 bytes: 1 GiB. Surfaces of more than 2^24
/// triangles may have four for each, but at most 2^28: at the worst place of the grid they are eight times as many,
/// which are then numbered below 2^32.
const MAX_INCIDENCES: f64 = (1 << 26) as f64;

/// Excess of the grid's length over the longest side of the surface, in cells.
const MARGIN: f64 = 0.3;

/// Offset of the surface from the middle of the grid, in cells, different along each axis. Without it, flat sides and
/// symmetry planes of models would lie on borders of cells, where the filled shares are less precise.
const SHIFT: DVec3 = DVec3::new(0.0123, 0.0171, 0.0147);

/// Grid of cells: rows along x, layers of rows along y, layers along z.
pub(super) struct Grid {
    /// Side of a cell (model unit).
    pub spacing: f64,
    /// Cells along each axis.
    pub size: [u32; 3],
    /// The middle of the surface (model unit).
    middle: DVec3,
    /// The middle of the surface in the grid's coordinates.
    center: DVec3,
}

impl Grid {
    /// Creates a grid with this number of cells along the longest side of the surface; None gives about
    /// [`DEFAULT_CELLS`] cells that the solid touches, or fewer if triangles meet too many of them.
    ///
    /// # Errors
    /// When the number is 0 or too large.
    pub fn around(surface: &Surface, cells: Option<usize>) -> Result<Self, ModesError> {
        let longest = surface.extent.max_element();
        let max_incidences = (4.0 * surface.faces.len() as f64).clamp(MAX_INCIDENCES, 4.0 * MAX_INCIDENCES);
        let limit = finest(|n| {
            touched(surface, n) <= MAX_CELLS
                && touched_by_surface(surface, n)
                && incidences(surface, n) <= max_incidences
        });
        let along = match cells {
            None => finest(|n| touched(surface, n) <= DEFAULT_CELLS).min(limit),
            Some(n) if n >= 1 && n as f64 - MARGIN <= limit => n as f64 - MARGIN,
            Some(cells) => return Err(ModesError::Resolution { cells, max: (limit + MARGIN) as usize }),
        };
        let spacing = longest / along;
        // The margin is reduced so that rounding does not add a cell to a whole number of cells.
        let size = (surface.extent / spacing + (MARGIN - 1e-3)).ceil();
        Ok(Self {
            spacing,
            size: size.to_array().map(|cells| cells as u32),
            middle: surface.middle,
            center: 0.5 * size + SHIFT,
        })
    }

    /// Converts a position (model unit) to units of cells: cell i lies between i and i + 1.
    pub fn coordinates(&self, position: DVec3) -> DVec3 {
        (position - self.middle) / self.spacing + self.center
    }

    /// Returns the position (model unit) of a corner of cells.
    pub fn position(&self, corner: [u32; 3]) -> DVec3 {
        (DVec3::from_array(corner.map(f64::from)) - self.center) * self.spacing + self.middle
    }

    /// Returns the cell that contains a point (in units of cells).
    pub fn cell_of(&self, point: DVec3) -> [u32; 3] {
        std::array::from_fn(|axis| cell_along(point[axis], self.size[axis]))
    }

    /// Returns the number of a cell: x-fastest.
    pub fn key(&self, cell: [u32; 3]) -> u64 {
        let [nx, ny, _] = self.size.map(u64::from);
        let [x, y, z] = cell.map(u64::from);
        (z * ny + y) * nx + x
    }

    /// Returns the cell with a number.
    pub fn cell(&self, key: u64) -> [u32; 3] {
        let [nx, ny, _] = self.size.map(u64::from);
        [key % nx, key / nx % ny, key / (nx * ny)].map(|i| i as u32)
    }
}

/// Returns the cell along one axis that contains a coordinate.
pub(super) fn cell_along(coordinate: f64, size: u32) -> u32 {
    (coordinate as u32).min(size - 1)
}

/// Estimates the number of cells that the solid touches, with n cells along its longest side. Steiner's formula for
/// convex bodies, with factors for cubes: volume, half a layer around the area, and rods thinner than cells.
fn touched(surface: &Surface, n: f64) -> f64 {
    let length = surface.extent.element_sum() / surface.extent.max_element();
    surface.volume * n * n * n + 0.75 * surface.area * n * n + length * n
}

/// Whether the surface touches few enough cells.
fn touched_by_surface(surface: &Surface, n: f64) -> bool {
    1.5 * surface.area * n * n <= MAX_SURFACE_CELLS
}

/// Returns the number of incidences of triangles and cells, with n cells along the longest side: the mean over all places
/// of the grid, which is the volume of the Minkowski sums of triangles and a cell.
pub(super) fn incidences(surface: &Surface, n: f64) -> f64 {
    surface.faces.len() as f64 + surface.triangle_extents * n + surface.triangle_projections * n * n
}

/// Returns the largest number for which a monotone condition holds.
fn finest(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.5, MAX_CELLS);
    // 100 halvings give a relative error of 1e-15.
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
