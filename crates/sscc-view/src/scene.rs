//! What the page shows, as the JSON that it reads.

use glam::DVec3;
use serde::Serialize;
use sscc::{Certificates, ReducedModel};

use crate::extremal::{Extremal, extremal};
use crate::levels::{Level, levels};
use crate::{Arrays, Playback, Plot, ViewError};

/// All that a page shows. Numbers that are not finite become `null`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// Its title.
    pub title: String,
    /// Of this program.
    pub version: &'static str,
    /// The shapes.
    pub models: Vec<ModelScene>,
    /// Further plots.
    pub plots: Vec<Plot>,
    /// A motion.
    pub playback: Option<Playback>,
    /// Lines of a table: label and value.
    pub summary: Vec<(String, String)>,
}

impl Scene {
    /// Nothing yet.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            version: env!("CARGO_PKG_VERSION"),
            models: Vec::new(),
            plots: Vec::new(),
            playback: None,
            summary: Vec::new(),
        }
    }
}

/// A shape, and what its certificates say.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelScene {
    name: String,
    triangles: usize,
    vertices: usize,
    rank: usize,
    arrays: ModelArrays,
    /// At rest.
    #[serde(rename = "box")]
    bounds: Bounds,
    frequencies: Option<Vec<f64>>,
    mode_names: Option<Vec<String>>,
    /// `z_k = scales[k] (q_k - center_k)`, where the metric is diagonal.
    scales: Option<Vec<f64>>,
    center: Vec<f64>,
    default_q: Vec<f64>,
    limits: Vec<f64>,
    root_radius: f64,
    global_radius: f64,
    /// The limit of the pair tree: below it no pair of nodes is opened without need; none where there is no tree.
    resolved_up_to: Option<f64>,
    metric: &'static str,
    exceptions: usize,
    nodes: usize,
    levels: Vec<Level>,
    extremal: Vec<Extremal>,
}

/// Names of the arrays of a shape.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct ModelArrays {
    positions: String,
    faces: String,
    modes: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

/// What files say of a model beside its shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelDetails {
    /// Of each mode (Hz), where it is known.
    pub frequencies: Option<Vec<f64>>,
    /// Of each mode, or none.
    pub mode_names: Vec<String>,
    /// The q that a file shows when nothing moves it; none: the centre.
    pub default_q: Option<Vec<f64>>,
}

impl ModelScene {
    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Describes a model, and adds its arrays under names that end in `-INDEX`.
    ///
    /// # Errors
    /// When the certificates are of another model, or its numbers are too large for the page.
    pub fn new(
        index: usize,
        name: impl Into<String>,
        model: &ReducedModel,
        certificates: &Certificates,
        details: ModelDetails,
        arrays: &mut Arrays,
    ) -> Result<Self, ViewError> {
        certificates.check_model(model)?;
        let rest = model.mesh().rest_positions();
        let (min, max) = bounds(rest);
        let (limits, rank) = (limits(model, (max - min).length()), model.rank());
        let farthest = limits.iter().fold(1.0_f64, |far, x| far.max(*x)) * LARGEST_SLIDERS;
        let modes = model.modes().displacements();
        if !rest.iter().chain(modes).all(|v| fits(*v)) || farthest > f64::from(f32::MAX) {
            return Err(ViewError::Range);
        }
        let singles = |v: &DVec3| v.as_vec3().to_array();
        let of_mode = |k: usize| modes.iter().skip(k).step_by(rank).flat_map(singles);
        let names = ModelArrays {
            positions: arrays.add_f32(format!("positions-{index}"), rest.iter().flat_map(singles)),
            faces: arrays
                .add_u32(format!("faces-{index}"), model.mesh().faces().as_flattened().iter().copied()),
            modes: arrays.add_f32(format!("modes-{index}"), (0..rank).flat_map(of_mode)),
        };
        let metric = certificates.metric();
        Ok(Self {
            name: name.into(),
            triangles: model.mesh().faces().len(),
            vertices: rest.len(),
            rank,
            arrays: names,
            bounds: Bounds { min: min.to_array(), max: max.to_array() },
            frequencies: details.frequencies,
            mode_names: Some(details.mode_names).filter(|names| !names.is_empty()),
            scales: metric.dense_factor().is_none().then(|| metric.scales()),
            center: certificates.center().to_vec(),
            default_q: details.default_q.unwrap_or_else(|| certificates.center().to_vec()),
            limits,
            root_radius: certificates.root_radius(),
            global_radius: certificates.global_radius(),
            resolved_up_to: Some(certificates.parts().pair_tree.limit()).filter(|limit| *limit > 0.0),
            metric: metric.kind().name(),
            exceptions: certificates.exceptions().len(),
            nodes: certificates.hierarchy().nodes().len(),
            levels: levels(certificates),
            extremal: extremal(certificates),
        })
    }
}

/// The box around all vertices; of no vertices a point.
fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let Some(first) = points.first() else { return (DVec3::ZERO, DVec3::ZERO) };
    points.iter().fold((*first, *first), |(min, max), p| (min.min(*p), max.max(*p)))
}

/// For each mode how far from the centre the vertex that it moves farthest has moved by half the box's diagonal; 1 for
/// modes that move nothing.
fn limits(model: &ReducedModel, diagonal: f64) -> Vec<f64> {
    let mut fastest = vec![0.0_f64; model.rank()];
    for (i, u) in model.modes().displacements().iter().enumerate() {
        let fastest = &mut fastest[i % model.rank()];
        *fastest = fastest.max(u.length());
    }
    let limit = |fastest: f64| 0.5 * diagonal / fastest;
    fastest.into_iter().map(limit).map(|x| if x.is_finite() && x > 0.0 { x } else { 1.0 }).collect()
}

/// The page may go so many times farther than its sliders.
const LARGEST_SLIDERS: f64 = 1e6;

/// Far enough from the largest single precision number that sums over modes stay finite.
const LARGEST: f64 = 1e30;

fn fits(v: DVec3) -> bool {
    v.abs().max_element() <= LARGEST
}
