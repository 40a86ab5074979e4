//! Jobs as bytes: some tasks of one stage, for a worker.
//!
//! The bytes are the stage's maximum number of added pairs, then the tasks in order. They carry lower bounds and caps
//! from earlier stages, so a worker needs nothing but its model. Bytes that are no job on the worker's hierarchy are refused.

use super::byte_reader::ByteReader;
use crate::certificates::build::{BoundedNodePair, NodeRadiusTask, Precision, SearchGoal, SplitTask, Task};
use crate::hierarchy::{Hierarchy, NodePair};

/// Tasks that one worker runs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Job {
    /// The maximum number of node pairs that the results may add.
    pub(super) max_added_pairs: usize,
    pub(super) tasks: Vec<Task>,
}

const SPLIT: u8 = 0;
const COARSE_RADIUS: u8 = 1;
const FULL_RADIUS: u8 = 2;
const FINE_RADIUS: u8 = 3;
const OUTER_SPLIT: u8 = 4;

/// Writes a job, task by task, so that not all of them need be in memory at once.
pub(super) struct JobWriter(Vec<u8>);

impl JobWriter {
    pub(super) fn new(max_added_pairs: usize) -> Self {
        Self((max_added_pairs as u64).to_le_bytes().to_vec())
    }

    pub(super) fn add(&mut self, task: &Task) {
        match task {
            Task::Split(task) => self.add_split(task),
            Task::NodeRadius(task) => self.add_radius(task),
        }
    }

    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.0
    }

    fn add_split(&mut self, task: &SplitTask) {
        self.0.push(if task.is_outer { OUTER_SPLIT } else { SPLIT });
        self.add_nodes(task.nodes);
        self.0.extend(task.lower.to_le_bytes());
        self.0.extend(task.limit.to_le_bytes());
    }

    fn add_radius(&mut self, task: &NodeRadiusTask) {
        let SearchGoal { cap, refine_up_to, precision } = task.goal;
        self.0.push(match precision {
            Precision::Coarse => COARSE_RADIUS,
            Precision::Fine => FINE_RADIUS,
            Precision::Full => FULL_RADIUS,
        });
        self.0.extend(task.node.to_le_bytes());
        self.0.extend(cap.to_le_bytes());
        self.0.extend(refine_up_to.to_le_bytes());
        self.0.extend((task.pairs.len() as u64).to_le_bytes());
        for pair in &task.pairs {
            self.add_nodes(pair.nodes);
            self.0.extend(pair.lower.to_le_bytes());
        }
    }

    fn add_nodes(&mut self, (n, m): NodePair) {
        self.0.extend(n.to_le_bytes());
        self.0.extend(m.to_le_bytes());
    }
}

impl Job {
    /// Reads a job. None if the bytes are no job on this hierarchy.
    pub(super) fn read(hierarchy: &Hierarchy, bytes: &[u8]) -> Option<Self> {
        let mut from = ByteReader::new(bytes);
        let max_added_pairs = usize::try_from(from.u64()?).ok()?;
        let mut tasks = Vec::new();
        while !from.is_at_end() {
            tasks.push(match from.u8()? {
                SPLIT => Task::Split(read_split(hierarchy, false, &mut from)?),
                OUTER_SPLIT => Task::Split(read_split(hierarchy, true, &mut from)?),
                COARSE_RADIUS => Task::NodeRadius(read_radius(hierarchy, Precision::Coarse, &mut from)?),
                FINE_RADIUS => Task::NodeRadius(read_radius(hierarchy, Precision::Fine, &mut from)?),
                FULL_RADIUS => Task::NodeRadius(read_radius(hierarchy, Precision::Full, &mut from)?),
                _ => return None,
            });
        }
        Some(Self { max_added_pairs, tasks })
    }
}

fn read_split(hierarchy: &Hierarchy, is_outer: bool, from: &mut ByteReader<'_>) -> Option<SplitTask> {
    let nodes = read_nodes(hierarchy, from)?;
    Some(SplitTask { nodes, lower: from.single_radius()?, limit: from.radius()?, is_outer })
}

fn read_radius(
    hierarchy: &Hierarchy,
    precision: Precision,
    from: &mut ByteReader<'_>,
) -> Option<NodeRadiusTask> {
    let node = from.u32()?;
    hierarchy.nodes().get(node as usize)?;
    let goal = SearchGoal { cap: from.radius()?, refine_up_to: from.radius()?, precision };
    let count = from.u64()?;
    // The count is untrusted: allocate only as pairs are read.
    let mut pairs = Vec::new();
    for _ in 0..count {
        pairs.push(BoundedNodePair { nodes: read_nodes(hierarchy, from)?, lower: from.radius()? });
    }
    Some(NodeRadiusTask { node, pairs, goal })
}

fn read_nodes(hierarchy: &Hierarchy, from: &mut ByteReader<'_>) -> Option<NodePair> {
    let (n, m) = (from.u32()?, from.u32()?);
    (n != m && n.max(m) < hierarchy.nodes().len() as u32).then_some((n, m))
}
