//! Pair trees with something changed.

use sscc::parts::PairTree;

/// A link's bits.
pub const LAST: u32 = 1 << 31;
pub const START: u32 = (1 << 28) - 1;

/// The same tree without the entries at the given places and all below them, and without what has nothing left below
/// it; `change` gives each other entry another radius.
pub fn edited(
    tree: &PairTree,
    limit: f64,
    removed: &[usize],
    change: impl Fn(usize, f32) -> f32,
) -> PairTree {
    let entries: Vec<(f32, u32)> = tree.entries().collect();
    let is_inner = |at: usize| entries[at].1 & START != 0;
    let mut kept: Vec<bool> = (0..entries.len()).map(|at| !removed.contains(&at)).collect();
    // Children come after their parents: what is above is gone, then what has nothing left.
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
    // The last one left of each list.
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

/// The places of the siblings that start there.
fn list(entries: &[(f32, u32)], start: usize) -> Vec<usize> {
    let count = entries[start..].iter().position(|(_, link)| link & LAST != 0).unwrap() + 1;
    (start..start + count).collect()
}

fn children(entries: &[(f32, u32)], at: usize) -> impl Iterator<Item = usize> + use<> {
    let start = (entries[at].1 & START) as usize;
    if start == 0 { Vec::new() } else { list(entries, start) }.into_iter()
}
