//! From files of other programs to sound: the commands of docs/simulations.md, and files that are refused.

use std::fs;
use std::path::Path;

use glam::DVec3;
use sscc::{Modes, ReducedModel};
use sscc_io::ModelInfo;
use sscc_modes::nonlinear_modes;
use sscc_solid::{Elasticity, Material, PartialMaterial, ReducedForces, Solid};
use tempfile::TempDir;

use crate::common::solids::{bridge, comb, crossing, medit, obj, octopus, solid, subdivided, veg};
use crate::common::{Run, command};
use crate::readme::commands;

/// Returns the bytes of VegaFEM's modal matrix.
fn modal_matrix(modes: &Modes) -> Vec<u8> {
    let (rows, rank) = (3 * modes.vertices(), modes.rank());
    let mut bytes = [(rows as i32).to_le_bytes(), (rank as i32).to_le_bytes()].concat();
    for k in 0..rank {
        for v in 0..modes.vertices() as u32 {
            modes.of_vertex(v)[k].to_array().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        }
    }
    bytes
}

/// Returns the bytes of VegaFEM's reduced forces.
fn cub(forces: &ReducedForces) -> Vec<u8> {
    let r = forces.rank();
    let sizes = [r, r, r * (r + 1) / 2, r * (r + 1) * (r + 2) / 6];
    let mut bytes: Vec<u8> = sizes.iter().flat_map(|n| (*n as i32).to_le_bytes()).collect();
    for part in [forces.linear().entries(), forces.quadratic(), forces.cubic()] {
        part.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    bytes
}

/// Writes a reduced model as VegaFEM does: NAME.obj, NAME.U and NAME.cub of rank 4, held at its top if `is_held`.
fn reduced(folder: &Path, name: &str, is_held: bool) {
    let firm = PartialMaterial { youngs_modulus: Some(1e7), ..PartialMaterial::default() };
    let body = solid(&comb(), |p| 0.01 * p);
    let (vertices, tets) = (body.vertices().to_vec(), body.tets().to_vec());
    let body = Solid::uniform(vertices, tets, vec![], Material::new(&firm).unwrap()).unwrap();
    let top: Vec<u32> =
        (0..body.vertices().len() as u32).filter(|v| body.vertices()[*v as usize].z > 0.029).collect();
    let found = nonlinear_modes(&body, if is_held { &top[..] } else { &[] }, 4, &()).unwrap();
    let Elasticity::Nonlinear(forces) = &found.elasticity else { panic!("linear") };
    let boundary = body.boundary().unwrap();
    let file = |ending: &str| folder.join(format!("{name}.{ending}"));
    fs::write(file("obj"), obj(&boundary.mesh)).unwrap();
    fs::write(file("U"), modal_matrix(&boundary.on_surface(&found.modes).unwrap())).unwrap();
    fs::write(file("cub"), cub(forces)).unwrap();
}

/// A folder with all files that the guide names.
fn files() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| fs::write(directory.path().join(name), text).unwrap();
    let bridge = solid(&bridge(), |p| 10.0 * p);
    let feet = (1..)
        .zip(bridge.vertices())
        .filter(|(_, p)| p.z == 0.0)
        .map(|(number, _): (u32, _)| number.to_string());
    write("bridge.bou", feet.collect::<Vec<_>>().join(",") + "\n");
    write("bridge.veg", veg(&bridge));
    write("comb.mesh", medit(&solid(&comb(), |p| 0.01 * p)));
    let octopus = solid(&octopus(), crossing);
    write("octopus.mesh", medit(&octopus));
    write("octopus.obj", obj(&subdivided(&octopus.boundary().unwrap().mesh)));
    reduced(directory.path(), "bracket", true);
    directory
}

fn sscc(folder: &Path, args: &[&str]) -> Run {
    Run::of(command(folder, args).env("XDG_CACHE_HOME", folder.join("cache")).env_remove("SSCC_MODELS"))
}

/// Returns the blocks of TOML that begin with the name of a file, `# NAME.toml`, with these names.
fn scenes(text: &str) -> Vec<(String, String)> {
    let blocks = text.split("```toml\n# ").skip(1).map(|rest| rest.split_once("```").unwrap().0);
    blocks
        .map(|block| block.split_once('\n').unwrap())
        .map(|(name, text)| (name.into(), text.into()))
        .collect()
}

#[test]
fn the_guide_leads_from_files_to_sound() {
    let guide =
        fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/simulations.md")).unwrap();
    let directory = files();
    let folder = directory.path();
    let scenes = scenes(&guide);
    assert_eq!(
        scenes.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        ["bridge.toml", "octopus.toml"]
    );
    scenes.iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
    let mut notes = String::new();
    for args in commands(&guide) {
        let run = sscc(folder, &args.iter().map(String::as_str).collect::<Vec<_>>());
        let wanted = if args[0] == "check" { 1 } else { 0 };
        assert_eq!(run.code, Some(wanted), "{run:?}");
        notes += &run.stderr;
    }
    for name in ["bridge", "octopus"] {
        let sound = fs::read(folder.join(name).join("sound.wav")).unwrap();
        let samples = sound[44..].as_chunks().0.iter().map(|sample| i16::from_le_bytes(*sample));
        let peak = samples.clone().map(i16::unsigned_abs).max();
        assert_eq!((samples.clone().count(), peak.is_some_and(|peak| peak > 29_000)), (800, true), "{name}");
        assert!(samples.take(100).all(|sample| sample == 0), "{name}: sound before the first contact");
    }
    for note in [
        "note: comb: longest side 0.05000 m, mass 0.01",
        "note: octopus: ",
        " of triangles collide at rest; they make no contact",
        "note: bracket: longest side 0.05000 m, held, first mode ",
        "note: body 1 (bracket): shake gives ",
    ] {
        assert!(notes.contains(note), "{note}: {notes}");
    }
    assert!(!notes.contains("outside the solid"), "{notes}");

    // The bridge is held, and the comb is not.
    let arrays = fs::File::open(folder.join("bridge/trajectories.npz")).unwrap();
    let mut arrays = zip::ZipArchive::new(arrays).unwrap();
    let mut bytes = Vec::new();
    std::io::Read::read_to_end(&mut arrays.by_name("positions.npy").unwrap(), &mut bytes).unwrap();
    let positions = sscc_io::npy::parse(&bytes).unwrap().to_c_order();
    let (first, last) = (&positions[..6], &positions[positions.len() - 6..]);
    assert_eq!(first[..3], last[..3]);
    assert!((first[0] - 0.04).abs() < 1e-12 && first[5] > last[5] + 0.005, "{first:?} {last:?}");
}

const SCENE: &str =
    "steps_per_second = 8000\nduration = 0.01\ngravity = [0, 0, -9.81]\n[contact]\nfrequency = 500\n";

/// Runs a scene with one model of these keys and one body of it.
fn simulate(folder: &Path, model: &str, body: &str) -> Run {
    simulate_in(folder, SCENE, model, body)
}

fn simulate_in(folder: &Path, scene: &str, model: &str, body: &str) -> Run {
    let text = format!("{scene}[models.m]\n{model}\n[[bodies]]\nmodel = \"m\"\n{body}\n");
    fs::write(folder.join("scene.toml"), text).unwrap();
    sscc(folder, &["simulate", "scene.toml", "--out", "out", "--restart", "--json"])
}

#[test]
fn models_that_cannot_move_are_refused() {
    let directory = files();
    let folder = directory.path();
    reduced(folder, "free", false);
    reduced(folder, "other", true);
    let forces = fs::read(folder.join("other.cub")).unwrap();
    fs::write(folder.join("cut.cub"), &forces[..forces.len() - 8]).unwrap();
    let made = sscc(
        folder,
        &["modes", "comb.mesh", "-o", "comb.model.safetensors", "--kind", "linear", "--rank", "3"],
    );
    assert_eq!(made.code, Some(0), "{made:?}");
    let (model, info) = sscc_io::read_model(&folder.join("comb.model.safetensors")).unwrap();
    let write =
        |name: &str, info: ModelInfo| sscc_io::write_model(&folder.join(name), &model, &info).unwrap();
    let elasticity = info.elasticity.clone().unwrap();
    write("cm.model.safetensors", ModelInfo::new("cm", "").with_elasticity(elasticity.clone()));
    write("still.model.safetensors", ModelInfo::new("m", ""));
    write("light.model.safetensors", ModelInfo::new("m", "").with_elasticity(elasticity));
    let narrow =
        Modes::from_matrix(model.mesh().rest_positions().len(), 2, |row, k| (row + k) as f64).unwrap();
    fs::write(folder.join("two.U"), modal_matrix(&narrow)).unwrap();
    let vega = |name: &str| format!("file = \"{name}.obj\"\nmodes = \"{name}.U\"\nforces = \"{name}.cub\"");
    for (model, body, cause) in [
        (
            "file = \"still.model.safetensors\"",
            "",
            "still.model.safetensors: the model has no forces, so it cannot move",
        ),
        ("file = \"bracket.obj\"\nmodes = \"bracket.U\"", "", "forces = \"FILE.cub\""),
        ("file = \"cm.model.safetensors\"", "", "its unit of length is 'cm', but scenes are in metres"),
        ("file = \"light.model.safetensors\"", "", "state no mass: give material = { density"),
        (&vega("free"), "", "state no mass: give material = { density"),
        (
            "file = \"comb.model.safetensors\"\nmaterial = { density = 2 }",
            "",
            "has its own mass: leave out density",
        ),
        (
            "file = \"comb.model.safetensors\"\nmaterial = \"steel\"",
            "",
            "has its own stiffness: leave out youngs",
        ),
        (
            "file = \"comb.model.safetensors\"\ndynamics = \"nonlinear\"",
            "",
            "no forces of large deformations",
        ),
        ("file = \"comb.model.safetensors\"\nforces = \"other.cub\"", "", "the model has forces of its own"),
        ("file = \"comb.model.safetensors\"\namplitudes = [1]", "", "amplitudes: 1 numbers for 3 modes"),
        ("file = \"comb.model.safetensors\"", "shake = [1, 2, 3, 4]", "shake: 4 numbers for 3 modes"),
        (
            "file = \"bracket.obj\"\nmodes = \"two.U\"\nforces = \"bracket.cub\"",
            "",
            "bracket.cub: forces of 4 modes, but the model has 2",
        ),
        ("file = \"bracket.obj\"\nmodes = \"bracket.U\"\nforces = \"cut.cub\"", "", "is the file cut off?"),
        (&vega("bracket"), "velocity = [0, 0, 1]", "so it does not move as a whole: leave out velocity"),
        (
            "file = \"comb.mesh\"\nkind = \"linear\"\nrank = 3\nfix = [9999]",
            "",
            "m: fix: there is no vertex 9999",
        ),
        (
            "file = \"comb.mesh\"\nkind = \"linear\"\nrank = 3\nfix = \"box:9,9,9,8,8,8\"",
            "",
            "this selects no vertex",
        ),
    ] {
        let run = simulate(folder, model, body);
        let message = run.refusal();
        assert!(message.contains(cause), "{model}: {message}");
        assert!(!folder.join("out/trajectories.npz").exists());
    }
    // The same files with the missing data.
    for model in [
        format!("{}\nmaterial = {{ density = 1000 }}", vega("free")),
        "file = \"light.model.safetensors\"\nmaterial = { density = 1000 }".into(),
        format!("{}\ndynamics = \"linear\"", vega("bracket")),
    ] {
        let run = simulate(folder, &model, "");
        assert_eq!(run.code, Some(0), "{run:?}");
    }
}

/// A model of twice the size is that of the solid of twice the size.
#[test]
fn scaled_models_move_like_scaled_solids() {
    let directory = files();
    let folder = directory.path();
    let made = |kind: &str| {
        let args = ["modes", "comb.mesh", "-o", "comb.model.safetensors", "--kind", kind, "--rank", "4"];
        let run = sscc(folder, &args);
        assert_eq!(run.code, Some(0), "{run:?}");
    };
    let energies = |model: &str| {
        let run = simulate(folder, model, "shake = { speed = [0.5, 1] }\nvelocity = [0, 0, 1]");
        assert_eq!(run.code, Some(0), "{run:?}");
        let summary = run.json().remove(0);
        let number = |key: &str| summary[key].as_f64().unwrap();
        (number("energy_first"), number("energy_last"), run.stderr)
    };
    for kind in ["linear", "nonlinear"] {
        made(kind);
        let solid = format!("file = \"comb.mesh\"\nkind = \"{kind}\"\nrank = 4");
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * b.abs();
        for resize in ["scale = 2", "size = 0.2", "scale = 1"] {
            let (first, last, notes) = energies(&format!("{solid}\n{resize}"));
            let (own_first, own_last, own_notes) =
                energies(&format!("file = \"comb.model.safetensors\"\n{resize}"));
            assert!(near(own_first, first) && near(own_last, last), "{kind} {resize}: {own_last} {last}");
            let shake =
                |notes: &str| notes.lines().find(|line| line.contains("shake gives")).unwrap().to_owned();
            assert_eq!(shake(&own_notes), shake(&notes));
        }
    }
}

#[test]
fn surfaces_outside_their_solid_are_reported_or_refused() {
    let directory = files();
    let folder = directory.path();
    let surface = sscc_io::read_mesh(&folder.join("octopus.obj")).unwrap();
    let moved = |name: &str, map: &dyn Fn(DVec3) -> DVec3| {
        let points = surface.rest_positions().iter().map(|p| map(*p)).collect();
        let mesh = sscc::TriMesh::new(points, surface.faces().to_vec()).unwrap();
        fs::write(folder.join(name), obj(&mesh)).unwrap();
    };
    moved("larger.obj", &|p| p * 1.05);
    moved("beside.obj", &|p| p + DVec3::Z * 5.0);
    let modes = |surface: &str, more: &[&str]| {
        let args = [
            "modes",
            surface,
            "--solid",
            "octopus.mesh",
            "-o",
            "x.model.safetensors",
            "--kind",
            "linear",
            "--rank",
            "3",
        ];
        sscc(folder, &[&args[..], more].concat())
    };
    let exact = modes("octopus.obj", &[]);
    assert_eq!((exact.code, exact.stderr.as_str()), (Some(0), ""), "{exact:?}");
    // The embedded surface moves with the solid: the corners of the coarse boundary have the solid's modes.
    let embedded = sscc_io::read_model(&folder.join("x.model.safetensors")).unwrap().0;
    let whole = sscc(
        folder,
        &["modes", "octopus.mesh", "-o", "y.model.safetensors", "--kind", "linear", "--rank", "3"],
    );
    assert_eq!(whole.code, Some(0), "{whole:?}");
    let whole = sscc_io::read_model(&folder.join("y.model.safetensors")).unwrap().0;
    let size =
        |model: &ReducedModel| model.modes().displacements().iter().map(|u| u.length()).fold(0.0, f64::max);
    for v in 0..whole.mesh().rest_positions().len() as u32 {
        let [a, b] = [&embedded, &whole].map(|model| model.modes().of_vertex(v));
        assert!(a.iter().zip(b).all(|(a, b)| a.distance(*b) < 1e-9 * size(&whole)), "vertex {v}");
    }

    let larger = modes("larger.obj", &[]);
    assert_eq!(larger.code, Some(0), "{larger:?}");
    assert!(
        larger.stderr.starts_with("note: ")
            && larger.stderr.contains("vertices of the surface are outside the solid; the farthest, vertex "),
        "{larger:?}"
    );
    let beside = modes("beside.obj", &[]);
    let message = beside.refusal();
    assert!(message.contains("more than a tenth of its size; use a solid that encloses"), "{message}");
    let model = "file = \"beside.obj\"\nsolid = \"octopus.mesh\"\nkind = \"linear\"\nrank = 3";
    assert!(simulate(folder, model, "").refusal().contains("octopus.mesh: "), "scene");
    assert!(modes("comb.mesh", &[]).refusal().contains("comb.mesh: it is a solid itself: only a surface"));
    assert!(modes("octopus.obj", &["--resolution", "4"]).refusal().contains("--resolution"));
    let fixed = modes("octopus.obj", &["--fix", "0,1,2"]);
    assert_eq!(fixed.code, Some(0), "{fixed:?}");
    let info = sscc_io::read_model(&folder.join("x.model.safetensors")).unwrap().1;
    assert!(info.mass.unwrap().is_held);
}

/// VegaFEM's letter A with its own modes and forces: it is held at its fixed vertices, and keeps its energy.
#[test]
fn the_letter_of_vegafem_vibrates() {
    let Some(models) = sscc_testing::models("the_letter_of_vegafem_vibrates") else { return };
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| models.join("vega_A").join(name).to_str().unwrap().to_owned();
    let [mesh, modes, forces] = ["A.obj", "A.URendering.float", "A.cub"].map(path);
    let files = format!("file = {mesh:?}\nmodes = {modes:?}\nforces = {forces:?}");
    for dynamics in ["nonlinear", "linear"] {
        let model = format!("{files}\ndynamics = \"{dynamics}\"");
        let weightless = SCENE.replace("gravity = [0, 0, -9.81]\n", "");
        let run = simulate_in(directory.path(), &weightless, &model, "shake = { speed = [0.01] }");
        assert_eq!(run.code, Some(0), "{run:?}");
        let summary = &run.json()[0];
        let [first, largest, last] =
            ["energy_first", "energy_largest", "energy_last"].map(|key| summary[key].as_f64().unwrap());
        assert!(first > 0.0 && largest < 1.01 * first && last > 0.99 * first, "{dynamics}: {summary}");
        assert!(run.stderr.contains("note: m: longest side 0.9035 m, held, first mode "), "{run:?}");
        let assumed = summary["models"][0]["note"].as_str().unwrap();
        assert!(assumed.starts_with("10 vertices are fixed, so the body is held"), "{assumed}");
    }
}
