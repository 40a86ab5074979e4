//! The smallest distance between two triangles of a mesh, or of two meshes. The search visits pairs of nodes, the nearer boxes first,
//! while their boxes are nearer than the nearest triangles so far.

use glam::DVec3;

use super::boxes::Boxes;
use super::detector::Detector;
use crate::detect::narrow_phase::NearPair;
use crate::filter::{Relation, Rings};
use crate::geometry::Aabb;
use crate::hierarchy::NodePair;
use crate::{Error, distance_triangle_triangle};

/// Pairs of nodes visited between two checks whether the search was cancelled.
const VISITS_PER_CHECK: u64 = 1024;

/// Returns the distance of two boxes: a lower bound of that of points in them, up to rounding.
fn distance_between(a: &Aabb, b: &Aabb) -> f64 {
    let gaps = (b.lower - a.upper).max(a.lower - b.upper).max(DVec3::ZERO);
    // Scaling prevents overflow and underflow of squares.
    let largest = gaps.max_element();
    if largest > 0.0 { (gaps / largest).length() * largest } else { 0.0 }
}

impl Detector {
    /// Returns the nearest two triangles at these positions that count and are not within `rings` rings of each other on the surface (1:
    /// have no common vertex; see [`Clearance::beyond_rings`](crate::Clearance::beyond_rings)), with their distance. It differs from the
    /// smallest distance by at most the error of [`distance_triangle_triangle`], and is 0 if any such pair collides. `None` if no pair
    /// counts.
    ///
    /// # Errors
    /// As [`Detector::discrete_at_most`].
    pub fn nearest(&mut self, positions: &[DVec3], rings: u32) -> Result<Option<NearPair>, Error> {
        self.check([positions])?;
        let filter = &self.context.filter;
        let mut rings = (rings > 1).then(|| Rings::new(filter, rings));
        let counts = |a: u32, b: u32| {
            a != b
                && filter.relation(a, b) == Relation::NonAdjacent
                && !filter.is_excluded(a, b)
                && !rings.as_mut().is_some_and(|rings| rings.contain(filter, a, b))
        };
        let boxes = Boxes::new(&self.context, positions);
        let found = nearest([&boxes, &boxes], true, counts);
        self.statistics.finish(found)
    }

    /// Returns the nearest two triangles (triangle of this mesh at `positions`, triangle of the other at
    /// `other_positions`) that count as for [`Detector::against`], with their distance. `None` if no pair counts.
    ///
    /// # Errors
    /// As [`Detector::discrete_at_most`], for the positions of both meshes.
    pub fn nearest_against(
        &mut self,
        positions: &[DVec3],
        other: &mut Detector,
        other_positions: &[DVec3],
    ) -> Result<Option<NearPair>, Error> {
        self.check([positions])?;
        other.check([other_positions])?;
        let boxes = [(&self.context, positions), (&other.context, other_positions)];
        let [one, two] = boxes.map(|(context, positions)| Boxes::new(context, positions));
        let groups = self.context.filter.groups_against(&other.context.filter);
        let counts = |a: u32, b: u32| groups.is_none_or(|groups| groups.is_counted((a, b)));
        let found = nearest([&one, &two], false, counts);
        self.statistics.finish(found)
    }
}

/// Returns the nearest pair of triangles that counts, of one mesh with itself (`is_self`: both arguments are the same mesh) or of two.
///
/// # Errors
/// When the token of the first mesh cancels.
fn nearest(
    boxes: [&Boxes<'_>; 2],
    is_self: bool,
    mut counts: impl FnMut(u32, u32) -> bool,
) -> Result<Option<NearPair>, Error> {
    let [one, two] = boxes;
    let mut best: Option<NearPair> = None;
    // Boxes farther apart than this contain no nearer pair. The added share covers the rounding of distances of boxes.
    let mut most = f64::INFINITY;
    let bound = |(n, m): NodePair| distance_between(&one.of_nodes[n as usize], &two.of_nodes[m as usize]);
    let mut open = vec![((0, 0), bound((0, 0)))];
    let (mut parts, mut visits) = (Vec::new(), 0_u64);
    while let Some(((n, m), least)) = open.pop() {
        if visits.is_multiple_of(VISITS_PER_CHECK) && one.context.is_cancelled() {
            return Err(Error::Cancelled);
        }
        visits += 1;
        if with_mutant!(least > most, NearestTakenFirst, best.is_some()) {
            continue;
        }
        if !(one.is_leaf(n) && two.is_leaf(m)) {
            parts.clear();
            let pairs = one.parts(n).flat_map(|i| two.parts(m).map(move |j| (i, j)));
            // With one mesh each pair of nodes is visited once.
            let pairs = pairs.filter(|(i, j)| {
                !(is_self && n == m && with_mutant!(i > j, NearestBetweenNodesAlone, i >= j))
            });
            parts.extend(pairs.map(|pair| (pair, bound(pair))).filter(|(_, least)| *least <= most));
            parts.sort_unstable_by(|a, b| b.1.total_cmp(&a.1));
            open.append(&mut parts);
            continue;
        }
        for &a in one.triangles(n) {
            // The rings of one triangle may take as long as those of all others.
            if one.context.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let corners = one.corners(a);
            for &b in two.triangles(m) {
                if is_self && (a == b || n == m && a > b) {
                    continue;
                }
                let others = two.corners(b);
                let of = |x: &[DVec3; 3]| Aabb::of_points(x.iter().copied());
                if distance_between(&of(&corners), &of(&others)) > most || !counts(a, b) {
                    continue;
                }
                // The rounding of a distance depends on the order of the two triangles, so that the order is fixed.
                let is_turned = is_self && a > b;
                let (x, y) = if is_turned { (&others, &corners) } else { (&corners, &others) };
                let distance = distance_triangle_triangle(x, y);
                if best.is_none_or(|best| distance < best.distance) {
                    best = Some(NearPair { pair: if is_turned { (b, a) } else { (a, b) }, distance });
                    most = with_mutant!(
                        distance * (1.0 + 1e-12) + f64::MIN_POSITIVE,
                        NearestBoxesExact,
                        distance
                    );
                }
            }
        }
        if best.is_some_and(|best| best.distance == 0.0) {
            break;
        }
    }
    Ok(best)
}
