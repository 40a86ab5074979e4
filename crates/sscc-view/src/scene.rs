//! The scene of the page: the JSON that describes models, plots and motions.

use glam::DVec3;
use serde::Serialize;
use sscc::{Certificates, ReducedModel};

use crate::extremal::{Extremal, extremal};
use crate::levels::{Level, levels};
use crate::{Arrays, Playback, Plot, ViewError};

/// A scene: models, plots, a motion and a table. Numbers that are not finite become `null`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// Title of the page.
    pub title: String,
    /// Version of this program.
    pub version: &'static str,
    /// The models.
    pub models: Vec<ModelScene>,
    /// Plots beside those of models and motions.
    pub plots: Vec<Plot>,
    /// A recorded motion.
    pub playback: Option<Playback>,
    /// Rows of the summary table: label and value.
    pub summary: Vec<(String, String)>,
}

impl Scene {
    /// Returns an empty scene.
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

/// A model and the facts of its certificates.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelScene {
    name: String,
    triangles: usize,
    vertices: usize,
    rank: usize,
    arrays: ModelArrays,
    /// The AABB of the rest pose.
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
    /// The limit of the pair tree: below it the pair tree contains every node pair that can collide. `None` if the pair
    /// tree is empty.
    resolved_up_to: Option<f64>,
    metric: &'static str,
    exceptions: usize,
    nodes: usize,
    levels: Vec<Level>,
    extremal: Vec<Extremal>,
}

/// Names of a model's arrays.
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

/// Facts about a model that its file may state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelDetails {
    /// Frequency of each mode (Hz); `None` where unknown.
    pub frequencies: Option<Vec<f64>>,
    /// Name of each mode; empty where unknown.
    pub mode_names: Vec<String>,
    /// The initial q of the page; `None`: the centre.
    pub default_q: Option<Vec<f64>>,
}

impl ModelScene {
    /// The model's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the description of a model and adds its arrays, whose names end in `-INDEX`.
    ///
    /// # Errors
    /// If the certificates belong to another model, or a number of the model exceeds the range of the page.
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
        let farthest = limits.iter().fold(1.0_f64, |far, x| far.max(*x)) * MAX_SLIDER_SCALE;
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

/// The AABB of points, as minimum and maximum; zero for no points.
fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let Some(first) = points.first() else { return (DVec3::ZERO, DVec3::ZERO) };
    points.iter().fold((*first, *first), |(min, max), p| (min.min(*p), max.max(*p)))
}

/// For each mode the range of its slider. At its end the vertex that moves farthest has moved by half the diagonal of
/// the AABB. It is 1 for a mode without displacement.
fn limits(model: &ReducedModel, diagonal: f64) -> Vec<f64> {
    let mut fastest = vec![0.0_f64; model.rank()];
    for (i, u) in model.modes().displacements().iter().enumerate() {
        let fastest = &mut fastest[i % model.rank()];
        *fastest = fastest.max(u.length());
    }
    let limit = |fastest: f64| 0.5 * diagonal / fastest;
    fastest.into_iter().map(limit).map(|x| if x.is_finite() && x > 0.0 { x } else { 1.0 }).collect()
}

/// The page may show displacements up to this multiple of its sliders' range.
const MAX_SLIDER_SCALE: f64 = 1e6;

/// Largest coordinate and displacement on the page. Sums over modes then stay finite in single precision.
const MAX_COORDINATE: f64 = 1e30;

fn fits(v: DVec3) -> bool {
    v.abs().max_element() <= MAX_COORDINATE
}
