//! Principal components of animations of known low rank.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::Random;
use glam::DVec3;
use sscc::{CancelToken, Error, TriMesh, deformed_position};
use sscc_modes::{ModesError, Pca, pca_modes};

const VERTICES: usize = 40;

/// A strip of triangles; no triangle uses its last vertex.
fn strip() -> TriMesh {
    strip_of(VERTICES)
}

fn strip_of(vertices: usize) -> TriMesh {
    let positions = (0..vertices).map(|i| DVec3::new(i as f64, (i % 2) as f64, 0.0)).collect();
    let faces = (0..vertices as u32 - 3).map(|i| [i, i + 1, i + 2]).collect();
    TriMesh::new(positions, faces).unwrap()
}

/// Two directions, orthonormal over the used vertices.
fn directions() -> [Vec<DVec3>; 2] {
    let used = (VERTICES - 1) as f64;
    [DVec3::Z, DVec3::Y].map(|axis| (0..VERTICES).map(|_| axis / used.sqrt()).collect())
}

/// Frames with coordinates along the directions: their means are (1, 0), their deviations 3 and 1, and they are
/// uncorrelated.
fn frames() -> Vec<Vec<DVec3>> {
    let along = [[3.0, 1.0], [3.0, -1.0], [-3.0, 1.0], [-3.0, -1.0]].map(|[a, b]| {
        let scale = 3.0_f64.sqrt() / 2.0; // four frames, so n - 1 is 3
        [1.0 + a * scale, b * scale]
    });
    let [z, y] = directions();
    let rest = strip().rest_positions().to_vec();
    along
        .map(|[a, b]| rest.iter().zip(z.iter().zip(&y)).map(|(p, (z, y))| *p + *z * a + *y * b).collect())
        .to_vec()
}

/// Returns the coordinates of a frame: modes are orthogonal, and their lengths are the deviations.
fn coordinates(pca: &Pca, frame: &[DVec3]) -> Vec<f64> {
    let rank = pca.modes.rank();
    let dot = |k: usize| -> f64 {
        let used = 0..VERTICES - 1;
        used.map(|v| (frame[v] - pca.mesh.rest_positions()[v]).dot(pca.modes.of_vertex(v as u32)[k])).sum()
    };
    (0..rank).map(|k| dot(k) / (pca.deviations[k] * pca.deviations[k])).collect()
}

#[test]
fn known_components_are_recovered() {
    for rank in [None, Some(2)] {
        let pca = pca_modes(&strip(), &frames(), rank, &()).unwrap();
        assert_eq!((pca.modes.rank(), pca.mesh.faces()), (2, strip().faces()));
        for (found, known) in pca.deviations.iter().zip([3.0, 1.0]) {
            assert!((found - known).abs() < 1e-12, "{:?}", pca.deviations);
        }
        assert!((pca.shares[0] - 0.9).abs() < 1e-12 && (pca.shares[1] - 0.1).abs() < 1e-12);
        let [z, y] = directions();
        for (v, p) in strip().rest_positions().iter().enumerate() {
            assert!(pca.mesh.rest_positions()[v].distance(*p + z[v]) < 1e-12);
            let modes = pca.modes.of_vertex(v as u32);
            assert!(modes[0].distance(z[v] * 3.0) < 1e-12 && modes[1].distance(y[v]) < 1e-12, "{modes:?}");
        }
    }
    let one = pca_modes(&strip(), &frames(), Some(1), &()).unwrap();
    assert_eq!((one.modes.rank(), one.deviations.len(), one.shares.len()), (1, 1, 1));
}

#[test]
fn every_frame_is_recovered_from_all_components() {
    let mut random = Random(7);
    let mut moved = || random.vector() * 1e-3 + DVec3::X * 50.0;
    let frames: Vec<Vec<DVec3>> = (0..9).map(|_| (0..VERTICES).map(|_| moved()).collect()).collect();
    let pca = pca_modes(&strip(), &frames, Some(8), &()).unwrap();
    assert!((pca.shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    assert!(pca.deviations.is_sorted_by(|a, b| a >= b));
    for frame in &frames {
        let q = coordinates(&pca, frame);
        for v in 0..VERTICES - 1 {
            let found = deformed_position(pca.mesh.rest_positions()[v], pca.modes.of_vertex(v as u32), &q);
            assert!(found.distance(frame[v]) < 1e-12);
        }
    }
    // Coordinates have mean 0 and deviation 1.
    for k in 0..8 {
        let squares: f64 = frames.iter().map(|frame| coordinates(&pca, frame)[k].powi(2)).sum();
        assert!((squares / 8.0 - 1.0).abs() < 1e-9);
    }
    assert_eq!(pca_modes(&strip(), &frames, Some(8), &()).unwrap(), pca);
    assert_eq!(
        pca_modes(&strip(), &frames, Some(9), &()).unwrap_err().to_string(),
        "9 components were requested, but the frames have 8 independent directions: request at most that many"
    );
}

#[test]
fn the_range_of_numbers_does_not_matter() {
    let expected = pca_modes(&strip(), &frames(), None, &()).unwrap();
    for exponent in [-190, 190] {
        let scale = 2.0_f64.powi(exponent);
        let scaled: Vec<Vec<DVec3>> =
            frames().iter().map(|f| f.iter().map(|p| *p * scale).collect()).collect();
        let found = pca_modes(&strip(), &scaled, None, &()).unwrap();
        assert_eq!(found.deviations[0], expected.deviations[0] * scale);
        assert_eq!(found.modes.of_vertex(3)[0], expected.modes.of_vertex(3)[0] * scale);
    }
}

#[test]
fn frames_without_components_are_rejected() {
    let message =
        |frames: &[Vec<DVec3>], rank| pca_modes(&strip(), frames, rank, &()).unwrap_err().to_string();
    let frame = frames().remove(0);
    assert!(message(&[], None).starts_with("0 frames"));
    assert!(message(std::slice::from_ref(&frame), None).starts_with("1 frames"));
    assert!(
        message(&[frame.clone(), frame.clone(), frame.clone()], Some(1))
            .starts_with("all 3 frames are equal")
    );
    // Only an unused vertex moves, or only the last bit of a coordinate.
    let mut unused = frame.clone();
    unused[VERTICES - 1] += DVec3::ONE;
    assert!(message(&[frame.clone(), unused], None).starts_with("all 2 frames are equal"));
    let mut rounded = frame.clone();
    rounded[1].x = rounded[1].x.next_up();
    assert!(message(&[frame.clone(), rounded], None).starts_with("all 2 frames are equal"));
    assert_eq!(
        message(&[frame.clone(), frame[1..].to_vec()], None),
        "frame 1 (counted from 0) has 39 vertices, the mesh 40: all frames must be of the same mesh"
    );
    let mut nan = frame.clone();
    nan[5].z = f64::NAN;
    assert!(message(&[frame.clone(), nan], None).starts_with("vertex 5 of frame 1 (counted from 0)"));
    assert!(message(&frames(), Some(0)).contains("no modes"));
    assert!(message(&frames(), Some(3)).contains("have 2 independent directions"));
}

/// Vertices that do not move change no component, but with them the Gram matrix is smaller than the covariance.
#[test]
fn the_covariance_has_the_components_of_the_gram_matrix() {
    let mut random = Random(3);
    // Vertex 4 is unused by both meshes.
    let mut moved = |v: i32| random.vector() * 3.0_f64.powi(-v) + DVec3::X * 5.0;
    let few: Vec<Vec<DVec3>> = (0..30).map(|_| (0..5).map(&mut moved).collect()).collect();
    let still: Vec<DVec3> = (0..12).map(|i| DVec3::new(f64::from(i), 0.3, 1.0)).collect();
    let many: Vec<Vec<DVec3>> = few.iter().map(|frame| [&frame[..], &still[..]].concat()).collect();
    let mut faces = vec![[0, 1, 2], [1, 2, 3]];
    let small = TriMesh::new(few[0].clone(), faces.clone()).unwrap();
    faces.extend((5..17).step_by(3).map(|v| [v, v + 1, v + 2]));
    let large = TriMesh::new(many[0].clone(), faces).unwrap();
    for rank in [Some(12), Some(1), None] {
        let found = pca_modes(&small, &few, rank, &()).unwrap();
        let expected = pca_modes(&large, &many, rank, &()).unwrap();
        assert_eq!(found.modes.rank(), expected.modes.rank());
        for (k, (a, b)) in found.deviations.iter().zip(&expected.deviations).enumerate() {
            assert!((a / b - 1.0).abs() < 1e-10, "{rank:?}, {k}: {a} {b}");
            assert!((found.shares[k] / expected.shares[k] - 1.0).abs() < 1e-10);
        }
        for v in 0..5 {
            let modes = found.modes.of_vertex(v).iter().zip(expected.modes.of_vertex(v));
            assert!(modes.clone().all(|(a, b)| a.distance(*b) < 1e-10), "{rank:?}, vertex {v}");
        }
    }
    let message = pca_modes(&small, &few, Some(13), &()).unwrap_err().to_string();
    assert!(message.contains("the frames have 12 independent directions"), "{message}");
    assert!(pca_modes(&small, &few, Some(0), &()).unwrap_err().to_string().contains("no modes"));
}

/// Their Gram matrix would take 29 GB.
#[test]
fn many_frames_of_few_vertices_have_components() {
    let count = 60_000;
    let triangle = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
    let frame = |t: i32| {
        let (sin, cos) = (TAU * f64::from(t) / f64::from(count)).sin_cos();
        vec![DVec3::Z * 3.0 * cos, DVec3::X + DVec3::Y * sin, DVec3::Y]
    };
    let pca = pca_modes(&triangle, &(0..count).map(frame).collect::<Vec<_>>(), None, &()).unwrap();
    let deviation = (f64::from(count) / (2.0 * f64::from(count - 1))).sqrt();
    let expected = [
        [DVec3::Z * 3.0 * deviation, DVec3::ZERO],
        [DVec3::ZERO, DVec3::Y * deviation],
        [DVec3::ZERO, DVec3::ZERO],
    ];
    assert_eq!(pca.modes.rank(), 2);
    for (v, expected) in (0..3).zip(expected) {
        let modes = pca.modes.of_vertex(v);
        assert!((0..2).all(|k| modes[k].distance(expected[k]) < 1e-9), "vertex {v}: {modes:?}");
    }
    assert!((pca.deviations[0] - 3.0 * deviation).abs() < 1e-9 && (pca.shares[1] - 0.1).abs() < 1e-9);
}

#[test]
fn too_many_frames_of_too_many_coordinates_are_rejected() {
    let frames = vec![Vec::new(); 4097];
    let message = |vertices: usize, count: usize| {
        pca_modes(&strip_of(vertices), &frames[..count], None, &()).unwrap_err().to_string()
    };
    assert_eq!(
        message(1367, 4097),
        "4097 frames of 4098 coordinates (three for each vertex of a face) are too many for principal components: \
         use at most 4096 frames, or a mesh of at most 1365 vertices"
    );
    // The frames are checked next.
    assert!(message(1366, 4097).starts_with("frame 0 (counted from 0) has 0 vertices"));
    assert!(message(1367, 4096).starts_with("frame 0 (counted from 0) has 0 vertices"));
}

#[test]
fn each_check_for_cancellation_ends_the_work() {
    // Frames of fewer coordinates than frames, and of more.
    let few: Vec<Vec<DVec3>> =
        (0..10).map(|t| vec![DVec3::X * f64::from(t * t), DVec3::Y, DVec3::Z]).collect();
    let triangle = TriMesh::new(few[0].clone(), vec![[0, 1, 2]]).unwrap();
    for (mesh, frames) in [(triangle, few), (strip(), frames())] {
        let checks_until = |limit: usize| {
            let checks = Arc::new(AtomicUsize::new(0));
            let seen = Arc::clone(&checks);
            let token = CancelToken::when(move || seen.fetch_add(1, Ordering::Relaxed) >= limit);
            (pca_modes(&mesh, &frames, None, &token).err(), checks.load(Ordering::Relaxed))
        };
        let (error, checks) = checks_until(usize::MAX);
        // In the products, before and after the decomposition, and in the modes.
        assert!(error.is_none() && checks >= 4, "{checks}");
        for limit in 0..checks {
            assert_eq!(checks_until(limit), (Some(ModesError::Core(Error::Cancelled)), limit + 1));
        }
    }
}
