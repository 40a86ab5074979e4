//! One search after the other for what counts, at one configuration or between two.

use std::sync::Arc;

use crate::detect::narrow_phase::Found;
use crate::detect::normal_cones::NormalCones;
use crate::detect::tables::Tables;
use crate::detect::volumes::Boxes;
use crate::filter::Relation;
use crate::query::context::{Asked, Ends};
use crate::query::{Method, Statistics};
use crate::{Error, Pair};

/// Triangles tested between two looks at whether the query was cancelled: one test may take a millisecond.
const TESTS: u64 = 64;

/// Finds what counts, and owns the memory for it. `E` is the number of configurations: 1, or the 2 ends of a motion.
#[derive(Clone)]
pub(crate) struct Finder<F, const E: usize> {
    pub(crate) boxes: Boxes<E>,
    /// Where the method uses them, at one configuration.
    cones: Option<NormalCones>,
    /// Pairs of nodes still to be looked at: see [`Finder::traverse`].
    pub(crate) stack: Vec<Pair>,
    /// The same for [`Finder::walk_pairs`].
    pub(crate) walk: Vec<(u32, u32, u32)>,
    pub(crate) found: Vec<F>,
    /// The search ends with this many.
    limit: usize,
    /// Whether it did, with something left to look at.
    full: bool,
    /// Whether the query was cancelled when it last looked.
    cancelled: bool,
    pub(crate) statistics: Statistics,
}

impl<F: Found<E>, const E: usize> Finder<F, E> {
    pub(crate) fn new(tables: &Arc<Tables>, method: Method) -> Self {
        Self {
            boxes: Boxes::new(tables, matches!(method, Method::Certified | Method::BdTree)),
            cones: NormalCones::new(tables.clusters.node_count(), method).filter(|_| E == 1),
            stack: Vec::new(),
            walk: Vec::new(),
            found: Vec::new(),
            limit: usize::MAX,
            full: false,
            cancelled: false,
            statistics: Statistics::default(),
        }
    }

    /// Forgets what was found, and starts a search for at most `limit`.
    #[inline]
    pub(crate) fn begin(&mut self, limit: usize) {
        self.found.clear();
        self.limit = limit;
        (self.full, self.cancelled) = (false, false);
        self.statistics = Statistics::default();
    }

    /// Finds what counts, sorted.
    #[inline]
    pub(crate) fn find(&mut self, asked: &Asked<'_>, ends: &Ends<'_, E>) -> Result<(), Error> {
        self.statistics.root_certified = asked.root_certifies(ends.norm);
        if !self.statistics.root_certified || !asked.exceptions().is_empty() {
            self.search(asked, ends)?;
        }
        self.statistics.complete = !self.full;
        Ok(())
    }

    fn search(&mut self, asked: &Asked<'_>, ends: &Ends<'_, E>) -> Result<(), Error> {
        if asked.method == Method::BruteForce {
            self.brute_force(asked, ends);
        } else {
            self.boxes.update(&asked.hierarchy, ends);
            if let Some(cones) = &mut self.cones {
                cones.update(&asked.hierarchy, &self.boxes);
            }
            self.test_exceptions(asked, ends);
            if !self.statistics.root_certified {
                self.search_by_boxes(asked, ends);
            }
        }
        self.outcome()?;
        self.found.sort_unstable_by_key(Found::pair);
        Ok(())
    }

    /// Adds all that is found, exceptions apart, by the boxes of this query.
    pub(crate) fn search_by_boxes(&mut self, asked: &Asked<'_>, ends: &Ends<'_, E>) {
        match asked.complete_pair_tree(ends.norm) {
            Some(tree) => self.walk_pairs(asked, tree, ends),
            None => self.traverse(asked, (0, 0), ends),
        }
    }

    /// Whether the normals of a node prove that it is free, if the method uses them.
    pub(crate) fn culled_by_normals(&mut self, n: u32) -> bool {
        self.cones.as_mut().is_some_and(|cones| cones.culls(n, &self.boxes))
    }

    /// Whether the limit is reached while there is still something to look at: then the answer is not complete.
    #[inline]
    pub(crate) fn is_full(&mut self) -> bool {
        self.full |= self.found.len() >= self.limit;
        self.full
    }

    /// Looks whether the query was cancelled: then the search is full at once.
    pub(crate) fn look(&mut self, asked: &Asked<'_>) {
        if asked.progress.is_cancelled() {
            (self.cancelled, self.limit) = (true, 0);
        }
    }

    /// Counts a test of two triangles, and looks now and then.
    #[inline]
    pub(crate) fn count_test(&mut self, asked: &Asked<'_>) {
        self.statistics.triangle_tests += 1;
        if self.statistics.triangle_tests.is_multiple_of(TESTS) {
            self.look(asked);
        }
    }

    /// An error, and nothing found, if the search was cancelled.
    pub(crate) fn outcome(&mut self) -> Result<(), Error> {
        if !self.cancelled {
            return Ok(());
        }
        self.found.clear();
        Err(Error::Cancelled)
    }

    /// Two triangles whose boxes overlap, each with the places of its corners.
    #[inline]
    pub(crate) fn test(
        &mut self,
        asked: &Asked<'_>,
        x: (u32, [u32; 3]),
        y: (u32, [u32; 3]),
        ends: &Ends<'_, E>,
    ) {
        if self.cancelled {
            return;
        }
        let (x, y) = if x.0 < y.0 { (x, y) } else { (y, x) };
        let pair = (x.0, y.0);
        let relation = asked.filter.relation(pair.0, pair.1);
        if relation == Relation::Adjacent {
            return;
        }
        self.count_test(asked);
        [x, y].iter().for_each(|(_, corners)| self.boxes.move_corners(*corners, ends));
        let [x, y] = [x, y].map(|(_, corners)| self.boxes.corners(corners));
        if let Some(found) = F::of(&asked.filter, relation, pair, &x, &y)
            && !asked.filter.is_excluded(pair.0, pair.1)
            && !asked.is_exception(pair)
            && !self.is_full()
        {
            self.found.push(found);
        }
    }
}
