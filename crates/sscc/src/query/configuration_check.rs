//! The check that every query makes first: whether q is a configuration of the model, and its norm and reach.

use super::configuration::Configuration;
use super::context::QueryContext;
use super::valid_ball::ValidBall;
use crate::Error;

/// Checks and measures configurations.
#[derive(Clone)]
pub(super) struct ConfigurationCheck {
    valid_ball: ValidBall,
    /// Scratch for `q - center`; empty where the centre is 0.
    offset: Vec<f64>,
}

impl ConfigurationCheck {
    pub(super) fn new(context: &QueryContext) -> Self {
        let is_centered = context.scope.center.iter().all(|x| *x == 0.0);
        let offset = vec![0.0; if is_centered { 0 } else { context.model.rank() }];
        Self { valid_ball: ValidBall::new(context), offset }
    }

    /// Checks that q is a configuration of the model, and measures it.
    ///
    /// # Errors
    /// When q has the wrong length, an entry is not finite, or q moves vertices too far.
    #[inline(always)]
    pub(super) fn measure<'q>(
        &mut self,
        context: &QueryContext,
        q: &'q [f64],
    ) -> Result<Configuration<'q>, Error> {
        let scope = &context.scope;
        let norm = if q.len() != scope.center.len() {
            f64::INFINITY
        } else if self.offset.is_empty() {
            scope.metric.length(q)
        } else {
            scope.metric.norm_from(q, &scope.center, &mut self.offset)
        };
        let is_within = with_mutant!(norm < self.valid_ball.radius, ReachOfBallAnywhere, true);
        let reach = if is_within { self.valid_ball.reach } else { context.model.check_coordinates(q)? };
        Ok(Configuration { q, norm, reach })
    }
}
