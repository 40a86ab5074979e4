//! Reports of meshes without modes.

use glam::DVec3;
use sscc::TriMesh;
use sscc::parts::Surface;
use sscc_tasks::text::{counted, file_name, grouped, one_line};
use sscc_tasks::{DetectionAnswer, LeftOut, ShapeInMotion};

use super::contact_segments::contact_segments;
use super::node_pairs::NodePairs;
use super::recorded_body::RecordedBody;
use super::recording::Recording;
use crate::{Arrays, Axis, MAX_REPORT_BYTES, PAGE, Plot, Report, Scene, Series, ViewError};

/// Maximum size of a frame of a body in the text of a report (bytes): time, numbers of pairs, plots.
const FRAME_BYTES: u64 = 160;

/// Number of pairs whose contacts are computed at a time. It bounds memory.
const MAX_CONTACTS: usize = 1 << 16;

/// Maximum number of bodies with a row of their own in the report's table.
const MAX_ROWS: usize = 20;

/// A report of meshes, of their frames or of animations, built from the answers of [`detect`](sscc_tasks::detect) in their
/// order.
///
/// Positions are stored in single precision, relative to the middle of the first frame.
#[derive(Default)]
pub struct MeshReport {
    center: DVec3,
    bodies: Vec<RecordedBody>,
    /// The files of the meshes, each once; between two meshes, the files of both.
    files: Vec<String>,
    /// Time of each frame (s), for animations.
    times: Option<Vec<f64>>,
    /// Time of the queries of each frame (microseconds).
    microseconds: Vec<f64>,
    is_continuous: bool,
    is_between: bool,
    /// The pairs of different nodes of a scene.
    node_pairs: Vec<NodePairs>,
    left_out: LeftOut,
    /// Size of the pairs and segments of all bodies and node pairs (bytes).
    contact_bytes: usize,
    /// Size in the report of the positions that are recorded and of those still to be recorded (bytes).
    planned_bytes: u64,
}

impl MeshReport {
    /// Adds an answer.
    ///
    /// # Errors
    /// If the answer has no positions; if it is not the next answer of its mesh, in the order of the indices from 0; if a
    /// coordinate exceeds the range of the page (1e30); if the report would exceed [`MAX_REPORT_BYTES`].
    pub fn add(&mut self, answer: &DetectionAnswer<'_>) -> Result<(), ViewError> {
        let shape = answer.shape.ok_or_else(|| ViewError::Request("the answers have no positions".into()))?;
        if answer.index == 0 {
            self.begin(answer, shape)?;
        }
        let first = self.bodies.len().checked_sub(1 + usize::from(answer.other.is_some()));
        let first = first.ok_or_else(|| ViewError::Request("the first answer is missing".into()))?;
        let next = self.bodies[first].pairs.frames();
        if answer.index != next {
            let cause = format!("the answer with index {} was added where {next} is next", answer.index);
            return Err(ViewError::Request(cause));
        }
        let is_last_step = answer.times.is_some() && answer.index + 2 == answer.frames;
        for (body, shape) in self.bodies[first..].iter_mut().zip([shape].into_iter().chain(answer.other)) {
            body.push_positions(shape.x_t0, self.center)?;
            if is_last_step {
                body.push_positions(shape.x_t1, self.center)?;
            }
        }
        // The size is checked before the pairs are copied.
        let impact_bytes = if self.is_continuous { 4 } else { 0 };
        self.check_size((8 + impact_bytes) * answer.pairs.len())?;
        let before = self.bodies[first].contact_bytes();
        self.bodies[first].push_pairs(answer);
        self.contact_bytes += self.bodies[first].contact_bytes() - before;
        let center = self.center;
        for pairs in answer.pairs.chunks(MAX_CONTACTS) {
            let body = &mut self.bodies[first];
            let before = body.contact_bytes();
            let found = contact_segments(surface(shape), answer.other.map(surface), pairs, |ends| {
                let [a, b] = ends.map(|p| (p - center).as_vec3().to_array());
                body.segments.push([a[0], a[1], a[2], b[0], b[1], b[2]]);
            });
            self.contact_bytes += body.contact_bytes() - before;
            found?;
            self.check_size(0)?;
        }
        self.bodies[first].segments.end_frame();
        let frames = self.microseconds.len().max(answer.index + 1);
        self.microseconds.resize(frames, 0.0);
        self.microseconds[answer.index] += answer.microseconds;
        Ok(())
    }

    /// Adds an answer about two nodes of a scene, whose own answers have been added.
    ///
    /// # Errors
    /// If the answer has no positions; if no answer of one of the nodes, or of this frame, has been added; if the report would
    /// exceed [`MAX_REPORT_BYTES`].
    pub fn add_between_nodes(&mut self, answer: &DetectionAnswer<'_>) -> Result<(), ViewError> {
        let shapes = answer.shape.zip(answer.other);
        let (shape, other) =
            shapes.ok_or_else(|| ViewError::Request("the answers have no positions".into()))?;
        let body = |node: Option<usize>| self.bodies.iter().position(|body| body.node == node);
        let bodies = body(answer.node).zip(body(answer.other_node));
        let bodies = bodies.filter(|_| answer.index < self.microseconds.len());
        let (a, b) = bodies.ok_or_else(|| ViewError::Request("the answer of a node is missing".into()))?;
        self.check_size(12 * answer.pairs.len())?;
        let mut segments = Vec::new();
        for pairs in answer.pairs.chunks(MAX_CONTACTS) {
            contact_segments(surface(shape), Some(surface(other)), pairs, |ends| {
                let [a, b] = ends.map(|p| (p - self.center).as_vec3().to_array());
                segments.push([a[0], a[1], a[2], b[0], b[1], b[2]]);
            })?;
            self.check_size(12 * answer.pairs.len() + size_of_val(&segments[..]))?;
        }
        let pairs = NodePairs {
            frame: answer.index,
            bodies: [a, b],
            pairs: answer.pairs.to_vec(),
            impacts: answer.times.into_iter().flatten().map(|time| *time as f32).collect(),
            segments,
        };
        self.contact_bytes += pairs.bytes();
        self.node_pairs.push(pairs);
        self.microseconds[answer.index] += answer.microseconds;
        Ok(())
    }

    /// Begins the bodies of a mesh with its first answer.
    fn begin(&mut self, answer: &DetectionAnswer<'_>, shape: ShapeInMotion<'_>) -> Result<(), ViewError> {
        if self.bodies.is_empty() {
            self.center = middle(shape.x_t0);
            self.times = answer.frame_times.map(<[f64]>::to_vec);
        }
        self.is_continuous = answer.times.is_some();
        self.is_between = answer.other.is_some();
        self.left_out = std::mem::take(&mut self.left_out).and(answer.left_out);
        let nodes = [answer.node, answer.other_node].into_iter().zip(answer.node_names);
        for (shape, node) in [shape].into_iter().chain(answer.other).zip(nodes) {
            let file = one_line(&file_name(shape.file));
            let name = match node {
                (Some(node), Some(name)) => format!("node {node} {}", one_line(name)),
                (Some(node), None) => format!("node {node}"),
                (None, _) => file.clone(),
            };
            if !self.files.contains(&file) || self.is_between {
                self.files.push(file);
            }
            self.planned_bytes = self.planned_bytes.saturating_add(planned_bytes(shape.mesh, answer.frames));
            self.bodies.push(RecordedBody::new(name, node.0, shape.mesh));
        }
        self.check_size(0)
    }

    /// Returns an error if the report would be too large with `more` further bytes.
    fn check_size(&self, more: usize) -> Result<(), ViewError> {
        let contacts = (more + self.contact_bytes) as u64;
        let bytes = (PAGE.len() as u64 + in_base64(contacts)).saturating_add(self.planned_bytes);
        if bytes > MAX_REPORT_BYTES { Err(ViewError::TooLarge) } else { Ok(()) }
    }

    /// Returns the report as one HTML file.
    ///
    /// # Errors
    /// If it exceeds [`MAX_REPORT_BYTES`].
    pub fn html(self) -> Result<String, ViewError> {
        let of_bodies: usize = self.bodies.iter().map(RecordedBody::contact_bytes).sum();
        let of_pairs: usize = self.node_pairs.iter().map(NodePairs::bytes).sum();
        debug_assert_eq!(self.contact_bytes, of_bodies + of_pairs, "the running sum is the sum");
        let frames = self.microseconds.len() + usize::from(self.is_continuous);
        let recording = Recording {
            center: self.center,
            bodies: self.bodies,
            times: self.times,
            frames,
            is_continuous: self.is_continuous,
            is_between: self.is_between,
            node_pairs: self.node_pairs,
            left_out: self.left_out,
        };
        let mut arrays = Arrays::default();
        let mut scene = Scene::new(self.files.join(if self.is_between { " against " } else { ", " }));
        scene.summary = summary(&recording);
        let (models, mut playback) = recording.scene(&mut arrays);
        if frames > 1 {
            let [pairs, costs] = plots(&recording, &self.microseconds);
            playback.costs = Some(pairs);
            scene.plots.push(costs);
        }
        (scene.models, scene.playback) = (models, Some(playback));
        let html = Report { scene, arrays, checks: None }.html()?;
        if html.len() as u64 > MAX_REPORT_BYTES { Err(ViewError::TooLarge) } else { Ok(html) }
    }
}

/// Returns the middle of the AABB; zero for no points.
fn middle(points: &[DVec3]) -> DVec3 {
    let Some(first) = points.first() else { return DVec3::ZERO };
    let (min, max) = points.iter().fold((*first, *first), |(min, max), p| (min.min(*p), max.max(*p)));
    0.5 * min + 0.5 * max
}

fn surface(shape: ShapeInMotion<'_>) -> Surface<'_> {
    Surface { faces: shape.mesh.faces(), positions: shape.x_t0 }
}

/// Returns the size of the positions, the faces and the text of the frames of a body in a report (bytes).
fn planned_bytes(mesh: &TriMesh, frames: usize) -> u64 {
    let frame = 12 * mesh.rest_positions().len() as u64;
    // The first frame is stored twice.
    let positions = frame.saturating_mul(frames as u64 + 1);
    let arrays = positions.saturating_add(12 * mesh.faces().len() as u64);
    in_base64(arrays).saturating_add(FRAME_BYTES.saturating_mul(frames as u64))
}

fn in_base64(bytes: u64) -> u64 {
    bytes.saturating_add(bytes / 3)
}

/// Returns the rows of the table: the kind of check, and the colliding frames of each body.
fn summary(recording: &Recording) -> Vec<(String, String)> {
    let row = |label: &str, value: String| (label.to_owned(), value);
    let noun = if recording.is_continuous { "step" } else { "frame" };
    let queries = recording.frames - usize::from(recording.is_continuous);
    let colliding =
        |counts: &mut dyn Iterator<Item = usize>| counts.filter(|count| *count > 0).count() as u64;
    let all = colliding(&mut recording.counts().into_iter().map(|count| count as usize));
    let checked = match recording.is_continuous {
        true => "each step from a frame to the next, every vertex on a straight line",
        false => "each frame by itself",
    };
    let mut rows = vec![
        row("checked", checked.into()),
        row("colliding", format!("{} of {}", all, counted(queries as u64, noun))),
    ];
    let left_out = recording.left_out.to_string();
    if !left_out.is_empty() {
        rows.push(row("not tested", left_out));
    }
    if recording.times.is_some() && !recording.is_timed() {
        rows.push(row(
            "note",
            "the times do not ascend: the page plays 30 frames a second, in their order".into(),
        ));
    }
    for (index, body) in recording.bodies.iter().enumerate().take(MAX_ROWS) {
        let triangles = counted((body.faces.len() / 3) as u64, "triangle");
        let vertices = grouped(body.vertices as u64);
        let own = colliding(&mut (0..queries).map(|frame| usize::from(recording.collides(index, frame))));
        let is_alone = recording.bodies.len() == 1 || recording.is_between;
        let collides =
            if is_alone { String::new() } else { format!(", colliding in {}", counted(own, noun)) };
        let name = if recording.is_between && index == 1 {
            format!("against {}", body.name)
        } else {
            body.name.clone()
        };
        rows.push((name, format!("{triangles}, vertices: {vertices}{collides}")));
    }
    if recording.bodies.len() > MAX_ROWS {
        rows.push(row("bodies", format!("{} in total", recording.bodies.len())));
    }
    rows
}

/// Returns the number of pairs and the time of the queries, over the frames.
fn plots(recording: &Recording, microseconds: &[f64]) -> [Plot; 2] {
    let times = recording.playback_times();
    let label = if recording.is_timed() { "time (s)" } else { "time (s), 30 frames a second" };
    let plot = |title: &str, y: Axis, name: &str, values: &mut dyn Iterator<Item = f64>| Plot {
        title: title.into(),
        x: Axis::linear(label),
        y,
        series: vec![Series::new(name, times.iter().zip(values).map(|(time, y)| [*time, y]))],
    };
    let counts = recording.counts();
    let queries = microseconds.len();
    [
        plot(
            "Colliding pairs over time",
            Axis::linear("pairs"),
            "pairs",
            &mut counts.iter().take(queries).map(|count| *count as f64),
        ),
        plot(
            "Cost over time",
            Axis::logarithmic("queries of a frame, ms"),
            "sscc",
            &mut microseconds.iter().map(|t| 1e-3 * t),
        ),
    ]
}
