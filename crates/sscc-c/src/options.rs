//! Options of certificates, and the contact filter.
#![allow(unsafe_code, reason = "structs of the caller")]

use sscc::{
    CertifyOptions, ContactFilter, Metric, MetricKind, Neighbours, ReducedModel, TriMesh, TriangleGroups,
};

use crate::pointers::{Versioned, read_versioned, slice};
use crate::status::{Failure, Result};
use crate::types::sscc_pair;

/// The largest number of threads: as many as a machine may have. More would exhaust the system.
const MAX_THREADS: usize = 1024;

/// Whether triangles that share vertices count.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum sscc_neighbours {
    /// Pairs with common vertices never count.
    Exclude = 0,
    /// Pairs with exactly one common vertex count when they have another point in common.
    IncludeOneVertex = 1,
    /// Pairs with common vertices count when they have a common point other than these and the edges between them.
    /// Doubled faces always count. This is for discrete queries of detectors only.
    IncludeFolded = 2,
}

/// Whether vertices of equal positions (and modes) are one vertex, for adjacency only.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum sscc_weld {
    /// The default of the mesh: on for files of formats that split vertices (STL, glTF), otherwise off.
    Default = 0,
    /// Vertices of equal positions are one vertex.
    On = 1,
    /// All vertices are different.
    Off = 2,
}

/// The contact filter: which pairs of triangles count. Set `size` to `sizeof(sscc_filter)`; all other fields are 0 by default.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct sscc_filter {
    /// `sizeof(sscc_filter)`.
    pub size: usize,
    /// Pairs that never count, in any order.
    pub ignored: *const sscc_pair,
    /// Number of ignored pairs.
    pub ignored_count: usize,
    /// A group for each triangle (below 65,536). Without groups: NULL, with `groups_count` 0.
    pub groups: *const u32,
    /// Number of triangles in `groups`.
    pub groups_count: usize,
    /// 1: pairs within one group do not count, which needs `groups`. 0: groups have no effect.
    pub between_groups_only: i32,
    /// One of SSCC_WELD_DEFAULT, SSCC_WELD_ON, SSCC_WELD_OFF.
    pub weld: i32,
    /// One of SSCC_NEIGHBOURS_EXCLUDE, SSCC_NEIGHBOURS_INCLUDE_ONE_VERTEX, SSCC_NEIGHBOURS_INCLUDE_FOLDED.
    pub neighbours: i32,
    /// Must be 0.
    pub reserved: i32,
}

// No padding: the size is the sum of the fields. A target on which this fails is not supported.
const _: () = assert!(size_of::<sscc_filter>() == 5 * size_of::<usize>() + 4 * size_of::<i32>());

// SAFETY: zeros are valid, the size is first, there is no padding.
unsafe impl Versioned for sscc_filter {}

/// The metric in which radii are measured, |z| = |S (q - center)|.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum sscc_metric {
    /// The metric of the model.
    Model = 0,
    /// Each mode is scaled by its largest vertex displacement.
    Displacement = 1,
    /// Each mode is scaled by its root mean square displacement, weighted by area.
    Mass = 2,
    /// All weights are 1.
    Identity = 3,
    /// S is the diagonal matrix of `scales`.
    Scales = 4,
}

/// The kinds of radii that certificates store.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum sscc_scheme {
    /// Radii of nodes and node pairs, and local certificates.
    Full = 0,
    /// One radius for each node, and for each pair of the root's children, which takes little time and memory.
    Paper = 1,
}

/// Options of certificates. Set `size` to `sizeof(sscc_certify_options)`; all other fields are 0 by default.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct sscc_certify_options {
    /// `sizeof(sscc_certify_options)`.
    pub size: usize,
    /// Relative tolerance of the root's radius, in (0, 1); 0 means 0.1.
    pub epsilon: f64,
    /// The largest radius, in units of the paper's global radius: finite, at least 1; 0 means 1. It has no effect with
    /// SSCC_SCHEME_PAPER.
    pub reach: f64,
    /// The q from which radii are measured, r numbers. NULL, with `center_count` 0, means q = 0.
    pub center: *const f64,
    /// Number of entries of `center`.
    pub center_count: usize,
    /// One positive number for each mode, for SSCC_METRIC_SCALES.
    pub scales: *const f64,
    /// Number of entries of `scales`.
    pub scales_count: usize,
    /// Which pairs count; NULL means the default of the mesh.
    pub filter: *const sscc_filter,
    /// Memory of the pair tree, in bytes for each triangle; 0 means 64. SSCC_SCHEME_PAPER stores none.
    pub budget: usize,
    /// Memory of local certificates, in bytes for each triangle; 0 means 64. SSCC_SCHEME_PAPER stores none.
    pub local_budget: usize,
    /// The largest number of exceptions (pairs that collide at the centre); 0 means half the number of triangles,
    /// rounded up. If more pairs collide there, none is an exception, and nodes that contain one have radius 0.
    pub max_exceptions: usize,
    /// Number of threads, of which at most 1024 are started; 0 means all cores. The certificates are the same for any number.
    pub threads: usize,
    /// One of SSCC_METRIC_MODEL, SSCC_METRIC_DISPLACEMENT, SSCC_METRIC_MASS, SSCC_METRIC_IDENTITY, SSCC_METRIC_SCALES.
    pub metric: i32,
    /// One of SSCC_SCHEME_FULL, SSCC_SCHEME_PAPER. With SSCC_SCHEME_PAPER both budgets must be 0.
    pub scheme: i32,
    /// 1: pairs that collide at rest never count, and neither do those within `ignore_rings` rings of them.
    pub ignore_rest: i32,
    /// Rings around pairs that collide at rest. They have no effect if `ignore_rest` is 0.
    pub ignore_rings: u32,
}

// No padding, as for `sscc_filter`. With pointers of 32 bits, most targets would have padding before `epsilon`.
const _: () = assert!(
    size_of::<sscc_certify_options>()
        == 10 * size_of::<usize>() + 2 * size_of::<f64>() + 4 * size_of::<i32>()
);

// SAFETY: zeros are valid, the size is first, there is no padding.
unsafe impl Versioned for sscc_certify_options {}

/// Returns the contact filter of a mesh.
///
/// # Errors
/// As [`read_versioned`], and as [`slice`] for the arrays; when a field has an invalid value, or a pair names no
/// triangle.
///
/// # Safety
/// As [`read_versioned`], and the arrays have as many elements as the struct states.
pub unsafe fn contact_filter(filter: *const sscc_filter, mesh: &TriMesh) -> Result<ContactFilter> {
    // SAFETY: by the caller's guarantee.
    let filter = unsafe { read_versioned(filter, "filter") }?;
    let neighbours = choose(
        &[Neighbours::Exclude, Neighbours::IncludeOneVertex, Neighbours::IncludeFolded],
        filter.neighbours,
        "filter.neighbours",
    )?;
    let weld = choose(&[mesh.has_split_vertices(), true, false], filter.weld, "filter.weld")?;
    let is_between_only = choose(&[false, true], filter.between_groups_only, "filter.between_groups_only")?;
    // SAFETY: by the caller's guarantee, here and below.
    let ignored = unsafe { slice(filter.ignored, filter.ignored_count, "filter.ignored") }?;
    let groups = unsafe { slice(filter.groups, filter.groups_count, "filter.groups") }?;
    if filter.reserved != 0 {
        return Err(Failure::argument(format!("filter.reserved is {}: it must be 0", filter.reserved)));
    }
    if is_between_only && filter.groups.is_null() {
        return Err(Failure::argument("filter.between_groups_only needs filter.groups"));
    }
    let triangles = mesh.faces().len();
    if let Some(pair) = ignored.iter().position(|pair| pair.a.max(pair.b) as usize >= triangles) {
        let sscc_pair { a, b } = ignored[pair];
        return Err(sscc::Error::PairIndex { pair, triangle: a.max(b), triangles }.into());
    }
    let mut chosen =
        ContactFilter::new(neighbours).weld(weld).ignoring(ignored.iter().map(|pair| (pair.a, pair.b)));
    if !filter.groups.is_null() {
        let groups = TriangleGroups::new(groups)?;
        chosen = chosen.with_groups(if is_between_only { groups.between_only() } else { groups });
    }
    Ok(chosen)
}

/// Returns the options for certificates of a model. The computation itself checks `epsilon`, `reach` and `center`.
///
/// # Errors
/// As [`contact_filter`]; when options exclude each other, or the metric cannot be used for the model.
///
/// # Safety
/// As [`contact_filter`].
pub unsafe fn certify_options(
    options: *const sscc_certify_options,
    model: &ReducedModel,
) -> Result<CertifyOptions> {
    // SAFETY: by the caller's guarantee.
    let given = unsafe { read_versioned(options, "options") }?;
    let mut options = CertifyOptions::default();
    let is_paper = choose(&[false, true], given.scheme, "options.scheme")?;
    if is_paper && (given.budget, given.local_budget) != (0, 0) {
        return Err(Failure::argument(
            "options: SSCC_SCHEME_PAPER stores no pair tree and no local certificates: leave both budgets 0",
        ));
    }
    if is_paper {
        options = options.budget(0).local_budget(0);
    }
    if given.budget > 0 {
        options = options.budget(given.budget);
    }
    if given.local_budget > 0 {
        options = options.local_budget(given.local_budget);
    }
    if given.epsilon != 0.0 {
        options = options.epsilon(given.epsilon);
    }
    if given.reach != 0.0 {
        options = options.reach(given.reach);
    }
    if choose(&[false, true], given.ignore_rest, "options.ignore_rest")? {
        options = options.ignore_rest(given.ignore_rings);
    }
    // SAFETY: by the caller's guarantee.
    let center = unsafe { slice(given.center, given.center_count, "options.center") }?;
    if !given.center.is_null() {
        options = options.center(center.to_vec());
    }
    if !given.filter.is_null() {
        // SAFETY: by the caller's guarantee.
        options = options.filter(unsafe { contact_filter(given.filter, model.mesh()) }?);
    }
    // SAFETY: by the caller's guarantee.
    let scales = unsafe { slice(given.scales, given.scales_count, "options.scales") }?;
    let some = |count: usize| (count > 0).then_some(count);
    Ok(options
        .metric(metric(given.metric, scales, model)?)
        .max_exceptions(some(given.max_exceptions))
        .threads(some(given.threads.min(MAX_THREADS))))
}

/// Returns the metric of an option; `None` for the metric of the model.
fn metric(kind: i32, scales: &[f64], model: &ReducedModel) -> Result<Option<Metric>> {
    let (mesh, modes) = (model.mesh(), model.modes());
    if !scales.is_empty() && kind != sscc_metric::Scales as i32 {
        return Err(Failure::argument("options.scales are for SSCC_METRIC_SCALES"));
    }
    if kind == sscc_metric::Scales as i32 && scales.len() != model.rank() {
        let (found, rank) = (scales.len(), model.rank());
        return Err(Failure::argument(format!(
            "options.scales has {found} entries, the model has {rank} modes"
        )));
    }
    Ok(match kind {
        0 => None,
        1 => Some(Metric::displacement(mesh, modes)?),
        2 => Some(Metric::mass(mesh, modes)?),
        3 => Some(Metric::identity(model.rank())),
        4 => Some(Metric::from_scales(MetricKind::Given, scales.to_vec())?),
        _ => return Err(no_value("options.metric", kind)),
    })
}

/// Returns the value with that number.
fn choose<T: Copy>(values: &[T], number: i32, name: &str) -> Result<T> {
    let value = usize::try_from(number).ok().and_then(|i| values.get(i).copied());
    value.ok_or_else(|| no_value(name, number))
}

fn no_value(name: &str, number: i32) -> Failure {
    Failure::argument(format!("{name} is {number}: that is none of its values"))
}
