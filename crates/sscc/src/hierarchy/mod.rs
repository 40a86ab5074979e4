//! The bounding volume hierarchy of section 3: 4-ary k-means on rest positions and modes together.
//!
//! Clustering on the modes as well tends to put regions that move apart into different nodes even where
//! they are close in space, which makes certificates stronger (paper, section 3, after Huang et al. 2009).

use glam::DVec3;

use crate::{Error, Metric, ReducedModel};

/// Children of an inner node: between 2 and this many.
const BRANCHING: usize = 4;

/// Nodes with at most this many triangles are leaves. With 8 the root radius of the bunny is the same as with 4 and
/// with 2, the tree half the size. Queries compare boxes by clusters of their own (`query/clusters.rs`).
const LEAF_TRIANGLES: usize = 8;

/// Rounds of k-means. Twelve rounds changed the number of box tests by half a percent.
const ROUNDS: usize = 6;

/// A child may hold at most this share of its parent (else the parent is cut evenly), so that no input can
/// make the tree deep: its depth is at most log N / log(8/7).
const LARGEST_CHILD: (usize, usize) = (7, 8);

/// Trees from elsewhere (a file) may have leaves up to this size ...
const LARGEST_LEAF: u32 = 64;

/// ... and this many levels. Our own have at most log N / log(8/7), 166 for 2^32 triangles.
const MOST_LEVELS: usize = 256;

/// How many numbers stand for the modes of a triangle: sums of the scaled mode entries with fixed random
/// signs, which keep distances between triangles within a few tens of percent (Johnson and
/// Lindenstrauss). On the bunny, 3, 9 and 24 of them gave the same root radius within 1%.
const MODE_FEATURES: usize = 9;

const FEATURES: usize = 3 + MODE_FEATURES;

type Feature = [f64; FEATURES];

/// A node: a set of triangles, and the range of its children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node {
    /// First of its triangles, as a position in [`Hierarchy::order`].
    pub first_triangle: u32,
    /// Number of its triangles.
    pub triangle_count: u32,
    /// Index of its first child; the others follow it. 0 for a leaf.
    pub first_child: u32,
    /// Number of children: 0 for a leaf, else 2 to 4.
    pub child_count: u32,
}

impl Node {
    /// Whether the node has no children.
    pub fn is_leaf(&self) -> bool {
        self.child_count == 0
    }

    /// Indices of its children.
    pub fn children(&self) -> std::ops::Range<u32> {
        self.first_child..self.first_child + self.child_count
    }

    /// All pairs of its children, in the order (0, 1), (0, 2), ..., (2, 3).
    pub(crate) fn child_pairs(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let children = self.children();
        children.clone().flat_map(move |n| (n + 1..children.end).map(move |m| (n, m)))
    }

    /// Whether queries look at the node as a whole: it has at most 64 triangles.
    pub fn is_small(&self) -> bool {
        self.triangle_count as usize <= SMALL
    }
}

/// Nodes of at most this many triangles are looked at as a whole in queries.
pub(crate) const SMALL: usize = 64;

/// How a pair of nodes is split: one of them into its children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Split {
    /// The first node is split.
    First(Node, u32),
    /// The second node is split.
    Second(u32, Node),
}

impl Split {
    /// The children of the node that is split.
    pub(crate) fn children(&self) -> std::ops::Range<u32> {
        match self {
            Self::First(node, _) | Self::Second(_, node) => node.children(),
        }
    }

    /// The pair with the child of that place.
    pub(crate) fn pair(&self, which: u32) -> (u32, u32) {
        match self {
            Self::First(node, m) => (node.first_child + which, *m),
            Self::Second(n, node) => (*n, node.first_child + which),
        }
    }

    /// All pairs, child by child.
    pub(crate) fn pairs(self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.children().len() as u32).map(move |which| self.pair(which))
    }
}

/// A tree over all triangles: each node's triangles are the disjoint union of its children's. Nodes are
/// stored level by level, the root first, siblings side by side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hierarchy {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl Hierarchy {
    /// Clusters the triangles of a model, modes scaled by `metric`. The same input gives the same tree on
    /// every machine.
    pub fn build(model: &ReducedModel, metric: &Metric) -> Self {
        let features = features(model, metric);
        let mut order: Vec<u32> = (0..features.len() as u32).collect();
        let root =
            Node { first_triangle: 0, triangle_count: order.len() as u32, first_child: 0, child_count: 0 };
        let mut nodes = vec![root];
        let mut next = 0;
        while next < nodes.len() {
            let Node { first_triangle, triangle_count, .. } = nodes[next];
            if triangle_count as usize > LEAF_TRIANGLES {
                let first = first_triangle as usize;
                let sizes = split(&features, &mut order[first..first + triangle_count as usize]);
                nodes[next].first_child = nodes.len() as u32;
                nodes[next].child_count = sizes.len() as u32;
                let mut child_first = first_triangle;
                for size in sizes {
                    nodes.push(Node {
                        first_triangle: child_first,
                        triangle_count: size,
                        first_child: 0,
                        child_count: 0,
                    });
                    child_first += size;
                }
            }
            next += 1;
        }
        Self { nodes, order }
    }

    /// Takes a tree from its parts, as read from a file.
    ///
    /// # Errors
    /// When the parts are no tree over exactly `triangles` triangles in the documented order.
    pub fn from_parts(nodes: Vec<Node>, order: Vec<u32>, triangles: usize) -> Result<Self, Error> {
        let damaged = |what: &str| Error::Certificates(format!("hierarchy: {what}"));
        let mut seen = vec![false; triangles];
        if order.len() != triangles {
            return Err(damaged("its triangles are not this mesh's"));
        }
        for &t in &order {
            match seen.get_mut(t as usize) {
                Some(seen) if !*seen => *seen = true,
                _ => return Err(damaged("a triangle is listed twice or does not exist")),
            }
        }
        let Some(root) = nodes.first() else { return Err(damaged("it has no nodes")) };
        if (root.first_triangle, root.triangle_count as usize) != (0, triangles) {
            return Err(damaged("its root does not hold all triangles"));
        }
        let mut next_child = 1_u64;
        for node in &nodes {
            if node.triangle_count == 0 {
                return Err(damaged("a node is empty"));
            }
            if node.is_leaf() {
                if node.first_child != 0 {
                    return Err(damaged("a leaf names a child"));
                }
                continue;
            }
            let end = u64::from(node.first_child) + u64::from(node.child_count);
            let fits = (2..=BRANCHING as u32).contains(&node.child_count)
                && u64::from(node.first_child) == next_child
                && end <= nodes.len() as u64;
            if !fits {
                return Err(damaged("children are out of order"));
            }
            next_child = end;
            let mut first = u64::from(node.first_triangle);
            for child in &nodes[node.first_child as usize..end as usize] {
                if u64::from(child.first_triangle) != first {
                    return Err(damaged("a node is not the disjoint union of its children"));
                }
                first += u64::from(child.triangle_count);
            }
            if first != u64::from(node.first_triangle) + u64::from(node.triangle_count) {
                return Err(damaged("a node is not the disjoint union of its children"));
            }
        }
        if next_child != nodes.len() as u64 {
            return Err(damaged("some nodes have no parent"));
        }
        // Bounds the time of whatever walks over nodes and their triangles.
        if nodes.iter().any(|node| node.is_leaf() && node.triangle_count > LARGEST_LEAF) {
            return Err(damaged("a leaf has more than 64 triangles"));
        }
        let tree = Self { nodes, order };
        if tree.levels().len() > MOST_LEVELS {
            return Err(damaged("it has more than 256 levels"));
        }
        Ok(tree)
    }

    /// The nodes, level by level, the root first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// All triangles, sorted so that each node's are contiguous.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// How a pair of nodes is split: the one of more triangles, the first of equals; none where both are leaves.
    #[inline]
    pub(crate) fn split(&self, n: u32, m: u32) -> Option<Split> {
        let (node_n, node_m) = (self.nodes[n as usize], self.nodes[m as usize]);
        if node_n.is_leaf() && node_m.is_leaf() {
            None
        } else if node_m.is_leaf() || (!node_n.is_leaf() && node_n.triangle_count >= node_m.triangle_count) {
            Some(Split::First(node_n, m))
        } else {
            Some(Split::Second(n, node_m))
        }
    }

    /// Whether a node is searched and queried as a whole, so that nothing is known of the pairs within it: it is small,
    /// and not the root, whose pairs of children have radii of their own.
    pub(crate) fn is_whole(&self, n: u32) -> bool {
        n != 0 && self.nodes[n as usize].is_small()
    }

    /// For each node whether it lies below one that is searched as a whole.
    pub(crate) fn nodes_within_buckets(&self) -> Vec<bool> {
        let mut within = vec![false; self.nodes.len()];
        for node in (0..within.len()).filter(|n| self.is_whole(*n as u32)).map(|n| &self.nodes[n]) {
            node.children().for_each(|child| within[child as usize] = true);
        }
        within
    }

    /// The same as far as the certified pair tree goes: none where both are small.
    #[inline]
    pub(crate) fn split_large(&self, n: u32, m: u32) -> Option<Split> {
        let count = |n: u32| self.nodes[n as usize].triangle_count as usize;
        if count(n).max(count(m)) <= SMALL { None } else { self.split(n, m) }
    }

    /// The triangles of a node.
    pub fn triangles(&self, node: &Node) -> &[u32] {
        &self.order[node.first_triangle as usize..][..node.triangle_count as usize]
    }

    /// The vertices of a node's triangles, ascending, each once.
    pub(crate) fn vertices(&self, node: &Node, faces: &[[u32; 3]]) -> Vec<u32> {
        let mut vertices: Vec<u32> = self.triangles(node).iter().flat_map(|&t| faces[t as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    /// The range of node indices of each level, the root's first.
    pub fn levels(&self) -> Vec<std::ops::Range<usize>> {
        let mut levels = Vec::new();
        let mut level = 0..1;
        while !level.is_empty() {
            let below: u32 = self.nodes[level.clone()].iter().map(|n| n.child_count).sum();
            levels.push(level.clone());
            level = level.end..level.end + below as usize;
        }
        levels
    }
}

/// One point for each triangle: its centroid in units of the box, and its mean scaled modes, projected to
/// few numbers, in units of their largest deviation from the mean.
fn features(model: &ReducedModel, metric: &Metric) -> Vec<Feature> {
    let (mesh, modes) = (model.mesh(), model.modes());
    let p = mesh.rest_positions();
    let mut vertex_features = vec![[0.0; FEATURES]; p.len()];
    let mut scaled = vec![DVec3::ZERO; modes.rank()];
    for v in mesh.used_vertices() {
        let feature = &mut vertex_features[v as usize];
        feature[..3].copy_from_slice(&p[v as usize].to_array());
        metric.scaled_modes(modes.of_vertex(v), &mut scaled);
        for (k, a) in scaled.iter().enumerate() {
            for (c, a) in a.to_array().into_iter().enumerate() {
                let signs = hash(3 * k as u64 + c as u64);
                for (j, f) in feature[3..].iter_mut().enumerate() {
                    *f += if signs >> j & 1 == 0 { a } else { -a };
                }
            }
        }
    }
    let mut features: Vec<Feature> = mesh
        .faces()
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|v| vertex_features[v as usize]);
            std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0)
        })
        .collect();
    for range in [0..3, 3..FEATURES] {
        normalise(&mut features, range);
    }
    features
}

/// Centres the features of a range and divides them by the largest deviation from the mean.
fn normalise(features: &mut [Feature], range: std::ops::Range<usize>) {
    let mut largest = 0.0_f64;
    for i in range.clone() {
        let mean = features.iter().map(|f| f[i]).sum::<f64>() / features.len() as f64;
        for f in features.iter_mut() {
            f[i] -= mean;
            largest = largest.max(f[i].abs());
        }
    }
    if largest > 0.0 {
        features.iter_mut().for_each(|f| f[range.clone()].iter_mut().for_each(|x| *x /= largest));
    }
}

/// Reorders `triangles` into 2 to 4 clusters and returns their sizes, each positive.
fn split(features: &[Feature], triangles: &mut [u32]) -> Vec<u32> {
    let mut centres = farthest_points(features, triangles);
    let mut labels = vec![0_u8; triangles.len()];
    for round in 0..ROUNDS {
        for (label, &t) in labels.iter_mut().zip(triangles.iter()) {
            *label = nearest(&centres, &features[t as usize]);
        }
        if round + 1 < ROUNDS {
            move_centres(&mut centres, features, triangles, &labels);
        }
    }
    let mut sizes = [0_u32; BRANCHING];
    labels.iter().for_each(|&l| sizes[l as usize] += 1);
    let largest = sizes.iter().max().map_or(0, |&s| s as usize);
    let mut sorted: Vec<(u8, u32)> = labels.iter().copied().zip(triangles.iter().copied()).collect();
    if largest * LARGEST_CHILD.1 > triangles.len() * LARGEST_CHILD.0 {
        return cut_evenly(features, triangles);
    }
    sorted.sort_by_key(|&(label, t)| (label, t));
    triangles.iter_mut().zip(sorted).for_each(|(slot, (_, t))| *slot = t);
    sizes.into_iter().filter(|&s| s > 0).collect()
}

/// Cuts into four equal parts along the widest feature: for clusters that k-means cannot split fairly.
fn cut_evenly(features: &[Feature], triangles: &mut [u32]) -> Vec<u32> {
    let width = |i: usize| {
        let values = triangles.iter().map(|&t| features[t as usize][i]);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    let widest = (0..FEATURES).fold(0, |best, i| if width(i) > width(best) { i } else { best });
    triangles.sort_by(|&a, &b| {
        features[a as usize][widest].total_cmp(&features[b as usize][widest]).then(a.cmp(&b))
    });
    let n = triangles.len();
    (0..BRANCHING).map(|i| ((i + 1) * n / BRANCHING - i * n / BRANCHING) as u32).filter(|&s| s > 0).collect()
}

/// Starting centres: the triangle farthest from the mean, then always the one farthest from those chosen.
fn farthest_points(features: &[Feature], triangles: &[u32]) -> [Feature; BRANCHING] {
    let mut mean = [0.0; FEATURES];
    for &t in triangles {
        mean.iter_mut().zip(&features[t as usize]).for_each(|(m, f)| *m += f);
    }
    mean.iter_mut().for_each(|m| *m /= triangles.len() as f64);
    let farthest = |distances: &mut [f64], from: &Feature| {
        let mut best = 0;
        for (i, &t) in triangles.iter().enumerate() {
            distances[i] = distances[i].min(distance(from, &features[t as usize]));
            if distances[i] > distances[best] {
                best = i;
            }
        }
        features[triangles[best] as usize]
    };
    let mut centres = [farthest(&mut vec![f64::INFINITY; triangles.len()], &mean); BRANCHING];
    let mut distances = vec![f64::INFINITY; triangles.len()];
    for i in 1..BRANCHING {
        centres[i] = farthest(&mut distances, &centres[i - 1]);
    }
    centres
}

fn nearest(centres: &[Feature; BRANCHING], feature: &Feature) -> u8 {
    let mut best = (f64::INFINITY, 0);
    for (i, centre) in centres.iter().enumerate() {
        let d = distance(centre, feature);
        if d < best.0 {
            best = (d, i as u8);
        }
    }
    best.1
}

fn move_centres(centres: &mut [Feature; BRANCHING], features: &[Feature], triangles: &[u32], labels: &[u8]) {
    let mut sums = [[0.0; FEATURES]; BRANCHING];
    let mut counts = [0.0; BRANCHING];
    for (&label, &t) in labels.iter().zip(triangles) {
        counts[label as usize] += 1.0;
        sums[label as usize].iter_mut().zip(&features[t as usize]).for_each(|(s, f)| *s += f);
    }
    for ((centre, sum), count) in centres.iter_mut().zip(sums).zip(counts) {
        if count > 0.0 {
            *centre = sum.map(|s| s / count);
        }
    }
}

fn distance(a: &Feature, b: &Feature) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

/// Fixed pseudo-random bits (the mixing function of SplitMix64).
fn hash(x: u64) -> u64 {
    let x = x.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
