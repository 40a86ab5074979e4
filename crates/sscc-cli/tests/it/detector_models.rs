//! Real meshes, frames and animations with known answers, by the command.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;
use sscc_testing::models;

use crate::common::sscc;

type Pairs = BTreeSet<(u64, u64)>;

fn pairs(value: &Value) -> Pairs {
    let pairs: Vec<(u64, u64)> = serde_json::from_value(value.clone()).unwrap();
    pairs.into_iter().collect()
}

/// Runs `check --json`, and returns its lines.
fn check(args: &[&str]) -> Vec<Value> {
    let run = sscc(Path::new("."), &[&["check", "--json"], args].concat());
    assert!(matches!(run.code, Some(0 | 1)) && run.stderr.is_empty(), "{run:?}");
    let lines = run.json();
    assert_eq!(run.code == Some(1), lines.iter().any(|line| line["colliding"] == true));
    lines
}

#[test]
fn double_loop_at_rest() {
    let Some(folder) = models("double_loop_at_rest") else { return };
    let folder = folder.join("selfintersecting");
    let text = fs::read_to_string(folder.join("doubleLoopWithCube.pairs.txt")).unwrap();
    let number = |word: &str| word.parse::<u64>().unwrap();
    let listed: Pairs = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.split_once(char::is_whitespace))
        .map(|(i, j)| (number(i.trim()), number(j.trim())))
        .collect();
    let mesh = folder.join("doubleLoopWithCube.obj");
    let lines = check(&[mesh.to_str().unwrap()]);
    assert_eq!((lines.len(), listed.len()), (1, 792));
    assert_eq!(pairs(&lines[0]["pairs"]), listed);
    assert!(
        lines[0]["norm"].is_null() && lines[0]["root_certified"].is_null() && lines[0].get("file").is_none()
    );
}

#[test]
fn free_meshes() {
    let Some(folder) = models("free_meshes") else { return };
    let names = ["bunny_14964_closed.obj", "bunny_6966_closed.off", "bunny_69664_closed.ply"];
    let meshes = names.map(|name| folder.join(name).to_str().unwrap().to_owned());
    let lines = check(&meshes.each_ref().map(String::as_str));
    for (line, file) in lines.iter().zip(&meshes) {
        assert_eq!((&line["file"], &line["count"]), (&file.as_str().into(), &0.into()));
    }
    assert_eq!(lines.len(), 3);
}

/// Two frames of a garment: their own pairs, and every true contact on the way from one to the other.
#[test]
fn cloth_frames() {
    let Some(folder) = models("cloth_frames") else { return };
    let folder = folder.join("ccd_frames/cloth-funnel");
    let (mesh, frames) = (folder.join("227.ply"), folder.to_str().unwrap());
    let args = [mesh.to_str().unwrap(), "--frames", frames];
    let counts: Vec<u64> = check(&args).iter().map(|line| line["count"].as_u64().unwrap()).collect();
    assert!(counts.len() == 2 && counts[0] >= 261 && counts[1] >= 332, "{counts:?}");

    let lines = check(&[&args[..], &["--continuous"]].concat());
    assert_eq!(lines.len(), 1);
    let listed = pairs(&lines[0]["pairs"]);
    let mesh = sscc_io::read_mesh(&mesh).unwrap();
    let end = sscc_io::read_mesh(&folder.join("228.ply")).unwrap();
    let mut detector = sscc::Detector::new(&mesh);
    let impacts = detector.continuous(mesh.rest_positions(), end.rest_positions()).unwrap();
    let times: Vec<f64> = impacts.iter().map(|impact| impact.time).collect();
    assert_eq!((&lines[0]["times"], listed.len()), (&serde_json::json!(times), times.len()));
    let faces = mesh.faces();
    let edges: BTreeSet<(u32, u32)> = faces
        .iter()
        .flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)].map(|(i, j)| (*i.max(j), *i.min(j))))
        .collect();
    let edges: Vec<[u32; 2]> = edges.into_iter().map(|(max, min)| [min, max]).collect();
    // The faces of an element: a vertex, an edge or a face, by its number.
    let around = |id: u64| -> Vec<usize> {
        let (id, v, e) = (id as usize, mesh.rest_positions().len(), edges.len());
        let with = |corners: &[u32]| {
            let contains = |face: &[u32; 3]| corners.iter().all(|corner| face.contains(corner));
            (0..faces.len()).filter(|f| contains(&faces[*f])).collect()
        };
        match id {
            id if id < v => with(&[id as u32]),
            id if id < v + e => with(&edges[id - v]),
            id => vec![id - v - e],
        }
    };
    let read =
        |name: String| -> Value { serde_json::from_slice(&fs::read(folder.join(name)).unwrap()).unwrap() };
    let mut contacts = 0;
    for kind in ["ee", "vf"] {
        let (elements, truth) =
            (read(format!("227{kind}_boxes.json")), read(format!("227{kind}_mma_bool.json")));
        let elements: Vec<(u64, u64)> = serde_json::from_value(elements).unwrap();
        for ((a, b), _) in
            elements.iter().zip(truth.as_array().unwrap()).filter(|(_, is_true)| **is_true == true)
        {
            contacts += 1;
            for (f, g) in around(*a).iter().flat_map(|f| around(*b).into_iter().map(move |g| (*f, g))) {
                if !faces[f].iter().any(|v| faces[g].contains(v)) {
                    assert!(listed.contains(&(f.min(g) as u64, f.max(g) as u64)), "{kind} {a} {b}: {f} {g}");
                }
            }
        }
    }
    assert_eq!(contacts, 107 + 27);
}

/// Every answered frame of every skinned model.
#[test]
fn skinned_animations() {
    let Some(folder) = models("skinned_animations") else { return };
    let folder = folder.join("skinned");
    let (mut frames, mut count) = (0, 0);
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if !path.to_str().unwrap().ends_with(".answers.json") {
            continue;
        }
        let records: Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
        for record in records.as_array().unwrap() {
            let answers = ["frames", "dropped"].map(|list| record[list].as_array().unwrap());
            let answers: Vec<&Value> = answers.into_iter().flatten().collect();
            let times: Vec<String> = answers.iter().map(|answer| answer["time"].to_string()).collect();
            let times = times.join(",");
            let file = folder.join(record["file"].as_str().unwrap());
            let weights = if record["weights"] == "normalized" { "normalized" } else { "as-stored" };
            let [animation, node] = ["animation", "node"].map(|key| record[key].to_string());
            let animation = record["animation_name"].as_str().map_or(animation, str::to_owned);
            let args = [
                &["check", file.to_str().unwrap(), "--animation", &animation, "--node", &node, "--json"],
                &["--times", &times, "--weights", weights][..],
            ];
            let run = sscc(&folder, &args.concat());
            assert!(matches!(run.code, Some(0 | 1)), "{run:?}");
            let has_error = record["largest_weight_sum_error"].as_f64().unwrap() > 1e-2;
            let is_warned = run.stderr.starts_with("warning: ") && run.stderr.lines().count() == 1;
            assert_eq!(is_warned, has_error && weights == "normalized", "{run:?}");
            let lines = run.json();
            assert_eq!(lines.len(), answers.len());
            for (index, (line, answer)) in lines.iter().zip(&answers).enumerate() {
                assert_eq!((&line["time"], &line["index"]), (&answer["time"], &index.into()));
                assert_eq!((&line["node"], line["complete"].as_bool()), (&record["node"], Some(true)));
                let (found, certain) = (pairs(&line["pairs"]), pairs(&answer["pairs"]));
                let allowed =
                    if answer["uncertain"].is_null() { Pairs::new() } else { pairs(&answer["uncertain"]) };
                assert!(found.is_superset(&certain), "{run:?}");
                assert!(found.difference(&certain).all(|pair| allowed.contains(pair)), "{run:?}");
                frames += 1;
                count += found.len();
            }
        }
    }
    assert!(frames >= 178 && count > 8000, "{frames} {count}");
}
