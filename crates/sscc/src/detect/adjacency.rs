//! Which pairs of triangles of two blocks never count.

use crate::detect::packet::LANES;
use crate::filter::{PairFilter, Relation};

/// Of vertices with more triangles than this, neighbours are told apart when they are met, by the [`PairFilter`]:
/// there are as many pairs as the square of the number of triangles.
const MOST_AROUND: usize = 24;

/// For each two blocks with adjacent triangles, which of their pairs never count. Of the triangles whose
/// boxes overlap, nearly all share a vertex (at rest, at least 19 of 20 on spring, bunny and dragon): they are never
/// met.
#[derive(Default)]
pub(crate) struct Never {
    /// For each block where its part of the list begins, and the end.
    starts: Vec<u32>,
    /// For each block: blocks not before it, ascending, itself first, and the pairs: bit `8 i + j` for triangle i of
    /// the first and j of the second block.
    pairs: Vec<(u32, u64)>,
}

/// Bits `8 i + j` with `j <= i`.
const NOT_AFTER: u64 = 0xff7f_3f1f_0f07_0301;

impl Never {
    /// Of triangles in blocks: `places[b]..places[b + 1]` are those of block b.
    pub(crate) fn new(places: &[u32], triangles: &[u32], filter: &PairFilter) -> Self {
        let members = |block: usize| &triangles[places[block] as usize..places[block + 1] as usize];
        // For each vertex class the triangles around it, as `8 block + lane`.
        let mut around: Vec<Vec<u32>> = vec![Vec::new(); filter.class_count()];
        for block in 0..places.len() - 1 {
            for (lane, &t) in members(block).iter().enumerate() {
                let own = (LANES * block + lane) as u32;
                for class in filter.vertex_classes(t) {
                    let all = &mut around[class as usize];
                    if all.last() != Some(&own) {
                        all.push(own);
                    }
                }
            }
        }
        let (mut starts, mut pairs) = (vec![0], Vec::new());
        let mut found: Vec<(u32, u64)> = Vec::new();
        for a in 0..places.len() - 1 {
            found.push((a as u32, NOT_AFTER));
            for (i, &t) in members(a).iter().enumerate() {
                let around = filter.vertex_classes(t).map(|class| &around[class as usize]);
                for &other in around.into_iter().filter(|all| all.len() <= MOST_AROUND).flatten() {
                    let (b, j) = (other as usize / LANES, other as usize % LANES);
                    if b >= a && filter.relation(t, members(b)[j]) == Relation::Adjacent {
                        found.push((b as u32, 1 << (LANES * i + j)));
                    }
                }
            }
            found.sort_unstable_by_key(|(b, _)| *b);
            let of_block = |same: &[(u32, u64)]| (same[0].0, same.iter().fold(0, |all, pair| all | pair.1));
            pairs.extend(found.chunk_by(|x, y| x.0 == y.0).map(of_block));
            starts.push(pairs.len() as u32);
            found.clear();
        }
        Self { starts, pairs }
    }

    /// The pairs of triangles of two blocks, a not after b, that never count: bit `8 i + j` for triangle i of a and j
    /// of b. For a = b also those with `j <= i`: each pair counts once.
    #[inline]
    pub(crate) fn pairs(&self, a: usize, b: usize) -> u64 {
        let all = &self.pairs[self.starts[a] as usize..self.starts[a + 1] as usize];
        all.iter().find(|(other, _)| *other == b as u32).map_or(0, |(_, pairs)| *pairs)
    }
}
