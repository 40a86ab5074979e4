//! Answers of a live page equal those of the core.

use glam::DVec3;
use serde_json::{Value, json};
use sscc::{
    Certificates, CertifyOptions, Clearance, Error, Method, ModeRange, Modes, Proof, Query, ReducedModel,
    TriMesh,
};
use sscc_view::{Arrays, Live, ModelDetails, ModelScene, Picture, Scene, ViewError};

use crate::common::{Client, scene, strips, with_server};

fn check(client: &Client, request: &Value) -> Value {
    let reply = client.post("/api/check", &request.to_string());
    assert_eq!(reply.status, 200, "{}", String::from_utf8_lossy(&reply.body));
    reply.json()
}

#[test]
fn answers_are_those_of_the_query() {
    let (model, certificates) = strips();
    let mut query = Query::new(&model, &certificates).unwrap();
    let mut kinds = [0; 3];
    with_server(|client| {
        for i in 0..60 {
            let amplitude = f64::from(i) * 0.04;
            let q: Vec<f64> = (0..3).map(|k| (f64::from(i) * 1.7 + f64::from(k)).sin() * amplitude).collect();
            let answer = check(client, &json!({"q": q, "serial": i, "nodes": true}));
            let pairs = query.discrete(&q).unwrap().to_vec();
            let statistics = query.statistics();
            assert_eq!(answer["pairs"], json!(pairs));
            assert_eq!((&answer["serial"], &answer["count"]), (&json!(i), &json!(pairs.len())));
            assert_eq!(
                (&answer["colliding"], &answer["complete"]),
                (&json!(!pairs.is_empty()), &json!(true))
            );
            assert_eq!(
                (&answer["norm"], &answer["root_certified"], &answer["proof"]),
                (
                    &json!(query.statistics().norm),
                    &json!(statistics.root_certified),
                    &json!(statistics.proof.to_string())
                )
            );
            assert_eq!(
                (&answer["opened"], &answer["box_tests"], &answer["triangle_tests"]),
                (&json!(statistics.opened), &json!(statistics.box_tests), &json!(statistics.triangle_tests))
            );
            assert_eq!(answer["root_share"], json!(query.statistics().norm / certificates.root_radius()));
            let mut triangles: Vec<u32> = pairs.iter().flat_map(|(i, j)| [*i, *j]).collect();
            triangles.sort_unstable();
            triangles.dedup();
            assert_eq!(answer["triangles"], json!(triangles));
            let opened = answer["nodes"]["opened"].as_array().unwrap().len();
            assert_eq!(opened == 0, statistics.proof == Proof::Radius);
            kinds[if pairs.is_empty() { usize::from(statistics.root_certified) } else { 2 }] += 1;
            let slow = client.post("/api/traditional", &json!({"q": q}).to_string()).json();
            assert_eq!((&slow["count"], &slow["complete"]), (&json!(pairs.len()), &json!(true)));
        }
    });
    assert!(kinds.iter().all(|count| *count > 3), "{kinds:?}");
}

#[test]
fn counts_at_the_limit_are_lower_bounds() {
    // Triangles in planes of constant y, and triangles in planes of constant x, which are 10 away at rest. At q = 1 each of the
    // first crosses each of the second: 102,400 pairs.
    const PLANES: usize = 320;
    let offset = |i: usize| i as f64 / PLANES as f64;
    let corners = [[-1.0, -1.0], [2.0, -1.0], [0.5, 1.0]];
    let first = (0..PLANES).flat_map(|i| corners.map(|[u, z]| DVec3::new(u, offset(i), z)));
    let second = (0..PLANES).flat_map(|i| corners.map(|[u, z]| DVec3::new(10.0 + offset(i), u, z)));
    let faces = (0..2 * PLANES as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = TriMesh::new(first.chain(second).collect(), faces).unwrap();
    let is_moved = |row: usize| row / 3 >= 3 * PLANES && row.is_multiple_of(3);
    let modes = Modes::from_matrix(6 * PLANES, 1, |row, _| if is_moved(row) { -10.0 } else { 0.0 });
    let model = ReducedModel::new(mesh, modes.unwrap()).unwrap();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let live = Live::new(&model, &certificates, Scene::new("planes"), Arrays::default(), None).unwrap();
    let at = json!({"q": [1.0]});
    let checked = live.check(&serde_json::from_value(at.clone()).unwrap()).unwrap();
    let traditional = live.traditional(&serde_json::from_value(at).unwrap()).unwrap();
    for answer in [json!(checked), json!(traditional)] {
        assert_eq!((&answer["count"], &answer["complete"]), (&json!(100_000), &json!(false)));
    }
}

#[test]
fn a_search_finds_the_first_collision() {
    let (model, certificates) = strips();
    let mut query = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    with_server(|client| {
        for direction in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [3.0, 5.0, 0.1], [10.0, 0.0, 0.0]] {
            let answer = client.post("/api/safe_scale", &json!({"direction": direction}).to_string()).json();
            let certified = answer["certified"].as_f64().unwrap();
            let scale = answer["first"]["scale"].as_f64().unwrap();
            let at = |scale: f64| direction.map(|d| d * scale);
            assert!(certified <= scale && certified > 0.5 * scale, "{answer}");
            assert_eq!((&answer["searched"], &answer["complete"]), (&json!(scale), &json!(true)));
            // Flat strips pass each other without a collision at any float.
            let colliding = query.discrete(&at(scale)).unwrap();
            assert_eq!(colliding.is_empty(), direction[2] == 0.0);
            assert!(!answer["first"]["pairs"].as_array().unwrap().is_empty());
            if !colliding.is_empty() {
                assert_eq!(answer["first"]["pairs"], json!(colliding));
            }
            for i in 0..100 {
                assert!(query.discrete(&at(scale * (1.0 - 1e-6) * f64::from(i) / 99.0)).unwrap().is_empty());
            }
        }
        // The strips move apart, too far to the side, or not at all.
        for direction in [[-1.0, 0.0, 0.0], [0.3, 5.0, 0.1], [0.0, 0.0, 0.0]] {
            let answer = client.post("/api/safe_scale", &json!({"direction": direction}).to_string()).json();
            assert_eq!((&answer["first"], &answer["complete"]), (&Value::Null, &json!(true)));
        }
    });
}

#[test]
fn sweeps_of_modes_are_those_of_the_core() {
    let (model, certificates) = strips();
    let query = Query::new(&model, &certificates).unwrap();
    let q = [0.25, 0.5, 0.1];
    with_server(|client| {
        // Mode 0 lowers the upper strip through the lower one, mode 1 shifts it, mode 2 bends its end down.
        for (mode, range, hits) in [
            (0, [-1.0, 1.5], [true, false]),
            (1, [0.0, 1.0], [false, false]),
            (2, [-2.0, 2.0], [true, false]),
            // The q is outside the range: the sweep begins at the nearer end.
            (0, [0.5, 1.5], [true, false]),
        ] {
            let request = json!({"q": q, "mode": mode, "range": range}).to_string();
            let reply = client.post("/api/sweep", &request);
            assert_eq!(reply.status, 200, "{reply:?}");
            let answer = reply.json();
            let sweeps = query
                .sweep_modes(&q, &[ModeRange { mode, low: range[0], high: range[1] }], None, &())
                .unwrap();
            assert_eq!(answer.as_array().unwrap().len(), sweeps.len());
            for ((answer, sweep), hit) in answer.as_array().unwrap().iter().zip(&sweeps).zip(hits) {
                assert_eq!((&answer["from"], &answer["to"]), (&json!(sweep.from), &json!(sweep.to)));
                assert_eq!(answer["first_free"], json!(sweep.first_free));
                assert_eq!(answer["first_hit"], json!(sweep.first_hit));
                assert_eq!(answer["pairs"], json!(sweep.pairs));
                assert_eq!(answer["count"], json!(sweep.pairs.len()));
                assert_eq!(answer["first_hit"].is_number(), hit, "{answer}");
            }
        }
    });
}

#[test]
fn intervals_of_modes_are_those_of_the_core() {
    let (model, certificates) = strips();
    let query = Query::new(&model, &certificates).unwrap();
    let q = [0.25, 0.5, 0.1];
    with_server(|client| {
        for (mode, range, count) in [(0, [-1.0, 1.5], 1), (1, [0.0, 1.0], 0), (2, [-2.0, 2.0], 1)] {
            let request = json!({"q": q, "mode": mode, "range": range}).to_string();
            let reply = client.post("/api/intervals", &request);
            assert_eq!(reply.status, 200, "{reply:?}");
            let answer = reply.json();
            let ranges = [ModeRange { mode, low: range[0], high: range[1] }];
            let found = query.sweep_intervals(&q, &ranges, 101, None, &()).unwrap().remove(0);
            assert_eq!(found.intervals.len(), count, "{found:?}");
            assert_eq!(answer["samples"].as_array().unwrap().len(), 101);
            let ends = |key: &str| -> Vec<Value> {
                answer["intervals"].as_array().unwrap().iter().map(|found| found[key].clone()).collect()
            };
            assert_eq!(
                json!(ends("from")),
                json!(found.intervals.iter().map(|i| i.from).collect::<Vec<_>>())
            );
            assert_eq!(
                json!(ends("free_from")),
                json!(found.intervals.iter().map(|i| i.free_from).collect::<Vec<_>>())
            );
        }
        for bad in [
            json!({"q": q, "mode": 9, "range": [0.0, 1.0]}),
            json!({"q": [0.0], "mode": 0, "range": [0.0, 1.0]}),
            json!({"q": q, "mode": 0, "range": [1.0, 0.0]}),
        ] {
            assert_eq!(client.post("/api/intervals", &bad.to_string()).status, 400);
        }
    });
}

#[test]
fn sliders_of_named_modes_are_weights_from_0_to_1() {
    let (model, certificates) = strips();
    let ranges = |names: &[&str]| {
        let mode_names = names.iter().map(|name| (*name).to_owned()).collect();
        let details = ModelDetails { mode_names, ..ModelDetails::default() };
        let mut arrays = Arrays::default();
        let scene = ModelScene::new(0, "strips", &model, &certificates, details, &mut arrays).unwrap();
        serde_json::to_value(&scene).unwrap()["ranges"].clone()
    };
    assert_eq!(ranges(&["jaw", "lip", "brow"]), json!([[0.0, 1.0], [0.0, 1.0], [0.0, 1.0]]));
    let limits = model.weight_limits();
    assert_eq!(ranges(&[]), json!(limits.iter().map(|limit| [-limit, *limit]).collect::<Vec<_>>()));
}

#[test]
fn the_hierarchy_and_its_aabbs_are_those_of_the_core() {
    let (model, certificates) = strips();
    with_server(|client| {
        let nodes = client.get("/api/nodes").json();
        let all = certificates.parts().hierarchy.nodes();
        assert_eq!(nodes["radius"].as_array().unwrap().len(), all.len());
        assert_eq!((&nodes["parent"][0], &nodes["level"][0]), (&json!(-1), &json!(0)));
        for (n, node) in all.iter().enumerate() {
            for child in node.children() {
                assert_eq!(nodes["parent"][child as usize], json!(n));
            }
            assert_eq!(nodes["count"][n], json!(node.triangle_count));
        }
        let order = client.get("/api/array/order").body;
        let order: Vec<u32> = order.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect();
        assert_eq!(order, certificates.parts().hierarchy.order());

        let q = [0.5, 1.0, 0.0];
        let boxes = client.post("/api/boxes", &json!({"q": q, "level": 0}).to_string()).json();
        let positions = model.positions(&q).unwrap();
        let least = positions.iter().copied().reduce(|a, b| a.min(b)).unwrap();
        let most = positions.iter().copied().reduce(|a, b| a.max(b)).unwrap();
        assert_eq!(boxes, json!({"boxes": [[least.x, least.y, least.z, most.x, most.y, most.z]]}));
        let reply = client.post("/api/boxes", &json!({"q": q, "level": 99}).to_string());
        assert_eq!(reply.status, 400);
        assert!(reply.error().contains("there is no level 99"));
    });
}

#[test]
fn the_scene_and_its_arrays_describe_the_model() {
    let (model, certificates) = strips();
    with_server(|client| {
        let found = client.get("/api/scene").json();
        assert_eq!(found, serde_json::to_value(scene(&model, &certificates).0).unwrap());
        let shape = &found["models"][0];
        assert_eq!((&shape["triangles"], &shape["rank"]), (&json!(76), &json!(3)));
        let floats = |name: &Value| -> Vec<f32> {
            let bytes = client.get(&format!("/api/array/{}", name.as_str().unwrap())).body;
            bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
        };
        let (positions, modes) = (floats(&shape["arrays"]["positions"]), floats(&shape["arrays"]["modes"]));
        let vertices = model.mesh().rest_positions().len();
        let q = [0.25, -0.5, 0.75];
        for (v, x) in model.positions(&q).unwrap().iter().enumerate() {
            for axis in 0..3 {
                let of_mode = |k: usize| f64::from(modes[(k * vertices + v) * 3 + axis]) * q[k];
                let shown = f64::from(positions[3 * v + axis]) + (0..3).map(of_mode).sum::<f64>();
                assert!((shown - x[axis]).abs() < 1e-5);
            }
        }
        // Each q is along one mode, just inside the root's radius.
        let extremal = shape["extremal"].as_array().unwrap();
        assert_eq!(extremal.len(), 6);
        // Modes are numbered from 0, as in the command.
        assert_eq!((&extremal[0]["name"], &extremal[5]["name"]), (&json!("mode 0 +"), &json!("mode 2 -")));
        for extremal in extremal {
            let answer = check(client, &json!({"q": extremal["q"]}));
            assert_eq!(answer["root_certified"], json!(true));
            assert!(answer["root_share"].as_f64().unwrap() > 1.0 - 1e-6);
        }
        // The limit is half the diagonal.
        let diagonal = (19.0_f64 * 19.0 + 1.0 + 1.0).sqrt();
        assert!((shape["limits"][0].as_f64().unwrap() - 0.5 * diagonal).abs() < 1e-12);
    });
}

#[test]
fn invalid_requests_are_refused() {
    with_server(|client| {
        for (path, body) in [
            ("/api/check", r#"{"q":[0,0]}"#),
            ("/api/check", r#"{"q":[0,0,0,0]}"#),
            ("/api/check", r#"{"q":[0,0,NaN]}"#),
            ("/api/check", r#"{"q":[0,0,1e999]}"#),
            ("/api/check", r#"{"q":[0,0,1e300]}"#),
            ("/api/check", r#"{"q":[0,0,null]}"#),
            ("/api/check", "{}"),
            ("/api/check", ""),
            ("/api/check", "[[[[["),
            ("/api/check", "\u{1}\u{2}"),
            ("/api/traditional", r#"{"q":[0]}"#),
            ("/api/safe_scale", r#"{"direction":[0,1]}"#),
            ("/api/safe_scale", r#"{"direction":[0,1,1e300]}"#),
            ("/api/sweep", r#"{"q":[0,1],"mode":0,"range":[0,1]}"#),
            ("/api/sweep", r#"{"q":[0,0,0],"mode":3,"range":[0,1]}"#),
            ("/api/sweep", r#"{"q":[0,0,0],"mode":0,"range":[1,1]}"#),
            ("/api/sweep", r#"{"q":[0,0,0],"mode":0,"range":[-1e308,1e308]}"#),
            ("/api/sweep", r#"{"q":[0,0,0],"mode":0,"range":[0,1e300]}"#),
            ("/api/boxes", r#"{"q":[0,1],"level":0}"#),
            ("/api/boxes", r#"{"q":[0,0,0],"level":-1}"#),
            ("/api/glb", r#"{"q":[[0,0,0]],"times":[]}"#),
            ("/api/glb", r#"{"q":[],"times":[]}"#),
            ("/api/glb", r#"{"q":[[0,0]],"times":[0]}"#),
            ("/api/glb", r#"{"q":[[0,0,0],[0,0,0]],"times":[1,0]}"#),
        ] {
            let reply = client.post(path, body);
            assert_eq!(reply.status, 400, "{path} {body}");
            reply.error();
        }
        // The server refuses a motion at the first frame beyond the limit.
        let frames =
            |count: usize, frame: &str| format!("[{}{frame}]", format!("{frame},").repeat(count - 1));
        for body in [
            format!("{{\"q\":{},\"times\":[0]}}", frames(100_001, "[]")),
            format!("{{\"q\":[[0,0,0]],\"times\":{}}}", frames(100_001, "0")),
        ] {
            let reply = client.post("/api/glb", &body);
            assert_eq!(reply.status, 400);
            assert!(reply.error().contains("more than 100000 key frames"));
        }
        let nested = format!("{{\"q\":{}", "[".repeat(100_000));
        assert_eq!(client.post("/api/check", &nested).status, 400);
    });
}

#[test]
fn the_animation_is_the_reduced_motion() {
    let (model, _) = strips();
    with_server(|client| {
        // Mode 1 does not move.
        let mut q = [[0.0, 2.0, 0.0], [0.5, 2.0, -0.25], [-100.0, 2.0, 30.0]];
        for _ in 0..q.len() {
            let reply = client.post("/api/glb", &json!({"q": q, "times": [0.0, 0.5, 1.0]}).to_string());
            assert_eq!(reply.status, 200);
            let read = sscc_io::gltf::parse(&reply.body, None).unwrap();
            assert_eq!(read.mesh.faces(), model.mesh().faces());
            // Two modes that move, and the start of the motion.
            assert_eq!(read.modes.rank(), 3);
            // The node has the weights of the first frame.
            let length = u32::from_le_bytes(*reply.body[12..].first_chunk().unwrap()) as usize;
            let root: Value = serde_json::from_slice(&reply.body[20..20 + length]).unwrap();
            let weights: Vec<f64> = serde_json::from_value(root["nodes"][1]["weights"].clone()).unwrap();
            assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)), "{weights:?}");
            let shown = sscc::ReducedModel::new(read.mesh, read.modes).unwrap();
            let [ours, theirs] = [model.positions(&q[0]).unwrap(), shown.positions(&weights).unwrap()];
            let farthest = ours.iter().zip(theirs).map(|(a, b)| (*a - b).length()).fold(0.0, f64::max);
            assert!(farthest < 1e-5 * 19.0, "{farthest}");
            q.rotate_left(1);
        }
        // A motion of one frame at rest.
        let reply = client.post("/api/glb", r#"{"q":[[0,0,0]],"times":[0]}"#);
        assert_eq!(sscc_io::gltf::parse(&reply.body, None).unwrap().modes.rank(), 1);
    });
}

/// The page compares norms with radii by itself, so the radii must prove that nothing collides.
#[test]
fn certificates_with_a_clearance_are_refused() {
    let (model, plain) = strips();
    let options = CertifyOptions::default().clearance(Clearance::new(0.1).unwrap());
    let kept = Certificates::compute(&model, &options, &()).unwrap();
    let is_refused = |error: ViewError| matches!(error, ViewError::Core(Error::ClearanceCertificates));
    let mut arrays = Arrays::default();
    let details = ModelDetails::default();
    assert!(is_refused(ModelScene::new(0, "strips", &model, &kept, details, &mut arrays).unwrap_err()));
    assert!(is_refused(Picture::draw(&model, &kept, &[]).map(|_| ()).unwrap_err()));
    let (scene, arrays) = scene(&model, &plain);
    assert!(is_refused(Live::new(&model, &kept, scene, arrays, None).map(|_| ()).unwrap_err()));
}
