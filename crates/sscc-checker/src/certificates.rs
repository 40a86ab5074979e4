//! Certificates: the hierarchy, which must be a partition, and the radii that queries rely on.

use crate::container::Container;
use crate::refusal::{Refusal, claim, proof};

/// A bucket has at most this many triangles, and is not the root. The pair tree ends at buckets. Leaves also have at most this many.
pub(crate) const BUCKET: u32 = 64;
/// The largest number of children of a node.
const MAX_CHILDREN: u32 = 4;
/// The largest number of levels of a hierarchy.
const MAX_LEVELS: usize = 256;
/// The start of a node without stored pairs of its children.
const NO_PAIRS: u32 = u32::MAX;

/// A node: its triangles are a range of the order, its children a range of the nodes.
#[derive(Clone, Copy)]
pub(crate) struct Node {
    pub(crate) first: u32,
    pub(crate) count: u32,
    first_child: u32,
    pub(crate) children: u32,
}

impl Node {
    pub(crate) fn children(&self) -> std::ops::Range<u32> {
        self.first_child..self.first_child + self.children
    }
}

/// A node pair of the pair tree.
#[derive(Clone, Copy)]
pub(crate) struct StoredPair {
    pub(crate) radius: f64,
    /// The index among all siblings, including those that are not stored.
    pub(crate) which: u32,
    /// The start of the list of its children.
    pub(crate) start: u32,
}

/// Hierarchy and radii.
pub(crate) struct Certificates {
    pub(crate) digest: [u8; 32],
    pub(crate) nodes: Vec<Node>,
    order: Vec<u32>,
    pub(crate) node_radii: Vec<f64>,
    pub(crate) root_pair_radii: Vec<f64>,
    /// The limit of the pair tree; 0 if there is no pair tree.
    pub(crate) pair_limit: f64,
    starts: Vec<u32>,
    radii: Vec<f32>,
    /// A link for each node pair of the pair tree.
    pub(crate) links: Vec<u32>,
}

impl Certificates {
    pub(crate) fn read(file: &Container<'_>, triangles: usize) -> Result<Self, Refusal> {
        let digest = file.shaped::<u8>("model_digest", &[Some(32)])?.try_into().unwrap_or_default();
        let rows = file.shaped::<u32>("nodes", &[None, Some(4)])?;
        let node =
            |&[first, count, first_child, children]: &[u32; 4]| Node { first, count, first_child, children };
        let nodes: Vec<Node> = rows.as_chunks().0.iter().map(node).collect();
        let order = file.shaped("order", &[Some(triangles)])?;
        check_partition(&nodes, &order)?;
        let children = nodes[0].children as usize;
        let root_pairs = children * children.saturating_sub(1) / 2;
        let is_old = matches!(file.text("version")?, "1" | "2" | "3");
        let has_tree = !is_old && file.has("pair_limit");
        let pair_limit = if has_tree { file.shaped("pair_limit", &[Some(1)])?[0] } else { 0.0 };
        let list = |name| if has_tree { file.shaped::<u32>(name, &[None]) } else { Ok(Vec::new()) };
        let (starts, links) = (list("pair_starts")?, list("pair_links")?);
        let this = Self {
            digest,
            node_radii: file.shaped("node_radii", &[Some(nodes.len())])?,
            root_pair_radii: file.shaped("root_pair_radii", &[Some(root_pairs)])?,
            pair_limit,
            radii: if has_tree { file.shaped("pair_radii", &[Some(links.len())])? } else { Vec::new() },
            starts,
            links,
            nodes,
            order,
        };
        let reals = [&this.node_radii[..], &this.root_pair_radii, &[pair_limit]].concat();
        let are_radii =
            reals.iter().all(|radius| *radius >= 0.0) && this.radii.iter().all(|radius| *radius >= 0.0);
        claim(are_radii, "a radius is negative or not a number")?;
        let starts = if pair_limit > 0.0 { this.nodes.len() } else { 0 };
        let fits = pair_limit.is_finite() && this.starts.len() == starts;
        claim(fits, "the limit or the starts of the pair tree do not fit the hierarchy")?;
        Ok(this)
    }

    /// Returns the triangles of a node.
    pub(crate) fn triangles(&self, n: u32) -> &[u32] {
        let node = self.nodes[n as usize];
        &self.order[node.first as usize..][..node.count as usize]
    }

    /// Returns the pairs of triangles between two nodes, or within one.
    pub(crate) fn pairs(&self, [n, m]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
        let [x, y] = [n, m].map(|n| self.triangles(n));
        let rest = move |i: usize| if n == m { &y[i + 1..] } else { y };
        x.iter().enumerate().flat_map(move |(i, a)| rest(i).iter().map(move |b| [*a, *b]))
    }

    /// Whether queries test a node as a whole, so that the pair tree has no pairs within it.
    pub(crate) fn is_bucket(&self, n: u32) -> bool {
        n != 0 && self.nodes[n as usize].count <= BUCKET
    }

    /// Returns the children of a node pair in the pair tree; `None` if both nodes are at most as large as buckets.
    pub(crate) fn split(&self, [n, m]: [u32; 2]) -> Option<Vec<[u32; 2]>> {
        let [node_n, node_m] = [n, m].map(|n| self.nodes[n as usize]);
        if node_n.count.max(node_m.count) <= BUCKET || (node_n.children == 0 && node_m.children == 0) {
            return None;
        }
        let is_first = node_m.children == 0 || (node_n.children > 0 && node_n.count >= node_m.count);
        let children = if is_first { node_n.children() } else { node_m.children() };
        Some(children.map(|child| if is_first { [child, m] } else { [n, child] }).collect())
    }

    /// Returns the stored pairs of a node's children.
    pub(crate) fn stored_of_node(&self, n: u32) -> Result<Vec<StoredPair>, Refusal> {
        let start = self.starts[n as usize];
        if start == NO_PAIRS { Ok(Vec::new()) } else { self.stored(start) }
    }

    /// Returns the list of siblings that begins at `start`.
    pub(crate) fn stored(&self, start: u32) -> Result<Vec<StoredPair>, Refusal> {
        let mut list = Vec::new();
        for (&radius, &link) in self.radii.iter().zip(&self.links).skip(start as usize).take(8) {
            let (start, which) = (link & ((1 << 28) - 1), link >> 28 & 7);
            list.push(StoredPair { radius: f64::from(radius), which, start });
            if link >> 31 == 1 {
                return Ok(list);
            }
        }
        proof("pair tree: a list of siblings does not end")
    }
}

#[cfg(test)]
impl Certificates {
    /// Returns certificates of one leaf with this many triangles, which has a radius.
    pub(crate) fn of_leaf(triangles: u32, radius: f64) -> Self {
        Self {
            digest: [0; 32],
            nodes: vec![Node { first: 0, count: triangles, first_child: 0, children: 0 }],
            order: (0..triangles).collect(),
            node_radii: vec![radius],
            root_pair_radii: Vec::new(),
            pair_limit: 0.0,
            starts: Vec::new(),
            radii: Vec::new(),
            links: Vec::new(),
        }
    }
}

/// Checks that each triangle is listed once, that the triangles of each node are the disjoint union of those of its
/// children, and that no leaf is larger than a bucket.
fn check_partition(nodes: &[Node], order: &[u32]) -> Result<(), Refusal> {
    let mut sorted = order.to_vec();
    sorted.sort_unstable();
    let is_each_listed = sorted.iter().enumerate().all(|(a, listed)| *listed as usize == a);
    claim(is_each_listed, "hierarchy: a triangle is listed twice or does not exist")?;
    let has_all = nodes.first().is_some_and(|root| (root.first, root.count as usize) == (0, order.len()));
    claim(has_all, "hierarchy: the root does not have all triangles")?;
    let are_small = nodes.iter().all(|node| node.children > 0 || node.count <= BUCKET);
    claim(are_small, "hierarchy: a leaf has more than 64 triangles")?;
    let (mut next, mut levels) = (1_u64, vec![0_usize; nodes.len()]);
    for (n, node) in nodes.iter().enumerate().filter(|(_, node)| node.children > 0) {
        let end = u64::from(node.first_child) + u64::from(node.children);
        let has_children = (2..=MAX_CHILDREN).contains(&node.children)
            && u64::from(node.first_child) == next
            && end <= nodes.len() as u64;
        claim(has_children, "hierarchy: the children of a node are not the next two to four nodes")?;
        let (mut is_union, mut first) = (levels[n] < MAX_LEVELS, u64::from(node.first));
        for child in node.children() {
            let part = nodes[child as usize];
            is_union &= u64::from(part.first) == first && part.count > 0;
            first += u64::from(part.count);
            levels[child as usize] = levels[n] + 1;
        }
        is_union &= first == u64::from(node.first) + u64::from(node.count);
        claim(is_union, "hierarchy: a node is too deep, or not the disjoint union of its children")?;
        next = end;
    }
    claim(next == nodes.len() as u64, "hierarchy: some nodes have no parent")
}
