//! Collisions between two deforming meshes.

use glam::DVec3;

use super::detector::Detector;
use super::detector_search::Refit;
use super::given_motion::GivenMotion;
use crate::{Error, Impact, Pair};

impl Detector {
    /// Returns all pairs (triangle of this mesh at `positions`, triangle of the other at `other_positions`) that have a
    /// point in common, sorted. Every pair counts, unless there are groups of both meshes
    /// ([`TriangleGroups::of_meshes`](crate::TriangleGroups::of_meshes)); no other part of a contact filter applies.
    ///
    /// ```
    /// use sscc::glam::DVec3;
    /// use sscc::{Detector, TriMesh};
    ///
    /// # fn main() -> Result<(), sscc::Error> {
    /// // A triangle, and another one whose corner pierces it.
    /// let mesh = |corners: [DVec3; 3]| TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]);
    /// let plate = mesh([DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0])?;
    /// let needle = mesh([DVec3::new(1.0, 1.0, -0.5), DVec3::new(1.0, 1.0, 2.0), DVec3::new(2.0, 1.0, 2.0)])?;
    /// let (mut x, mut y) = (Detector::new(&plate), Detector::new(&needle));
    /// assert_eq!(x.against(plate.rest_positions(), &mut y, needle.rest_positions())?, [(0, 0)]);
    /// let lifted: Vec<DVec3> = needle.rest_positions().iter().map(|p| *p + DVec3::Z).collect();
    /// assert!(x.against(plate.rest_positions(), &mut y, &lifted)?.is_empty());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Detector::discrete`], for the positions of both meshes.
    pub fn against(
        &mut self,
        positions: &[DVec3],
        other: &mut Detector,
        other_positions: &[DVec3],
    ) -> Result<&[Pair], Error> {
        self.against_at_most(positions, other, other_positions, Self::MAX_PAIRS)?;
        self.check_complete()?;
        Ok(&self.discrete.narrow.0.list)
    }

    /// Returns at most `limit` pairs of [`Detector::against`], sorted; which ones is not fixed. Where the limit stopped the
    /// search, [`Statistics::complete`](crate::Statistics::complete) is false.
    ///
    /// # Errors
    /// As [`Detector::discrete_at_most`], for the positions of both meshes.
    pub fn against_at_most(
        &mut self,
        positions: &[DVec3],
        other: &mut Detector,
        other_positions: &[DVec3],
        limit: usize,
    ) -> Result<&[Pair], Error> {
        let motions = [self.check([positions])?, other.check([other_positions])?];
        let motions = in_common_frame(motions);
        self.begin_discrete(&motions[0], positions, Refit::Nodes);
        other.begin_discrete(&motions[1], other_positions, Refit::Nodes);
        let contexts = [&self.context, &other.context];
        let result = self.discrete.find_between(&mut other.discrete, contexts, &motions, limit);
        self.statistics.set_search(&mut self.discrete, result.is_ok());
        result?;
        self.discrete.narrow.0.list.sort_unstable();
        Ok(&self.discrete.narrow.0.list)
    }

    /// Returns all pairs (triangle of this mesh, triangle of the other) that collide while every vertex of both moves on a
    /// straight line, sorted by pair, each with its time of impact, with the same guarantee as
    /// [`Query::continuous`](crate::Query::continuous). Pairs count as for [`Detector::against`].
    ///
    /// # Errors
    /// As [`Detector::discrete`], for all positions.
    pub fn continuous_against(
        &mut self,
        [x_t0, x_t1]: [&[DVec3]; 2],
        other: &mut Detector,
        [y_t0, y_t1]: [&[DVec3]; 2],
    ) -> Result<&[Impact], Error> {
        let motions = in_common_frame([self.check([x_t0, x_t1])?, other.check([y_t0, y_t1])?]);
        self.begin_swept(&motions[0], x_t0, Refit::Nodes);
        other.begin_swept(&motions[1], y_t0, Refit::Nodes);
        let contexts = [&self.context, &other.context];
        let result = self.swept.find_between(&mut other.swept, contexts, &motions, Self::MAX_PAIRS);
        self.statistics.set_search(&mut self.swept, result.is_ok());
        result?;
        self.check_complete()?;
        self.swept.narrow.0.list.sort_unstable_by_key(|impact| impact.pair);
        Ok(&self.swept.narrow.0.list)
    }
}

/// Returns two motions in the frame of the AABB of both.
pub(super) fn in_common_frame<'x, const E: usize>(
    motions: [GivenMotion<'x, E>; 2],
) -> [GivenMotion<'x, E>; 2] {
    let whole = motions[0].aabb().union(&motions[1].aabb());
    motions.map(|motion| motion.in_frame_of(with_mutant!(whole, FramesOfTheirOwn, motion.aabb())))
}
