//! Reader and writer for certificates: `*.sscc.safetensors`.
//!
//! | tensor | type | shape | |
//! | --- | --- | --- | --- |
//! | `model_digest` | U8 | 32 | BLAKE3 of the data that the certificates depend on |
//! | `nodes` | U32 | n x 4 | first triangle, number of triangles, first child, number of children |
//! | `order` | U32 | N | permutation of the triangles; those of a node are contiguous |
//! | `node_radii` | F64 | n | `R_n` |
//! | `node_states` | U8 | n | 0: resolved radius, computed coarsely where it is far above the root's; 1: capped at the limit, the true radius is not smaller |
//! | `root_pair_radii` | F64 | p | `R_nm` of the pairs of the root's children: (0,1), (0,2), ..., (2,3) |
//! | `root_pair_states` | U8 | p | as `node_states` |
//! | `metric_scales` | F64 | r | the diagonal of the metric's factor S, or |
//! | `metric_factor` | F64 | r x r | S itself, upper triangular, where it is not diagonal |
//! | `limit` | F64 | 1 | the global radius: radii are resolved and stored up to here; may be infinite |
//! | `epsilon` | F64 | 1 | relative error allowed |
//! | `center` | F64 | r | the q from which radii are measured: they are norms `\|S (q - center)\|` |
//! | `exceptions` | U32 | e x 2 | triangle pairs that no radius covers; every query tests them; sorted |
//! | `ignored` | U32 | i x 2 | ignored triangle pairs, sorted |
//! | `groups` | U32 | N | the group of each triangle; absent where all pairs of groups count |
//! | `group_pairs` | U32 | g x 2 | pairs of groups `a <= b`, sorted; with `groups` only |
//! | `clearance` | F64 | 1 | below a radius no pair that counts is nearer than this distance. Triangles with a common vertex do not count. Without this tensor: below a radius no pair collides |
//! | `clearance_rings` | U32 | 1 | with `clearance` only: the number of rings; pairs within it of each other on the surface do not count |
//! | `rest_collisions` | U64 | 1 | number of pairs that collide at rest, ignored ones included |
//! | `pair_limit` | F64 | 1 | the pair tree holds all node pairs with a smaller radius: a missing node pair is certified up to here; 0: no tree |
//! | `pair_starts` | U32 | n or 0 | for each node, the index of the first pair of its children; 2^32 - 1: no pair is below the limit, or the node is a bucket |
//! | `pair_radii` | F32 | t | radius of each node pair, rounded down, below the limit |
//! | `pair_links` | U32 | t | bits 0 to 27: index of its first child (0: none, both nodes are buckets); 28 to 30: its number among the children of its parent; 31: last sibling |
//! | `local_nodes` | U32 | l | the node of each local certificate, ascending; this tensor and those below are absent where there are none |
//! | `local_mode_starts` | U32 | l + 1 | for each certificate the start of its modes in `local_modes`, then the end |
//! | `local_modes` | U32 | m | the modes that move the patch of each certificate, ascending |
//! | `local_gradients` | F32 | | for each certificate the gradients G of its modes: for each mode eight entries of the 3 x 3 matrix, column by column, then the ninth of all its modes, padded with zeros to a multiple of eight |
//! | `local_ellipsoids` | U32 | | for each certificate W, upper triangular: for each eight rows their entries in all columns from the first row's diagonal on. Two entries in each number, the first in the lower half; an entry is the upper half of a single-precision number |
//! | `local_bounds` | F64 | l x 9 | for each certificate the ratio of the pairs within the node (infinite if there is no such pair), rho, 1 / s, the largest Frobenius norm of a gradient, the largest norm of a column of W, the direction across a flat patch (3 numbers; else zeros), phi (infinite where the patch is not flat). l x 5 in version 6, which has no flat patches |
//! | `local_list_starts` | U32 | l + 1 | for each certificate the start of its list in `local_list_nodes`, then the end |
//! | `local_list_nodes` | U32 | k | the nodes of each list, ascending |
//! | `local_list_ratios` | F32 | k | the ratio of the pairs between the certificate's node and each node of its list; may be infinite |
//!
//! A node pair is split at the node with more triangles (the first of equals; never a leaf): its children pair with the
//! other node. Lists of siblings are stored breadth first; the lists of the nodes' own children come first.
//! `local_certificates.rs` in the core has the inequality of local certificates.
//!
//! Text: `metric` (the kind), `scheme` ("full" with a pair tree or local certificates, else "paper"), `neighbours`
//! ("exclude": triangles that share a vertex are no pair; "include-one-vertex": triangles that share exactly one vertex
//! count if they meet at another point), `weld` ("none", or "equal": vertices of equal position and modes count as one
//! for adjacency). With `groups` also `group_pairs`, the kind of the pairs in the tensor of that name ("ignored": pairs
//! that do not count, the others do; "counted": pairs that count, the others do not). The text `scheme` adds nothing to
//! the tensors. A bucket has at most 64 triangles and is not the root; the tree holds no pairs within a bucket.
//! Clearances are new in version 8, local certificates in version 6, groups in version 5; version 6 has no flat patches.
//! A file is written in the oldest of the versions 4, 5, 7 and 8 that supports its contents. Version 3 has a tree with
//! pairs within buckets, which is not read. Versions 1 and 2 have no tree. They have a text `pairs` ("root-children").

use std::path::Path;

use sscc::parts::{CertificateParts, Digest, Hierarchy, LocalCertificates, Node, PairTree, Scope};
use sscc::{Certificates, ContactFilter, Neighbours, Pair};

use super::{
    ANY, CERTIFICATES, Container, ContainerWriter, Kind, certificate_clearance, certificate_groups,
    local_certificates, metric,
};
use crate::error::quoted;
use crate::file::{read_whole, write_whole};
use crate::{FormatError, IoError, Place};

/// Files without groups, local certificates and a clearance are written in this version, which earlier builds read.
const PLAIN_VERSION: u32 = 4;

/// Value of the text `weld` if equal vertices count as one.
const WELD: &str = "equal";

/// Value of the text `weld` if each vertex counts alone.
const NO_WELD: &str = "none";

/// Returns the value of the text `scheme`.
fn scheme(tree: &PairTree, local: &LocalCertificates) -> &'static str {
    if tree.limit() > 0.0 || !local.nodes.is_empty() { "full" } else { "paper" }
}

const TENSORS: [&str; 23] = [
    "center",
    certificate_clearance::CLEARANCE,
    certificate_clearance::RINGS,
    "epsilon",
    "exceptions",
    certificate_groups::PAIRS,
    certificate_groups::GROUPS,
    "ignored",
    "limit",
    metric::FACTOR,
    metric::SCALES,
    "model_digest",
    "node_radii",
    "node_states",
    "nodes",
    "order",
    "pair_limit",
    "pair_links",
    "pair_radii",
    "pair_starts",
    "rest_collisions",
    "root_pair_radii",
    "root_pair_states",
];

/// Writes certificates. Reading returns the same numbers, bit for bit.
///
/// # Errors
/// When the file cannot be written.
pub fn write_certificates(path: &Path, certificates: &Certificates) -> Result<(), IoError> {
    write_whole(path, &certificates_to_bytes(certificates).map_err(|error| error.of(path))?)
}

/// Reads certificates.
///
/// # Errors
/// When the file cannot be read, is damaged, of another kind or a newer version; when a tensor or a text is missing,
/// unknown or out of range, or its parts do not fit each other.
pub fn read_certificates(path: &Path) -> Result<Certificates, IoError> {
    certificates_from_bytes(&read_whole(path)?).map_err(|error| error.of(path))
}

/// Returns the bytes of a certificate file. Equal certificates have equal bytes.
///
/// # Errors
/// None in practice, because all names and texts are short.
pub fn certificates_to_bytes(certificates: &Certificates) -> Result<Vec<u8>, FormatError> {
    let parts = certificates.parts();
    let nodes = parts.hierarchy.nodes();
    let columns: Vec<u32> = nodes
        .iter()
        .flat_map(|n| [n.first_triangle, n.triangle_count, n.first_child, n.child_count])
        .collect();
    let (order, scope) = (parts.hierarchy.order(), &parts.scope);
    let flat = |pairs: &[Pair]| -> Vec<u32> { pairs.iter().flat_map(|&(i, j)| [i, j]).collect() };
    let (exceptions, ignored) = (flat(&scope.exceptions), flat(scope.filter.ignored()));
    let (node_radii, pair_radii) = (&parts.node_radii, &parts.root_pair_radii);
    let tree = &parts.pair_tree;
    let (tree_radii, tree_links): (Vec<f32>, Vec<u32>) = tree.entries().unzip();
    let version = match (scope.clearance, parts.local.nodes.is_empty(), scope.filter.groups()) {
        (Some(_), ..) => certificate_clearance::VERSION,
        (None, false, _) => local_certificates::VERSION,
        (None, true, Some(_)) => certificate_groups::VERSION,
        (None, true, None) => PLAIN_VERSION,
    };
    let mut writer = ContainerWriter::new(Kind { version, ..CERTIFICATES });
    metric::write(&mut writer, &scope.metric);
    certificate_groups::write(&mut writer, &scope.filter);
    certificate_clearance::write(&mut writer, scope.clearance);
    local_certificates::write(&mut writer, &parts.local);
    writer
        .text("scheme", scheme(tree, &parts.local))
        .text("neighbours", scope.filter.neighbours.into())
        .text("weld", if scope.filter.weld { WELD } else { NO_WELD })
        .u8("model_digest", &[32], &parts.digest.0)
        .u32("nodes", &[nodes.len(), 4], &columns)
        .u32("order", &[order.len()], order)
        .f64("node_radii", &[node_radii.len()], node_radii)
        .u8("node_states", &[node_radii.len()], &states(node_radii, parts.global_radius))
        .f64("root_pair_radii", &[pair_radii.len()], pair_radii)
        .u8("root_pair_states", &[pair_radii.len()], &states(pair_radii, parts.global_radius))
        .f64("limit", &[1], &[parts.global_radius])
        .f64("epsilon", &[1], &[parts.epsilon])
        .f64("center", &[scope.center.len()], &scope.center)
        .u32("exceptions", &[exceptions.len() / 2, 2], &exceptions)
        .u32("ignored", &[ignored.len() / 2, 2], &ignored)
        .u64("rest_collisions", &[1], &[parts.rest_collisions])
        .f64("pair_limit", &[1], &[tree.limit()])
        .u32("pair_starts", &[tree.starts().len()], tree.starts())
        .f32("pair_radii", &[tree_radii.len()], &tree_radii)
        .u32("pair_links", &[tree_links.len()], &tree_links);
    writer.finish()
}

/// Parses a certificate file.
///
/// # Errors
/// As [`read_certificates`], without the file's name.
pub fn certificates_from_bytes(bytes: &[u8]) -> Result<Certificates, FormatError> {
    let file = Container::parse(bytes, CERTIFICATES)?;
    file.only(&[&TENSORS[..], &local_certificates::TENSORS].concat())?;
    let unknown = |key: &str, found: &str| {
        let cause = format!("{} is not known in this version of the format", quoted(found));
        FormatError::new(Place::Key(key.into()), cause)
    };
    if file.version() < 3 && file.text("pairs")? != "root-children" {
        return Err(unknown("pairs", file.text("pairs")?));
    }
    let (pair_tree, local) = (read_pair_tree(&file)?, local_certificates::read(&file)?);
    match file.text("scheme")? {
        found if found == scheme(&pair_tree, &local) => {}
        "full" if file.version() == 3 => {}
        "full" | "paper" => {
            let cause = "it does not agree with 'pair_limit' and 'local_nodes'";
            return Err(FormatError::new(Place::Key("scheme".into()), cause));
        }
        other => return Err(unknown("scheme", other)),
    }
    let neighbours = file.text("neighbours")?;
    let neighbours = neighbours.parse::<Neighbours>().map_err(|_| unknown("neighbours", neighbours))?;
    let weld = match file.text("weld")? {
        WELD => true,
        NO_WELD => false,
        other => return Err(unknown("weld", other)),
    };
    let metric = metric::read(&file, ANY)?;
    let center = file.f64("center")?.shaped(&[metric.rank()])?;
    if center.values.iter().any(|x| !x.is_finite()) {
        return Err(center.refused("it is not finite"));
    }
    let ignored = if file.version() == 1 { Vec::new() } else { read_pairs(&file, "ignored")? };
    let scope = Scope {
        metric,
        center: center.values,
        filter: certificate_groups::read(&file, ContactFilter::new(neighbours).weld(weld).ignoring(ignored))?,
        exceptions: read_pairs(&file, "exceptions")?,
        clearance: certificate_clearance::read(&file)?,
    };
    let one = |name| file.f64(name)?.shaped(&[1]);
    let epsilon = one("epsilon")?;
    if !(epsilon.values[0] > 0.0 && epsilon.values[0] < 1.0) {
        return Err(epsilon.refused("it is not between 0 and 1"));
    }
    let hierarchy = read_hierarchy(&file)?;
    let limit = one("limit")?.values[0];
    let radii = |name, states_name, count| {
        let radii = file.f64(name)?.shaped(&[count])?.values;
        let found = file.u8(states_name)?.shaped(&[count])?;
        if found.values != states(&radii, limit) {
            return Err(found.refused("it does not agree with the radii and the limit"));
        }
        Ok(radii)
    };
    let node_radii = radii("node_radii", "node_states", hierarchy.nodes().len())?;
    let root_pair_radii = radii("root_pair_radii", "root_pair_states", {
        let children = hierarchy.nodes()[0].child_count as usize;
        children * children.saturating_sub(1) / 2
    })?;
    let digest = file.u8("model_digest")?.shaped(&[32])?.values;
    let digest = Digest(digest.try_into().unwrap_or_default());
    Ok(Certificates::try_from(CertificateParts {
        digest,
        scope: scope.into(),
        hierarchy: hierarchy.into(),
        epsilon: epsilon.values[0],
        global_radius: limit,
        node_radii,
        root_pair_radii,
        pair_tree,
        local: local.into(),
        rest_collisions: file.u64("rest_collisions")?.shaped(&[1])?.values[0],
    })?)
}

/// Reads triangle pairs `i < j`, sorted, without duplicates.
fn read_pairs(file: &Container<'_>, name: &str) -> Result<Vec<Pair>, FormatError> {
    let tensor = file.u32(name)?.shaped(&[ANY, 2])?;
    let pairs: Vec<Pair> = tensor.values.as_chunks().0.iter().map(|&[i, j]| (i, j)).collect();
    if pairs.is_sorted_by(|a, b| a < b) && pairs.iter().all(|(i, j)| i < j) {
        Ok(pairs)
    } else {
        Err(tensor.refused("pairs are not in order"))
    }
}

/// Reads the pair tree. [`Certificates::try_from`] checks that it fits the hierarchy.
fn read_pair_tree(file: &Container<'_>) -> Result<PairTree, FormatError> {
    if file.version() < 4 {
        return Ok(PairTree::default());
    }
    let limit = file.f64("pair_limit")?.shaped(&[1])?.values[0];
    let starts = file.u32("pair_starts")?.shaped(&[ANY])?.values;
    let links = file.u32("pair_links")?.shaped(&[ANY])?.values;
    let radii = file.f32("pair_radii")?.shaped(&[links.len()])?.values;
    Ok(PairTree::from_parts(limit, starts, radii.into_iter().zip(links)))
}

fn read_hierarchy(file: &Container<'_>) -> Result<Hierarchy, FormatError> {
    let columns = file.u32("nodes")?.shaped(&[ANY, 4])?.values;
    let nodes = columns
        .as_chunks()
        .0
        .iter()
        .map(|&[first_triangle, triangle_count, first_child, child_count]| Node {
            first_triangle,
            triangle_count,
            first_child,
            child_count,
        })
        .collect();
    let order = file.u32("order")?.shaped(&[ANY])?.values;
    let triangles = order.len();
    Ok(Hierarchy::from_parts(nodes, order, triangles)?)
}

/// Returns 1 for each radius that reaches the limit, else 0.
fn states(radii: &[f64], limit: f64) -> Vec<u8> {
    radii.iter().map(|radius| u8::from(*radius >= limit)).collect()
}

#[cfg(test)]
mod tests;
