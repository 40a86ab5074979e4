//! Clamping of a configuration to the ellipsoid that the root's certificate proves free.

use super::Certificates;
use crate::Error;
use crate::arithmetic::check_arithmetic;

/// The maximum number of steps towards the centre: a few compensate for rounding, about a thousand for a norm that overflows.
const MAX_STEPS: usize = 4096;

impl Certificates {
    /// Returns q itself if it is inside the root's ellipsoid, else the last point inside it, up to rounding, on the
    /// line from the centre to q (if `|z|` at q overflows, some point of this line inside it). The root's certificate
    /// proves the result free. None if the root's radius is 0, if there are exceptions, which no radius covers, or if
    /// the certificates have a clearance, since triangles within its rings may collide.
    ///
    /// # Errors
    /// When the length of q is not the number of modes, an entry is not finite, or this thread's arithmetic is not that of
    /// IEEE 754 ([`Error::Arithmetic`]).
    pub fn clamp(&self, q: &[f64]) -> Result<Option<Vec<f64>>, Error> {
        let center = self.center();
        if q.len() != center.len() {
            return Err(Error::CoordinatesLength { found: q.len(), rank: center.len() });
        }
        if let Some(index) = q.iter().position(|x| !x.is_finite()) {
            return Err(Error::CoordinatesValue { index, value: q[index] });
        }
        check_arithmetic()?;
        let root = self.root_radius();
        let has_exceptions = with_mutant!(!self.exceptions().is_empty(), ClampedWithExceptions, false);
        let has_clearance = with_mutant!(self.clearance().is_some(), ClampedWithClearance, false);
        if root <= 0.0 || has_exceptions || has_clearance {
            return Ok(None);
        }
        let mut offset = vec![0.0; q.len()];
        let mut norm_at = |q: &[f64]| self.metric().norm_from(q, center, &mut offset);
        let mut clamped = q.to_vec();
        let norm = norm_at(&clamped);
        let mut scale = if norm.is_finite() { root / norm } else { 0.5 };
        for _ in 0..MAX_STEPS {
            let norm_here = norm_at(&clamped);
            if with_mutant!(norm_here < root, ClampedToTheRadius, norm_here <= root) {
                return Ok(Some(clamped));
            }
            for ((x, q), c) in clamped.iter_mut().zip(q).zip(center) {
                *x = c + (q - c) * scale;
            }
            scale *= 1.0 - 4.0 * f64::EPSILON;
            if norm.is_infinite() {
                scale *= 0.5;
            }
        }
        Ok(Some(center.to_vec()))
    }
}
