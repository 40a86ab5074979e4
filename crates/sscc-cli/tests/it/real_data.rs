//! Real models with known answers: every method lists exactly the published pairs.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use serde_json::Value;
use sscc::{AuditOptions, Certificates, CertifyOptions, Method, Query, ReducedModel, audit};
use sscc_testing::models;

type Pairs = Vec<(u32, u32)>;

struct Case {
    q: Vec<f64>,
    pairs: Pairs,
}

/// Returns the model and the cases of a `*_selfcollision_cases.json`.
fn cases(file: &Path) -> (ReducedModel, Vec<Case>) {
    let json: Value = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
    let beside = |key: &str| file.with_file_name(json[key].as_str().unwrap());
    let (model, _) = sscc_io::load_model(&beside("mesh"), Some(&beside("modes"))).unwrap();
    let cases = json["cases"].as_array().unwrap().iter();
    let cases = cases.map(|case| Case {
        q: serde_json::from_value(case["q"].clone()).unwrap(),
        pairs: serde_json::from_value(case["pairs"].clone()).unwrap(),
    });
    (model, cases.collect())
}

fn every_method_gives_the_listed_pairs(model: &ReducedModel, cases: &[Case], certificates: &Certificates) {
    for method in [Method::Certified, Method::BdTree, Method::Traditional] {
        let mut query = Query::with_method(model, certificates, method).unwrap();
        for (i, case) in cases.iter().enumerate() {
            assert_eq!(query.discrete(&case.q).unwrap(), case.pairs, "case {i} by {method:?}");
        }
    }
}

#[test]
fn vega_letter() {
    let Some(folder) = models("vega_letter") else { return };
    let (model, cases) = cases(&folder.join("vega_A/A_selfcollision_cases.json"));
    assert_eq!(cases.len(), 17);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    every_method_gives_the_listed_pairs(&model, &cases, &certificates);
}

/// An audit of the letter finds no violation, and its root radius is tight.
#[test]
fn vega_letter_audit() {
    let Some(folder) = models("vega_letter_audit") else { return };
    let (model, _) = cases(&folder.join("vega_A/A_selfcollision_cases.json"));
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let options = AuditOptions::default().samples(2000);
    let report = audit(&model, &certificates, &options, &()).unwrap();
    assert_eq!((report.samples, report.violations), (2000, vec![]));
    assert!(report.root_tightness.unwrap() >= 0.9, "{:?}", report.root_tightness);
}

/// A GLB of another tool, and the same model as OBJ and npy, have the same pairs at 200 random q.
#[test]
fn glb_and_obj_agree() {
    let Some(folder) = models("glb_and_obj_agree") else { return };
    let directory = tempfile::tempdir().unwrap();
    let mut colliding = 0;
    for file in ["RobotExpressive.glb", "AnimatedMorphSphere.gltf", "MorphStressTest.gltf"] {
        let glb = folder.join("morph").join(file);
        let model = sscc_io::load_model(&glb, None).unwrap().0;
        let (vertices, rank) = (model.mesh().rest_positions().len(), model.rank());
        let mut obj = String::new();
        for p in model.mesh().rest_positions() {
            writeln!(obj, "v {} {} {}", p.x, p.y, p.z).unwrap();
        }
        for [a, b, c] in model.mesh().faces() {
            writeln!(obj, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
        }
        fs::write(directory.path().join("a.obj"), obj).unwrap();
        let modes: Vec<f64> = (0..rank)
            .flat_map(|k| (0..vertices as u32).map(move |v| (v, k)))
            .flat_map(|(v, k)| model.modes().of_vertex(v)[k].to_array())
            .collect();
        sscc_io::write_npy(&directory.path().join("a.npy"), &[rank, vertices, 3], &modes).unwrap();
        let q: Vec<f64> = (0..200 * rank).map(random).collect();
        sscc_io::write_npy(&directory.path().join("q.npy"), &[200, rank], &q).unwrap();
        let run = |model: &[&str]| {
            let model = [&["check"], model, &["--trajectory", "q.npy", "--json"]].concat();
            let run = crate::common::sscc(directory.path(), &model);
            assert!(matches!(run.code, Some(0 | 1)), "{run:?}");
            run.json().into_iter().map(|mut line| line["pairs"].take()).collect::<Vec<Value>>()
        };
        let of_glb = run(&[glb.to_str().unwrap()]);
        assert_eq!(of_glb.len(), 200);
        assert_eq!(of_glb, run(&["a.obj", "--modes", "a.npy", "--weld"]), "{file}");
        assert_eq!(of_glb, run(&["a.obj", "--modes", "a.npy", "--weld", "--method=traditional"]), "{file}");
        colliding += of_glb.iter().filter(|pairs| !pairs.as_array().unwrap().is_empty()).count();
    }
    assert!(colliding > 200, "{colliding}");
}

/// Fixed pseudo-random numbers in [-1, 1).
fn random(i: usize) -> f64 {
    let x = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// The face, its cases and its certificates.
struct Face {
    model: ReducedModel,
    cases: Vec<Case>,
    with_exceptions: Certificates,
}

/// Returns the face, which two tests share; None without real models.
fn face_of(test: &str) -> Option<&'static Face> {
    static FACE: OnceLock<Face> = OnceLock::new();
    let file = models(test)?.join("ict_face/ict_face_selfcollision_cases.json");
    Some(FACE.get_or_init(|| {
        let (model, cases) = cases(&file);
        let with_exceptions = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        Face { model, cases, with_exceptions }
    }))
}

#[test]
fn face() {
    let Some(Face { model, cases, with_exceptions }) = face_of("face") else { return };
    assert_eq!(cases.len(), 12);
    every_method_gives_the_listed_pairs(model, cases, with_exceptions);
}

/// Every published configuration, with the pairs that collide at rest as exceptions, or ignored.
#[test]
fn face_with_exceptions() {
    let Some(Face { model, cases, with_exceptions: with }) = face_of("face_with_exceptions") else { return };
    let rest = &cases[0].pairs;
    // Loose radii suffice for the pairs.
    let options = CertifyOptions::default().ignore_rest(0).epsilon(0.9);
    let ignoring = Certificates::compute(model, &options, &()).unwrap();
    assert_eq!((with.exceptions(), ignoring.filter().ignored()), (&rest[..], &rest[..]));
    assert!(with.root_radius() > 0.0 && with.rest_collisions() == 124);
    let mut query = Query::new(model, with).unwrap();
    assert_eq!(query.discrete(&cases[0].q).unwrap(), rest);
    assert!(query.statistics().root_certified && query.statistics().opened == 0);
    // The jaw alone opens a small part of the hierarchy.
    let mut jaw = vec![0.0; model.rank()];
    jaw[0] = 0.1;
    assert!(query.discrete(&jaw).unwrap().is_empty());
    let nodes = with.parts().hierarchy.nodes();
    let open: Vec<bool> = with.parts().node_radii.iter().map(|r| *r <= query.statistics().norm).collect();
    // Counted by triangles, since nodes within a bucket repeat its radius, and lips and eyelids are in many buckets.
    let leaves = || (0..nodes.len()).filter(|n| nodes[*n].children().is_empty());
    let open: u32 = leaves().filter(|n| open[*n]).map(|n| nodes[n].triangle_count).sum();
    assert!(0 < open && 8 * open < model.mesh().faces().len() as u32, "{open}");
    let mut ignoring = Query::new(model, &ignoring).unwrap();
    for case in cases {
        let expected: Pairs = case.pairs.iter().copied().filter(|pair| !rest.contains(pair)).collect();
        assert_eq!(ignoring.discrete(&case.q).unwrap(), expected);
    }
}

/// Certifies by the command, then checks a trajectory of all cases.
#[test]
fn vega_letter_by_the_command() {
    let Some(folder) = models("vega_letter_by_the_command") else { return };
    let file = folder.join("vega_A/A_selfcollision_cases.json");
    let (model, cases) = cases(&file);
    let directory = tempfile::tempdir().unwrap();
    let q: Vec<f64> = cases.iter().flat_map(|case| case.q.clone()).collect();
    sscc_io::write_npy(&directory.path().join("q.npy"), &[cases.len(), model.rank()], &q).unwrap();
    let [mesh, modes] =
        ["A.obj", "A.URendering.float"].map(|name| file.with_file_name(name).to_str().unwrap().to_owned());
    let run = |args: &[&str]| {
        let [command, rest @ ..] = args else { unreachable!() };
        crate::common::sscc(directory.path(), &[&[*command, &mesh, "--modes", &modes], rest].concat())
    };
    assert_eq!(run(&["certify", "-o", "a.sscc.safetensors"]).code, Some(0));
    let checked = run(&["check", "--certificates", "a.sscc.safetensors", "--trajectory", "q.npy", "--json"]);
    assert_eq!(checked.code, Some(1), "{}", checked.stderr);
    let found: Vec<Pairs> = checked
        .json()
        .into_iter()
        .map(|mut line| serde_json::from_value(line["pairs"].take()).unwrap())
        .collect();
    assert_eq!(found, cases.into_iter().map(|case| case.pairs).collect::<Vec<_>>());
}

/// A mesh that intersects itself at rest, with a mode that moves nothing.
#[test]
fn double_loop() {
    let Some(folder) = models("double_loop") else { return };
    let folder = folder.join("selfintersecting");
    let text = fs::read_to_string(folder.join("doubleLoopWithCube.pairs.txt")).unwrap();
    let listed: Pairs = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let mut numbers = line.split_whitespace().map(|word| word.parse().unwrap());
            (numbers.next().unwrap(), numbers.next().unwrap())
        })
        .collect();
    assert_eq!(listed.len(), 792);
    let directory = tempfile::tempdir().unwrap();
    let path = folder.join("doubleLoopWithCube.obj");
    let vertices = sscc_io::read_mesh(&path).unwrap().rest_positions().len();
    let still = directory.path().join("still.npy");
    sscc_io::write_npy(&still, &[3 * vertices, 1], &vec![0.0; 3 * vertices]).unwrap();
    for method in ["certified", "bdtree", "traditional", "brute-force"] {
        let args = [
            "check",
            path.to_str().unwrap(),
            "--modes",
            still.to_str().unwrap(),
            "--q=1",
            "--json",
            "--method",
            method,
        ];
        let run = crate::common::sscc(directory.path(), &args);
        assert_eq!(run.code, Some(1), "{}", run.stderr);
        let found: Pairs = serde_json::from_value(run.json()[0]["pairs"].take()).unwrap();
        assert_eq!(found, listed, "{method}");
    }
}
