//! Writer for animated bodies as binary glTF: modes as morph targets, q(t) as their weights, rigid motion on nodes.
//!
//! A player shows `R (p + U q - c) + x` for a body with rotation R about its centre c and position x. Numbers are
//! rounded to single precision (relative error 2^-24). Between key frames players interpolate weights and positions
//! linearly, and rotations on the shortest arc. Bodies of one model share its data in the file.
//!
//! Two animations of one key frame follow the motion, with the minimum and the maximum of each weight. Blender (5.0)
//! needs them: it clamps weights to the range of 0, 1 and the weights of the first key frame of each animation. Players
//! show the first animation, the motion, by default.

use std::path::Path;

use glam::{DQuat, DVec3};
use serde_json::{Value, json};
use sscc::ReducedModel;

use crate::{IoError, write_whole};

/// A model with the name of its mesh.
#[derive(Clone, Copy, Debug)]
pub struct NamedModel<'a> {
    /// The name.
    pub name: &'a str,
    /// The model.
    pub model: &'a ReducedModel,
}

/// Motion of one body: one entry for each key frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Name of the node.
    pub name: String,
    /// Index of the model.
    pub model: usize,
    /// Centre of rotation, in the model.
    pub center: DVec3,
    /// Positions of the centre.
    pub positions: Vec<DVec3>,
    /// Rotations (unit quaternions).
    pub orientations: Vec<DQuat>,
    /// q, frame after frame (r numbers each).
    pub weights: Vec<f64>,
}

/// Writes an animation (`.glb`). `times` are the times of the key frames (s), ascending.
///
/// # Errors
/// When there is no key frame or no track; when the times do not increase in single precision; when a track does not
/// have one entry per time, or its model does not exist; when a number is not finite in single precision; when the file
/// exceeds 4 GiB or cannot be written.
pub fn write_animation(
    path: &Path,
    models: &[NamedModel<'_>],
    times: &[f64],
    tracks: &[Track],
) -> Result<(), IoError> {
    let bytes = animation_to_bytes(models, times, tracks).map_err(|cause| IoError::request(path, cause))?;
    write_whole(path, &bytes)
}

/// Returns the indices of the key frames for about `rate` frames per second: the step nearest to the time of each
/// frame, the first and the last of `steps`. No two have the same time in single precision. `step` is the time step
/// (s). With a rate that is not positive (also NaN), only the first and the last step remain.
pub fn key_frames(steps: usize, step: f64, rate: f64) -> Vec<usize> {
    let Some(last) = steps.checked_sub(1) else { return Vec::new() };
    // Key frames for each step. NaN must fail the comparison, too.
    let per_step = rate * step;
    let stride = if per_step > 0.0 { (1.0 / per_step).max(1.0) } else { f64::INFINITY };
    // With a rate that is not positive or below one frame, only the first and the last step remain.
    let count = if stride.is_finite() { (last as f64 / stride) as usize } else { 0 };
    let mut frames: Vec<usize> =
        (0..=count).map(|frame| ((frame as f64 * stride).round() as usize).min(last)).collect();
    // Times are stored in single precision, in which close frames may coincide.
    let time = |frame: usize| (frame as f64 * step) as f32;
    frames.dedup_by_key(|frame| time(*frame));
    while frames.last().is_some_and(|frame| *frame > 0 && time(*frame) >= time(last)) {
        frames.pop();
    }
    frames.push(last);
    frames.dedup();
    frames
}

/// Returns the bytes of the file that [`write_animation`] writes.
///
/// # Errors
/// As [`write_animation`]; the message has one line without a file name.
pub fn animation_to_bytes(
    models: &[NamedModel<'_>],
    times: &[f64],
    tracks: &[Track],
) -> Result<Vec<u8>, String> {
    check(models, times, tracks)?;
    let mut file = File::default();
    let meshes: Vec<Value> =
        models.iter().map(|named| file.mesh(named.name, named.model)).collect::<Result<_, _>>()?;
    let input = file.accessor(SCALAR, times, None)?;
    let mut nodes = Vec::new();
    let [mut motion, mut minima, mut maxima] =
        ["simulation", "least weights", "greatest weights"].map(Animation::new);
    let start = file.accessor(SCALAR, &times[..1], None)?;
    for track in tracks {
        let (carrier, shape) = (nodes.len(), nodes.len() + 1);
        let flat = |points: &[DVec3]| points.iter().flat_map(|p| p.to_array()).collect::<Vec<f64>>();
        let outputs = [
            (carrier, "translation", file.accessor(VEC3, &flat(&track.positions), None)?),
            (carrier, "rotation", file.accessor(VEC4, &continuous_quaternions(&track.orientations), None)?),
            (shape, "weights", file.accessor(SCALAR, &track.weights, None)?),
        ];
        for (node, path, output) in outputs {
            motion.push(node, path, input, output);
        }
        let rank = models[track.model].model.rank();
        for (animation, pick) in
            [(&mut minima, f64::min as fn(f64, f64) -> f64), (&mut maxima, f64::max as fn(f64, f64) -> f64)]
        {
            let of_mode = |k: usize| track.weights.iter().skip(k).step_by(rank).copied().reduce(pick);
            let weights: Vec<f64> = (0..rank).filter_map(of_mode).collect();
            animation.push(shape, "weights", start, file.accessor(SCALAR, &weights, None)?);
        }
        nodes.push(json!({
            "name": track.name,
            "children": [shape],
            "translation": single_precision(&track.positions[0].to_array()),
            "rotation": single_precision(&track.orientations[0].to_array()),
        }));
        nodes.push(json!({
            "mesh": track.model,
            "translation": single_precision(&(-track.center).to_array()),
            "weights": single_precision(&track.weights[..rank]),
        }));
    }
    let roots: Vec<usize> = (0..nodes.len()).step_by(2).collect();
    let root = json!({
        "asset": {"version": "2.0", "generator": concat!("sscc ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": roots}],
        "nodes": nodes,
        "meshes": meshes,
        "animations": [motion.json(), minima.json(), maxima.json()],
        "accessors": file.accessors,
        "bufferViews": file.views,
        "buffers": [{"byteLength": file.binary.len()}],
    });
    glb(root.to_string().into_bytes(), file.binary)
}

/// Animation of the JSON: samplers and channels.
struct Animation {
    name: &'static str,
    samplers: Vec<Value>,
    channels: Vec<Value>,
}

impl Animation {
    fn new(name: &'static str) -> Self {
        Self { name, samplers: Vec::new(), channels: Vec::new() }
    }

    fn push(&mut self, node: usize, path: &str, input: usize, output: usize) {
        let sampler = self.samplers.len();
        self.channels.push(json!({"sampler": sampler, "target": {"node": node, "path": path}}));
        self.samplers.push(json!({"input": input, "output": output, "interpolation": "LINEAR"}));
    }

    fn json(self) -> Value {
        json!({"name": self.name, "samplers": self.samplers, "channels": self.channels})
    }
}

fn check(models: &[NamedModel<'_>], times: &[f64], tracks: &[Track]) -> Result<(), String> {
    if times.is_empty() || tracks.is_empty() {
        return Err("an animation needs a key frame and a body".into());
    }
    // Times in the precision of the file.
    if let Some(at) = times.windows(2).position(|pair| (pair[0] as f32) >= pair[1] as f32) {
        return Err(format!("key frame {} is not later than the one before it: times must increase", at + 1));
    }
    for Track { name, model, positions, orientations, weights, .. } in tracks {
        let Some(NamedModel { model, .. }) = models.get(*model) else {
            return Err(format!("body {name} refers to model {model}, but there are {}", models.len()));
        };
        let [n, rank] = [times.len(), model.rank()];
        if [positions.len(), orientations.len()] != [n, n] || weights.len() != n * rank {
            return Err(format!("body {name} needs one entry for each of the {n} key frames"));
        }
    }
    Ok(())
}

/// Returns the components x y z w of rotations, each with the sign that is nearest to its predecessor (q and -q are the
/// same rotation).
fn continuous_quaternions(orientations: &[DQuat]) -> Vec<f64> {
    let mut previous = DQuat::IDENTITY;
    let mut values = Vec::with_capacity(4 * orientations.len());
    for rotation in orientations {
        previous = if rotation.dot(previous) < 0.0 { -*rotation } else { *rotation };
        values.extend(previous.to_array());
    }
    values
}

fn single_precision(values: &[f64]) -> Vec<f32> {
    values.iter().map(|x| *x as f32).collect()
}

/// Name and width of the accessor type of numbers.
const SCALAR: (&str, usize) = ("SCALAR", 1);

/// Name and width of the accessor type of vectors.
const VEC3: (&str, usize) = ("VEC3", 3);

/// Name and width of the accessor type of quaternions.
const VEC4: (&str, usize) = ("VEC4", 4);

/// Target of views with vertices.
const VERTICES: u32 = 34962;

/// Target of views with indices.
const CORNERS: u32 = 34963;

/// Binary data of the file, with its views and accessors.
#[derive(Default)]
struct File {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    fn mesh(&mut self, name: &str, model: &ReducedModel) -> Result<Value, String> {
        let rest = model.mesh().rest_positions();
        let flat = |of: &dyn Fn(usize) -> DVec3| -> Vec<f64> {
            (0..rest.len()).flat_map(|v| of(v).to_array()).collect()
        };
        let position = self.accessor(VEC3, &flat(&|v| rest[v]), Some(VERTICES))?;
        let targets: Vec<Value> = (0..model.rank())
            .map(|k| {
                let values = flat(&|v| model.modes().of_vertex(v as u32)[k]);
                Ok(json!({"POSITION": self.accessor(VEC3, &values, Some(VERTICES))?}))
            })
            .collect::<Result<_, String>>()?;
        let corners = model.mesh().faces().as_flattened();
        let view = self.view(corners.iter().flat_map(|v| v.to_le_bytes()), Some(CORNERS));
        let indices = self.accessors.len();
        self.accessors.push(
            json!({"bufferView": view, "componentType": 5125, "count": corners.len(), "type": "SCALAR"}),
        );
        Ok(json!({
            "name": name,
            "primitives": [{"attributes": {"POSITION": position}, "indices": indices, "targets": targets}],
            "weights": vec![0.0; model.rank()],
        }))
    }

    /// Adds single precision numbers with their bounds, which the format requires for positions and times.
    fn accessor(
        &mut self,
        (kind, width): (&str, usize),
        values: &[f64],
        target: Option<u32>,
    ) -> Result<usize, String> {
        let values = single_precision(values);
        if let Some(x) = values.iter().find(|x| !x.is_finite()) {
            return Err(format!(
                "a number of the animation is {x} in single precision: scale the model down"
            ));
        }
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            let item = |c: usize| values.iter().skip(c).step_by(width).copied();
            (0..width).filter_map(|c| item(c).reduce(pick)).collect()
        };
        let (min, max) = (bound(f32::min), bound(f32::max));
        let view = self.view(values.iter().flat_map(|x| x.to_le_bytes()), target);
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5126, "count": values.len() / width, "type": kind,
            "min": min, "max": max,
        }));
        Ok(self.accessors.len() - 1)
    }

    fn view(&mut self, bytes: impl Iterator<Item = u8>, target: Option<u32>) -> usize {
        let start = self.binary.len();
        self.binary.extend(bytes);
        let mut view = json!({"buffer": 0, "byteOffset": start, "byteLength": self.binary.len() - start});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.views.push(view);
        self.views.len() - 1
    }
}

/// Joins header and both chunks. Only the JSON needs padding: all numbers have 4 bytes.
fn glb(mut json: Vec<u8>, binary: Vec<u8>) -> Result<Vec<u8>, String> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + json.len() + 8 + binary.len();
    let size = |n: usize| u32::try_from(n).map(u32::to_le_bytes);
    let (Ok(all), Ok(first), Ok(second)) = (size(total), size(json.len()), size(binary.len())) else {
        return Err(format!(
            "the animation has {total} bytes, but a file can have at most 4 GiB: use fewer key frames"
        ));
    };
    let mut bytes = Vec::with_capacity(total);
    for part in [&b"glTF"[..], &2_u32.to_le_bytes(), &all, &first, b"JSON", &json, &second, b"BIN\0", &binary]
    {
        bytes.extend(part);
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests;
