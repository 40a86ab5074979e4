//! Two closed meshes as bodies: the volume that they share, and one depth.

use std::fs;

use serde_json::Value;

use crate::common::{keys, sorted, sscc};

/// A unit cube at this x, as OBJ.
fn cube(x: f64, faces: usize) -> String {
    let vertex = |k: usize| format!("v {} {} {}\n", x + (k & 1) as f64, k >> 1 & 1, k >> 2 & 1);
    let quads = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"];
    let vertices: String = (0..8).map(vertex).collect();
    vertices + &quads[..faces].iter().map(|quad| format!("f {quad}\n")).collect::<String>()
}

#[test]
fn bodies_have_a_shared_volume_and_one_depth() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    for (name, x, faces) in [("a.obj", 0.0, 6), ("b.obj", 0.75, 6), ("far.obj", 3.0, 6), ("open.obj", 0.5, 5)]
    {
        fs::write(folder.join(name), cube(x, faces)).unwrap();
    }
    let check =
        |args: &[&str]| sscc(folder, &[&["check", "a.obj", "--penetration", "--against"], args].concat());
    let number = |line: &Value, key: &str| line[key].as_f64().unwrap();
    let run = check(&["b.obj", "--json"]);
    let line = &run.json()[0];
    assert_eq!(run.code, Some(1), "{run:?}");
    let own = "penetration_volume, penetration_volume_error, penetration_depth, penetration_depth_error";
    let usual = "index norm colliding count complete pairs microseconds root_certified proof opened box_tests triangle_tests";
    assert_eq!(keys(line), sorted(&format!("{usual} {own}")));
    assert!((number(line, "penetration_volume") - 0.25).abs() <= number(line, "penetration_volume_error"));
    let (depth, error) = (number(line, "penetration_depth"), number(line, "penetration_depth_error"));
    assert!(depth <= 0.25 && 0.25 <= depth + error + 1e-8 && error < 1e-3, "{line}");
    let far = check(&["far.obj", "--json"]);
    assert_eq!((far.code, number(&far.json()[0], "penetration_volume")), (Some(0), 0.0));
    let text = check(&["b.obj"]).stdout;
    assert!(
        text.starts_with("COLLIDING: ") && text.contains("; shared volume 0.2500, penetration depth 0.2"),
        "{text}"
    );
    let open = check(&["open.obj"]);
    assert!(open.refusal().contains("a.obj: the second mesh has no inside, because it is open"), "{open:?}");
    let alone = sscc(folder, &["check", "a.obj", "--penetration"]);
    assert!(alone.code == Some(2) && alone.stderr.contains("--against"), "{alone:?}");
}
