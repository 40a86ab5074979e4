//! Limit on the work that polygons of a file may take.

/// Steps for a file of any size: comparisons of boxes, of cells and of points; some seconds at most.
const BASE_STEPS: u64 = 1 << 29;

/// Further steps for each corner of a polygon that is no fan.
const STEPS_OF_A_CORNER: u64 = 256;

/// Steps of a test by exact signs of up to four determinants.
pub(super) const STEPS_OF_EXACT_SIGNS: usize = 8;

/// Steps that remain.
pub(super) struct Work(u64);

/// Error: the allowed work is used up.
#[derive(Debug, PartialEq)]
pub(super) struct TooIntricate;

impl Work {
    pub fn new() -> Self {
        Self(BASE_STEPS)
    }

    /// Adds the steps for a polygon.
    pub fn allow(&mut self, corners: usize) {
        self.0 = self.0.saturating_add((corners as u64).saturating_mul(STEPS_OF_A_CORNER));
    }

    /// Takes steps.
    #[inline]
    pub fn take(&mut self, steps: usize) -> Result<(), TooIntricate> {
        match self.0.checked_sub(steps as u64) {
            Some(left) => {
                self.0 = left;
                Ok(())
            }
            None => Err(TooIntricate),
        }
    }

    #[cfg(test)]
    pub fn left(&self) -> u64 {
        self.0
    }

    #[cfg(test)]
    pub fn of(steps: u64) -> Self {
        Self(steps)
    }
}
