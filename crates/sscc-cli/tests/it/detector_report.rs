//! `sscc check --report`: the page with the frames of meshes.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use serde_json::{Value, json};
use sscc_io::write_npy;

use crate::common::{command, files, page_data, sscc};
use crate::detector::folder;

/// Runs with `--report`; returns the scene of the report.
fn scene(folder: &Path, args: &[&str]) -> Value {
    let run = sscc(folder, &[&["check"], args, &["--json", "--report", "report.html"]].concat());
    let collides = run.json().iter().any(|line| line["colliding"] == true);
    assert_eq!((run.code, run.stderr.as_str()), (Some(i32::from(collides)), ""), "{run:?}");
    // The report changes no answer.
    let without = sscc(folder, &[&["check"], args, &["--json"]].concat());
    let pairs = |lines: Vec<Value>| lines.iter().map(|line| line["pairs"].clone()).collect::<Vec<_>>();
    assert_eq!(pairs(run.json()), pairs(without.json()));
    let html = fs::read_to_string(folder.join("report.html")).unwrap();
    page_data(&html)["scene"].take()
}

#[test]
fn reports_have_every_frame_of_every_body() {
    let directory = folder();
    let folder = directory.path();
    let rest = scene(folder, &["mesh.obj"]);
    assert_eq!(rest["playback"]["bodies"][0]["pairs"], json!([0]));
    for frames in ["frames.npy", "frames"] {
        let scene = scene(folder, &["mesh.obj", "--frames", frames, "--threads", "3"]);
        assert_eq!(scene["title"], "mesh.obj");
        assert_eq!(scene["playback"]["bodies"][0]["pairs"], json!([0, 0, 1, 0]));
        assert_eq!(scene["playback"]["clock"], "frame");
    }
    let steps = scene(folder, &["mesh.obj", "--frames", "frames", "--continuous"]);
    assert_eq!(steps["playback"]["bodies"][0]["pairs"], json!([0, 1, 1, 0]));
    let against = scene(folder, &["mesh.obj", "--frames", "frames", "--against", "lower.obj"]);
    assert_eq!(against["title"], "mesh.obj against lower.obj");
    assert_eq!(against["playback"]["bodies"].as_array().unwrap().len(), 2);
    assert_eq!(against["playback"]["contacts"]["is_between"], true);
    for continuous in [&[][..], &["--continuous"]] {
        let args = [&["flag.gltf", "--animation", "wave", "--fps", "2", "--weld=off"], continuous].concat();
        let nodes = scene(folder, &args);
        let playback = &nodes["playback"];
        assert_eq!(
            (&playback["times"], &playback["clock"]),
            (&json!([0.0, 0.5, 1.0]), &json!("frame_and_time"))
        );
        let names = playback["bodies"].as_array().unwrap().iter().map(|body| body["name"].clone());
        assert_eq!(names.collect::<Vec<_>>(), ["node 1", "node 2 moved"]);
        let last = u8::from(continuous.is_empty());
        assert_eq!(playback["bodies"][1]["pairs"], json!([1, 1, last]));
    }
}

#[test]
fn a_report_is_whole_without_a_reader_of_the_output() {
    let directory = folder();
    let folder = directory.path();
    let args = ["check", "mesh.obj", "--frames", "long.npy", "--json", "--report", "report.html"];
    let heights: Vec<f64> = (0..2000).map(|_| 1.0).collect();
    write_npy(&folder.join("long.npy"), &[2000, 6, 3], &crate::detector::frames(&heights)).unwrap();
    let mut child = command(folder, &args).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    let html = fs::read_to_string(folder.join("report.html")).unwrap();
    let (_, counts) = html.split_once("\"pairs\":[").unwrap();
    assert_eq!(counts.split_once(']').unwrap().0.split(',').count(), 2000);
}

#[test]
fn reports_that_cannot_be_written_are_refused() {
    let directory = folder();
    let folder = directory.path();
    fs::write(folder.join("cut.npy"), &fs::read(folder.join("frames.npy")).unwrap()[..300]).unwrap();
    fs::create_dir(folder.join("dir.html")).unwrap();
    let before = files(folder);
    for (args, named) in [
        (&["mesh.obj", "--report", "report.txt"][..], "report.txt: the name of the output must end in .html"),
        (&["mesh.obj", "--report", "dir.html"], "dir.html: cannot be written: it is not a file"),
        (&["mesh.obj", "--report", "missing/r.html"], "missing/r.html: cannot be written"),
        (&["mesh.obj", "lower.obj", "--report", "r.html"], "--report"),
        (&["mesh.obj", "--first", "--report", "r.html"], "--first"),
        (&["mesh.obj", "--limit", "3", "--report", "r.html"], "--limit"),
        (&["mesh.obj", "--q=1", "--report", "r.html"], "--q"),
        (&["mesh.obj", "--frames", "cut.npy", "--report", "r.html"], "cut.npy: "),
        (&["mesh.obj", "--frames", "frames", "--against", "none.obj", "--report", "r.html"], "none.obj: "),
    ] {
        let run = sscc(folder, &[&["check"], args].concat());
        assert!(run.refusal().contains(named), "{run:?}");
    }
    // The animation has more frames than a report can contain.
    let args = ["check", "flag.gltf", "--animation", "wave", "--fps", "2000000", "--report", "r.html"];
    let run = sscc(folder, &args);
    let message = run.refusal();
    assert!(message.starts_with("error: r.html: the report would be larger than 256 MiB, "), "{message}");
    assert_eq!(files(folder), before);
}
