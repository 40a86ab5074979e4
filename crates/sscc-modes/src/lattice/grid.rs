//! The cells of a lattice, and the samples within them.

use glam::DVec3;

use super::surface::Surface;
use crate::ModesError;

/// Samples along each side of a cell, and lines through it along each axis: two for each octant.
pub(super) const SAMPLES: usize = 4;

/// Samples at most; each takes 5 bytes. A request beyond is refused, the default is made coarser.
const MOST_SAMPLES: f64 = 1.5e8;
const MOST_BY_DEFAULT: f64 = 3e7;

/// Where the first cell begins before the surface, in cells: an odd share, so that no face of a box is a face of cells.
const BEGIN: DVec3 = DVec3::new(0.371, 0.423, 0.397);

/// Cells of equal size.
pub(super) struct Grid {
    /// The corner with the smallest coordinates.
    pub low: DVec3,
    /// Edge of a cell (model unit).
    pub spacing: f64,
    /// Cells along each axis.
    pub size: [usize; 3],
}

impl Grid {
    /// Around a surface, with `cells` along its longest side, or `filled` cells of its volume.
    ///
    /// # Errors
    /// When there would be too many.
    pub fn new(surface: &Surface, cells: Option<usize>, filled: f64) -> Result<Self, ModesError> {
        let used = || surface.faces.iter().flatten().map(|v| surface.points[*v as usize]);
        let low = used().fold(DVec3::INFINITY, DVec3::min);
        let extent = used().fold(DVec3::NEG_INFINITY, DVec3::max) - low;
        let samples = |spacing: f64| {
            let cells = extent / spacing + DVec3::splat(2.0);
            cells.x * cells.y * cells.z * (SAMPLES * SAMPLES * SAMPLES) as f64
        };
        let spacing = match cells {
            Some(cells) => extent.max_element() / cells.max(1) as f64,
            None => {
                let mut spacing = (surface.volume / filled).cbrt();
                while samples(spacing) > MOST_BY_DEFAULT {
                    spacing *= 1.1;
                }
                spacing
            }
        };
        let ratio = extent.max_element() / spacing;
        if !(samples(spacing) <= MOST_SAMPLES && spacing > 0.0 && ratio.is_finite()) {
            return Err(ModesError::Resolution { cells: ratio });
        }
        let low = low - BEGIN * spacing;
        let size = (extent / spacing + BEGIN + DVec3::splat(0.01)).to_array().map(|x| x.ceil() as usize);
        Ok(Self { low, spacing, size })
    }

    /// The cell that holds a coordinate along an axis.
    pub fn cell_along(&self, axis: usize, x: f64) -> usize {
        (((x - self.low[axis]) / self.spacing).floor().max(0.0) as usize).min(self.size[axis] - 1)
    }

    /// The coordinate of a sample along an axis.
    pub fn sample_along(&self, axis: usize, index: usize) -> f64 {
        self.low[axis] + self.spacing * ((index as f64 + 0.5) / SAMPLES as f64)
    }

    /// The samples along an axis whose coordinates are from `low` to `high`, or a little beyond.
    pub fn samples_within(&self, axis: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let index = |x: f64| (x - self.low[axis]) / self.spacing * SAMPLES as f64 - 0.5;
        let last = self.size[axis] * SAMPLES;
        let from = (index(low).ceil().max(0.0) as usize).min(last);
        from..((index(high).floor() + 1.0).max(0.0) as usize).min(last).max(from)
    }

    /// The number of a cell.
    pub fn cell(&self, at: [usize; 3]) -> usize {
        at[0] + self.size[0] * (at[1] + self.size[1] * at[2])
    }

    /// The place of a cell.
    pub fn place(&self, cell: usize) -> [usize; 3] {
        [cell % self.size[0], cell / self.size[0] % self.size[1], cell / (self.size[0] * self.size[1])]
    }

    /// The number of a sample.
    pub fn sample(&self, at: [usize; 3]) -> usize {
        at[0] + SAMPLES * self.size[0] * (at[1] + SAMPLES * self.size[1] * at[2])
    }

    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.size.iter().product()
    }

    /// The number of samples.
    pub fn samples(&self) -> usize {
        self.cells() * SAMPLES * SAMPLES * SAMPLES
    }

    /// The corner of a cell with the smallest coordinates.
    pub fn corner(&self, at: [usize; 3]) -> DVec3 {
        self.low + DVec3::from_array(at.map(|k| k as f64)) * self.spacing
    }
}
