//! Tests that threads whose floating-point mode is not that of the proofs are refused. They are here because a change of the mode
//! needs `unsafe`.

use std::arch::asm;
use std::thread;

use glam::DVec3;
use sscc::parts::{Aabb, Pose, PosedShape, Scope, SweptShape};
use sscc::{
    Certificates, CertifyOptions, Detector, Error, KineticQuery, Method, Modes, Query, ReducedModel, TriMesh,
};

/// Bits of the control register of SSE: flush results to zero, read subnormal operands as zero, round down, up, to zero.
const MODES: [(u32, &str); 5] = [
    (1 << 15, "flushes small numbers"),
    (1 << 6, "flushes small numbers"),
    (1 << 13, "does not round to nearest"),
    (2 << 13, "does not round to nearest"),
    (3 << 13, "does not round to nearest"),
];

fn mode() -> u32 {
    let mut mode = 0_u32;
    // SAFETY: stores the register to a variable.
    unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut mode, options(nostack)) };
    mode
}

fn set_mode(mode: u32) {
    // SAFETY: loads the register from a variable; callers set documented bits, and end their thread or restore the mode.
    unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const mode, options(nostack)) };
}

/// Calls a function in a mode.
fn in_mode<T>(bits: u32, call: impl FnOnce() -> T) -> T {
    let old = mode();
    set_mode(old | bits);
    let result = call();
    set_mode(old);
    result
}

fn mesh() -> Result<TriMesh, Error> {
    let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])
}

/// Returns two triangles one unit apart, and a mode that lowers the second.
fn model() -> ReducedModel {
    let lowers = |row, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 };
    ReducedModel::new(mesh().unwrap(), Modes::from_matrix(6, 1, lowers).unwrap()).unwrap()
}

/// Checks that a call is refused in every wrong mode, and succeeds before and after.
fn refused<T>(name: &str, mut call: impl FnMut() -> Result<T, Error>) {
    for (bits, what) in MODES {
        assert!(call().is_ok(), "{name}");
        let error = in_mode(bits, &mut call).err().map(|error| error.to_string());
        assert!(error.as_ref().is_some_and(|error| error.contains(what)), "{name}: {bits:x}: {error:?}");
    }
    assert!(call().is_ok(), "{name}");
}

#[test]
fn objects_are_not_created_in_another_mode() {
    let model = model();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    refused("mesh", mesh);
    for threads in [None, Some(1), Some(2)] {
        let options = CertifyOptions::default().threads(threads);
        refused("certificates", || Certificates::compute(&model, &options, &()));
    }
    refused("query", || Query::new(&model, &certificates));
    refused("kinetic query", || KineticQuery::new(&model, &certificates));
    refused("query without certificates", || {
        Query::without_certificates(&model, Scope::of(&model), Method::BdTree)
    });
    refused("shape", || PosedShape::new(&model, &certificates));
}

#[test]
fn searches_in_another_mode_are_refused() {
    let model = model();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap();
    for method in [Method::BdTree, Method::Traditional, Method::NormalCones, Method::BruteForce] {
        let mut query = Query::with_method(&model, &certificates, method).unwrap();
        refused("discrete", || query.discrete(&[1.0]).map(<[_]>::len));
    }
    refused("discrete", || query.discrete(&[1.0]).map(<[_]>::len));
    refused("continuous", || query.continuous(&[0.0], &[1.0]).map(<[_]>::len));
    refused("batch", || query.batch(&[[1.0]], Some(1), &()));
    refused("safe scale", || query.safe_scale(&[1.0]));
    refused("sweep", || query.sweep(&[0.0], 0, 2.0));
    refused("clamp", || certificates.clamp(&[1.0]));
    refused("resolve", || query.resolve(&[1.0], &sscc::ResolveOptions::default()));
    let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
    refused("kinetic", || kinetic.discrete(&[1.0]).map(<[_]>::len));
    // Beyond the root's radius, and within the region of the last query, which needs no search.
    let at = |step: i32| [1.5 + 1e-6 * f64::from(step)];
    (0..=12).for_each(|step| assert!(kinetic.discrete(&at(step)).unwrap().is_empty()));
    refused("kinetic continuous", || kinetic.continuous(&at(12), &at(13)).map(<[_]>::len));
    let mesh = mesh().unwrap();
    let mut detector = Detector::new(&mesh);
    refused("detector", || detector.discrete(mesh.rest_positions()).map(<[_]>::len));
    let mut shape = PosedShape::new(&model, &certificates).unwrap();
    let mut height = 0.0;
    refused("place", || {
        height += 1.0;
        shape.place(&[0.0], &Pose { translation: DVec3::Z * height, ..Pose::default() })
    });
    // These shapes were placed in the right mode.
    let mut other = shape.clone();
    let mut pairs = Vec::new();
    refused("against", || shape.colliding(&mut other, Aabb::EMPTY, &mut pairs));
    let [mut x, mut y] = [(); 2].map(|()| {
        let mut swept = SweptShape::new(&shape).unwrap();
        swept.place([&[0.0], &[1.0]], [&Pose::default(); 2]).unwrap();
        swept
    });
    let mut impacts = Vec::new();
    refused("impacts", || x.impacts(&mut y, Aabb::EMPTY, &mut impacts));
    refused("near", || x.near(&mut y, Aabb::EMPTY, 0.5, 9, &mut pairs));
    let mut vertices = Vec::new();
    refused("vertices below a plane", || shape.vertices_below(DVec3::Z, 0.5, &mut vertices));
    refused("bound of displacements", || shape.displacement_bound(&[0.5]));
}

/// Each thread has its own mode, so that other threads are not refused.
#[test]
fn other_threads_have_their_own_mode() {
    let old = mode();
    set_mode(old | 1 << 15);
    let in_new_thread = thread::spawn(move || {
        set_mode(old);
        mesh().is_ok()
    });
    assert!(mesh().is_err());
    assert!(in_new_thread.join().unwrap());
    set_mode(old);
    assert!(mesh().is_ok());
}
