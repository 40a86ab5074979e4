//! Changes of pair trees, for tests.

use sscc::parts::PairTree;

/// The bit of a link that marks the last sibling.
pub const LAST: u32 = 1 << 31;
/// The bits of a link that are the start of its children.
pub const START: u32 = (1 << 28) - 1;

/// Returns the tree without the given entries and all entries below them, and without inner entries that lost all
/// children; `change` returns the new radius of each other entry.
pub fn edited(
    tree: &PairTree,
    limit: f64,
    removed: &[usize],
    change: impl Fn(usize, f32) -> f32,
) -> PairTree {
    let entries: Vec<(f32, u32)> = tree.entries().collect();
    let is_inner = |at: usize| entries[at].1 & START != 0;
    let mut kept: Vec<bool> = (0..entries.len()).map(|at| !removed.contains(&at)).collect();
    // Children come after their parents. Removes entries below removed ones first, then inner entries without children.
    for at in 0..entries.len() {
        for child in children(&entries, at) {
            kept[child] &= kept[at];
        }
    }
    for at in (0..entries.len()).rev() {
        kept[at] &= !is_inner(at) || children(&entries, at).any(|child| kept[child]);
    }
    let mut places = vec![0; entries.len()];
    let mut next = 0;
    for at in 0..entries.len() {
        places[at] = next;
        next += u32::from(kept[at]);
    }
    let start_of = |list: Vec<usize>| list.into_iter().find(|at| kept[*at]).map(|at| places[at]);
    let start_of_node = |start: &u32| {
        let list = if *start == u32::MAX { Vec::new() } else { list(&entries, *start as usize) };
        start_of(list).unwrap_or(u32::MAX)
    };
    let starts = tree.starts().iter().map(start_of_node).collect();
    let mut changed: Vec<(f32, u32)> = Vec::new();
    for (at, &(radius, link)) in entries.iter().enumerate().filter(|(at, _)| kept[*at]) {
        let start = start_of(children(&entries, at).collect()).unwrap_or(0);
        changed.push((change(at, radius), link & !START & !LAST | start));
    }
    // Marks the last remaining entry of each list.
    let mut first = 0;
    while first < entries.len() {
        let list = list(&entries, first);
        if let Some(at) = list.iter().rev().find(|at| kept[**at]) {
            changed[places[*at] as usize].1 |= LAST;
        }
        first += list.len();
    }
    PairTree::from_parts(limit, starts, changed)
}

/// Returns the indices of the siblings that begin at `start`.
fn list(entries: &[(f32, u32)], start: usize) -> Vec<usize> {
    let count = entries[start..].iter().position(|(_, link)| link & LAST != 0).unwrap() + 1;
    (start..start + count).collect()
}

fn children(entries: &[(f32, u32)], at: usize) -> impl Iterator<Item = usize> + use<> {
    let start = (entries[at].1 & START) as usize;
    if start == 0 { Vec::new() } else { list(entries, start) }.into_iter()
}
