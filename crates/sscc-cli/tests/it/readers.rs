//! Files that programs write in unusual ways: each is read, or refused with its cause.

use std::fs;
use std::path::Path;

use sscc_io::write_npy;
use tempfile::TempDir;

use crate::common::{Run, sscc};

/// Two triangles that cross, as vertices and as faces of OBJ.
const CROSSING: &str = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 -1\nv 1 1 1\nv 2 1 1\n";

fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = directory.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    directory
}

fn check(name: &str, bytes: &[u8]) -> Run {
    sscc(folder(&[(name, bytes)]).path(), &["check", name, "--json"])
}

/// Asserts that the two triangles of a file cross.
fn assert_crossing(run: &Run) {
    assert_eq!(run.code, Some(1), "{run:?}");
    assert_eq!(run.json()[0]["pairs"], serde_json::json!([[0, 1]]), "{run:?}");
}

#[test]
fn notches_of_polygons_are_free() {
    // A needle in the notch of an arrow, which a fan around the first corner covers.
    let text = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nv 3 2.8 -1\nv 3.02 2.8 1\nv 2.98 2.8 1\nf 1 2 3 4 5\nf 6 7 8\n";
    let run = check("a.obj", text.as_bytes());
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    // Below the notch it goes through the surface: triangle 3 is the needle.
    let run = check("a.obj", text.replace("2.8", "0.25").as_bytes());
    assert_eq!(run.json()[0]["pairs"].as_array().unwrap().len(), 1, "{run:?}");
    assert_eq!(run.json()[0]["pairs"][0][1], 3);
    let off = "OFF\n8 2 0\n0 0 0\n4 0 0\n4 4 0\n2 1 0\n0 4 0\n3 2.8 -1\n3.02 2.8 1\n2.98 2.8 1\n5 0 1 2 3 4\n3 5 6 7\n";
    assert_eq!(check("a.off", off.as_bytes()).code, Some(0));
}

#[test]
fn polygons_without_a_clear_surface_are_named() {
    let text = "v 0 0 0\nv 4 4 0\nv 4 0 0\nv 0 4 0\nv 0 0 9\nv 1 0 9\nv 1 1 10\nv 0 1 9\nf 1 2 3\nf 1 2 3 4\nf 5 6 7 8\n";
    let directory = folder(&[("a.obj", text.as_bytes())]);
    for command in ["check", "info"] {
        let run = sscc(directory.path(), &[command, "a.obj"]);
        assert_eq!(run.code, Some(0), "{run:?}");
        let [bent, crossing] = run.stderr.lines().collect::<Vec<_>>()[..] else { panic!("{run:?}") };
        assert!(
            bent.starts_with("warning: a.obj: 1 of the 2 faces with more than 3 corners are not plane"),
            "{bent}"
        );
        assert!(bent.ends_with("(faces, counted from 0: 2)"), "{bent}");
        assert!(
            crossing.contains("touch or cross themselves") && crossing.ends_with("from 0: 1)"),
            "{crossing}"
        );
    }
    let run =
        sscc(directory.path(), &["modes", "a.obj", "-o", "a.model.safetensors", "--kind", "polynomial"]);
    assert!(run.stderr.contains("warning: a.obj: 1 of the 2 faces"), "{run:?}");
}

#[test]
fn all_faces_of_a_file_are_read_or_refused() {
    assert_crossing(&check("a.obj", format!("{CROSSING}f 1 2 3\nfo 4 5 6\n").as_bytes()));
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
         property list uchar int vertex_indices\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
         {}3 0 1 2\n4 3 4 5 -1\n",
        CROSSING.replace("v ", "")
    );
    assert_crossing(&check("a.ply", ply.as_bytes()));
    let refused = check("a.ply", ply.replace("tristrips", "patch").as_bytes());
    assert!(refused.refusal().contains("a.ply: line 9: the element 'patch' has lists of vertex numbers"));
    let refused = check("a.obj", format!("{CROSSING}f 1 2 3\nbzp 4 5 6\n").as_bytes());
    assert!(refused.refusal().contains("a.obj: line 8: 'bzp': free-form surfaces are not supported"));
}

#[test]
fn lines_may_end_with_cr() {
    assert_crossing(&check("a.obj", format!("{CROSSING}f 1 2 3\nf 4 5 6\n").replace('\n', "\r").as_bytes()));
    let off = format!("OFF6 2 0\n{}3 0 1 2\n3 3 4 5\n", CROSSING.replace("v ", ""));
    assert_crossing(&check("a.off", off.as_bytes()));
    assert_crossing(&check("a.off", off.replace('\n', "\r").as_bytes()));
}

/// A binary STL file of the two triangles, with this count.
fn stl(count: u32) -> Vec<u8> {
    let corners: Vec<f32> = CROSSING.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let mut bytes = [b'x'; 80].to_vec();
    bytes.extend(count.to_le_bytes());
    for triangle in corners.chunks(9) {
        bytes.extend([0; 12]);
        triangle.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn binary_stl_files_of_unusual_sizes() {
    assert_crossing(&check("a.stl", &stl(2)));
    let trailing = check("a.stl", &[&stl(2)[..], b"trailing comments"].concat());
    assert_crossing(&trailing);
    assert!(
        trailing.stderr.contains("warning: a.stl: 17 bytes after the last of the 2 triangles"),
        "{trailing:?}"
    );
    let unset = check("a.stl", &stl(0));
    assert_crossing(&unset);
    assert!(unset.stderr.contains("declares 0 triangles, but data of 2 follow"), "{unset:?}");
    let refused = check("a.stl", &stl(1));
    assert!(refused.refusal().contains("a.stl: byte 134: 50 bytes follow the 1 triangles"), "{refused:?}");
}

#[test]
fn soups_have_a_hint_at_welding() {
    // A closed tetrahedron whose corners are not shared.
    let corners = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let mut text: String =
        faces.as_flattened().iter().map(|c: &usize| format!("v {}\n", corners[*c])).collect();
    (0..4).for_each(|t| text += &format!("f {} {} {}\n", 3 * t + 1, 3 * t + 2, 3 * t + 3));
    let directory = folder(&[
        ("soup.obj", text.as_bytes()),
        ("copy.obj", text.as_bytes()),
        ("doubled.obj", format!("{CROSSING}v 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3\nf 7 8 9").as_bytes()),
        ("shared.obj", format!("{CROSSING}f 1 2 3\nf 4 5 6").as_bytes()),
    ]);
    let run = |args: &[&str]| sscc(directory.path(), &[&["check"], args].concat());
    let hint = "note: soup.obj: in 6 colliding pairs, triangles have corners at equal positions but do not share them: with \
        --weld they are neighbours, which do not count\n";
    for args in [&["soup.obj"][..], &["soup.obj", "--json"], &["soup.obj", "soup.obj"]] {
        let found = run(args);
        let expected = hint.replace(
            "6 colliding",
            if args.len() > 1 && args[1] == "soup.obj" { "12 colliding" } else { "6 colliding" },
        );
        assert_eq!((found.code, found.stderr), (Some(1), expected));
    }
    // There is no hint if the user has chosen, or if welding would not help. A folder changes no flag.
    std::fs::create_dir(directory.path().join("off")).unwrap();
    for (args, code) in [
        (&["soup.obj", "--weld"][..], 0),
        (&["soup.obj", "--weld=off"], 1),
        (&["soup.obj", "--weld", "off"], 1),
        (&["--weld", "on", "soup.obj"], 0),
        (&["soup.obj", "--against", "copy.obj"], 1),
        (&["shared.obj"], 1),
        (&["doubled.obj"], 1),
    ] {
        let found = run(args);
        assert_eq!((found.code, found.stderr.as_str()), (Some(code), ""), "{found:?}");
    }
    // The hint is also given for a model.
    write_npy(&directory.path().join("u.npy"), &[12, 3], &[0.5; 36]).unwrap();
    let found = run(&["soup.obj", "--modes", "u.npy", "--q", "0", "--method", "brute-force"]);
    assert!(found.code == Some(1) && found.stderr.contains(hint), "{found:?}");
    // There is no hint for a model if the user has chosen, or the format has welded its vertices.
    let decided =
        run(&["soup.obj", "--modes", "u.npy", "--q", "0", "--method", "brute-force", "--weld", "off"]);
    assert!(decided.code == Some(1) && !decided.stderr.contains("note: "), "{decided:?}");
    let facet = |[a, b, c]: [&str; 3]| {
        format!("facet normal 0 0 1\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n")
    };
    let facets = [["0 0 0", "4 0 0", "0 4 0"], ["0 0 0", "2 2 1", "2 2 -1"]].map(facet).concat();
    fs::write(directory.path().join("s.stl"), format!("solid s\n{facets}endsolid s\n")).unwrap();
    write_npy(&directory.path().join("v.npy"), &[5, 3], &[0.5; 15]).unwrap();
    write_npy(&directory.path().join("w.npy"), &[6, 3], &[0.5; 18]).unwrap();
    let welded = ["--q", "0", "--method", "brute-force", "--neighbours", "include-one-vertex"];
    let found = ["v.npy", "w.npy"].map(|modes| run(&[&["s.stl", "--modes", modes], &welded[..]].concat()));
    let found = found.iter().find(|found| found.code == Some(1)).unwrap();
    assert!(!found.stderr.contains("note: "), "{found:?}");
}

#[test]
fn surfaces_of_solids_are_meshes() {
    let medit =
        "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 0\n";
    let triangles = format!("{medit}Triangles\n1\n1 2 3 0\nEnd\n");
    let tets = format!("{medit}Tetrahedra\n2\n1 2 3 4 0\n2 3 4 5 0\nEnd\n");
    let gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ParametricNodes\n4\n1 0 0 0 0 1\n2 1 0 0 3 1 .1 .1 .1\n\
        3 0 1 0 2 1 .5 .5\n4 0 0 1 1 1 0.5\n$EndParametricNodes\n$Elements\n1\n1 4 2 0 0 1 2 3 4\n$EndElements\n";
    let directory = folder(&[
        ("surface.mesh", triangles.as_bytes()),
        ("tets.mesh", tets.as_bytes()),
        ("a.msh", gmsh.as_bytes()),
    ]);
    let run = |args: &[&str]| sscc(directory.path(), args);
    for name in ["surface.mesh", "tets.mesh", "a.msh"] {
        let found = run(&["check", name]);
        assert!(found.code == Some(0) && found.stdout.starts_with("free: proven"), "{found:?}");
    }
    assert_eq!(run(&["info", "surface.mesh", "--json"]).json()[0]["kind"], "mesh");
    assert_eq!(run(&["info", "tets.mesh", "--json"]).json()[0]["kind"], "solid");
    assert_eq!(run(&["info", "a.msh", "--json"]).json()[0]["tetrahedra"], 1);
    // Two solids against each other.
    let found = run(&["check", "tets.mesh", "--against", "a.msh"]);
    assert_eq!(found.code, Some(1), "{found:?}");
}

/// No region and no face of a file is left out without a warning.
#[test]
fn all_regions_and_faces_of_solids_are_checked() {
    let head = "MeshVersionFormatted 1\nDimension 3\nVertices";
    let first = "0 0 0 0\n4 0 0 0\n0 4 0 0\n0 0 4 0\n";
    let faces = "Triangles 4\n1 2 3 1\n1 2 4 1\n1 3 4 1\n2 3 4 1\nEnd\n";
    // The second tetrahedron pierces the first one, whose faces alone are listed.
    let regions = format!(
        "{head} 8\n{first}1 1 1 0\n5 1 1 0\n1 5 1 0\n1 1 5 0\nTetrahedra 2\n1 2 3 4 1\n5 6 7 8 2\n{faces}"
    );
    // The triangle pierces the tetrahedron.
    let free = format!(
        "{head} 7\n{first}1 1 -1 0\n1 1 1 0\n2 1 1 0\nTetrahedra 1\n1 2 3 4 0\nTriangles 1\n5 6 7 0\nEnd\n"
    );
    // The second tetrahedron is outside the listed faces, and has one of them.
    let filling = format!("{head} 5\n{first}1 1 -4 0\nTetrahedra 2\n1 2 3 4 0\n1 3 2 5 0\n{faces}");
    // The triangle is between the two tetrahedra.
    let sheet =
        format!("{head} 5\n{first}1 1 -4 0\nTetrahedra 2\n1 2 3 4 0\n1 3 2 5 0\nTriangles 1\n1 4 5 0\nEnd\n");
    let directory = folder(&[
        ("regions.mesh", regions.as_bytes()),
        ("free.mesh", free.as_bytes()),
        ("filling.mesh", filling.as_bytes()),
        ("sheet.mesh", sheet.as_bytes()),
    ]);
    let added = "1 triangles of the file belong to no element: they are added after those of the elements";
    let left_out = "1 tetrahedra outside the surface of the file are left out";
    for (name, code, warning) in
        [("regions.mesh", 1, None), ("free.mesh", 1, Some(added)), ("filling.mesh", 0, Some(left_out))]
    {
        let found = sscc(directory.path(), &["check", name, "--json"]);
        let expected = warning.map_or_else(String::new, |warning| format!("warning: {name}: {warning}\n"));
        assert_eq!((found.code, found.stderr.as_str()), (Some(code), expected.as_str()), "{found:?}");
        let pairs: Vec<[usize; 2]> = serde_json::from_value(found.json()[0]["pairs"].clone()).unwrap();
        assert_eq!(pairs.is_empty(), code == 0, "{found:?}");
        // Triangles of the first tetrahedron with those after them.
        assert!(pairs.iter().all(|[a, b]| *a < 4 && *b >= 4), "{found:?}");
    }
    // A model of the solid has no others, which is a note.
    let line =
        "1 triangles of the file belong to no element of the solid: they have no elasticity and are left out";
    for args in [
        &["info", "sheet.mesh"][..],
        &["info", "free.mesh"],
        &["modes", "sheet.mesh", "--kind", "linear", "--rank", "4", "-o", "a.model.safetensors"],
    ] {
        let found = sscc(directory.path(), args);
        assert!(found.code == Some(0) && found.stderr.contains(&format!("note: {line}\n")), "{found:?}");
    }
}

#[test]
fn materials_whose_stiffness_is_not_computed_are_refused() {
    let veg = |materials: &str| {
        format!(
            "*VERTICES\n5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n*ELEMENTS\nTET\n2 4 0\n1 1 2 3 4\n2 2 3 4 5\n\
             {materials}"
        )
    };
    let wood = "*MATERIAL wood\nORTHOTROPIC, 700, 1e9, 2e9, 3e9, 0.3, 0.3, 0.3, 1e9, 1e9, 1e9\n";
    let soft = "*MATERIAL soft\nENU, 1000, 1e6, 0.4\n";
    let one = format!("{soft}{wood}*SET half\n1\n*REGION\nallElements, soft\n*REGION\nhalf, wood\n");
    let unused = format!("{wood}{soft}*REGION\nallElements, soft\n");
    let directory = folder(&[
        ("all.veg", veg(wood).as_bytes()),
        ("one.veg", veg(&one).as_bytes()),
        ("unused.veg", veg(&unused).as_bytes()),
        ("other.veg", veg(&wood.replace("ORTHOTROPIC", "OGDEN")).as_bytes()),
    ]);
    let modes = |name: &str, more: &[&str]| {
        let args = ["modes", name, "-o", "a.model.safetensors", "--kind", "linear", "--rank", "2"];
        sscc(directory.path(), &[&args[..], more].concat())
    };
    for (name, kind) in [("all.veg", "ORTHOTROPIC"), ("one.veg", "ORTHOTROPIC"), ("other.veg", "OGDEN")] {
        let refused = modes(name, &[]);
        let message = refused.refusal();
        assert!(message.contains(&format!("{name}: the material wood is of the kind {kind}")), "{message}");
        assert!(message.contains("--material youngs=1e6,poisson=0.4"), "{message}");
        assert_eq!(modes(name, &["--material", "youngs=1e9"]).code, Some(2));
        let made = modes(name, &["--material", "youngs=1e9,poisson=0.3"]);
        assert_eq!(made.code, Some(0), "{made:?}");
    }
    assert_eq!(modes("unused.veg", &[]).code, Some(0));
    let info = sscc(directory.path(), &["info", "all.veg"]);
    assert!(
        info.stdout.contains("wood: density=700; the stiffness of the kind ORTHOTROPIC is not computed"),
        "{info:?}"
    );
    // A check needs no stiffness.
    assert_eq!(sscc(directory.path(), &["check", "all.veg"]).code, Some(0));
}

#[test]
fn messages_state_causes_and_remedies() {
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1\n";
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
         property list uchar int vertex_indices\nproperty uchar red\nend_header\n{}3 0 1 2 3 255 0 0\n3 3 4 5 3 255 0 0\n",
        CROSSING.replace("v ", "")
    );
    let cases: [(&str, &[u8], &str); 5] = [
        (
            "a.glb",
            pointer,
            "a.glb: a Git LFS pointer, not the file itself: run 'git lfs pull' in its repository",
        ),
        ("a.ply", ply.as_bytes(), "a.ply: line 17: this row has more values than the header declares"),
        (
            "a.veg",
            b"# a body\n*INCLUDE parts.veg\n",
            "a.veg: line 2: the file includes 'parts.veg', which does not exist",
        ),
        (
            "a.fbx",
            b"x",
            "a.fbx: unknown kind of mesh file; supported: .obj, .off, .ply, .stl; solids: .mesh, .veg, .msh, .node, .ele, .vtu, .vtk, .pvd; glTF: .glb, .gltf",
        ),
        (
            "a.msh",
            b"$MeshFormat\n2.2 1 8\n\x01\0\0\0\n$EndMeshFormat\n$ParametricNodes\n1\n",
            "binary parametric nodes are not supported",
        ),
    ];
    for (name, bytes, cause) in cases {
        let run = check(name, bytes);
        assert!(run.refusal().contains(cause), "{run:?}");
    }
    let directory = folder(&[("a.fbx", b"x")]);
    let run = sscc(directory.path(), &["modes", "a.fbx", "-o", "a.model.safetensors", "--kind", "linear"]);
    assert!(
        run.refusal().contains(
            "unknown kind of surface or solid file; supported: .obj, .off, .ply, .stl; solids: .mesh"
        )
    );
}

#[test]
fn arrays_of_any_numbers_are_read() {
    let directory = folder(&[("a.obj", format!("{CROSSING}f 1 2 3\nf 4 5 6\n").as_bytes())]);
    let path = |name: &str| directory.path().join(name);
    // One mode, which lowers the second triangle.
    let lowered: Vec<f64> = (0..18).map(|at| if at >= 9 && at % 3 == 2 { -2.0 } else { 0.0 }).collect();
    write_npy(&path("one.npy"), &[6, 3], &lowered).unwrap();
    let q = [0.0, 1.0];
    write_npy(&path("q.npy"), &[2, 1], &q).unwrap();
    write_typed(&path("half.npy"), "<f2", "(2, 1)", &[0x0000_u16, 0x3c00].map(u16::to_le_bytes).concat());
    write_typed(&path("integers.npy"), "<i4", "(2, 1)", &[0, 1_i32].map(i32::to_le_bytes).concat());
    for rows in ["q.npy", "half.npy", "integers.npy"] {
        let args = [
            "check",
            "a.obj",
            "--modes",
            "one.npy",
            "--trajectory",
            rows,
            "--method",
            "brute-force",
            "--json",
        ];
        let run = sscc(directory.path(), &args);
        let counts: Vec<u64> = run.json().iter().map(|answer| answer["count"].as_u64().unwrap()).collect();
        assert_eq!((run.code, counts), (Some(1), vec![1, 0]), "{rows}");
    }
}

fn write_typed(path: &Path, descr: &str, shape: &str, body: &[u8]) {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    fs::write(path, [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), body].concat()).unwrap();
}
