//! Check by the inertia of a shifted matrix that no eigenvalue is missing.

use crate::ModesError;
use crate::sparse::{Analysis, BlockSparse, count_negative_eigenvalues};

/// Relative positions of the shift within a gap between two eigenvalues, in the order of attempts.
const GAP_POSITIONS: [f64; 3] = [0.5, 0.3, 0.7];

/// Maximum number of gaps to try, the widest first.
const MAX_GAPS: usize = 2;

/// Result of a count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Count {
    /// Number of computed eigenvalues below a bound.
    pub found: usize,
    /// Number of existing eigenvalues below it, including rigid motions.
    pub counted: usize,
}

/// Counts the eigenvalues of `K x = lambda M x` up to a bound in the widest gap (relative) after the first `count` of
/// `values`, ascending. Tries the next gap if the count is uncertain by rounding; None if it is uncertain in all that
/// are tried.
pub(super) fn count_below_gap(
    stiffness: &BlockSparse,
    mass: &BlockSparse,
    analysis: &Analysis,
    values: &[f64],
    count: usize,
) -> Result<Option<Count>, ModesError> {
    let width = |k: usize| 1.0 - values[k - 1] / values[k];
    let mut gaps: Vec<usize> = (count.max(1)..values.len()).collect();
    gaps.sort_by(|a, b| width(*b).total_cmp(&width(*a)).then(a.cmp(b)));
    for gap in gaps.into_iter().take(MAX_GAPS) {
        for position in GAP_POSITIONS {
            let sigma = values[gap - 1] + position * (values[gap] - values[gap - 1]);
            let shifted = stiffness.combined(1.0, mass, -sigma);
            if let Some(counted) = count_negative_eigenvalues(&shifted, analysis)? {
                return Ok(Some(Count { found: gap, counted }));
            }
        }
    }
    Ok(None)
}
