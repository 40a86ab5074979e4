//! The help pages: their width is that of the terminal, and their examples run as shown.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use serde_json::json;
use sscc_io::write_npy;

use crate::common::{Run, STRIP, command, strips};

const COMMANDS: [&str; 13] = [
    "demo", "modes", "certify", "check", "sweep", "resolve", "load", "fit", "audit", "info", "simulate",
    "bench", "view",
];

/// Returns the lines of a help page in a terminal of that width.
fn page(name: Option<&str>, width: usize) -> Vec<String> {
    let args: Vec<&str> = name.into_iter().chain(["--help"]).collect();
    let run = Run::of(command(Path::new("."), &args).env("COLUMNS", width.to_string()));
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{name:?}");
    run.stdout.lines().map(str::to_owned).collect()
}

/// Returns the example commands of a page.
fn examples(page: &[String]) -> Vec<String> {
    let (start, _) = page.iter().enumerate().find(|(_, line)| *line == "Examples:").unwrap();
    let lines = page[start + 1..].iter().take_while(|line| !line.is_empty());
    lines.map(|line| line.strip_prefix("  ").unwrap().to_owned()).collect()
}

#[test]
fn pages_are_as_wide_as_the_terminal() {
    for name in [None].into_iter().chain(COMMANDS.map(Some)) {
        let wide = page(name, 100);
        let commands = examples(&wide);
        assert!(
            !commands.is_empty() && commands.iter().all(|line| line.starts_with("sscc ")),
            "{commands:?}"
        );
        for width in [60, 80, 100, 200] {
            let page = page(name, width);
            assert_eq!(examples(&page), commands, "{name:?} at {width}: one command a line");
            // Longer lines are hard to read, even on wide terminals.
            let max = width.min(100);
            let prose =
                page.iter().filter(|line| !line.starts_with("  sscc ") && !line.starts_with("Usage: "));
            let widest = prose.clone().max_by_key(|line| line.chars().count()).unwrap();
            assert!(widest.chars().count() <= max, "{name:?} at {width}: {widest}");
            assert!(widest.chars().count() > max / 2, "{name:?} at {width}: {widest}");
        }
        assert!(page(name, 60).len() > wide.len(), "{name:?}");
    }
}

/// Returns the words of a command up to a pipe, as a shell splits them.
fn words(command: &str) -> Vec<String> {
    let command = command.split(" | ").next().unwrap();
    assert!(
        !command.contains(['\'', '"', '\\', '$', '>', ';', '&', '*']) && !command.contains(" #"),
        "{command}: the test supports no shell syntax"
    );
    command.split_whitespace().skip(1).map(str::to_owned).collect()
}

/// Writes two strips that touch at q_0 = 1, as in `strips`, with `rank` modes that move the upper one.
fn write_face(folder: &Path, rank: usize) {
    let modes: Vec<f32> = (0..rank)
        .flat_map(|k| (0..6 * STRIP).map(move |row| (row, (2 + k) % 3)))
        .map(|(row, axis)| if row >= 3 * STRIP && row % 3 == axis { -1.0 } else { 0.0 })
        .collect();
    let header = [6 * STRIP as i32, rank as i32].map(i32::to_le_bytes);
    let bytes = header.into_iter().chain(modes.iter().map(|x| x.to_le_bytes())).flatten();
    fs::write(folder.join("face.U.float"), bytes.collect::<Vec<u8>>()).unwrap();
    fs::copy(folder.join("mesh.obj"), folder.join("face.obj")).unwrap();
}

/// Writes copies of `mesh.obj`, each moved up a little further: targets or frames.
fn write_meshes(folder: &Path, names: &[String]) {
    let mesh = sscc_io::read_mesh(&folder.join("mesh.obj")).unwrap();
    for (n, name) in names.iter().enumerate() {
        let mut text = String::new();
        for (v, p) in mesh.rest_positions().iter().enumerate() {
            let up = 0.1 * f64::from(u8::from(v == n)) + 0.01 * (n as f64);
            writeln!(text, "v {} {} {}", p.x, p.y, p.z + up).unwrap();
        }
        for [a, b, c] in mesh.faces() {
            writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
        }
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
}

/// Writes a glTF file with two triangles, and three targets that move the second one.
fn write_head(folder: &Path) {
    let rest: [[f32; 3]; 6] =
        [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 0., 1.], [0., 1., 1.]];
    let target = |k: usize| -> Vec<[f32; 3]> {
        (0..6).map(|v| std::array::from_fn(|c| if v > 2 && c == (k + 2) % 3 { -1.0 } else { 0.0 })).collect()
    };
    let all: Vec<[f32; 3]> = rest.into_iter().chain((0..3).flat_map(target)).collect();
    let binary: Vec<u8> = all.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let views: Vec<_> =
        (0..4).map(|n| json!({"buffer": 0, "byteOffset": 72 * n, "byteLength": 72})).collect();
    let list: Vec<_> = (0..4)
        .map(|n| {
            json!({"bufferView": n, "componentType": 5126, "count": 6, "type": "VEC3",
            "min": [-1.0, -1.0, -1.0], "max": [1.0, 1.0, 1.0]})
        })
        .collect();
    let targets: Vec<_> = (1..4).map(|n| json!({"POSITION": n})).collect();
    let gltf = json!({
        "asset": {"version": "2.0"}, "buffers": [{"uri": "head.bin", "byteLength": binary.len()}],
        "bufferViews": views, "accessors": list,
        "meshes": [{"name": "Head", "primitives": [{"attributes": {"POSITION": 0}, "targets": targets}]}],
    });
    fs::write(folder.join("head.bin"), binary).unwrap();
    fs::write(folder.join("head.glb"), gltf.to_string()).unwrap();
}

/// Writes frames of `mesh.obj`, and a glTF file with an animation.
fn write_frames(folder: &Path) {
    let positions: Vec<f64> = sscc_io::read_mesh(&folder.join("mesh.obj"))
        .unwrap()
        .rest_positions()
        .iter()
        .flat_map(|p| p.to_array())
        .collect();
    write_npy(&folder.join("frames.npy"), &[2, 2 * STRIP, 3], &positions.repeat(2)).unwrap();
    let flag = crate::detector::flag().replace(r#"{"mesh":0}"#, r#"{"mesh":0,"name":"body"}"#);
    fs::write(folder.join("character.glb"), flag.replace("moved", "shirt")).unwrap();
}

/// Writes a bar of 2 x 2 x 6 cubes that begins at z = 0.
fn write_bar(folder: &Path) {
    let [x, y, z] = [3, 3, 7];
    let vertex = |i: usize, j: usize, k: usize| i + x * (j + y * k) + 1;
    let mut text = format!("*VERTICES\n{} 3 0 0\n", x * y * z);
    for (k, j, i) in (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| (k, j, i)))) {
        writeln!(text, "{} {} {} {}", vertex(i, j, k), i as f64 - 1.0, j as f64 - 1.0, k).unwrap();
    }
    text += "*ELEMENTS\nCUBIC\n24 8 0\n";
    for n in 0..24 {
        let (i, j, k) = (n % 2, n / 2 % 2, n / 4);
        let lower = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(a, b)| (i + a, j + b));
        let corners = [k, k + 1].map(|k| lower.map(|(i, j)| vertex(i, j, k).to_string()).join(" "));
        writeln!(text, "{} {}", n + 1, corners.join(" ")).unwrap();
    }
    text += "*MATERIAL BODY\nENU, 1000, 1e6, 0.4\n*REGION\nallElements, BODY\n";
    fs::write(folder.join("bar.veg"), text).unwrap();
}

/// Whether an example takes long or does not end. Such examples are only parsed.
fn takes_long(args: &[String]) -> bool {
    matches!(args[0].as_str(), "demo" | "simulate" | "view")
        || args[0] == "bench" && args[1] != "--list"
        || args.iter().any(|arg| arg == "nonlinear")
}

#[test]
fn examples_run_as_they_are_shown() {
    let directory = strips();
    let folder = directory.path();
    for name in ["spring.model.safetensors", "spring.sscc.safetensors"] {
        fs::copy(folder.join(name.replace("spring", "strips")), folder.join(name)).unwrap();
    }
    fs::create_dir(folder.join("demo")).unwrap();
    fs::copy(folder.join("spring.model.safetensors"), folder.join("demo/spring.model.safetensors")).unwrap();
    for name in ["q.npy", "demo/spring.npy"] {
        write_npy(&folder.join(name), &[2, 2], &[0.5, 0.0, 1.0, 0.0]).unwrap();
    }
    let cone = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.2 0.3 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    fs::write(folder.join("bunny.obj"), cone).unwrap();
    write_face(folder, 3);
    write_meshes(folder, &["targets/a.obj", "targets/b.obj"].map(str::to_owned));
    write_meshes(folder, &(0..12).map(|n| format!("frames/{n:02}.obj")).collect::<Vec<_>>());
    write_meshes(folder, &["meshes/a.obj", "meshes/b.obj"].map(str::to_owned));
    write_head(folder);
    write_bar(folder);
    write_frames(folder);
    let pages = COMMANDS.map(Some).into_iter().chain([None]);
    let all: Vec<String> = pages.flat_map(|name| examples(&page(name, 80))).collect();
    let (mut run, mut collided) = (0, 0);
    for example in &all {
        let args = words(example);
        if takes_long(&args) {
            // Arguments are parsed in order, so that those of the example are valid if the last one is refused.
            let parsed = crate::common::sscc(folder, &[&args[..], &["--no-such-flag".to_owned()]].concat());
            assert!(parsed.refusal().contains("'--no-such-flag'"), "{example}: {parsed:?}");
            continue;
        }
        let done = crate::common::sscc(folder, &args);
        let expected: &[_] =
            if matches!(args[0].as_str(), "check" | "sweep") { &[Some(0), Some(1)] } else { &[Some(0)] };
        assert!(expected.contains(&done.code) && !done.stdout.is_empty(), "{example}: {done:?}");
        run += 1;
        collided += usize::from(done.code == Some(1));
    }
    assert!(run >= 20 && collided >= 3, "{run} of {} examples, {collided} found collisions", all.len());
}
