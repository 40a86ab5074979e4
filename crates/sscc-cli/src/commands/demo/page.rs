//! The report of the demo: the page with the spring's animation.

use anyhow::Result;
use sscc::Certificates;
use sscc_io::Rows;
use sscc_modes::mode_frequencies;
use sscc_modes::shapes::ElasticShape;
use sscc_view::{
    Arrays, Axis, Body, Colliding, ModelDetails, ModelScene, Playback, Plot, Report as Page, Scene, Series,
};

use super::frames::{Answers, Frames};
use super::report::Report;

/// Frames in a second.
const RATE: f64 = 30.0;

/// One file of HTML.
pub fn html(
    spring: &ElasticShape,
    certificates: &Certificates,
    animation: &Rows,
    frames: &Frames,
    report: &Report,
) -> Result<String> {
    let mut arrays = Arrays::default();
    let mut scene = Scene::new("A double-helix spring, shaken ever harder");
    let frequencies = mode_frequencies(spring.elasticity.stiffness());
    let details = ModelDetails { frequencies, ..ModelDetails::default() };
    scene.models.push(ModelScene::new(0, "spring", &spring.model, certificates, details, &mut arrays)?);
    scene.summary = report.table();
    let times: Vec<f64> = (0..animation.rows).map(|frame| frame as f64 / RATE).collect();
    let pairs = &frames.certified.pairs;
    let (mut offsets, mut triangles): (Vec<u32>, Vec<u32>) = (vec![0], Vec::new());
    for pairs in pairs {
        let mut own: Vec<u32> = pairs.iter().flat_map(|(i, j)| [*i, *j]).collect();
        own.sort_unstable();
        own.dedup();
        triangles.extend(own);
        offsets.push(triangles.len() as u32);
    }
    let line = |name, answers: &Answers| {
        let milliseconds = answers.microseconds.iter().map(|t| 1e-3 * t);
        Series::new(name, times.iter().zip(milliseconds).map(|(time, cost)| [*time, cost]))
    };
    let costs = Plot {
        title: "Cost over time".into(),
        x: Axis::linear("time (s)"),
        y: Axis::logarithmic("one query, ms"),
        series: vec![
            line("traditional", &frames.traditional),
            line("BD-tree", &frames.bd_tree),
            line("certified", &frames.certified),
        ],
    };
    scene.playback = Some(Playback {
        bodies: vec![Body {
            name: "spring".into(),
            model: 0,
            q: arrays.add_f32("q-0", animation.data.iter().map(|x| *x as f32)),
            rigid: None,
            center: [0.0; 3],
            pairs: Some(pairs.iter().map(|pairs| pairs.len() as u64).collect()),
        }],
        pairs_since: None,
        colliding: Some(Colliding {
            offsets: arrays.add_u32("colliding-offsets", offsets),
            triangles: arrays.add_u32("colliding-triangles", triangles),
        }),
        times,
        ground: None,
        sound: None,
        costs: Some(costs),
    });
    Ok(Page { scene, arrays }.html()?)
}
