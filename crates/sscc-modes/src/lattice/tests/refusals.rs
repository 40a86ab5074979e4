//! Errors for invalid surfaces and resolutions.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use sscc::{CancelToken, Progress, TriMesh};

use super::super::Lattice;
use super::super::cells::Cells;
use super::super::crossings::intervals;
use super::super::grid::{Grid, incidences};
use super::super::surface::Surface;
use super::bodies::{cuboid, folded_plate, inverted, joined, mesh, moved, needle, sphere};
use crate::ModesError;

fn refusal(mesh: &TriMesh, cells: Option<usize>) -> ModesError {
    let error = Lattice::around(mesh, cells, &()).err().expect("refused");
    assert!(!error.to_string().contains('\n'));
    error
}

#[test]
fn open_and_mixed_surfaces_are_refused() {
    let ball = sphere(2);
    let open = mesh(ball.rest_positions().to_vec(), ball.faces()[1..].to_vec());
    let ModesError::OpenEdge { from, to, forward, backward } = refusal(&open, None) else { panic!() };
    assert!(ball.faces()[0].contains(&from) && ball.faces()[0].contains(&to));
    assert_eq!(forward + backward, 1);

    let mut faces = ball.faces().to_vec();
    faces[5].swap(0, 1);
    let mixed = refusal(&mesh(ball.rest_positions().to_vec(), faces), None);
    assert!(matches!(mixed, ModesError::OpenEdge { .. }), "{mixed}");
}

#[test]
fn surfaces_without_volume_are_refused() {
    let flat = moved(&sphere(2), |p| DVec3::new(p.x, p.y, 0.0));
    assert_eq!(refusal(&flat, None), ModesError::NoVolume);
    assert_eq!(refusal(&moved(&flat, |p| p + 1e6), None), ModesError::NoVolume);
    assert_eq!(refusal(&moved(&flat, |_| DVec3::ONE), Some(3)), ModesError::NoVolume);
    let sheet = mesh(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2], [0, 2, 1]]);
    assert_eq!(refusal(&sheet, None), ModesError::NoVolume);
}

#[test]
fn collisions_at_rest_are_refused() {
    let boxes = [DVec3::ZERO, DVec3::new(0.4, 0.3, 0.2)].map(|p| cuboid(p, p + 1.0));
    let crossing = refusal(&joined(&boxes), None);
    assert!(matches!(crossing, ModesError::CollidesAtRest { a: 0..12, b: 12..24 }), "{crossing}");
}

#[test]
fn several_bodies_are_refused() {
    let [a, b, c] = [0.0, 1.001, 3.0].map(|x| cuboid(DVec3::X * x, DVec3::X * x + 1.0));
    for cells in [None, Some(1), Some(3), Some(50)] {
        assert_eq!(refusal(&joined(&[a.clone(), b.clone()]), cells), ModesError::Pieces { count: 2 });
        assert_eq!(
            refusal(&joined(&[c.clone(), a.clone(), b.clone()]), cells),
            ModesError::Pieces { count: 3 }
        );
        // A body within a body, and a body that is inside out.
        let inner = cuboid(DVec3::splat(0.3), DVec3::splat(0.7));
        assert_eq!(refusal(&joined(&[a.clone(), inner]), cells), ModesError::Nested { triangle: 12 });
        let inverse = refusal(&joined(&[a.clone(), inverted(&sphere(2)), c.clone()]), cells);
        assert!(matches!(inverse, ModesError::CollidesAtRest { .. }));
        let small = moved(&inverted(&sphere(2)), |p| 0.2 * p + DVec3::X * 2.0);
        assert_eq!(refusal(&joined(&[a.clone(), small]), cells), ModesError::Nested { triangle: 12 });
    }
}

#[test]
fn resolutions_out_of_range_are_refused() {
    let ball = sphere(3);
    for cells in [0, 1_000_000_000_000] {
        let ModesError::Resolution { cells: requested, max } = refusal(&ball, Some(cells)) else { panic!() };
        assert!(requested == cells && (100..400).contains(&max), "{max}");
        assert_eq!(refusal(&ball, Some(max + 1)), ModesError::Resolution { cells: max + 1, max });
    }
}

/// Each long triangle of a needle meets all cells along it.
#[test]
fn resolutions_at_which_triangles_meet_too_many_cells_are_refused() {
    let needle = needle(4000);
    let ModesError::Resolution { cells: 12_000, max } = refusal(&needle, Some(12_000)) else { panic!() };
    // There are 8000 long triangles, and 2^26 incidences are permitted.
    assert!((8300..8400).contains(&max), "{max}");
    let surface = Surface::new(&needle).unwrap();
    let size = |cells: Option<usize>| Grid::around(&surface, cells).unwrap().size[0] as usize;
    assert_eq!(size(Some(max)), max);
    assert!((max..=max + 1).contains(&size(None)), "{}", size(None));
}

#[test]
fn the_number_of_incidences_is_near_its_mean() {
    for (mesh, along) in [(sphere(3), 40), (needle(30), 50), (cuboid(DVec3::ZERO, DVec3::ONE), 40)] {
        let surface = Surface::new(&mesh).unwrap();
        let grid = Grid::around(&surface, Some(along)).unwrap();
        let points: Vec<DVec3> = mesh.rest_positions().iter().map(|p| grid.coordinates(*p)).collect();
        let inside = intervals(0, &points, &surface.faces, &mut Vec::new(), &()).unwrap();
        let cells = Cells::new(&grid, &points, &surface.faces, &inside, &()).unwrap();
        let found: usize = (0..cells.len()).map(|cell| cells.triangles(cell).len()).sum();
        let expected = incidences(&surface, surface.extent.max_element() / grid.spacing);
        assert!((found as f64 / expected - 1.0).abs() < 0.1, "{along}: {found}, not {expected}");
    }
}

#[test]
fn cancelled_work_is_an_error() {
    let error = Lattice::around(&sphere(2), None, &CancelToken::when(|| true)).err();
    assert_eq!(error, Some(ModesError::Core(sscc::Error::Cancelled)));
}

/// Cancels after a number of checks. Queries check nothing, because it has no token.
struct CancelsAfter {
    limit: usize,
    checks: AtomicUsize,
}

impl Progress for CancelsAfter {
    fn report(&self, _done: usize, _total: usize) {}

    fn is_cancelled(&self) -> bool {
        self.checks.fetch_add(1, Ordering::Relaxed) >= self.limit
    }
}

/// Hundreds of layers lie in nine cells.
#[test]
fn work_within_a_cell_can_be_cancelled() {
    // All other work has fewer than 30 checks.
    let progress = CancelsAfter { limit: 100, checks: AtomicUsize::new(0) };
    let error = Lattice::around(&folded_plate(300, 1e-4), Some(3), &progress).err();
    assert_eq!(error, Some(ModesError::Core(sscc::Error::Cancelled)));
}
