//! Certificates: the hierarchy, which must be a partition, and the radii that queries rely on.

use safetensors::Dtype;

use crate::container::Container;
use crate::refusal::{Result, claim, proof};

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
    radii: Vec<f64>,
    /// A link for each node pair of the pair tree.
    pub(crate) links: Vec<u32>,
}

impl Certificates {
    pub(crate) fn read(file: &Container<'_>, triangles: usize) -> Result<Self> {
        let digest = file.bytes("model_digest", &[Some(32)], Dtype::U8)?;
        let rows = file.integers("nodes", &[None, Some(4)])?;
        let node =
            |row: &[u32; 4]| Node { first: row[0], count: row[1], first_child: row[2], children: row[3] };
        let nodes: Vec<Node> = rows.as_chunks().0.iter().map(node).collect();
        let order = file.integers("order", &[Some(triangles)])?;
        check_partition(&nodes, &order)?;
        let children = nodes[0].children as usize;
        let root_pairs = children * children.saturating_sub(1) / 2;
        let mut this = Self {
            digest: digest.try_into().unwrap_or_default(),
            node_radii: file.reals("node_radii", &[Some(nodes.len())])?,
            root_pair_radii: file.reals("root_pair_radii", &[Some(root_pairs)])?,
            pair_limit: 0.0,
            starts: Vec::new(),
            radii: Vec::new(),
            links: Vec::new(),
            nodes,
            order,
        };
        if !matches!(file.text("version")?, "1" | "2" | "3") && file.has("pair_limit") {
            this.pair_limit = file.reals("pair_limit", &[Some(1)])?[0];
            this.starts = file.integers("pair_starts", &[None])?;
            this.links = file.integers("pair_links", &[None])?;
            let radii = file.bytes("pair_radii", &[Some(this.links.len())], Dtype::F32)?.as_chunks().0;
            this.radii = radii.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))).collect();
        }
        let limit = &[this.pair_limit];
        let radii = [&this.node_radii, &this.root_pair_radii, &this.radii, &limit[..]].concat();
        claim(radii.iter().all(|radius| *radius >= 0.0), "a radius is negative or not a number")?;
        let starts = if this.pair_limit > 0.0 { this.nodes.len() } else { 0 };
        let fits = this.pair_limit.is_finite() && this.starts.len() == starts;
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

    /// Returns the children of a node pair in the pair tree; `None` if both nodes are at most as large as buckets.
    pub(crate) fn split(&self, [n, m]: [u32; 2]) -> Option<Vec<[u32; 2]>> {
        let [x, y] = [n, m].map(|n| self.nodes[n as usize]);
        if x.count.max(y.count) <= BUCKET {
            return None;
        }
        // The larger node is no leaf, because leaves are at most as large as buckets.
        Some(match x.count >= y.count {
            true => x.children().map(|child| [child, m]).collect(),
            false => y.children().map(|child| [n, child]).collect(),
        })
    }

    /// Returns where the pairs of a node's children start in the pair tree. Queries test a bucket as a whole, so the pair tree has no pairs
    /// within it.
    pub(crate) fn start(&self, n: u32) -> Option<u32> {
        let is_bucket = n != 0 && self.nodes[n as usize].count <= BUCKET;
        self.starts.get(n as usize).copied().filter(|_| !is_bucket)
    }

    /// Returns the list of siblings that begins at `start`; an empty one for [`NO_PAIRS`].
    pub(crate) fn stored(&self, start: u32) -> Result<Vec<StoredPair>> {
        let mut list = Vec::new();
        if start == NO_PAIRS {
            return Ok(list);
        }
        for (&radius, &link) in self.radii.iter().zip(&self.links).skip(start as usize).take(8) {
            list.push(StoredPair { radius, which: link >> 28 & 7, start: link & ((1 << 28) - 1) });
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
fn check_partition(nodes: &[Node], order: &[u32]) -> Result<()> {
    let mut sorted = order.to_vec();
    sorted.sort_unstable();
    let is_each_listed = sorted.iter().enumerate().all(|(a, listed)| *listed as usize == a);
    claim(is_each_listed, "hierarchy: a triangle is listed twice or does not exist")?;
    let has_all = nodes.first().is_some_and(|root| (root.first, root.count as usize) == (0, order.len()));
    claim(has_all, "hierarchy: the root does not have all triangles")?;
    let are_small = nodes.iter().all(|node| node.children > 0 || node.count <= BUCKET);
    claim(are_small, "hierarchy: a leaf has more than 64 triangles")?;
    let (mut next, mut levels) = (1, vec![0; nodes.len()]);
    for (n, node) in nodes.iter().enumerate().filter(|(_, node)| node.children > 0) {
        let end = usize::saturating_add(next, node.children as usize);
        let has_children = (2..=MAX_CHILDREN).contains(&node.children)
            && node.first_child as usize == next
            && end <= nodes.len();
        claim(has_children, "hierarchy: the children of a node are not the next two to four nodes")?;
        let level: usize = levels[n];
        levels[next..end].fill(level + 1);
        let (mut is_union, mut first) = (level < MAX_LEVELS, u64::from(node.first));
        for child in &nodes[next..end] {
            is_union &= u64::from(child.first) == first && child.count > 0;
            first += u64::from(child.count);
        }
        is_union &= first == u64::from(node.first) + u64::from(node.count);
        claim(is_union, "hierarchy: a node is too deep, or not the disjoint union of its children")?;
        next = end;
    }
    claim(next == nodes.len(), "hierarchy: some nodes have no parent")
}
