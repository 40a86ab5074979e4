//! Fine radii: those of the buckets and pairs of buckets that queries test most often, searched again with a smaller
//! error ([`Precision::Fine`]).
//!
//! The smallest radii are chosen, because queries reach them first: a number of single buckets, of pairs of buckets
//! that touch at the centre, and of other pairs. Hardly any AABB or plane separates the triangles of a bucket, or of
//! two that touch: wherever such a radius is reached, all of these triangles are moved and compared. Their
//! closest triangles are two rings apart on the surface, where a radius without subdivision is too small by a fifth in
//! the median. A fine search takes up to milliseconds, so the number of searches is limited
//! (docs/notes/bounds.md#fine-radii).

use super::bvtt::{Bvtt, BvttPair, PairState};
use super::executor::{Executor, Stage};
use super::preparation::Preparation;
use super::radius_bound::BoundedNodePair;
use super::search_goal::Precision;
use super::task::{NodeRadiusTask, Task, TaskResult};
use crate::Error;
use crate::hierarchy::Hierarchy;
use crate::model::rounding::to_f32_down;

/// One bucket is searched again for this many triangles of the mesh. Tests have small models.
const TRIANGLES_PER_BUCKET: usize = if cfg!(test) { 64 } else { 1024 };

/// One pair of buckets that touch is searched again for this many triangles.
const TRIANGLES_PER_TOUCHING_PAIR: usize = if cfg!(test) { 32 } else { 128 };

/// One other pair of buckets is searched again for this many triangles: it takes a tenth of the time.
const TRIANGLES_PER_PAIR: usize = 32;

/// The number of pairs that a thread takes at once.
const GRAIN: usize = 1;

/// Searches the radii of pairs of buckets below a limit again, then pulls the new bounds up to all pairs above them in the BVTT.
pub(super) fn refine_pairs(
    bvtt: &mut Bvtt,
    limit: f64,
    preparation: &Preparation,
    executor: &mut dyn Executor,
) -> Result<(), Error> {
    let hierarchy = &preparation.hierarchy;
    let pairs = &bvtt.pairs;
    let bounded = pairs.iter().enumerate().filter(|(_, pair)| pair.state() == PairState::Bounded);
    let (touching, others): (Vec<(usize, &BvttPair)>, Vec<_>) =
        bounded.partition(|(_, pair)| preparation.are_touching(pair.nodes));
    let choose = |pairs: Vec<(usize, &BvttPair)>, triangles: usize| {
        let radii = pairs.into_iter().map(|(index, pair)| (f64::from(pair.lower), index));
        smallest_below(limit, radii, at_most(hierarchy, triangles))
    };
    let chosen = [choose(touching, TRIANGLES_PER_TOUCHING_PAIR), choose(others, TRIANGLES_PER_PAIR)].concat();
    let task = |index: usize| {
        let BvttPair { nodes, lower, .. } = pairs[chosen[index]];
        let known = BoundedNodePair { nodes, lower: f64::from(lower) };
        Task::NodeRadius(NodeRadiusTask::between(known, Precision::Fine, limit))
    };
    let stage = Stage {
        count: chosen.len(),
        task: &task,
        grain: GRAIN,
        max_added_pairs: usize::MAX,
        on_finished: &|_| {},
    };
    let results = executor.run(&stage)?.unwrap_or_default();
    for (index, bound) in chosen.into_iter().zip(results.into_iter().map(TaskResult::into_bound)) {
        let pair = &mut bvtt.pairs[with_mutant!(index, FineRadiusOfAnother, index.saturating_sub(1))];
        pair.lower = pair.lower.max(to_f32_down(bound?.radius));
    }
    bvtt.pull_up(hierarchy);
    Ok(())
}

/// Returns the buckets whose radii are searched again: those below a limit, the smallest first.
pub(super) fn choose_buckets(
    limit: f64,
    buckets: &[usize],
    node_radii: &[f64],
    hierarchy: &Hierarchy,
) -> Vec<usize> {
    let radii = buckets.iter().map(|n| (node_radii[*n], *n));
    smallest_below(limit, radii, at_most(hierarchy, TRIANGLES_PER_BUCKET))
}

/// Returns the number of fine searches of a mesh: one for this many triangles.
fn at_most(hierarchy: &Hierarchy, triangles: usize) -> usize {
    hierarchy.order().len().div_ceil(triangles)
}

/// Returns the indices of the `most` smallest radii below a limit, smallest first, equal ones by their indices. A radius of 0 is
/// not among them: triangles touch, so no search makes it larger.
fn smallest_below(limit: f64, radii: impl Iterator<Item = (f64, usize)>, most: usize) -> Vec<usize> {
    let mut below: Vec<(f64, usize)> = radii.filter(|(radius, _)| 0.0 < *radius && *radius < limit).collect();
    below.sort_unstable_by(|(r, i), (s, j)| r.total_cmp(s).then(i.cmp(j)));
    below.truncate(most);
    below.into_iter().map(|(_, index)| index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificates::build::SearchGoal;
    use crate::certificates::test_models::ring;
    use crate::{Certificates, CertifyOptions};

    #[test]
    fn the_smallest_radii_are_chosen() {
        let radii = [3.0, 1.0, 0.0, 1.0, 2.0, 2.5];
        let smallest = |limit, most| smallest_below(limit, radii.into_iter().zip(0..radii.len()), most);
        assert_eq!(smallest(10.0, 9), [1, 3, 4, 5, 0]);
        assert_eq!(smallest(2.5, 9), [1, 3, 4]);
        assert_eq!(smallest(10.0, 1), [1]);
        assert!(smallest(0.0, 9).is_empty());
    }

    /// The radius of two buckets that touch is never above the upper bound of a full search, and mostly at least 0.95
    /// times its radius.
    #[test]
    fn radii_of_touching_buckets_are_fine() {
        let (mut all, mut close) = (0, 0);
        for case in 0..4 {
            let model = ring(160 + 40 * case, 3 + case % 3, 0.9 + case as f64);
            let options = CertifyOptions::default().budget(512);
            let certificates = Certificates::compute(&model, &options, &()).unwrap();
            let preparation = Preparation::new(&model, &options, &()).unwrap();
            let (tree, hierarchy) = (&certificates.parts().pair_tree, certificates.hierarchy());
            let mut search = preparation.search(&());
            for (index, nodes) in tree.pairs(hierarchy).unwrap().into_iter().enumerate() {
                if hierarchy.split_above_buckets(nodes.0, nodes.1).is_some()
                    || !preparation.are_touching(nodes)
                {
                    continue;
                }
                let goal = SearchGoal::new(tree.limit(), Precision::Full);
                let bound = search.between(vec![BoundedNodePair::unbounded(nodes)], goal).unwrap();
                let radius = f64::from(tree.entry(index).radius);
                assert!(radius <= bound.upper, "case {case}: {nodes:?}");
                all += 1;
                close += usize::from(radius >= 0.95 * bound.radius);
            }
        }
        assert!(all >= 10 && close * 10 >= all * 8, "{close} of {all}");
    }
}
