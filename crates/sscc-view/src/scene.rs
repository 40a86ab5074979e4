//! The scene of the page: the JSON that describes models, plots and motions.

use glam::DVec3;
use serde::Serialize;
use sscc::{Certificates, ReducedModel};
use sscc_tasks::IntervalRow;

use crate::error::check_certificates;
use crate::reduced_facts::{ModelDetails, ReducedFacts};
use crate::{Arrays, Playback, Plot, ViewError};

/// A scene: models, plots, a motion and a table. Numbers that are not finite become `null`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// Title of the page.
    pub title: String,
    /// Version of this program.
    pub version: &'static str,
    /// The models and meshes.
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

/// A shape: a model with modes and certificates, or a mesh whose positions a recording gives.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelScene {
    name: String,
    triangles: usize,
    vertices: usize,
    arrays: ModelArrays,
    /// The AABB of the rest pose; for a mesh, the AABB of all recorded positions.
    #[serde(rename = "box")]
    bounds: Bounds,
    /// Absent in a mesh.
    #[serde(flatten)]
    reduced: Option<ReducedFacts>,
}

/// Names of a model's arrays.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct ModelArrays {
    positions: String,
    faces: String,
    /// Absent in a mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    modes: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

impl ModelScene {
    /// Returns the model's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the description of a model and adds its arrays, whose names end in `-INDEX`.
    ///
    /// # Errors
    /// If the certificates belong to another model or have a clearance, or a number of the model exceeds the range of the page.
    pub fn new(
        index: usize,
        name: impl Into<String>,
        model: &ReducedModel,
        certificates: &Certificates,
        details: ModelDetails,
        arrays: &mut Arrays,
    ) -> Result<Self, ViewError> {
        check_certificates(model, certificates)?;
        let rest = model.mesh().rest_positions();
        let (min, max) = bounds(rest);
        let reduced = ReducedFacts::new(model, certificates, details);
        let modes = model.modes().displacements();
        if !rest.iter().chain(modes).all(|v| fits(*v)) || !reduced.fits() {
            return Err(ViewError::Range);
        }
        let rank = model.rank();
        let singles = |v: &DVec3| v.as_vec3().to_array();
        let of_mode = |k: usize| modes.iter().skip(k).step_by(rank).flat_map(singles);
        let names = ModelArrays {
            positions: arrays.add_f32(format!("positions-{index}"), rest.iter().flat_map(singles)),
            faces: arrays
                .add_u32(format!("faces-{index}"), model.mesh().faces().as_flattened().iter().copied()),
            modes: Some(arrays.add_f32(format!("modes-{index}"), (0..rank).flat_map(of_mode))),
        };
        Ok(Self {
            name: name.into(),
            triangles: model.mesh().faces().len(),
            vertices: rest.len(),
            arrays: names,
            bounds: Bounds { min: min.to_array(), max: max.to_array() },
            reduced: Some(reduced),
        })
    }

    /// Returns the scene with the intervals of collision of all modes about the initial q, which the page marks along the
    /// sliders. Their ranges are those of the sliders.
    #[must_use]
    pub fn with_intervals(mut self, intervals: Vec<IntervalRow>) -> Self {
        if let Some(reduced) = &mut self.reduced {
            reduced.ranges = intervals.iter().map(|row| [row.from, row.to]).collect();
            reduced.intervals = Some(intervals);
        }
        self
    }

    /// Returns the description of a mesh without modes, and adds its arrays, whose names end in `-INDEX`.
    ///
    /// `faces`: three vertex numbers for each triangle. `positions`: three coordinates for each vertex, at the first frame.
    /// `bounds`: the AABB of all frames, as minimum and maximum. All are in the coordinates of the page.
    pub(crate) fn of_mesh(
        index: usize,
        name: impl Into<String>,
        faces: &[u32],
        positions: &[f32],
        (min, max): (DVec3, DVec3),
        arrays: &mut Arrays,
    ) -> Self {
        Self {
            name: name.into(),
            triangles: faces.len() / 3,
            vertices: positions.len() / 3,
            arrays: ModelArrays {
                positions: arrays.add_f32(format!("positions-{index}"), positions.iter().copied()),
                faces: arrays.add_u32(format!("faces-{index}"), faces.iter().copied()),
                modes: None,
            },
            bounds: Bounds { min: min.to_array(), max: max.to_array() },
            reduced: None,
        }
    }
}

/// Returns the AABB of points, as minimum and maximum; zero for no points.
fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let Some(first) = points.first() else { return (DVec3::ZERO, DVec3::ZERO) };
    points.iter().fold((*first, *first), |(min, max), p| (min.min(*p), max.max(*p)))
}

/// Largest coordinate and displacement on the page. Sums over modes then stay finite in single precision.
const MAX_COORDINATE: f64 = 1e30;

/// Whether the page can show a position or a displacement.
pub(crate) fn fits(v: DVec3) -> bool {
    v.abs().max_element() <= MAX_COORDINATE
}
