//! Reports of animations: one shape, with its q and its colliding pairs in every frame.

use sscc::{Certificates, ReducedModel};
use sscc_tasks::LeftOut;

use crate::{
    Arrays, Axis, Body, Clock, Colliding, ModelDetails, ModelScene, Playback, Plot, Report, Scene, Series,
    Track, ViewError,
};

/// An animation of one shape, and the answers of the queries in its frames.
pub struct Animation<'a> {
    /// The title of the page.
    pub title: &'a str,
    /// Name of the shape on the page.
    pub name: &'a str,
    /// The shape.
    pub model: &'a ReducedModel,
    /// Certificates of the shape.
    pub certificates: &'a Certificates,
    /// Frequency of each mode (Hz); `None` where unknown.
    pub frequencies: Option<Vec<f64>>,
    /// Frames per second.
    pub rate: f64,
    /// The q of all frames (frames x r), row by row.
    pub q: &'a [f64],
    /// The colliding triangle pairs of each frame.
    pub pairs: &'a [Vec<(u32, u32)>],
    /// For each method its name and the time of its query in each frame (microseconds).
    pub costs: Vec<(&'a str, &'a [f64])>,
    /// Rows of the summary table: label and value.
    pub summary: Vec<(String, String)>,
}

impl Animation<'_> {
    /// Returns the report as one HTML file.
    ///
    /// # Errors
    /// If the certificates belong to another model, or a number exceeds the range of the page (1e30).
    pub fn report(self) -> Result<String, ViewError> {
        let mut arrays = Arrays::default();
        let mut scene = Scene::new(self.title);
        let details = ModelDetails { frequencies: self.frequencies, ..ModelDetails::default() };
        let (model, certificates) = (self.model, self.certificates);
        scene.models.push(ModelScene::new(0, self.name, model, certificates, details, &mut arrays)?);
        scene.summary = self.summary;
        let times: Vec<f64> = (0..self.pairs.len()).map(|frame| frame as f64 / self.rate).collect();
        let (mut offsets, mut triangles): (Vec<u32>, Vec<u32>) = (vec![0], Vec::new());
        for pairs in self.pairs {
            let mut own: Vec<u32> = pairs.iter().flat_map(|(i, j)| [*i, *j]).collect();
            own.sort_unstable();
            own.dedup();
            triangles.extend(own);
            offsets.push(triangles.len() as u32);
        }
        let series = |(name, microseconds): (&str, &[f64])| {
            let milliseconds = microseconds.iter().map(|t| 1e-3 * t);
            Series::new(name, times.iter().zip(milliseconds).map(|(time, cost)| [*time, cost]))
        };
        let costs = Plot {
            title: "Cost over time".into(),
            x: Axis::linear("time (s)"),
            y: Axis::logarithmic("one query, ms"),
            series: self.costs.into_iter().map(series).collect(),
        };
        scene.playback = Some(Playback {
            bodies: vec![Body {
                name: self.name.into(),
                model: 0,
                track: Track::Q(arrays.add_f32("q-0", self.q.iter().map(|x| *x as f32))),
                rigid: None,
                center: [0.0; 3],
                pairs: Some(self.pairs.iter().map(|pairs| pairs.len() as u64).collect()),
            }],
            pairs_since: None,
            apart: LeftOut::of(certificates.filter()).apart(),
            colliding: Some(Colliding {
                offsets: arrays.add_u32("colliding-offsets", offsets),
                triangles: arrays.add_u32("colliding-triangles", triangles),
            }),
            contacts: None,
            curves: None,
            clock: Clock::Time,
            times,
            ground: None,
            sound: None,
            costs: Some(costs),
        });
        Ok(Report { scene, arrays, checks: None }.html()?)
    }
}
