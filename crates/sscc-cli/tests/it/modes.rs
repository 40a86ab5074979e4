//! `sscc modes` of solids: surfaces in a lattice, files of elements, and solids that are refused.

use glam::DVec3;
use sscc_solid::{Material, Solid};
use std::fs;
use std::path::Path;

use crate::common::{files, sscc};
use crate::statics::BRACKET;

/// A box of 2 x 1 x 1, closed.
const BOX: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 0 1 1\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// Two tetrahedra, with two materials.
const VEG: &str = "*VERTICES\n5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n\
    *ELEMENTS\nTET\n2 4 0\n1 1 2 3 4\n2 2 3 4 5\n\
    *MATERIAL soft\nENU, 1000, 1e6, 0.4\n*MATERIAL hard\nENU, 2000, 1e7, 0.3\n\
    *SET first\n1\n*SET second\n2\n*REGION\nfirst, soft\n*REGION\nsecond, hard\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("box.obj", BOX);
    write("two.veg", VEG);
    write("open.obj", &BOX.replace("f 4 1 5 8\n", ""));
    write("turned.obj", &BOX.replace("f 4 1 5 8\n", "f 8 5 1 4\n"));
    // A second box, far from the first one or overlapping it.
    let second = |by: f64| {
        let moved: String = BOX
            .lines()
            .filter(|l| l.starts_with('v'))
            .map(|line| {
                let p: Vec<f64> = line.split(' ').skip(1).map(|x| x.parse().unwrap()).collect();
                format!("v {} {} {}\n", p[0] + by, p[1] + by, p[2] + by)
            })
            .collect();
        let faces: String = BOX
            .lines()
            .filter(|l| l.starts_with('f'))
            .map(|line| {
                let f: Vec<usize> = line.split(' ').skip(1).map(|x| x.parse().unwrap()).collect();
                format!("f {} {} {} {}\n", f[0] + 8, f[1] + 8, f[2] + 8, f[3] + 8)
            })
            .collect();
        format!("{BOX}{moved}{faces}")
    };
    write("pieces.obj", &second(5.0));
    write("crossing.obj", &second(0.5));
    write("inverted.veg", &VEG.replace("2 2 3 4 5\n*MAT", "2 2 4 3 5\n*MAT"));
    write("orphan.veg", &VEG.replace("5 3 0 0\n", "6 3 0 0\n").replace("5 1 1 1\n", "5 1 1 1\n6 9 9 9\n"));
    write("heavy.veg", &VEG.replace("1e7, 0.3", "1e7, 0.4999999"));
    write("first.txt", "0\n3\n");
    folder
}

fn modes(folder: &Path, args: &[&str]) -> serde_json::Value {
    let run = sscc(folder, &[&["modes", "-o", "x.model.safetensors", "--json"], args].concat());
    assert_eq!(run.code, Some(0), "{run:?}");
    run.json().remove(0)
}

#[test]
fn linear_modes_of_a_surface() {
    let directory = folder();
    let folder = directory.path();
    let report = modes(folder, &["box.obj", "--kind", "linear", "--rank", "6", "--resolution", "8"]);
    assert_eq!(
        (&report["triangles"], &report["vertices"], &report["rank"]),
        (&12.into(), &8.into(), &6.into())
    );
    let found: Vec<f64> =
        report["frequencies_hz"].as_array().unwrap().iter().map(|f| f.as_f64().unwrap()).collect();
    assert!(found.windows(2).all(|pair| pair[0] <= pair[1]) && found[0] > 1.0, "{found:?}");
    assert!(report["degrees_of_freedom"].as_u64().unwrap() > 3 * 5 * 5 * 9);

    let info = sscc(folder, &["info", "x.model.safetensors", "--json"]).json().remove(0);
    let listed: Vec<f64> =
        info["frequencies_hz"].as_array().unwrap().iter().map(|f| f.as_f64().unwrap()).collect();
    assert_eq!(
        (listed, &info["metric"], &info["nonlinear"]),
        (found.clone(), &"energy".into(), &false.into())
    );
    assert!(sscc(folder, &["info", "x.model.safetensors"]).stdout.contains(" Hz"));

    let certify = |metric| {
        sscc(folder, &["certify", "x.model.safetensors", "-o", "x.sscc.safetensors", "--metric", metric]).code
    };
    assert_eq!((certify("energy"), certify("displacement")), (Some(0), Some(0)));

    // Frequencies fall with the root of the density, and rise with the root of the stiffness.
    let args = ["box.obj", "--kind", "linear", "--rank", "6", "--resolution", "8", "--material"];
    for (material, factor) in [("density=4000", 0.5), ("youngs=4e6,density=1000", 2.0)] {
        let report = modes(folder, &[&args[..], &[material]].concat());
        let first = report["frequencies_hz"][0].as_f64().unwrap();
        assert!((first / found[0] / factor - 1.0).abs() < 1e-6);
    }

    // Fixed at one end, its lowest frequency is lower, and the vertices there do not move.
    for fix in ["box:-1,-1,-1,0,2,2", "0,3,4,7"] {
        let report =
            modes(folder, &["box.obj", "--kind", "linear", "--rank", "2", "--resolution", "8", "--fix", fix]);
        assert!(report["frequencies_hz"][0].as_f64().unwrap() < found[0]);
        let (model, _) = sscc_io::read_model(&folder.join("x.model.safetensors")).unwrap();
        let still = |v: u32| model.modes().of_vertex(v).iter().all(|u| u.length() == 0.0);
        assert_eq!((0..8).map(still).collect::<Vec<_>>(), [0, 1, 1, 0, 0, 1, 1, 0].map(|n| n == 0));
    }
}

#[test]
fn units_of_a_file_scale_its_model() {
    let directory = folder();
    let folder = directory.path();
    let args =
        ["box.obj", "--kind", "linear", "--rank", "6", "--resolution", "8", "--fix", "box:-1,-1,-1,0,2,2"];
    let of = |more: &[&str]| {
        let report = modes(folder, &[&args[..], more].concat());
        let numbers = ["longest_side", "mass"].map(|key| report[key].as_f64().unwrap());
        (numbers[0], numbers[1], report["frequencies_hz"][0].as_f64().unwrap())
    };
    let (side, mass, first) = of(&[]);
    assert!(side == 2.0 && (mass / 2000.0 - 1.0).abs() < 0.01);
    for more in [["--units", "mm"], ["--scale", "0.001"]] {
        let found = of(&more);
        let ratios = [found.0 / side * 1e3, found.1 / mass * 1e9, found.2 / first / 1e3];
        assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 1e-6), "{ratios:?}");
    }
    let text =
        sscc(folder, &["modes", "-o", "x.model.safetensors", "two.veg", "--kind", "linear", "--rank", "2"]);
    assert!(text.stdout.contains("\nlongest side 1.000 m, mass 833.3 kg, first mode "), "{text:?}");
    let refused = |more: &[&str]| {
        let run = sscc(folder, &[&["modes", "-o", "x.model.safetensors"], &args[..], more].concat());
        assert_eq!((run.code, run.stderr.lines().count()), (Some(2), 1), "{run:?}");
        run.stderr
    };
    let unknown = refused(&["--units", "ft"]);
    assert!(unknown.contains("'ft'") && unknown.contains("mm, cm, m, in"), "{unknown}");
    assert!(refused(&["--units", "mm", "--scale", "2"]).contains("cannot be used with"));
    for typed in ["--scale=0", "--scale=-1", "--scale=nan", "--scale=x", "--scale=inf"] {
        assert!(refused(&[typed]).contains("a finite number above 0 was expected"));
    }
    assert!(refused(&["--scale", "1e100"]).contains("box.obj: "));
}

/// Returns a gmsh file of a beam of 200 x 10 x 10 in one layer of tetrahedra, of first and of second order.
fn beams() -> [String; 2] {
    let vertices =
        (0..84).map(|k| DVec3::new(f64::from(k / 4 * 10), f64::from(k % 2 * 10), f64::from(k / 2 % 2 * 10)));
    let cube = |at: u32| [0, 4, 5, 1, 2, 6, 7, 3].map(|corner| 4 * at + corner);
    let paths = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];
    let tets = (0..20).flat_map(|at| paths.map(|path| path.map(|k| cube(at)[k]))).collect();
    let linear = Solid::uniform(vertices.collect(), tets, vec![], Material::default()).unwrap();
    let (second_order, _) = linear.elevated().unwrap();
    let text = |vertices: &[DVec3], kind: u32, elements: Vec<&[u32]>| {
        let nodes: String =
            vertices.iter().zip(1..).map(|(p, k)| format!("{k} {} {} {}\n", p.x, p.y, p.z)).collect();
        let line = |(nodes, k): (&&[u32], u32)| {
            let nodes: Vec<String> = nodes.iter().map(|v| (v + 1).to_string()).collect();
            format!("{k} {kind} 0 {}\n", nodes.join(" "))
        };
        let lines: String = elements.iter().zip(1..).map(line).collect();
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{}\n{lines}$EndElements\n",
            vertices.len(),
            elements.len()
        )
    };
    [
        text(linear.vertices(), 4, linear.tets().iter().map(|tet| &tet[..]).collect()),
        text(second_order.vertices(), 11, second_order.tets10().iter().map(|tet| &tet[..]).collect()),
    ]
}

#[test]
fn tetrahedra_of_second_order_bend_as_a_beam_and_linear_ones_are_noted() {
    let directory = folder();
    let folder = directory.path();
    let [linear, second_order] = beams();
    fs::write(folder.join("linear.msh"), linear).unwrap();
    fs::write(folder.join("second.msh"), &second_order).unwrap();
    let run = |file: &str, more: &[&str]| {
        let fixed = ["--units", "mm", "--material", "steel", "--fix", "box:0,0,0,0,10,10", "--rank", "4"];
        let args = ["modes", file, "-o", "x.model.safetensors", "--kind", "linear"];
        sscc(folder, &[&args[..], &fixed, more].concat())
    };
    let of = |file: &str| run(file, &["--json"]).json().remove(0);
    let hz = |report: &serde_json::Value| report["frequencies_hz"][0].as_f64().unwrap();
    let (coarse, found) = (of("linear.msh"), of("second.msh"));
    // Euler and Bernoulli's clamped beam of steel.
    let expected =
        1.875_104_f64.powi(2) / 0.04 * 0.01 * (2.0e11_f64 / 12.0 / 7850.0).sqrt() / std::f64::consts::TAU;
    assert!((hz(&found) / expected - 1.0).abs() < 0.02, "{found} {expected}");
    assert!((coarse["second_order_hz"].as_f64().unwrap() / hz(&found) - 1.0).abs() < 1e-6, "{coarse}");
    assert!(hz(&coarse) > 1.4 * expected && found.get("second_order_hz").is_none());
    assert_eq!((&found["triangles"], &found["elements"]), (&(4 * 164).into(), &120.into()));
    let note = run("linear.msh", &[]);
    assert!(note.stderr.contains("note: the tetrahedra are too stiff: the first frequency is "), "{note:?}");
    assert!(!run("second.msh", &[]).stderr.contains("stiff"));

    // The first edge's node is at a corner, then in another place.
    let nodes = second_order.lines().skip_while(|line| *line != "$Elements").nth(2).unwrap();
    let nodes: Vec<&str> = nodes.split(' ').skip(3).collect();
    let at = |k: usize| {
        let line = second_order.lines().find(|line| line.starts_with(&format!("{} ", nodes[k]))).unwrap();
        line.split_once(' ').unwrap().1.to_owned()
    };
    for moved in [at(0), "90 90 90".into()] {
        let line = format!("\n{} {}\n", nodes[4], at(4));
        let text = second_order.replacen(&line, &format!("\n{} {moved}\n", nodes[4]), 1);
        fs::write(folder.join("bad.msh"), text).unwrap();
        let run = run("bad.msh", &[]);
        let refused = run.refusal();
        assert!(
            refused.contains("bad.msh: the second-order tetrahedron 0 (counted from 0, corners ["),
            "{refused}"
        );
        assert!(refused.contains("move the nodes of its edges towards their middles"), "{refused}");
    }
    let run = run("box.obj", &["--solid", "second.msh"]);
    let embedded = run.refusal();
    assert!(embedded.contains("a surface can be embedded in tetrahedra of first order only"), "{embedded}");
}

#[test]
fn documented_commands_print_the_shown_output() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    fs::write(folder.join("bracket.obj"), BRACKET).unwrap();
    fs::write(folder.join("beam.msh"), &beams()[0]).unwrap();
    let guide = include_str!("../../../../docs/command.md");
    for source in ["bracket.obj", "beam.msh"] {
        let (_, block) = guide.split_once(&format!("$ sscc modes {source} ")).unwrap();
        let (typed, shown) = block.split_once("```").unwrap().0.split_once('\n').unwrap();
        let args: Vec<&str> = ["modes", source].into_iter().chain(typed.split(' ')).collect();
        let run = sscc(folder, &args);
        assert_eq!(run.stdout + &run.stderr, shown, "{args:?}");
    }
}

#[test]
fn bases_for_large_deformations_have_forces() {
    let directory = folder();
    let folder = directory.path();
    for (kind, rank) in [("nonlinear", 8), ("polynomial", 24)] {
        let report = match kind {
            "nonlinear" => modes(folder, &["box.obj", "--kind", kind, "--rank", "8", "--resolution", "6"]),
            _ => modes(folder, &["box.obj", "--kind", kind, "--resolution", "6"]),
        };
        assert_eq!(report["rank"], rank);
        let (model, info) = sscc_io::read_model(&folder.join("x.model.safetensors")).unwrap();
        assert_eq!(model.rank(), rank);
        let Some(sscc_solid::Elasticity::Nonlinear(forces)) = info.elasticity else { panic!("{kind}") };
        assert!(forces.asymmetry() < 1e-9);
        // Large deformations have an energy above 0.
        assert!(forces.energy(&vec![1.0; rank]) > 0.0);
    }
}

#[test]
fn linear_modes_of_solids_from_files() {
    let directory = folder();
    let folder = directory.path();
    let report = modes(folder, &["two.veg", "--kind", "linear", "--rank", "9"]);
    assert_eq!(
        (&report["triangles"], &report["elements"], &report["degrees_of_freedom"]),
        (&6.into(), &2.into(), &15.into())
    );
    let held = modes(folder, &["two.veg", "--kind", "linear", "--rank", "8", "--fix", "first.txt"]);
    assert_eq!(held["degrees_of_freedom"], 9);
}

/// Returns the provenance in the model's file.
fn provenance(folder: &Path) -> String {
    sscc_io::read_model(&folder.join("x.model.safetensors")).unwrap().1.provenance
}

fn frequencies(report: &serde_json::Value) -> Vec<f64> {
    report["frequencies_hz"].as_array().unwrap().iter().map(|f| f.as_f64().unwrap()).collect()
}

/// Note and provenance name the numbers of the materials of `two.veg` that `--material` replaces.
#[test]
fn a_typed_material_overrides_those_of_the_file() {
    let directory = folder();
    let folder = directory.path();
    let run = |file: &str, material: Option<&str>| {
        let args = ["modes", "-o", "x.model.safetensors", file, "--kind", "linear", "--rank", "9", "--json"];
        let material = material.map_or(vec![], |material| vec!["--material", material]);
        let run = sscc(folder, &[&args[..], &material].concat());
        assert_eq!(run.code, Some(0), "{run:?}");
        // Two tetrahedra are too stiff.
        let notes =
            run.stderr.lines().filter(|line| !line.contains("too stiff")).map(|line| format!("{line}\n"));
        (frequencies(&run.json()[0]), notes.collect::<String>(), provenance(folder))
    };
    let note = |numbers: &str| format!("note: --material overrides the file's materials: {numbers}\n");
    let (own, stderr, stored) = run("two.veg", None);
    assert_eq!(stderr, "");
    assert!(stored.ends_with(", materials of the file"), "{stored}");

    // A material gives the same frequencies in the file and on the command line.
    let both = |enu: &str| VEG.replace("1000, 1e6, 0.4", enu).replace("2000, 1e7, 0.3", enu);
    fs::write(folder.join("steel.veg"), both("7850, 2e11, 0.29")).unwrap();
    let (steel, ..) = run("steel.veg", None);
    for typed in ["steel", "youngs=2e11,poisson=0.29,density=7850"] {
        let (found, stderr, stored) = run("two.veg", Some(typed));
        assert_eq!((found, stderr), (steel.clone(), note("youngs=2e11 poisson=0.29 density=7850")));
        assert!(stored.ends_with(", youngs=2e11 poisson=0.29 density=7850"), "{stored}");
    }
    // A single number replaces that number of each material.
    let dense = VEG.replace("ENU, 1000", "ENU, 4000").replace("ENU, 2000", "ENU, 4000");
    fs::write(folder.join("dense.veg"), dense).unwrap();
    let (found, stderr, stored) = run("two.veg", Some("density=4000"));
    assert_eq!((&found, stderr), (&run("dense.veg", None).0, note("density=4000")));
    assert!(found != own && stored.ends_with(", materials of the file with density=4000"), "{stored}");

    // A file without materials: the default numbers, or the typed ones, and no note.
    let medit = "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n1 1 1 1\n\
        Tetrahedra\n2\n1 2 3 4 1\n2 3 4 5 1\nEnd\n";
    fs::write(folder.join("two.mesh"), medit).unwrap();
    for (typed, numbers) in [
        (None, "youngs=1e6 poisson=0.4 density=1000"),
        (Some("glass"), "youngs=6.2e10 poisson=0.2 density=2600"),
    ] {
        let (_, stderr, stored) = run("two.mesh", typed);
        assert_eq!(stderr, "");
        assert!(stored.ends_with(&format!(", {numbers}")), "{stored}");
    }
}

#[test]
fn the_help_lists_the_materials() {
    let directory = folder();
    let help = sscc(directory.path(), &["modes", "--help"]).stdout;
    for material in sscc_dynamics::MATERIALS {
        assert!(help.contains(material.name), "{}", material.name);
    }
}

#[test]
fn invalid_requests_are_refused() {
    let directory = folder();
    let folder = directory.path();
    let linear: &[&str] = &["--kind", "linear", "--rank", "3"];
    for (args, named) in [
        (&["open.obj"][..], "open.obj: the edge from vertex"),
        (&["turned.obj"], "orient its triangles alike"),
        (&["pieces.obj"], "the solid is in 2 separate pieces"),
        (&["crossing.obj"], "collide at rest"),
        (&["box.obj", "--resolution", "2000"], "2000 cells along the longest side"),
        (
            &["box.obj", "--resolution", "4", "--fix", "8"],
            "--fix 8: there is no vertex 8 (counted from 0): the file has 8",
        ),
        (&["box.obj", "--resolution", "4", "--fix", "box:1,2"], "--fix box: six numbers were expected"),
        (&["box.obj", "--resolution", "4", "--fix", "box:7,7,7,8,8,8"], "this selects no vertex"),
        (
            &["box.obj", "--resolution", "4", "--fix", "box:-9,-9,-9,9,9,9"],
            "vertices are fixed: leave some free",
        ),
        (&["box.obj", "--resolution", "4", "--fix", "none.txt"], "none.txt: not found"),
        (
            &["box.obj", "--resolution", "4", "--material", "youngs=-1"],
            "Young's modulus is -1e0: it must be above 0",
        ),
        (
            &["box.obj", "--resolution", "4", "--material", "poisson=0.5"],
            "Poisson's ratio is 5e-1: it must be",
        ),
        (
            &["box.obj", "--resolution", "4", "--material", "stel"],
            "--material: 'stel' is neither youngs=E, poisson=NU or density=RHO nor a known material (steel, aluminium, glass, ceramic, wood, plastic, polycarbonate, rubber, \
             spring-steel, stainless-steel, titanium, brass, copper, nylon, pla, concrete); did you mean 'steel'?",
        ),
        (
            &["box.obj", "--resolution", "4", "--material", "youngs=1e6,possion=0.3"],
            "--material: there is no 'possion': youngs=E, poisson=NU or density=RHO was expected; did you mean 'poisson'?",
        ),
        (
            &["inverted.veg"],
            "inverted.veg: tetrahedron 1 (counted from 0, vertices [1, 3, 2, 4]) is inverted",
        ),
        (&["orphan.veg"], "vertex 5 (counted from 0) of the solid belongs to no element"),
        (&["heavy.veg"], "Poisson's ratio is 4.999999e-1"),
        (&["two.veg", "--resolution", "4"], "--resolution is for surfaces"),
    ] {
        let before = files(folder);
        let run = sscc(folder, &[&["modes", "-o", "x.model.safetensors"], linear, args].concat());
        let message = run.refusal();
        assert!(message.contains(named), "{args:?}: {message}");
        assert_eq!(files(folder), before, "{args:?}");
    }
    let run =
        sscc(folder, &["modes", "-o", "x.model.safetensors", "two.veg", "--kind", "linear", "--rank", "10"]);
    assert!(run.refusal().contains("two.veg: 10 modes were requested, but the body has 9"), "{run:?}");
    let run = sscc(
        folder,
        &["modes", "-o", "x.model.safetensors", "box.obj", "--kind", "polynomial", "--rank", "9"],
    );
    assert!(run.refusal().contains("at most 24 polynomial modes"), "{run:?}");
}

#[test]
fn a_surface_split_along_seams_is_closed() {
    let folder = folder();
    let folder = folder.path();
    // The box, with three separate vertices for each triangle.
    let vertices: Vec<&str> = BOX.lines().filter(|line| line.starts_with('v')).collect();
    let mut text = "solid box\n".to_owned();
    for line in BOX.lines().filter(|line| line.starts_with('f')) {
        let f: Vec<usize> = line.split(' ').skip(1).map(|x| x.parse().unwrap()).collect();
        for [a, b, c] in [[f[0], f[1], f[2]], [f[0], f[2], f[3]]] {
            let corner = |i: usize| vertices[i - 1].replacen('v', "vertex", 1);
            let corners = [a, b, c].map(corner).join("\n");
            text += &format!("facet normal 0 0 0\nouter loop\n{corners}\nendloop\nendfacet\n");
        }
    }
    fs::write(folder.join("box.stl"), text + "endsolid\n").unwrap();
    let [whole, split] = ["box.obj", "box.stl"]
        .map(|name| modes(folder, &[name, "--kind", "linear", "--rank", "6", "--resolution", "4"]));
    assert_eq!((&whole["vertices"], &split["vertices"]), (&8.into(), &36.into()));
    assert_eq!(whole["frequencies_hz"], split["frequencies_hz"]);
    let certify = |weld| {
        let run =
            sscc(folder, &["certify", "x.model.safetensors", "-o", "x.sscc.safetensors", "--json", weld]);
        run.json().remove(0)["rest_collisions"].as_u64().unwrap()
    };
    assert_eq!(certify("--weld"), 0);
    assert!(certify("--weld=off") > 0);
}
