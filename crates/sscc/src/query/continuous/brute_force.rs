//! Every pair of triangles: the oracle for all other methods.

use super::super::Query;
use super::{Continuous, Ends};
use crate::Error;

impl Query<'_> {
    /// Adds all pairs that meet. No hierarchy, no certificates.
    pub(super) fn brute_force_impacts(&mut self, state: &mut Continuous, q: Ends<'_>) -> Result<(), Error> {
        state.boxes.move_all(self.model, q);
        let triangles = self.model.mesh().faces().len() as u32;
        for i in 0..triangles {
            if self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            (i + 1..triangles).for_each(|j| self.test_impact(state, (i, j)));
        }
        Ok(())
    }
}
