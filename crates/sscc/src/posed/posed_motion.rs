//! `PosedMotion`: deformed positions in the world, the vertex motion of posed shapes.

use glam::DVec3;

use super::pose::Pose;
use crate::arithmetic::check_arithmetic;
use crate::detect::layout::Layout;
use crate::detect::vertex_motion::{InWorld, VertexMotion, rounding_bound};
use crate::geometry::Aabb;
use crate::{Error, ReducedModel};

/// A shape at some q and pose, or on straight lines from one configuration to another.
#[derive(Clone)]
pub(super) struct PosedMotion<const E: usize> {
    pub(super) q: [Vec<f64>; E],
    pub(super) pose: [Pose; E],
    /// An AABB that contains both compared shapes.
    pub(super) around: Aabb,
    /// An upper bound of the magnitude of every term of every position in the world.
    pub(super) reach: f64,
    /// An upper bound of the magnitude of every term of every position in axes of the model.
    own_reach: f64,
    /// See [`VertexMotion::margin`].
    pub(super) margin: f64,
}

impl<const E: usize> PosedMotion<E> {
    /// Creates the shape of a model at q = 0 in its own axes.
    ///
    /// # Errors
    /// When the model is beyond the range of numbers.
    pub(super) fn new(model: &ReducedModel) -> Result<Self, Error> {
        let q = vec![0.0; model.rank()];
        let reach = model.check_coordinates(&q)?;
        let q = std::array::from_fn(|_| q.clone());
        Ok(Self {
            q,
            pose: [Pose::default(); E],
            around: Aabb::default(),
            reach,
            own_reach: reach,
            margin: 0.0,
        })
    }

    /// Sets q and pose of each configuration. Returns an AABB of the shape in the world at all of them.
    ///
    /// # Errors
    /// When q has the wrong length or an entry is not finite, the shape leaves the range of numbers, or this thread's
    /// arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]).
    pub(super) fn place(
        &mut self,
        model: &ReducedModel,
        layout: &Layout,
        q: [&[f64]; E],
        pose: [&Pose; E],
    ) -> Result<Aabb, Error> {
        check_arithmetic()?;
        let (mut all, mut all_own) = (0.0_f64, 0.0_f64);
        for (q, pose) in q.into_iter().zip(pose) {
            let own = model.check_coordinates(q)?;
            (all, all_own) = (all.max(pose.check_reach(own)?), all_own.max(own));
        }
        (self.reach, self.own_reach, self.margin) = (all, all_own, 0.0);
        for end in 0..E {
            self.q[end].copy_from_slice(q[end]);
            self.pose[end] = *pose[end];
        }
        let [own_rounding, rounding] = [self.own_rounding(), self.rounding()];
        let whole = |end: usize| {
            let own = layout.bd_tree.root([&*self.q[end]], DVec3::splat(own_rounding));
            self.pose[end].apply_to_aabb(own, rounding)
        };
        Ok((1..with_mutant!(E, SweptWholeAtStart, 1)).fold(whole(0), |all, end| all.union(&whole(end))))
    }

    /// Returns the rounding bound of positions in axes of the model. Answers would be right without it: the reach in the world is
    /// at least the own one times the largest sum of magnitudes of a row of the rotation, and rounding bounds are four times the
    /// error, so that the bound in the world contains the error of own positions.
    fn own_rounding(&self) -> f64 {
        with_mutant!(rounding_bound(self.own_reach, self.q[0].len()), PosedOwnRoundingForgotten, 0.0)
    }

    /// Returns the length by which AABBs are widened in axes of the model, and again in the world, in addition to rounding.
    fn widening(&self) -> f64 {
        with_mutant!(self.margin, PosedMarginForgotten, 0.0)
    }
}

impl<const E: usize> VertexMotion<E> for PosedMotion<E> {
    /// The AABB around two shapes contains all positions of both.
    const HAS_ERROR_BOUND: bool = true;

    #[inline]
    fn rounding(&self) -> f64 {
        rounding_bound(self.reach, self.q[0].len()) + self.widening()
    }

    #[inline]
    fn margin(&self) -> f64 {
        self.margin
    }

    fn overall_aabb(&self, _: &Layout) -> Aabb {
        self.around
    }

    /// Returns `None` in a search for near pairs, which become contacts and must be those of exact positions.
    #[inline]
    fn coarse_coordinates(&self) -> Option<[&[f64]; E]> {
        // With a margin, coarse positions would be right, too, but imprecise: their error is more than four times
        // [`Self::rounding`], of which the margin is a part, and it widens boxes.
        with_mutant!(self.margin == 0.0, PosedCoarseWithMargin, true).then(|| self.q.each_ref().map(|q| &**q))
    }

    #[inline]
    fn in_world(&self) -> Option<InWorld<E>> {
        let maps = self.pose.map(|pose| (pose.rotation, pose.translation));
        Some(InWorld { maps, own_rounding: self.own_rounding() })
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
        let [own_widening, rounding] = [self.own_rounding() + self.widening(), self.rounding()];
        let at = |end: usize| {
            let own = layout.bd_tree.at(node, [&*self.q[end]], DVec3::splat(own_widening))?;
            Some(self.pose[end].apply_to_aabb(own, rounding))
        };
        (1..with_mutant!(E, PosedNodesAtStart, 1)).try_fold(at(0)?, |all, end| Some(all.union(&at(end)?)))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DMat3, DQuat};

    use super::*;
    use crate::detect::context::Context;
    use crate::detect::layout::Needs;
    use crate::detect::node_volumes::NodeVolumes;
    use crate::hierarchy::Hierarchy;
    use crate::test_models::Random;
    use crate::{ContactFilter, Modes, TriMesh};

    /// The AABB of a node in axes of the model and its image are both widened by the margin.
    #[test]
    fn node_aabbs_are_the_images_of_those_in_axes_of_the_model() {
        let random = &mut Random(6);
        let positions: Vec<DVec3> = (0..302)
            .map(|i| DVec3::new(f64::from(i / 2) * 0.02, f64::from(i % 2) * 0.03, 0.1 * random.signed()))
            .collect();
        let faces = (0..300).map(|i| [i, i + 1, i + 2]).collect();
        let modes = (0..302 * 3).map(|_| random.vector() * 0.2).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(3, modes).unwrap()).unwrap();
        let hierarchy = Arc::new(Hierarchy::build(&model, model.metric()));
        let filter = ContactFilter::default();
        let context = Context::new(&model, Arc::clone(&hierarchy), &filter, &[], Some(Needs::LAZY));
        let layout = &context.layout;
        let mut motion = PosedMotion::<2>::new(&model).unwrap();
        for case in 0..40 {
            let ends = [(); 2].map(|()| {
                let q = [(); 3].map(|()| random.signed());
                let columns = [(); 3].map(|()| random.vector() * 2.0);
                let rotation = DMat3::from_cols(columns[0], columns[1], columns[2]);
                (q, Pose { rotation, translation: random.vector() * 2.0 })
            });
            let (q, pose) = (ends.each_ref().map(|(q, _)| &q[..]), ends.each_ref().map(|(_, pose)| pose));
            motion.place(&model, layout, q, pose).unwrap();
            let own_reach = q.map(|q| model.check_coordinates(q).unwrap()).into_iter().fold(0.0, f64::max);
            assert_eq!(motion.in_world().unwrap().own_rounding, rounding_bound(own_reach, 3));
            motion.margin = [0.0, 0.3][case % 2];
            let margin = DVec3::splat(motion.margin);
            for bucket in 0..layout.buckets.count() as u32 {
                let node = layout.buckets.node(bucket);
                let Aabb { lower, upper } = motion.node_aabb(layout, node).unwrap();
                let images = q.into_iter().zip(pose).flat_map(|(q, pose)| {
                    let own = layout.bd_tree.at(node, [q], margin).unwrap();
                    let corners = (0..8_u32).map(move |i| {
                        let of_axis =
                            |axis: usize| if i >> axis & 1 == 0 { own.lower[axis] } else { own.upper[axis] };
                        DVec3::new(of_axis(0), of_axis(1), of_axis(2))
                    });
                    corners.map(move |corner| pose.apply(corner))
                });
                let expected = Aabb::of_points(images);
                for (found, expected) in [(lower, expected.lower - margin), (upper, expected.upper + margin)]
                {
                    assert!((found - expected).abs().max_element() < 1e-9, "case {case}: {found} {expected}");
                }
                for x in layout.buckets.vertices(bucket).iter().flat_map(|v| motion.positions(layout, *v)) {
                    let is_inside = (x - margin).cmpge(lower).all() && (x + margin).cmple(upper).all();
                    assert!(is_inside, "case {case}: {x} {lower} {upper}");
                }
            }
        }
    }

    /// The shapes are small or large in the frame, rotated, sheared and moved far away. The test also checks that AABBs contain
    /// all exact positions.
    #[test]
    fn coarse_positions_are_within_their_error_bound() {
        let random = &mut Random(4);
        let (mut coarse, mut worst) = (0, 0.0_f64);
        for case in 0..80 {
            let rank = [1, 5, 20][case % 3];
            let positions: Vec<DVec3> = (0..202)
                .map(|i| DVec3::new(f64::from(i / 2) * 0.02, f64::from(i % 2) * 0.03, 0.1 * random.signed()))
                .collect();
            let faces = (0..200).map(|i| [i, i + 1, i + 2]).collect();
            let modes = (0..202 * rank).map(|_| random.vector() * 0.2).collect();
            let mesh = TriMesh::new(positions, faces).unwrap();
            let model = ReducedModel::new(mesh, Modes::new(rank, modes).unwrap()).unwrap();
            let hierarchy = Arc::new(Hierarchy::build(&model, model.metric()));
            let filter = ContactFilter::default();
            let context = Context::new(&model, Arc::clone(&hierarchy), &filter, &[], Some(Needs::LAZY));
            let layout = &context.layout;
            let mut volumes = NodeVolumes::<2>::new(layout, true);
            let mut motion = PosedMotion::<2>::new(&model).unwrap();
            let size = 10.0_f64.powi(-(case as i32 % 4));
            let mut place = || {
                let q: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
                let turn = DMat3::from_quat(DQuat::from_scaled_axis(random.vector() * 3.0));
                let shear = DMat3::from_diagonal(DVec3::new(1.0, 0.7, 1.2)) * turn * size;
                let rotation = if case % 2 == 0 { turn } else { shear };
                (q, Pose { rotation, translation: random.vector() * 2.0 })
            };
            let ends = [place(), place()];
            let (q, pose) = (ends.each_ref().map(|(q, _)| &q[..]), ends.each_ref().map(|(_, pose)| pose));
            let whole = motion.place(&model, layout, q, pose).unwrap();
            motion.around =
                Aabb { lower: whole.lower - 3.0 * f64::from(case as u32 % 5), upper: whole.upper };
            volumes.begin(&hierarchy, &motion);
            let error = f64::from(volumes.corner_error());
            let frame = *volumes.frame();
            let mut most = 0.0_f64;
            let mut is_coarse = false;
            for bucket in 0..layout.buckets.count() as u32 {
                let node = layout.buckets.node(bucket);
                volumes.update_node(node, &motion);
                let before = *volumes.node(node);
                volumes.open_bucket(bucket, &motion);
                for (v, mapped) in volumes.mapped_vertices(bucket) {
                    let exact = motion.positions(layout, v);
                    let off = mapped.truncate().as_dvec3() - frame.linear(exact[0]);
                    most = most.max(off.abs().max_element());
                    is_coarse |= mapped != frame.map(exact[0]);
                    for aabb in [before, *volumes.node(node)] {
                        for x in exact.map(|x| frame.map(x)) {
                            let inside = x.cmpge(aabb.lower) & x.cmple(aabb.upper);
                            assert_eq!(inside.bitmask() & 0b111, 0b111, "case {case}");
                        }
                    }
                }
            }
            assert!(most <= error, "case {case}: {most} {error}");
            coarse += u32::from(is_coarse);
            if is_coarse {
                worst = worst.max(most / error);
            }
        }
        assert!(coarse > 50 && worst > 0.05, "{coarse} {worst}");
    }
}
