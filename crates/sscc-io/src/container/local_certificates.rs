//! Local certificates in certificate files: optional tensors, whose names begin with `local_`.

use sscc::parts::{LocalBounds, LocalCertificates};

use super::{ANY, Container, ContainerWriter};
use crate::{FormatError, Place};

const NODES: &str = "local_nodes";
const MODE_STARTS: &str = "local_mode_starts";
const MODES: &str = "local_modes";
const GRADIENTS: &str = "local_gradients";
const ELLIPSOIDS: &str = "local_ellipsoids";
const BOUNDS: &str = "local_bounds";
const LIST_STARTS: &str = "local_list_starts";
const LIST_NODES: &str = "local_list_nodes";
const LIST_RATIOS: &str = "local_list_ratios";

/// The names of the tensors.
pub(super) const TENSORS: [&str; 9] =
    [BOUNDS, ELLIPSOIDS, GRADIENTS, LIST_NODES, LIST_RATIOS, LIST_STARTS, MODE_STARTS, MODES, NODES];

/// The version of files with local certificates.
pub(super) const VERSION: u32 = 7;

/// The first version with local certificates. It has no flat patches.
const FIRST_VERSION: u32 = 6;

/// Number of bounds of a certificate.
const BOUND_COUNT: usize = 9;

/// Number of bounds of a certificate in the first version.
const FIRST_BOUND_COUNT: usize = 5;

/// Writes local certificates, if there are any.
pub(super) fn write(writer: &mut ContainerWriter, local: &LocalCertificates) {
    if local.nodes.is_empty() {
        return;
    }
    // Each U32 has two numbers: earlier builds cannot read U16, and would not report that a newer version wrote the file.
    // The layout has an even number of them.
    let pair = |&[low, high]: &[u16; 2]| u32::from(low) | u32::from(high) << 16;
    let ellipsoids: Vec<u32> = local.ellipsoids.as_chunks().0.iter().map(pair).collect();
    let bounds: Vec<f64> = local
        .bounds
        .iter()
        .flat_map(|b| {
            let [x, y, z] = b.across;
            [b.ratio, b.per_factor, b.per_error, b.steepest, b.widest, x, y, z, b.flatness]
        })
        .collect();
    writer
        .u32(NODES, &[local.nodes.len()], &local.nodes)
        .u32(MODE_STARTS, &[local.mode_starts.len()], &local.mode_starts)
        .u32(MODES, &[local.modes.len()], &local.modes)
        .f32(GRADIENTS, &[local.gradients.len()], &local.gradients)
        .u32(ELLIPSOIDS, &[ellipsoids.len()], &ellipsoids)
        .f64(BOUNDS, &[local.bounds.len(), BOUND_COUNT], &bounds)
        .u32(LIST_STARTS, &[local.list_starts.len()], &local.list_starts)
        .u32(LIST_NODES, &[local.list_nodes.len()], &local.list_nodes)
        .f32(LIST_RATIOS, &[local.list_ratios.len()], &local.list_ratios);
}

/// Reads local certificates; empty if the file has none. [`sscc::Certificates::try_from`] checks that they fit the
/// hierarchy.
pub(super) fn read(file: &Container<'_>) -> Result<LocalCertificates, FormatError> {
    let names = file.names();
    let Some(name) = names.into_iter().find(|name| TENSORS.contains(&name.as_str())) else {
        return Ok(LocalCertificates::default());
    };
    if file.version() < FIRST_VERSION {
        return Err(FormatError::new(Place::Tensor(name), "not known in this version of the format"));
    }
    let u32s = |name: &str| -> Result<Vec<u32>, FormatError> { Ok(file.u32(name)?.shaped(&[ANY])?.values) };
    let f32s = |name: &str, count: usize| -> Result<Vec<f32>, FormatError> {
        Ok(file.f32(name)?.shaped(&[count])?.values)
    };
    let nodes = u32s(NODES)?;
    if nodes.is_empty() {
        return Err(FormatError::new(
            Place::Tensor(NODES.into()),
            "it is empty: files without local certificates have no such tensor",
        ));
    }
    let pairs = u32s(ELLIPSOIDS)?;
    let count = if file.version() < VERSION { FIRST_BOUND_COUNT } else { BOUND_COUNT };
    let bounds = file.f64(BOUNDS)?.shaped(&[nodes.len(), count])?.values;
    let bound = |of: &[f64]| {
        let at = |i: usize| of.get(i).copied();
        let [ratio, per_factor, per_error, steepest, widest] = std::array::from_fn(|i| of[i]);
        let across = std::array::from_fn(|i| at(FIRST_BOUND_COUNT + i).unwrap_or(0.0));
        let flatness = at(BOUND_COUNT - 1).unwrap_or(f64::INFINITY);
        LocalBounds { ratio, per_factor, per_error, steepest, widest, across, flatness }
    };
    let list_nodes = u32s(LIST_NODES)?;
    Ok(LocalCertificates {
        mode_starts: u32s(MODE_STARTS)?,
        modes: u32s(MODES)?,
        gradients: f32s(GRADIENTS, ANY)?,
        ellipsoids: pairs.iter().flat_map(|pair| [*pair as u16, (*pair >> 16) as u16]).collect(),
        bounds: bounds.chunks_exact(count).map(bound).collect(),
        list_starts: u32s(LIST_STARTS)?,
        list_ratios: f32s(LIST_RATIOS, list_nodes.len())?,
        nodes,
        list_nodes,
    })
}
