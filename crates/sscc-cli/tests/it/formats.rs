//! One model in every file format: the answers are the same.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use sscc::ReducedModel;
use sscc_io::write_npy;

use crate::common::{Run, sscc, strips};

/// Configurations of the strips: free, shifted, touching, past each other, touching and shifted.
const Q: [f64; 10] = [0.0, 0.0, 0.5, 2.0, 1.0, 0.25, 1.5, 0.0, 1.0, -2.0];

fn check(folder: &Path, model: &[&str], more: &[&str]) -> Run {
    write_npy(&folder.join("q.npy"), &[5, 2], &Q).unwrap();
    sscc(folder, &[&["check"], model, &["--trajectory", "q.npy", "--json"], more].concat())
}

fn pairs(run: &Run) -> Vec<Value> {
    assert!(matches!(run.code, Some(0 | 1)), "{run:?}");
    run.json().iter().map(|line| line["pairs"].clone()).collect()
}

fn model(folder: &Path) -> ReducedModel {
    sscc_io::load_model(&folder.join("mesh.obj"), Some(&folder.join("modes.npy"))).unwrap().0
}

/// Writes an STL file of the mesh, and modes for its vertices, three for each triangle.
fn write_stl(folder: &Path, model: &ReducedModel) {
    let mut text = "solid strips\n".to_owned();
    let mut modes: Vec<f64> = Vec::new();
    for face in model.mesh().faces() {
        text += "facet normal 0 0 0\nouter loop\n";
        for &v in face {
            let p = model.mesh().rest_positions()[v as usize];
            writeln!(text, "vertex {} {} {}", p.x, p.y, p.z).unwrap();
            let of = model.modes().of_vertex(v);
            modes.extend((0..3).flat_map(|c| of.iter().map(move |u| u[c])));
        }
        text += "endloop\nendfacet\n";
    }
    fs::write(folder.join("strips.stl"), text + "endsolid\n").unwrap();
    let rows = 9 * model.mesh().faces().len();
    write_npy(&folder.join("stl.npy"), &[rows, model.rank()], &modes).unwrap();
}

/// Writes a glTF file with morph targets. Each triangle has vertices of its own, as renderers need them.
fn write_gltf(folder: &Path, model: &ReducedModel, name: &str) {
    let faces = model.mesh().faces();
    let corners: Vec<u32> = faces.iter().flatten().copied().collect();
    let mut binary: Vec<u8> = Vec::new();
    let mut accessors = Vec::new();
    let mut add = |of: &dyn Fn(u32) -> glam::DVec3| {
        let start = binary.len();
        for &v in &corners {
            binary.extend(of(v).to_array().into_iter().flat_map(|x| (x as f32).to_le_bytes()));
        }
        accessors.push((start, binary.len() - start));
    };
    add(&|v| model.mesh().rest_positions()[v as usize]);
    for k in 0..model.rank() {
        add(&move |v| model.modes().of_vertex(v)[k]);
    }
    let views: Vec<Value> = accessors
        .iter()
        .map(|(start, length)| json!({"buffer": 0, "byteOffset": start, "byteLength": length}))
        .collect();
    let count = corners.len();
    let list: Vec<Value> = (0..accessors.len())
        .map(|i| {
            json!({"bufferView": i, "componentType": 5126, "count": count, "type": "VEC3",
            "min": [-100.0, -100.0, -100.0], "max": [100.0, 100.0, 100.0]})
        })
        .collect();
    let targets: Vec<Value> = (1..=model.rank()).map(|i| json!({"POSITION": i})).collect();
    let gltf = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "strips.bin", "byteLength": binary.len()}],
        "bufferViews": views,
        "accessors": list,
        "meshes": [
            {"name": "still", "primitives": [{"attributes": {"POSITION": 0}}]},
            {"name": name, "primitives": [{"attributes": {"POSITION": 0}, "targets": targets}],
             "weights": [0.5, 0.0], "extras": {"targetNames": ["lower", "shift"]}}
        ],
    });
    fs::write(folder.join("strips.bin"), binary).unwrap();
    fs::write(folder.join("strips.gltf"), gltf.to_string()).unwrap();
}

/// Writes a folder of target meshes, one for each mode.
fn write_targets(folder: &Path, model: &ReducedModel) {
    fs::create_dir(folder.join("targets")).unwrap();
    for (k, name) in ["a_lower", "b_shift"].iter().enumerate() {
        let mut q = vec![0.0; model.rank()];
        q[k] = 1.0;
        let mut text = String::new();
        for p in model.positions(&q).unwrap() {
            writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
        }
        for [a, b, c] in model.mesh().faces() {
            writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
        }
        fs::write(folder.join("targets").join(name).with_extension("obj"), text).unwrap();
    }
}

#[test]
fn every_form_of_a_model_gives_the_same_pairs() {
    let directory = strips();
    let folder = directory.path();
    let model = model(folder);
    write_stl(folder, &model);
    write_gltf(folder, &model, "strips");
    write_targets(folder, &model);
    let expected = check(folder, &["strips.model.safetensors"], &[]);
    assert_eq!(expected.code, Some(1));
    let expected = pairs(&expected);
    assert!(expected.iter().filter(|pairs| **pairs != json!([])).count() >= 2, "{expected:?}");
    for form in [
        &["mesh.obj", "--modes", "modes.npy"][..],
        &["mesh.obj", "--modes", "targets"],
        &["strips.stl", "--modes", "stl.npy"],
        &["strips.gltf"],
        &["strips.gltf", "--mesh-name", "strips"],
    ] {
        for method in ["certified", "bdtree", "traditional", "brute-force"] {
            assert_eq!(pairs(&check(folder, form, &["--method", method])), expected, "{form:?} {method}");
        }
        let certify = [&["certify"], form, &["-o", "x.sscc.safetensors"]].concat();
        assert_eq!(sscc(folder, &certify).code, Some(0));
        assert_eq!(pairs(&check(folder, form, &["--certificates", "x.sscc.safetensors"])), expected);
        let audit =
            [&["audit"], form, &["--certificates", "x.sscc.safetensors", "--samples", "100"]].concat();
        assert_eq!(sscc(folder, &audit).code, Some(0), "{form:?}");
    }
    // Without welding, every triangle touches its neighbours.
    for form in [&["strips.stl", "--modes", "stl.npy"][..], &["strips.gltf"]] {
        let unwelded = pairs(&check(folder, form, &["--weld=off", "--method", "traditional"]));
        assert!(unwelded.iter().all(|pairs| pairs.as_array().unwrap().len() >= 18), "{unwelded:?}");
        let welded = pairs(&check(folder, form, &["--weld", "--method", "traditional"]));
        assert_eq!(welded, expected);
    }
    // Welding does not change a mesh without duplicate vertices.
    assert_eq!(pairs(&check(folder, &["strips.model.safetensors"], &["--weld"])), expected);
}

#[test]
fn info_of_a_gltf_file() {
    let directory = strips();
    let folder = directory.path();
    write_gltf(folder, &model(folder), "two\nlines");
    let info = sscc(folder, &["info", "strips.gltf", "--json"]).json().remove(0);
    assert_eq!(info["kind"], "gltf");
    let [still, strips] = &info["meshes"].as_array().unwrap()[..] else { panic!("{info}") };
    assert_eq!((&still["name"], &still["targets"]), (&json!("still"), &json!([])));
    assert_eq!(
        (
            &strips["name"],
            &strips["targets"],
            &strips["triangles"],
            &strips["vertices"],
            &strips["default_q"]
        ),
        (&json!("two\nlines"), &json!(["lower", "shift"]), &json!(20), &json!(60), &json!([0.5, 0.0]))
    );
}

/// PCA and body models: an archive with mean, components and faces.
#[test]
fn a_statistical_shape_model_is_read() {
    let directory = strips();
    let folder = directory.path();
    let model = model(folder);
    let vertices = model.mesh().rest_positions();
    let mean: Vec<f64> = vertices.iter().flat_map(|p| p.to_array()).collect();
    let components: Vec<f64> = (0..model.rank())
        .flat_map(|k| (0..vertices.len() as u32).map(move |v| (v, k)))
        .flat_map(|(v, k)| model.modes().of_vertex(v)[k].to_array())
        .collect();
    for (name, shape, values) in [
        ("mean", &[3 * vertices.len()][..], &mean),
        ("components", &[model.rank(), 3 * vertices.len()], &components),
    ] {
        write_npy(&folder.join(name).with_extension("npy"), shape, values).unwrap();
    }
    let faces = model.mesh().faces();
    let header = format!("{{'descr': '<u4', 'fortran_order': False, 'shape': ({}, 3), }}\n", faces.len());
    let mut bytes =
        [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes()].concat();
    bytes.extend(faces.iter().flatten().flat_map(|v| v.to_le_bytes()));
    fs::write(folder.join("faces.npy"), bytes).unwrap();
    let mut archive = zip::ZipWriter::new(fs::File::create(folder.join("shape.npz")).unwrap());
    for name in ["mean.npy", "components.npy", "faces.npy"] {
        archive.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        std::io::Write::write_all(&mut archive, &fs::read(folder.join(name)).unwrap()).unwrap();
    }
    archive.finish().unwrap();
    let expected = pairs(&check(folder, &["strips.model.safetensors"], &[]));
    assert_eq!(pairs(&check(folder, &["shape.npz"], &[])), expected);
    assert_eq!(sscc(folder, &["info", "shape.npz", "--json"]).json()[0]["rank"], json!(2));
}

/// `--pose` writes the shape at q, with its colliding triangles marked.
#[test]
fn poses_have_their_collisions_marked() {
    let directory = strips();
    let folder = directory.path();
    for (q, colliding) in [("--q=0.5,0", 0), ("--q=1.5,0", 0), ("--q=1,0", 20)] {
        for name in ["pose.ply", "pose.obj"] {
            let args = ["check", "strips.model.safetensors", q, "--pose", name, "--json"];
            let run = sscc(folder, &args);
            assert_eq!(run.code, Some(i32::from(colliding > 0)), "{run:?}");
            let mesh = sscc_io::read_mesh(&folder.join(name)).unwrap();
            let numbers: Vec<f64> = q[4..].split(',').map(|x| x.parse().unwrap()).collect();
            assert_eq!(mesh.rest_positions(), model(folder).positions(&numbers).unwrap());
            assert_eq!(mesh.faces(), model(folder).mesh().faces());
        }
        let text = fs::read_to_string(folder.join("pose.obj")).unwrap();
        let (mut group, mut marked) = ("", 0);
        for line in text.lines() {
            group = line.strip_prefix("g ").unwrap_or(group);
            marked += usize::from(line.starts_with("f ") && group == "colliding");
        }
        assert_eq!(marked, colliding, "{q}");
    }
}

/// A model made from an STL file keeps the split vertices.
#[test]
fn models_from_stl_files_keep_split_vertices() {
    let directory = strips();
    let folder = directory.path();
    write_stl(folder, &model(folder));
    let run = sscc(folder, &["modes", "strips.stl", "-o", "s.model.safetensors", "--kind", "polynomial"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(run.stderr.contains("certify the model with --weld"), "{}", run.stderr);
    let (read, _) = sscc_io::read_model(&folder.join("s.model.safetensors")).unwrap();
    assert_eq!(read.modes().vertices(), 60);
    let welded =
        sscc(folder, &["certify", "s.model.safetensors", "--weld", "-o", "s.sscc.safetensors", "--json"]);
    assert_eq!(welded.json()[0]["rest_collisions"], json!(0), "{welded:?}");
}

/// PCA of frames made with two modes returns the mean and these modes.
#[test]
fn an_animation_becomes_a_model() {
    let directory = strips();
    let folder = directory.path();
    let strips = model(folder);
    fs::create_dir(folder.join("frames")).unwrap();
    let coordinates = [[0.2, 0.0], [-0.2, 0.0], [0.0, 0.1], [0.0, -0.1], [0.0, 0.0]];
    for (i, q) in coordinates.iter().enumerate() {
        let mut text = String::new();
        for p in strips.positions(q).unwrap() {
            writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
        }
        for [a, b, c] in strips.mesh().faces() {
            writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
        }
        fs::write(folder.join(format!("frames/{i}.obj")), text).unwrap();
    }
    let output = "pca.model.safetensors";
    let args = ["modes", "frames", "-o", output, "--kind", "pca"];
    let report = sscc(folder, &[&args[..], &["--json"]].concat()).json().remove(0);
    assert_eq!((&report["rank"], &report["frames"]), (&json!(2), &json!(5)));
    assert!((report["explained"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    let (read, info) = sscc_io::read_model(&folder.join(output)).unwrap();
    assert_eq!(info.provenance, "mean and principal components of 5 meshes in frames");
    // q has unit variance: components are modes times the root mean square of their coordinates.
    let deviation = (2.0_f64 * 0.2 * 0.2 / 4.0).sqrt();
    for (v, p) in strips.mesh().rest_positions().iter().enumerate() {
        assert!(p.distance(read.mesh().rest_positions()[v]) < 1e-12);
        let (known, found) = (strips.modes().of_vertex(v as u32)[0], read.modes().of_vertex(v as u32)[0]);
        assert!(found.distance(known * deviation) < 1e-12, "{found} {known}");
    }
    let certify = sscc(folder, &["certify", output, "-o", "pca.sscc.safetensors"]);
    assert_eq!(certify.code, Some(0), "{certify:?}");
    let text = sscc(folder, &[&args[..], &["--rank", "1"]].concat()).stdout;
    assert!(
        text.starts_with("20 triangles, 24 vertices, 1 principal component of 5 frames (80.00%"),
        "{text}"
    );

    let refusal = |args: &[&str]| sscc(folder, args).refusal().to_owned();
    let more = refusal(&[&args[..], &["--rank", "3"]].concat());
    assert!(more.starts_with("error: frames: 3 components were requested, but the frames have 2 "), "{more}");
    let file = refusal(&["modes", "mesh.obj", "-o", output, "--kind", "pca"]);
    assert!(file.contains("mesh.obj: is a file; --kind pca needs a folder"), "{file}");
    let rank = refusal(&["modes", "mesh.obj", "-o", output, "--kind", "polynomial", "--rank", "3"]);
    assert!(rank.contains("there are at most 24 polynomial modes"), "{rank}");
    fs::write(folder.join("frames/5.obj"), "v 0 0 0\n").unwrap();
    assert!(refusal(&args).contains("5.obj: this frame has 1 vertices, the first one (0.obj) has 24"));
    fs::create_dir(folder.join("none")).unwrap();
    let none = refusal(&["modes", "none", "-o", output, "--kind", "pca"]);
    assert!(none.contains("none: there is no frame mesh in this folder: frames are .obj, "), "{none}");
}
