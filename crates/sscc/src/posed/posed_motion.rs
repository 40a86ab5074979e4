//! Deformed positions in the world: the vertex motion of posed shapes.

use glam::DVec3;

use super::pose::Pose;
use crate::detect::layout::Layout;
use crate::detect::vertex_motion::{VertexMotion, rounding_bound};
use crate::geometry::Aabb;
use crate::{Error, ReducedModel, limits};

/// A shape at some q and pose, or on straight lines from one to another.
#[derive(Clone)]
pub(super) struct PosedMotion<const E: usize> {
    pub(super) q: [Vec<f64>; E],
    pub(super) pose: [Pose; E],
    /// An AABB of approximately all shapes compared.
    pub(super) around: Aabb,
    /// An upper bound of the magnitude of every term of every position in the world.
    pub(super) reach: f64,
    /// See [`VertexMotion::margin`].
    pub(super) margin: f64,
}

impl<const E: usize> PosedMotion<E> {
    /// A shape of a model at q = 0 in its own axes.
    ///
    /// # Errors
    /// When the model is beyond the range of numbers.
    pub(super) fn new(model: &ReducedModel) -> Result<Self, Error> {
        let q = vec![0.0; model.rank()];
        let reach = model.check_coordinates(&q)?;
        let q = std::array::from_fn(|_| q.clone());
        Ok(Self { q, pose: [Pose::default(); E], around: Aabb::default(), reach, margin: 0.0 })
    }

    /// Sets q and pose of each configuration. Returns an AABB of the shape in the world at all of them.
    ///
    /// # Errors
    /// When q has the wrong length or an entry is not finite, or the shape leaves the range of numbers.
    pub(super) fn place(
        &mut self,
        model: &ReducedModel,
        layout: &Layout,
        places: [(&[f64], &Pose); E],
    ) -> Result<Aabb, Error> {
        let mut all = 0.0_f64;
        for (q, pose) in places {
            let reach = pose.reach(model.check_coordinates(q)?);
            // Rounding may carry a position a little beyond the exact reach. NaN is not seen in a maximum.
            let is_finite = pose.rotation.is_finite() && pose.translation.is_finite();
            if !(is_finite && reach * 1.001 <= limits::LARGEST) {
                return Err(Error::CoordinatesRange);
            }
            all = all.max(reach);
        }
        (self.reach, self.margin) = (all, 0.0);
        for (end, (q, pose)) in places.into_iter().enumerate() {
            self.q[end].copy_from_slice(q);
            self.pose[end] = *pose;
        }
        let rounding = self.rounding();
        let whole = |end: usize| {
            let own = layout.bd_tree.root([&*self.q[end]], DVec3::splat(rounding));
            self.pose[end].apply_to_aabb(own, rounding)
        };
        Ok((1..E).fold(whole(0), |all, end| all.union(&whole(end))))
    }
}

impl<const E: usize> VertexMotion<E> for PosedMotion<E> {
    /// The AABB around a swept shape contains all positions ([`SweptShape`](crate::SweptShape)).
    const HAS_ERROR_BOUND: bool = E == 2;

    #[inline]
    fn rounding(&self) -> f64 {
        rounding_bound(self.reach, self.q[0].len()) + self.margin
    }

    #[inline]
    fn margin(&self) -> f64 {
        self.margin
    }

    fn overall_aabb(&self, _: &Layout) -> Aabb {
        self.around
    }

    /// Coordinates in the world have no bound, so positions are exact.
    #[inline]
    fn coarse_coordinates(&self) -> Option<[&[f64]; E]> {
        None
    }

    #[inline]
    fn coarse_slack(&self, _: u32) -> Option<DVec3> {
        None
    }

    #[inline]
    fn positions(&self, layout: &Layout, vertex: u32) -> [DVec3; E] {
        let mut x = layout.vertices.position(vertex, self.q.each_ref().map(|q| &**q));
        x.iter_mut().zip(&self.pose).for_each(|(x, pose)| *x = pose.apply(*x));
        x
    }

    #[inline]
    fn node_aabb(&self, layout: &Layout, node: u32) -> Option<Aabb> {
        let rounding = self.rounding();
        let at = |end: usize| {
            let own = layout.bd_tree.at(node, [&*self.q[end]], DVec3::splat(rounding))?;
            Some(self.pose[end].apply_to_aabb(own, rounding))
        };
        (1..E).try_fold(at(0)?, |all, end| Some(all.union(&at(end)?)))
    }
}
