//! Job results as bytes: the results of the tasks, in order. For a split pair only states and lower bounds are written;
//! [`Hierarchy::split_above_buckets`] gives the node pairs, so a reader needs the task.

use super::byte_reader::ByteReader;
use crate::certificates::build::{BvttPair, PairState, RadiusBound, Task, TaskResult};
use crate::hierarchy::{Hierarchy, NodePair};

/// The first byte of results that exceed the maximum number of added pairs.
const OUT_OF_ROOM: u8 = 0;

/// The first byte of results within that maximum.
const COMPLETE: u8 = 1;

const OPEN: u8 = 0;
const BOUNDED: u8 = 1;
const SPLIT: u8 = 2;

/// The layout of a task's result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ResultLayout {
    /// The pair that is split.
    Split(NodePair),
    NodeRadius,
}

impl ResultLayout {
    pub(super) fn of(task: &Task) -> Self {
        match task {
            Task::Split(task) => Self::Split(task.nodes),
            Task::NodeRadius(_) => Self::NodeRadius,
        }
    }
}

/// The result of a job.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum JobResult {
    /// The results would add too many node pairs.
    OutOfRoom,
    Complete(Vec<TaskResult>),
}

impl JobResult {
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let Self::Complete(results) = self else { return vec![OUT_OF_ROOM] };
        let mut bytes = vec![COMPLETE];
        for result in results {
            match result {
                TaskResult::Split(subtree) => subtree.iter().for_each(|pair| write_pair(pair, &mut bytes)),
                TaskResult::NodeRadius(RadiusBound { radius, upper }) => {
                    bytes.extend(radius.to_le_bytes());
                    bytes.extend(upper.to_le_bytes());
                }
            }
        }
        bytes
    }

    /// Reads the results of some tasks. None if the bytes are no such results.
    pub(super) fn read(hierarchy: &Hierarchy, layouts: &[ResultLayout], bytes: &[u8]) -> Option<Self> {
        let mut from = ByteReader::new(bytes);
        let result = match from.u8()? {
            OUT_OF_ROOM => Self::OutOfRoom,
            COMPLETE => {
                let read = |layout: &ResultLayout| read_result(hierarchy, *layout, &mut from);
                Self::Complete(layouts.iter().map(read).collect::<Option<_>>()?)
            }
            _ => return None,
        };
        from.is_at_end().then_some(result)
    }
}

fn write_pair(pair: &BvttPair, bytes: &mut Vec<u8>) {
    bytes.push(match pair.state() {
        PairState::Open => OPEN,
        PairState::Bounded => BOUNDED,
        PairState::Split(_) => SPLIT,
    });
    bytes.extend(pair.lower.to_le_bytes());
}

fn read_result(hierarchy: &Hierarchy, layout: ResultLayout, from: &mut ByteReader<'_>) -> Option<TaskResult> {
    Some(match layout {
        ResultLayout::Split(nodes) => TaskResult::Split(read_subtree(hierarchy, nodes, from)?),
        ResultLayout::NodeRadius => {
            TaskResult::NodeRadius(RadiusBound { radius: from.radius()?, upper: from.radius()? })
        }
    })
}

fn read_subtree(hierarchy: &Hierarchy, nodes: NodePair, from: &mut ByteReader<'_>) -> Option<Vec<BvttPair>> {
    let mut subtree = vec![BvttPair::open(nodes, 0.0)];
    let mut next = 0;
    while next < subtree.len() {
        let (n, m) = subtree[next].nodes;
        let split = hierarchy.split_above_buckets(n, m);
        let (state, lower) = (from.u8()?, from.single_radius()?);
        let state = match (state, &split) {
            (OPEN, _) => PairState::Open,
            (BOUNDED, None) => PairState::Bounded,
            (SPLIT, Some(_)) => PairState::Split(subtree.len() as u32),
            _ => return None,
        };
        subtree[next].lower = lower;
        subtree[next].set_state(state);
        if let (PairState::Split(_), Some(split)) = (state, split) {
            subtree.extend(split.pairs().map(|nodes| BvttPair::open(nodes, lower)));
        }
        next += 1;
    }
    Some(subtree)
}
