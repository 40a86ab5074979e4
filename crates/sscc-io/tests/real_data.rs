//! Meshes and modes as they are found in the world, against what is known of them.
#![allow(clippy::unwrap_used)]

use glam::DVec3;
use sscc_io::{load_model, read_mesh, read_modes};
use sscc_testdata::models;

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

/// Closed meshes enclose a positive volume when every fan keeps the winding of its polygon, and each directed
/// edge then occurs once.
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
    // Ten vertices are fixed: their rows are zero but for rounding; the next smallest moves by 0.04.
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

    // Modes vary smoothly along edges: any other reading of the layout would not.
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
