//! Reports of meshes without modes: their data, and their refusals.

use std::path::Path;
use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use serde_json::{Value, json};
use sscc::{ContactFilter, Pair, TriMesh};
use sscc_tasks::{DetectionAnswer, LeftOut, ShapeInMotion};
use sscc_view::{MeshReport, Report};

/// A coordinate at which single precision has steps of 8.
const FAR: f64 = 1e8;

/// Returns two triangles: one in the plane z = 0, and an upright one that begins at this height.
fn positions(height: f64) -> Vec<DVec3> {
    let corners = [
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [0.0, 4.0, 0.0],
        [1.0, 1.0, height],
        [1.0, 1.0, height + 2.0],
        [1.0, -3.0, height + 2.0],
    ];
    corners.iter().map(|p| DVec3::from_array(*p) + FAR).collect()
}

fn mesh() -> TriMesh {
    TriMesh::new(positions(1.0), vec![[0, 1, 2], [3, 4, 5]]).unwrap()
}

/// Returns the answer at a frame of `frames` frames.
fn answer<'a>(
    mesh: &'a TriMesh,
    index: usize,
    frames: usize,
    pairs: &'a [Pair],
    x: [&'a [DVec3]; 2],
) -> DetectionAnswer<'a> {
    static LEFT_OUT: LazyLock<LeftOut> = LazyLock::new(|| LeftOut::of(&ContactFilter::default()));
    let file = Path::new("folder/mesh.obj");
    DetectionAnswer {
        file,
        mesh,
        node: None,
        other_node: None,
        node_names: [None; 2],
        index,
        time: None,
        pairs,
        times: None,
        penetrations: None,
        curves: None,
        near: None,
        enclosed: None,
        body_penetration: None,
        is_complete: true,
        microseconds: 2000.0,
        norm: None,
        root_certified: None,
        proof: None,
        exceptions: 0,
        left_out: &LEFT_OUT,
        opened: 0,
        box_tests: 0,
        triangle_tests: 0,
        queries: frames,
        frames,
        frame_times: None,
        shape: Some(ShapeInMotion { file, mesh, x_t0: x[0], x_t1: x[1] }),
        other: None,
    }
}

/// Returns the data of a report.
fn data(report: MeshReport) -> Value {
    let html = report.html().unwrap();
    // The report can be rebuilt, as `sscc view` does.
    assert_eq!(Report::rebuild(&html).unwrap(), html);
    let (_, rest) = html.split_once("id=\"sscc-report\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

fn bytes(data: &Value, name: &Value) -> Vec<[u8; 4]> {
    let bytes = STANDARD.decode(data["arrays"][name.as_str().unwrap()].as_str().unwrap()).unwrap();
    bytes.chunks_exact(4).map(|chunk| chunk.try_into().unwrap()).collect()
}

fn floats(data: &Value, name: &Value) -> Vec<f64> {
    bytes(data, name).into_iter().map(|b| f64::from(f32::from_le_bytes(b))).collect()
}

fn integers(data: &Value, name: &Value) -> Vec<u32> {
    bytes(data, name).into_iter().map(u32::from_le_bytes).collect()
}

#[test]
fn frames_have_positions_pairs_and_curves() {
    let mesh = mesh();
    let frames = [1.0, -1.0, 0.25].map(positions);
    let lists = [vec![], vec![(0, 1)], vec![]];
    let mut report = MeshReport::default();
    for (index, (x, pairs)) in frames.iter().zip(&lists).enumerate() {
        report.add(&answer(&mesh, index, 3, pairs, [x, &[]])).unwrap();
    }
    let data = data(report);
    let scene = &data["scene"];
    assert_eq!(scene["title"], "mesh.obj");
    let model = &scene["models"][0];
    for absent in ["rank", "metric", "root_radius", "levels"] {
        assert!(model.get(absent).is_none(), "{absent}");
    }
    assert_eq!(model["arrays"], json!({"positions": "positions-0", "faces": "faces-0"}));
    assert_eq!(integers(&data, &model["arrays"]["faces"]), [0, 1, 2, 3, 4, 5]);
    let playback = &scene["playback"];
    let body = &playback["bodies"][0];
    assert!(body.get("q").is_none());
    assert_eq!((&body["pairs"], &playback["clock"]), (&json!([0, 1, 0]), &json!("frame")));
    // All coordinates are exact, in spite of the offset.
    let center: Vec<f64> = body["center"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    let shown = floats(&data, &body["positions"]);
    let due = frames.iter().flatten().flat_map(|p| p.to_array());
    for (i, due) in due.enumerate() {
        assert_eq!(shown[i] + center[i % 3], due, "{i}");
    }
    assert_eq!(shown.len(), 3 * 18);
    assert_eq!(model["box"], json!({"min": [-2.0, -3.5, -2.5], "max": [2.0, 3.5, 1.5]}));
    let contacts = &playback["contacts"];
    assert_eq!(integers(&data, &contacts["offsets"]), [0, 0, 1, 1]);
    assert_eq!(integers(&data, &contacts["pairs"]), [0, 1]);
    assert_eq!((&contacts["times"], &contacts["is_between"]), (&Value::Null, &json!(false)));
    assert_eq!(integers(&data, &playback["curves"]["offsets"]), [0, 0, 1, 1]);
    // From (1, 0, 0) to (1, 1, 0) in the mesh's coordinates, in either order.
    let mut segment = floats(&data, &playback["curves"]["segments"]);
    segment.iter_mut().enumerate().for_each(|(i, x)| *x += center[i % 3] - FAR);
    let is_reversed = segment[1] > segment[4];
    segment.rotate_left(if is_reversed { 3 } else { 0 });
    assert_eq!(segment, [1.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
    let rows = scene["summary"].as_array().unwrap();
    assert!(rows.contains(&json!(["colliding", "1 of 3 frames"])), "{rows:?}");
}

#[test]
fn steps_have_times_of_impact_and_one_more_frame() {
    let mesh = mesh();
    let frames = [1.0, 0.5, -1.0].map(positions);
    let times = [0.25, 0.75, 1.0];
    let mut report = MeshReport::default();
    for index in 0..2 {
        let pairs = &[(0, 1)][..index];
        let mut answer = answer(&mesh, index, 3, pairs, [&frames[index], &frames[index + 1]]);
        answer.times = Some(&[0.5][..index]);
        answer.frame_times = Some(&times);
        answer.time = Some(times[index]);
        report.add(&answer).unwrap();
    }
    let data = data(report);
    let playback = &data["scene"]["playback"];
    assert_eq!((&playback["times"], &playback["clock"]), (&json!(times), &json!("frame_and_time")));
    assert_eq!(playback["bodies"][0]["pairs"], json!([0, 1, 0]));
    assert_eq!(floats(&data, &playback["bodies"][0]["positions"]).len(), 3 * 18);
    assert_eq!(integers(&data, &playback["contacts"]["offsets"]), [0, 0, 1, 1]);
    assert_eq!(floats(&data, &playback["contacts"]["times"]), [0.5]);
    // The pair has no common point at the frame before its impact.
    assert_eq!(integers(&data, &playback["curves"]["offsets"]), [0, 0, 0, 0]);
    let rows = data["scene"]["summary"].as_array().unwrap();
    assert!(rows.contains(&json!(["colliding", "1 of 2 steps"])), "{rows:?}");
}

#[test]
fn pairs_of_two_meshes_belong_to_two_bodies() {
    let x = positions(-1.0);
    let [lower, upright] =
        [0, 3].map(|start| TriMesh::new(x[start..start + 3].to_vec(), vec![[0, 1, 2]]).unwrap());
    let mut both = answer(&lower, 0, 1, &[(0, 0)], [&x[..3], &[]]);
    let file = Path::new("other.obj");
    both.other = Some(ShapeInMotion { file, mesh: &upright, x_t0: &x[3..], x_t1: &[] });
    let mut report = MeshReport::default();
    report.add(&both).unwrap();
    let data = data(report);
    assert_eq!(data["scene"]["title"], "mesh.obj against other.obj");
    let playback = &data["scene"]["playback"];
    assert_eq!(playback["contacts"]["is_between"], true);
    assert_eq!(playback["bodies"][0]["pairs"], json!([1]));
    assert_eq!(playback["bodies"][1]["pairs"], Value::Null);
    assert_eq!(playback["bodies"][0]["center"], playback["bodies"][1]["center"]);
    assert_eq!(integers(&data, &playback["contacts"]["offsets"]), [0, 1, 1]);
    assert_eq!(integers(&data, &playback["curves"]["offsets"]), [0, 1]);
}

#[test]
fn times_that_do_not_ascend_are_played_in_their_order() {
    let (mesh, x) = (mesh(), positions(1.0));
    let mut report = MeshReport::default();
    for index in 0..2 {
        let mut answer = answer(&mesh, index, 2, &[], [&x, &[]]);
        answer.frame_times = Some(&[2.0, 1.0]);
        report.add(&answer).unwrap();
    }
    let playback = &data(report)["scene"]["playback"];
    assert_eq!((&playback["times"], &playback["clock"]), (&json!([0.0, 1.0 / 30.0]), &json!("frame")));
}

#[test]
fn numbers_and_sizes_beyond_the_limits_of_the_page_are_refused() {
    let (mesh, x) = (mesh(), positions(1.0));
    // 6 vertices of 16 bytes in base64 each, in every frame.
    let too_many =
        MeshReport::default().add(&answer(&mesh, 0, 3_000_000, &[], [&x, &[]])).unwrap_err().to_string();
    assert_eq!(
        too_many,
        "the report would be larger than 256 MiB, the limit of sscc view: give fewer frames"
    );
    MeshReport::default().add(&answer(&mesh, 0, 500_000, &[], [&x, &[]])).unwrap();
    // Pairs count towards the size as well.
    let pairs = vec![(0, 0); 30_000_000];
    let error = MeshReport::default().add(&answer(&mesh, 0, 1, &pairs, [&x, &[]])).unwrap_err();
    assert_eq!(error.to_string(), too_many);

    let far: Vec<DVec3> = x.iter().map(|p| *p * 1e30).collect();
    let error = MeshReport::default().add(&answer(&mesh, 0, 1, &[], [&far, &[]])).unwrap_err();
    assert!(error.to_string().contains("beyond 1e30"), "{error}");
    let mut without = answer(&mesh, 0, 1, &[], [&x, &[]]);
    without.shape = None;
    assert_eq!(MeshReport::default().add(&without).unwrap_err().to_string(), "the answers have no positions");
    let error = MeshReport::default().add(&answer(&mesh, 1, 2, &[], [&x, &[]])).unwrap_err();
    assert_eq!(error.to_string(), "the first answer is missing");
}

#[test]
fn answers_out_of_order_are_refused() {
    let (mesh, x) = (mesh(), positions(1.0));
    let at = |index| answer(&mesh, index, 4, &[], [&x, &[]]);
    let mut report = MeshReport::default();
    report.add(&at(0)).unwrap();
    let error = report.add(&at(2)).unwrap_err();
    assert_eq!(error.to_string(), "the answer with index 2 was added where 1 is next");
    report.add(&at(1)).unwrap();
    let node = |node, index| DetectionAnswer { node: Some(node), ..at(index) };
    let mut report = MeshReport::default();
    report.add(&node(0, 0)).unwrap();
    report.add(&node(1, 0)).unwrap();
    for (index, is_known) in [(0, true), (1, false)] {
        let other = ShapeInMotion { file: Path::new("folder/mesh.obj"), mesh: &mesh, x_t0: &x, x_t1: &[] };
        let between = DetectionAnswer { other: Some(other), other_node: Some(1), ..node(0, index) };
        assert_eq!(report.add_between_nodes(&between).is_ok(), is_known);
    }
}
