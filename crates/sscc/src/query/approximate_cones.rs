//! Normal cones without the contour test, with which the paper's section 7 compares. They serve benches only: **queries may miss
//! collisions**.
//!
//! The method is here, hidden from the documentation, because it is one line of a query's broad phase. In the crate of the benches it
//! would need the traversal, the layout and the narrow phase to be public.

use super::method::Method;
use super::query::Query;
use crate::{Certificates, Error, ReducedModel};

impl Query {
    /// Returns a query by [`Method::NormalCones`] without its contour test. A patch whose normals are all on the positive side of
    /// one direction can still meet itself (a ramp that winds over itself), so discrete queries may list too few pairs.
    /// Continuous queries are traditional, hence exact.
    ///
    /// # Errors
    /// As [`Query::with_method`].
    #[doc(hidden)]
    pub fn with_approximate_cones(model: &ReducedModel, certificates: &Certificates) -> Result<Self, Error> {
        let mut query = Self::with_method(model, certificates, Method::NormalCones)?;
        let cones = &mut query.discrete.certified.broad.cones;
        *cones = cones.take().map(|cones| cones.without_contour_test());
        Ok(query)
    }
}
