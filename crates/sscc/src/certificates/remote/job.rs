//! Jobs and their results as bytes: some tasks of one stage, and what they came to.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::seal::Reader;
use crate::certificates::build::pair_tree_builder::{BOUNDED, Grown, OPEN, Round, expand};
use crate::certificates::build::search::Precision;
use crate::certificates::build::task::{NodeTask, Prepared};
use crate::hierarchy::Hierarchy;
use crate::{Error, Progress};

/// Tasks of one stage.
pub(in crate::certificates) enum Job {
    Grow(Round, Vec<Grown>),
    Radii(Precision, Vec<NodeTask>),
}

const GROW: u8 = 0;
const ROUGH: u8 = 1;
const FULL: u8 = 2;

/// More pairs than there is room for.
const TOO_MANY: u8 = 0;
const COMPLETE: u8 = 1;

/// What became of a pair.
const IS_OPEN: u8 = 0;
const IS_BOUNDED: u8 = 1;
const IS_SPLIT: u8 = 2;

impl Job {
    pub(in crate::certificates) fn write(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        match self {
            Self::Grow(Round { limit, most, room }, pairs) => {
                bytes.push(GROW);
                bytes.extend(limit.to_le_bytes());
                bytes.extend(most.to_le_bytes());
                bytes.extend((*room as u64).to_le_bytes());
                for Grown { pair: (n, m), lower, .. } in pairs {
                    bytes.extend(n.to_le_bytes());
                    bytes.extend(m.to_le_bytes());
                    bytes.extend(lower.to_le_bytes());
                }
            }
            Self::Radii(precision, tasks) => {
                bytes.push(if *precision == Precision::Rough { ROUGH } else { FULL });
                for task in tasks {
                    bytes.extend(task.node.to_le_bytes());
                    bytes.extend(task.cap.to_le_bytes());
                    bytes.extend(task.enough.to_le_bytes());
                    bytes.extend((task.pairs.len() as u64).to_le_bytes());
                    for ((n, m), lower) in &task.pairs {
                        bytes.extend(n.to_le_bytes());
                        bytes.extend(m.to_le_bytes());
                        bytes.extend(lower.to_le_bytes());
                    }
                }
            }
        }
        bytes
    }

    /// None where the bytes are no job on this hierarchy.
    pub(in crate::certificates) fn read(hierarchy: &Hierarchy, bytes: &[u8]) -> Option<Self> {
        let mut from = Reader(bytes);
        let precision = match from.u8()? {
            GROW => {
                let (limit, most) = (from.radius()?, from.radius()?);
                let round = Round { limit, most, room: usize::try_from(from.u64()?).ok()? };
                let mut pairs = Vec::new();
                while !from.0.is_empty() {
                    pairs.push(Grown::new(read_pair(hierarchy, &mut from)?, from.single()?));
                }
                return Some(Self::Grow(round, pairs));
            }
            ROUGH => Precision::Rough,
            FULL => Precision::Full,
            _ => return None,
        };
        let mut tasks = Vec::new();
        while !from.0.is_empty() {
            let (node, cap, enough) = (from.u32()?, from.radius()?, from.radius()?);
            hierarchy.nodes().get(node as usize)?;
            let mut pairs = Vec::new();
            for _ in 0..from.u64()? {
                pairs.push((read_pair(hierarchy, &mut from)?, from.radius()?));
            }
            tasks.push(NodeTask { node, cap, enough, pairs });
        }
        Some(Self::Radii(precision, tasks))
    }

    /// The result, written.
    pub(in crate::certificates) fn solve(
        self,
        prepared: &Prepared,
        progress: &dyn Progress,
    ) -> Result<Vec<u8>, Error> {
        let mut search = prepared.search(progress);
        let mut bytes = Vec::new();
        match self {
            Self::Grow(round, pairs) => {
                let used = AtomicUsize::new(0);
                bytes.push(COMPLETE);
                for pair in pairs {
                    for Grown { first, lower, .. } in
                        expand(pair, round, &prepared.hierarchy, &mut search, &used, progress)
                    {
                        bytes.push(match first {
                            OPEN => IS_OPEN,
                            BOUNDED => IS_BOUNDED,
                            _ => IS_SPLIT,
                        });
                        bytes.extend(lower.to_le_bytes());
                    }
                    if used.load(Ordering::Relaxed) > round.room {
                        bytes = vec![TOO_MANY];
                        break;
                    }
                }
            }
            Self::Radii(precision, tasks) => {
                search.set_precision(precision);
                for task in tasks {
                    let (radius, upper) = task.solve(prepared, &mut search);
                    bytes.extend(radius.to_le_bytes());
                    bytes.extend(upper.to_le_bytes());
                }
            }
        }
        if progress.is_cancelled() { Err(Error::Cancelled) } else { Ok(bytes) }
    }
}

fn read_pair(hierarchy: &Hierarchy, from: &mut Reader<'_>) -> Option<(u32, u32)> {
    let pair @ (n, m) = (from.u32()?, from.u32()?);
    (n != m && n.max(m) < hierarchy.nodes().len() as u32).then_some(pair)
}

/// Whether a result of growing says that there were more pairs than there is room for.
pub(in crate::certificates) fn too_many(result: &[u8]) -> bool {
    result == [TOO_MANY]
}

/// The lists that open pairs became. Pairs are not written: they follow from how nodes are split.
pub(in crate::certificates) fn read_grown(
    hierarchy: &Hierarchy,
    pairs: &[Grown],
    result: &[u8],
) -> Option<Vec<Vec<Grown>>> {
    let mut from = Reader(result);
    if from.u8()? != COMPLETE {
        return None;
    }
    let mut lists = Vec::with_capacity(pairs.len());
    for pair in pairs {
        let mut list = vec![*pair];
        let mut next = 0;
        while next < list.len() {
            let (n, m) = list[next].pair;
            let split = hierarchy.split_above_buckets(n, m);
            let state = from.u8()?;
            let lower = from.single()?;
            list[next].lower = lower;
            list[next].first = match (state, &split) {
                (IS_OPEN, _) => OPEN,
                (IS_BOUNDED, None) => BOUNDED,
                (IS_SPLIT, Some(_)) => list.len() as u32,
                _ => return None,
            };
            if state == IS_SPLIT {
                list.extend(split.into_iter().flat_map(|split| split.pairs()).map(|p| Grown::new(p, lower)));
            }
            next += 1;
        }
        lists.push(list);
    }
    from.0.is_empty().then_some(lists)
}

/// Radii and upper bounds of so many tasks.
pub(in crate::certificates) fn read_radii(count: usize, result: &[u8]) -> Option<Vec<(f64, f64)>> {
    let mut from = Reader(result);
    let radii = (0..count).map(|_| Some((from.radius()?, from.radius()?))).collect::<Option<Vec<_>>>()?;
    from.0.is_empty().then_some(radii)
}
