//! Free configurations near colliding ones, as the command reports them.

use std::fmt;

use serde::Serialize;
use sscc::{Certificates, Progress, Query, ReducedModel, ResolveOptions, Resolved};
use sscc_io::Rows;

use crate::error::Result;
use crate::text::length;

/// The free configuration near one q. The fields are the keys of its JSON; an infinite number is `null`.
#[derive(Clone, Debug, Serialize)]
pub struct ResolveReport {
    /// Whether a free configuration was found.
    pub resolved: bool,
    /// The free configuration.
    pub q: Option<Vec<f64>>,
    /// Its distance from q in the metric; infinite without a free configuration.
    pub change: f64,
    /// The distance from q of the last configuration on the line from the start to q that continuous queries prove
    /// free; infinite without a free configuration.
    pub safe_scale_change: f64,
}

impl From<Resolved> for ResolveReport {
    fn from(found: Resolved) -> Self {
        let resolved = found.is_resolved();
        let Resolved { q, change, safe_scale_change } = found;
        Self { resolved, q, change, safe_scale_change }
    }
}

impl ResolveReport {
    /// Whether the given q is its own result.
    pub fn is_free_as_given(&self) -> bool {
        self.resolved && self.change == 0.0
    }
}

impl fmt::Display for ResolveReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { q, change, safe_scale_change, .. } = self;
        match q {
            None => f.write_str("NOT RESOLVED: the centre collides"),
            Some(_) if self.is_free_as_given() => f.write_str("free as it is"),
            Some(_) => {
                let (change, back) = (length(*change), length(*safe_scale_change));
                write!(f, "resolved  change {change} (stepping back: {back})")
            }
        }
    }
}

/// Resolves every row, on this number of threads. The reports are in the order of the rows.
///
/// # Errors
/// When the certificates are of another model, a row is not a configuration of it, the start of the options is not a
/// configuration or collides, or `progress` cancels.
pub fn resolve_rows(
    model: &ReducedModel,
    certificates: &Certificates,
    rows: &Rows,
    options: &ResolveOptions,
    threads: usize,
    progress: &dyn Progress,
) -> Result<Vec<ResolveReport>> {
    let rows: Vec<&[f64]> = rows.iter().collect();
    let found = Query::new(model, certificates)?.resolve_batch(&rows, options, Some(threads), progress)?;
    Ok(found.into_iter().map(ResolveReport::from).collect())
}
