//! Parser for the section `$Nodes`.

use glam::DVec3;

use super::numbers::Numbers;
use super::version::Version;
use crate::FormatError;
use crate::solid::builder::Builder;

const LAST_NODE: &str = "the last node";

/// Tags of nodes: any numbers, in any order.
pub(super) struct Nodes {
    /// Tags with the indices of their vertices, sorted.
    tags: Vec<(u64, u64)>,
}

impl Nodes {
    /// Reads the section; `parametric` nodes of version 2 have further numbers.
    pub fn read(
        numbers: &mut Numbers,
        version: Version,
        parametric: bool,
        builder: &mut Builder,
    ) -> Result<Self, FormatError> {
        let mut tags = Vec::new();
        match version {
            Version::V2 => {
                let count = numbers.words.count("the number of nodes")?;
                numbers.words.rest_of_line();
                for _ in 0..count {
                    tags.push(numbers.tag(LAST_NODE)?);
                    vertex(numbers, builder)?;
                    if parametric {
                        numbers.words.rest_of_line();
                    }
                }
            }
            Version::V4 => {
                let blocks = numbers.size("the number of blocks")?;
                let count = numbers.size("the number of nodes")?;
                numbers.size("the smallest tag")?;
                numbers.size("the largest tag")?;
                for _ in 0..blocks {
                    block(numbers, &mut tags, builder)?;
                }
                if tags.len() as u64 != count {
                    return numbers
                        .refused(format!("the section has {} nodes, but declares {count}", tags.len()));
                }
            }
        }
        let mut tags: Vec<_> = tags.into_iter().zip(0..).collect();
        tags.sort_unstable();
        match tags.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => numbers.refused(format!("two nodes have the tag {}", pair[0].0)),
            None => Ok(Self { tags }),
        }
    }

    /// Returns the vertex of the node with this tag.
    pub fn vertex(&self, tag: u64) -> Option<u64> {
        let at = self.tags.binary_search_by_key(&tag, |(tag, _)| *tag).ok()?;
        Some(self.tags[at].1)
    }
}

/// Reads all tags of a block, then all positions, each with up to 3 parameters.
fn block(numbers: &mut Numbers, tags: &mut Vec<u64>, builder: &mut Builder) -> Result<(), FormatError> {
    let dimension = numbers.integer(LAST_NODE)?;
    numbers.integer(LAST_NODE)?; // the entity
    let parameters = match (numbers.integer(LAST_NODE)?, dimension) {
        (0, 0..=3) => 0,
        (1, 0..=3) => dimension,
        (parametric, _) => {
            return numbers
                .refused(format!("dimension {dimension} with parametric {parametric} is not supported"));
        }
    };
    let count = numbers.size("the number of nodes in a block")?;
    for _ in 0..count {
        tags.push(numbers.size(LAST_NODE)?);
    }
    for _ in 0..count {
        vertex(numbers, builder)?;
        for _ in 0..parameters {
            numbers.number(LAST_NODE)?;
        }
    }
    Ok(())
}

fn vertex(numbers: &mut Numbers, builder: &mut Builder) -> Result<(), FormatError> {
    let position =
        DVec3::new(numbers.number(LAST_NODE)?, numbers.number(LAST_NODE)?, numbers.number(LAST_NODE)?);
    builder.vertex(position, numbers.place())
}
