//! The certified pair tree: radii of pairs of nodes, so that a query ends where two neighbours touch.
//!
//! With radii of nodes alone a query walks along every common border of siblings that are not certified together: their
//! boxes always overlap. The tree stores the radius of every pair of nodes below a limit. It is built by the splitting
//! rule alone ([`Hierarchy::split`]), never by boxes: boxes that are apart at rest may meet later. So below the limit a
//! pair that is missing is certified; from the limit on, absence means nothing. Of pairs within small nodes it says
//! nothing.

use crate::Pair;
use crate::hierarchy::{Hierarchy, Node};

/// A link's flag: no sibling follows.
const LAST: u32 = 1 << 31;
/// Where a link says which child it is.
const WHICH: u32 = 28;
/// The part of a link that says where the children start.
const START: u32 = (1 << WHICH) - 1;

/// The start of the children of a node without stored pairs.
const NOTHING: u32 = u32::MAX;

/// The most entries: as many as links can name.
pub(in crate::certificates) const MOST_ENTRIES: usize = START as usize;

/// A pair of nodes that may collide below the limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    /// The radius, rounded down ([`round_down`]).
    pub(crate) radius: f32,
    /// Where its children start (0: none, both nodes are small), which child of its parent it is, and whether it is the
    /// last one.
    pub(crate) link: u32,
}

impl Entry {
    /// `which`: the child of the node that is split, or the place among the pairs of children of one node.
    pub(in crate::certificates) fn new(radius: f32, start: usize, which: usize, last: bool) -> Self {
        let link = start as u32 | (which as u32) << WHICH | if last { LAST } else { 0 };
        Self { radius, link }
    }

    /// Where its children start; 0 for none.
    pub(crate) fn start(self) -> u32 {
        self.link & START
    }

    /// Which child of its parent it is.
    pub(crate) fn which(self) -> u32 {
        (self.link & !LAST) >> WHICH
    }

    fn is_last(self) -> bool {
        self.link & LAST != 0
    }
}

/// A radius in single precision, rounded down.
pub(in crate::certificates) fn round_down(radius: f64) -> f32 {
    let rounded = radius as f32;
    let is_above = right_or!(f64::from(rounded) > radius, RadiusToNearest, false);
    let rounded = if is_above { rounded.next_down() } else { rounded };
    rounded.clamp(0.0, f32::MAX)
}

/// The pairs of a node's children, from which the tree is grown: none within small nodes, which queries look at as a
/// whole.
pub(crate) fn roots_of(hierarchy: &Hierarchy, n: u32) -> impl Iterator<Item = Pair> {
    let node = (!hierarchy.is_bucket_below_root(n)).then(|| &hierarchy.nodes()[n as usize]);
    node.into_iter().flat_map(Node::child_pairs)
}

/// The pairs of nodes that may collide below a limit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PairTree {
    limit: f64,
    /// For each node where its pairs of children start; `u32::MAX` where none is stored.
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

impl PairTree {
    /// Below this a pair that is not stored is certified, within small nodes apart. 0 where no pairs are stored.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// Number of pairs stored.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Memory of the pairs in bytes, 8 for each: what [`CertifyOptions::budget`](crate::CertifyOptions::budget) bounds.
    pub fn bytes(&self) -> usize {
        size_of_val(self.entries.as_slice())
    }

    /// Whether no pair is stored: none may collide below the limit.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// For each node where its pairs of children start; `u32::MAX` where none is stored, as within small nodes.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// For each pair its radius, rounded down, and its link: bits 0 to 27 say where its children start (0: none, both
    /// nodes are small), bits 28 to 30 which child it is, bit 31 that no sibling follows.
    pub fn entries(&self) -> impl ExactSizeIterator<Item = (f32, u32)> {
        self.entries.iter().map(|entry| (entry.radius, entry.link))
    }

    /// The entry of that place.
    pub(crate) fn entry(&self, place: usize) -> Entry {
        self.entries[place]
    }

    pub(in crate::certificates) fn new(limit: f64, starts: Vec<u32>, entries: Vec<Entry>) -> Self {
        Self { limit, starts, entries }
    }

    /// Takes a tree from its parts, as read from a file. Whether they are a tree over some hierarchy is
    /// checked where the two meet, by [`Certificates::from_parts`](crate::Certificates::from_parts).
    pub fn from_parts(limit: f64, starts: Vec<u32>, entries: impl IntoIterator<Item = (f32, u32)>) -> Self {
        let entries = entries.into_iter().map(|(radius, link)| Entry { radius, link }).collect();
        Self { limit, starts, entries }
    }

    /// The pair of nodes of each entry, once all of the tree has been found to be over this hierarchy, in order.
    pub(crate) fn pairs(&self, hierarchy: &Hierarchy) -> Result<Vec<Pair>, &'static str> {
        if self.limit.is_nan() || self.limit < 0.0 || self.limit.is_infinite() {
            return Err("its limit is negative or not finite");
        }
        if self.limit == 0.0 {
            let is_empty = self.entries.is_empty() && self.starts.is_empty();
            return if is_empty { Ok(Vec::new()) } else { Err("it has pairs, but no limit") };
        }
        let nodes = hierarchy.nodes();
        if self.starts.len() != nodes.len() {
            return Err("there is not one start for each node");
        }
        if self.entries.len() > MOST_ENTRIES {
            return Err("it has more pairs than links can name");
        }
        // Breadth first, each list of siblings right after the one before: what is visited is visited once.
        let mut pairs: Vec<Pair> = Vec::new();
        for (n, start) in self.starts.iter().enumerate() {
            if *start == NOTHING {
                continue;
            }
            let all: Vec<_> = roots_of(hierarchy, n as u32).collect();
            self.append(*start, 0.0, all.len(), |which| all[which], &mut pairs)?;
        }
        let mut at = 0;
        while let Some(&(n, m)) = pairs.get(at) {
            let entry = self.entries[at];
            match hierarchy.split_above_buckets(n, m) {
                None if entry.start() != 0 => return Err("a pair of small nodes has children"),
                None => {}
                Some(split) => {
                    let (count, pair) = (split.children().len(), |which| split.pair(which as u32));
                    self.append(entry.start(), entry.radius, count, pair, &mut pairs)?;
                }
            }
            at += 1;
        }
        if at == self.entries.len() { Ok(pairs) } else { Err("some pairs have no parent") }
    }

    /// Appends the pairs of a list of siblings whose parent has the radius `least`.
    fn append(
        &self,
        start: u32,
        least: f32,
        count: usize,
        pair: impl Fn(usize) -> Pair,
        pairs: &mut Vec<Pair>,
    ) -> Result<(), &'static str> {
        if start as usize != pairs.len() {
            return Err("lists of siblings are out of order");
        }
        let mut next = 0;
        for entry in self.entries.get(start as usize..).unwrap_or_default() {
            if entry.radius.is_nan() || entry.radius < 0.0 {
                return Err("a radius is negative or not a number");
            }
            if f64::from(entry.radius) >= self.limit {
                return Err("a radius is not below the limit");
            }
            if entry.radius < least {
                return Err("a pair's radius exceeds that of a child");
            }
            let which = entry.which() as usize;
            if which < next || which >= count {
                return Err("a child is listed twice or does not exist");
            }
            next = which + 1;
            pairs.push(pair(which));
            if entry.is_last() {
                return Ok(());
            }
        }
        Err("a list of siblings does not end")
    }

    /// The stored siblings that start there, each with its place.
    #[inline]
    pub(crate) fn siblings(&self, start: u32) -> impl Iterator<Item = (u32, Entry)> {
        let mut next = if start == NOTHING { None } else { Some(start) };
        std::iter::from_fn(move || {
            let at = next?;
            let entry = self.entries[at as usize];
            next = if entry.is_last() { None } else { Some(at + 1) };
            Some((at, entry))
        })
    }

    /// The stored pairs of a node's children; none within small nodes.
    #[inline]
    pub(crate) fn of_node(&self, node: u32) -> impl Iterator<Item = (u32, Entry)> {
        self.siblings(self.starts[node as usize])
    }

    /// The stored children of a pair that has some.
    #[inline]
    pub(crate) fn below(&self, place: u32) -> impl Iterator<Item = (u32, Entry)> {
        self.siblings(self.entries[place as usize].start())
    }
}
