//! Real meshes and modes: their sizes and properties match known values.
use glam::DVec3;
use sscc_io::gltf::{self, PrimitiveRange};
use sscc_io::{LoadOptions, load_model, load_model_with, read_mesh, read_modes};
use sscc_testing::models;

#[test]
fn meshes_have_their_known_sizes() {
    let Some(folder) = models("meshes_have_their_known_sizes") else { return };
    for (file, vertices, triangles) in [
        ("bunny_69451_open.obj", 35_947, 69_451),
        ("bunny_69664_closed.ply", 34_834, 69_664),
        ("bunny_14964_closed.obj", 7_484, 14_964),
        ("bunny_6966_closed.off", 3_485, 6_966),
        ("dragon_77202_closed.ply", 38_525, 77_202),
        ("selfintersecting/doubleLoopWithCube.obj", 2_008, 4_012),
        ("vega_A/A.obj", 575, 834),
        ("ict_face/ict_face_neutral.obj", 14_062, 28_068),
        ("ccd_frames/cloth-funnel/227.ply", 9_450, 18_484),
        ("ccd_frames/cloth-funnel/228.ply", 9_450, 18_484),
    ] {
        let mesh = read_mesh(&folder.join(file)).unwrap();
        assert_eq!((mesh.rest_positions().len(), mesh.faces().len()), (vertices, triangles), "{file}");
    }
}

#[test]
fn unused_vertices_are_kept() {
    let Some(folder) = models("unused_vertices_are_kept") else { return };
    for (file, used) in [("bunny_69451_open.obj", 34_834), ("vega_A/A.obj", 417)] {
        assert_eq!(read_mesh(&folder.join(file)).unwrap().used_vertices().len(), used, "{file}");
    }
}

/// Every fan keeps the winding of its polygon: closed meshes enclose a positive volume, and each directed edge occurs
/// once.
#[test]
fn fans_keep_the_winding() {
    let Some(folder) = models("fans_keep_the_winding") else { return };
    for file in
        ["selfintersecting/doubleLoopWithCube.obj", "bunny_14964_closed.obj", "dragon_77202_closed.ply"]
    {
        let mesh = read_mesh(&folder.join(file)).unwrap();
        let p = mesh.rest_positions();
        let volume: f64 = mesh
            .faces()
            .iter()
            .map(|f| f.map(|v| p[v as usize]))
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum();
        assert!(volume > 0.0, "{file}: {volume}");
        let mut edges: Vec<_> =
            mesh.faces().iter().flat_map(|f| [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])]).collect();
        edges.sort_unstable();
        assert!(edges.windows(2).all(|pair| pair[0] != pair[1]), "{file}");
    }
    // Its first two lines: f 1/1/1 2/2/2 4/4/4 3/3/3, f 3/3/5 4/4/6 6/6/7 5/5/8.
    let mesh = read_mesh(&folder.join("selfintersecting/doubleLoopWithCube.obj")).unwrap();
    assert_eq!(mesh.faces()[..4], [[0, 1, 3], [0, 3, 2], [2, 3, 5], [2, 5, 4]]);
}

#[test]
fn positions_are_those_of_the_files() {
    let Some(folder) = models("positions_are_those_of_the_files") else { return };
    let first = |file: &str| read_mesh(&folder.join(file)).unwrap().rest_positions()[0];
    assert_eq!(first("vega_A/A.obj"), DVec3::new(5.03195, 0.872461, 0.0));
    assert_eq!(first("bunny_6966_closed.off"), DVec3::new(-0.0260146, 0.112578, 0.0363871));
    // The same surface in two formats has the same box, up to the digits written and the holes filled.
    let bounds = |file: &str| {
        let mesh = read_mesh(&folder.join(file)).unwrap();
        let used: Vec<_> = mesh.used_vertices().iter().map(|v| mesh.rest_positions()[*v as usize]).collect();
        (used.iter().copied().reduce(DVec3::min).unwrap(), used.iter().copied().reduce(DVec3::max).unwrap())
    };
    let (open, closed) = (bounds("bunny_69451_open.obj"), bounds("bunny_69664_closed.ply"));
    assert!(open.0.distance(closed.0) < 1e-3 && open.1.distance(closed.1) < 1e-3, "{open:?} {closed:?}");
}

#[test]
fn modal_matrices_fit_their_meshes() {
    let Some(folder) = models("modal_matrices_fit_their_meshes") else { return };
    let (vega_mesh, vega_modes) = (folder.join("vega_A/A.obj"), folder.join("vega_A/A.URendering.float"));
    let (model, _) = load_model(&vega_mesh, Some(&vega_modes)).unwrap();
    assert_eq!(model.rank(), 20);
    // Ten vertices are fixed, with rows of 0 up to rounding; every other vertex moves by at least 0.04.
    let is_fixed = |v: &u32| model.modes().of_vertex(*v).iter().all(|u| u.length() < 1e-12);
    let fixed = (0..575).filter(is_fixed).count();
    assert_eq!(fixed, 10);
    let face = folder.join("ict_face");
    let (model, _) =
        load_model(&face.join("ict_face_neutral.obj"), Some(&face.join("ict_face_expressions30.U.float")))
            .unwrap();
    assert_eq!(model.rank(), 30);
    let message = read_modes(&vega_modes, 14_062).unwrap_err().to_string();
    assert!(
        message.ends_with("the modes are for 575 vertices, the mesh has 14062: are they of another mesh?")
    );

    // Modes vary smoothly along edges; a wrong layout would not.
    for k in 0..model.rank() {
        let of = |v: u32| model.modes().of_vertex(v)[k];
        let (mut along, mut whole) = (0.0, 0.0);
        for f in model.mesh().faces() {
            along += of(f[0]).distance(of(f[1]));
            whole += of(f[0]).length() + of(f[1]).length();
        }
        assert!(along < 0.25 * whole, "mode {k}: {along} of {whole}");
    }
}

#[test]
fn morph_targets_have_their_known_sizes() {
    let Some(folder) = models("morph_targets_have_their_known_sizes") else { return };
    // Vertices, distinct positions and triangles of each primitive.
    for (file, rank, primitives) in [
        ("AnimatedMorphSphere.gltf", 2, &[(1876, 482, 960)][..]),
        ("MorphStressTest.gltf", 8, &[(24, 8, 12), (1504, 1216, 2400)]),
        ("RobotExpressive.glb", 3, &[(302, 96, 154), (876, 345, 460), (564, 106, 196)]),
    ] {
        let path = folder.join("morph").join(file);
        let model = gltf::read(&path, None).unwrap();
        assert_eq!(
            (model.modes.rank(), model.target_names.len(), model.default_weights.len()),
            (rank, rank, rank)
        );
        let positions = model.mesh.rest_positions();
        let size = |range: &std::ops::Range<u32>| range.len();
        let distinct = |p: &PrimitiveRange| {
            let of = &positions[p.vertices.start as usize..p.vertices.end as usize];
            // +0 and -0 are one position.
            let bits = |p: &DVec3| (*p + DVec3::ZERO).to_array().map(f64::to_bits);
            of.iter().map(bits).collect::<std::collections::BTreeSet<_>>().len()
        };
        let found: Vec<_> =
            model.primitives.iter().map(|p| (size(&p.vertices), distinct(p), size(&p.triangles))).collect();
        assert_eq!(found, primitives, "{file}");
        let sum = |of: fn(&(usize, usize, usize)) -> usize| primitives.iter().map(of).sum::<usize>();
        assert_eq!((positions.len(), model.mesh.faces().len()), (sum(|p| p.0), sum(|p| p.2)), "{file}");
        // No triangle leaves its primitive.
        for p in &model.primitives {
            let faces = &model.mesh.faces()[p.triangles.start as usize..p.triangles.end as usize];
            assert!(faces.as_flattened().iter().all(|v| p.vertices.contains(v)));
        }
        // Vertices split along seams have the same modes.
        let mut seen = std::collections::BTreeMap::new();
        for (p, v) in
            model.primitives.iter().enumerate().flat_map(|(i, p)| p.vertices.clone().map(move |v| (i, v)))
        {
            let bits = (positions[v as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
            let modes = model.modes.of_vertex(v);
            assert_eq!(*seen.entry((p, bits)).or_insert(modes), modes, "{file}: vertex {v}");
        }
    }
    let robot = folder.join("morph/RobotExpressive.glb");
    let meshes = gltf::read_contents(&robot).unwrap().meshes;
    assert_eq!((meshes.len(), meshes[2].name.as_str(), meshes[2].targets.len()), (14, "Head", 3));
    let loaded = load_model_with(&robot, &LoadOptions::new(None, Some("Head"))).unwrap();
    assert_eq!(loaded.mode_names, ["Angry", "Surprised", "Sad"]);
    assert_eq!(loaded.default_q, Some(vec![0.0; 3]));
    let message =
        |name| load_model_with(&robot, &LoadOptions::new(None, Some(name))).unwrap_err().to_string();
    assert!(
        message("Torso")
            .ends_with("the mesh 'Torso' has no morph targets; meshes with morph targets: 'Head'")
    );
}

/// Single vertices, extracted with another tool: position, and displacement of the last target.
#[test]
fn morph_targets_are_those_of_the_files() {
    let Some(folder) = models("morph_targets_are_those_of_the_files") else { return };
    for (file, primitive, vertex, position, moved) in [
        (
            "AnimatedMorphSphere.gltf",
            0,
            1234,
            [0.007681776769459248, -0.00513280276209116, -0.003826834261417389],
            [0.007138815708458424, 0.0, 0.0],
        ),
        (
            "MorphStressTest.gltf",
            1,
            777,
            [0.142187237739563, 0.017187274992465973, 0.2186185121536255],
            [0.0, 0.0, 0.0],
        ),
        (
            "RobotExpressive.glb",
            2,
            321,
            [0.007592475973069668, -0.010716657154262066, -0.003983969800174236],
            [8.903681737137958e-05, -0.00010337352432543412, 0.0018026435282081366],
        ),
    ] {
        let model = gltf::read(&folder.join("morph").join(file), None).unwrap();
        let vertex = model.primitives[primitive].vertices.start + vertex;
        assert_eq!(model.mesh.rest_positions()[vertex as usize].to_array(), position, "{file}");
        assert_eq!(model.modes.of_vertex(vertex).last().unwrap().to_array(), moved, "{file}");
    }
}
