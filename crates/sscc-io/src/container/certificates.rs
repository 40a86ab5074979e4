//! Certificates: `*.sscc.safetensors`.
//!
//! | tensor | type | shape | |
//! | --- | --- | --- | --- |
//! | `model_digest` | U8 | 32 | BLAKE3 of everything that the certificates speak of |
//! | `nodes` | U32 | n x 4 | first triangle, number of triangles, first child, number of children |
//! | `order` | U32 | N | all triangles, so that each node's are contiguous |
//! | `node_radii` | F64 | n | `R_n` |
//! | `node_states` | U8 | n | 0: the radius was resolved; 1: capped at the limit, the true one is no smaller |
//! | `root_pair_radii` | F64 | p | `R_nm` of the pairs of the root's children: (0,1), (0,2), ..., (2,3) |
//! | `root_pair_states` | U8 | p | as `node_states` |
//! | `metric_scales` | F64 | r | the diagonal of the metric's factor S; radii are norms `\|S q\|` |
//! | `limit` | F64 | 1 | `R_global`: radii are resolved and stored up to here; may be infinite |
//! | `epsilon` | F64 | 1 | relative error allowed |
//! | `center` | F64 | r | the q from which radii are measured: zeros in this version |
//! | `exceptions` | U32 | 0 x 2 | pairs that the certificates leave out: none in this version |
//! | `rest_collisions` | U64 | 1 | number of pairs that collide at rest |
//!
//! Text: `metric` (the kind), `scheme` ("paper"), `pairs` (which pair radii are stored: "root-children"),
//! `neighbours` ("exclude": triangles that share a vertex are no pair), `weld` ("none"). Nothing is to be
//! inferred from the scheme's name: it says only how the file came about.

use std::path::Path;

use sscc::hierarchy::{Hierarchy, Node};
use sscc::{CertificateParts, Certificates, Digest, Metric, MetricKind};

use super::{ANY, CERTIFICATES, Sealed, SealedWriter};
use crate::error::quoted;
use crate::file::{read_whole, write_whole};
use crate::{FormatError, IoError, Place};

/// The texts that have only one value in this version: anything else would change what is proven.
const RULES: [(&str, &str); 4] =
    [("scheme", "paper"), ("pairs", "root-children"), ("neighbours", "exclude"), ("weld", "none")];

const TENSORS: [&str; 13] = [
    "center",
    "epsilon",
    "exceptions",
    "limit",
    "metric_scales",
    "model_digest",
    "node_radii",
    "node_states",
    "nodes",
    "order",
    "rest_collisions",
    "root_pair_radii",
    "root_pair_states",
];

/// Writes certificates. Reading them back gives the same numbers, bit for bit.
///
/// # Errors
/// When the file cannot be written.
pub fn write_certificates(path: &Path, certificates: &Certificates) -> Result<(), IoError> {
    write_whole(path, &certificates_to_bytes(certificates).map_err(|error| error.of(path))?)
}

/// Reads certificates.
///
/// # Errors
/// When the file cannot be read, is damaged, of another kind or a newer version, or its parts do not fit.
pub fn read_certificates(path: &Path) -> Result<Certificates, IoError> {
    certificates_from_bytes(&read_whole(path)?).map_err(|error| error.of(path))
}

/// The bytes of a certificate file: the same certificates give the same bytes.
///
/// # Errors
/// None in practice: all names and texts are short.
pub fn certificates_to_bytes(certificates: &Certificates) -> Result<Vec<u8>, FormatError> {
    let parts = certificates.parts();
    let nodes = parts.hierarchy.nodes();
    let columns: Vec<u32> = nodes
        .iter()
        .flat_map(|n| [n.first_triangle, n.triangle_count, n.first_child, n.child_count])
        .collect();
    let (order, scales) = (parts.hierarchy.order(), parts.metric.scales());
    let (node_radii, pair_radii) = (&parts.node_radii, &parts.root_pair_radii);
    let mut writer = SealedWriter::new(CERTIFICATES);
    for (key, text) in RULES {
        writer.text(key, text);
    }
    writer
        .text("metric", parts.metric.kind().name())
        .u8("model_digest", &[32], &parts.digest.0)
        .u32("nodes", &[nodes.len(), 4], &columns)
        .u32("order", &[order.len()], order)
        .f64("node_radii", &[node_radii.len()], node_radii)
        .u8("node_states", &[node_radii.len()], &states(node_radii, parts.global_radius))
        .f64("root_pair_radii", &[pair_radii.len()], pair_radii)
        .u8("root_pair_states", &[pair_radii.len()], &states(pair_radii, parts.global_radius))
        .f64("metric_scales", &[scales.len()], scales)
        .f64("limit", &[1], &[parts.global_radius])
        .f64("epsilon", &[1], &[parts.epsilon])
        .f64("center", &[scales.len()], &vec![0.0; scales.len()])
        .u32("exceptions", &[0, 2], &[])
        .u64("rest_collisions", &[1], &[parts.rest_collisions]);
    writer.finish()
}

/// Parses a certificate file.
///
/// # Errors
/// As [`read_certificates`], but for the file's name.
pub fn certificates_from_bytes(bytes: &[u8]) -> Result<Certificates, FormatError> {
    let file = Sealed::parse(bytes, CERTIFICATES)?;
    file.only(&TENSORS)?;
    for (key, wanted) in RULES {
        let found = file.text(key)?;
        if found != wanted {
            let cause = format!("{} is not known in this version of the format", quoted(found));
            return Err(FormatError::new(Place::Key(key.into()), cause));
        }
    }
    let metric = read_metric(&file)?;
    let rank = metric.scales().len();
    let center = file.f64("center")?.shaped(&[rank])?;
    if center.values.iter().any(|x| *x != 0.0) {
        return Err(center.refused("it is not zero, which this version of the format does not know"));
    }
    file.u32("exceptions")?.shaped(&[0, 2])?;
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
    Ok(Certificates::from_parts(CertificateParts {
        digest,
        hierarchy,
        metric,
        epsilon: epsilon.values[0],
        global_radius: limit,
        node_radii,
        root_pair_radii,
        rest_collisions: file.u64("rest_collisions")?.shaped(&[1])?.values[0],
    })?)
}

fn read_metric(file: &Sealed<'_>) -> Result<Metric, FormatError> {
    let name = file.text("metric")?;
    let kind = MetricKind::from_name(name).ok_or_else(|| {
        FormatError::new(Place::Key("metric".into()), format!("unknown metric {}", quoted(name)))
    })?;
    Ok(Metric::from_scales(kind, file.f64("metric_scales")?.shaped(&[ANY])?.values)?)
}

fn read_hierarchy(file: &Sealed<'_>) -> Result<Hierarchy, FormatError> {
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

/// 1 for a radius that reaches the limit, else 0.
fn states(radii: &[f64], limit: f64) -> Vec<u8> {
    radii.iter().map(|radius| u8::from(*radius >= limit)).collect()
}

#[cfg(test)]
mod tests;
