//! Natural vibrations match closed forms, and bodies without a spectrum are rejected.

use std::f64::consts::TAU;

use glam::DVec3;
use sscc_modes::{ModesError, linear_modes, nonlinear_modes};
use sscc_solid::{Elasticity, Material, PartialMaterial, Solid};

/// Steel without transverse contraction, so that beam theory is exact up to shear.
const STEEL: Material = {
    let (density, youngs_modulus, poisson_ratio) = (Some(7800.0), Some(2e11), Some(0.0));
    match Material::new(&PartialMaterial { density, youngs_modulus, poisson_ratio }) {
        Ok(steel) => steel,
        Err(_) => panic!("steel is a material"),
    }
};

/// Returns a bar of cubes from the origin.
fn bar(size: DVec3, cells: [usize; 3], material: Material) -> Solid {
    let [nx, ny, nz] = cells;
    let index = |x: usize, y: usize, z: usize| (x + (nx + 1) * (y + (ny + 1) * z)) as u32;
    let mut vertices = Vec::new();
    let mut cubes = Vec::new();
    for z in 0..=nz {
        for y in 0..=ny {
            for x in 0..=nx {
                let share = DVec3::new(x as f64 / nx as f64, y as f64 / ny as f64, z as f64 / nz as f64);
                vertices.push(size * share);
                if x < nx && y < ny && z < nz {
                    let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
                    let corner = |k: usize| index(x + corners[k % 4][0], y + corners[k % 4][1], z + k / 4);
                    cubes.push(std::array::from_fn(corner));
                }
            }
        }
    }
    Solid::uniform(vertices, vec![], cubes, material).unwrap()
}

/// Returns the same bar with each cube split into six tetrahedra.
fn bar_of_tets(size: DVec3, cells: [usize; 3], material: Material) -> Solid {
    let solid = bar(size, cells, material);
    let paths = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];
    let tets = solid.cubes().iter().flat_map(|cube| paths.map(|path| path.map(|k| cube[k]))).collect();
    Solid::uniform(solid.vertices().to_vec(), tets, vec![], material).unwrap()
}

/// Returns the bending frequency (Hz) of a slender bar of length 1, from the root of its bending equation.
fn bending_frequency(root: f64, thickness: f64) -> f64 {
    root * root / TAU * (STEEL.youngs_modulus() * thickness * thickness / 12.0 / STEEL.density()).sqrt()
}

#[test]
fn frequencies_of_bars_match_closed_forms() {
    // Shear and rotary inertia lower the first bending frequency of this slender bar by 0.6% (free) or 0.2% (clamped).
    let thickness = 0.05;
    let size = DVec3::new(1.0, thickness, thickness);
    let longitudinal = (STEEL.youngs_modulus() / STEEL.density()).sqrt();
    for (clamped, root, axial) in [(false, 4.730_040_745, 0.5), (true, 1.875_104_069, 0.25)] {
        let mut errors = Vec::new();
        for fine in [1, 2, 4] {
            let solid = bar(size, [20 * fine, fine, fine], STEEL);
            let fixed: Vec<u32> = (0..solid.vertices().len() as u32)
                .filter(|v| clamped && solid.vertices()[*v as usize].x == 0.0)
                .collect();
            let modes = linear_modes(&solid, &fixed, 10, &()).unwrap();
            let found = modes.frequencies();
            // Bending along y and z has the same frequency.
            assert!((found[0] / found[1] - 1.0).abs() < 1e-6, "{found:?}");
            errors.push(found[0] / bending_frequency(root, thickness) - 1.0);
            let nearest = found.iter().map(|f| (f / (axial * longitudinal) - 1.0).abs()).fold(1.0, f64::min);
            assert!(nearest < 2e-3, "axial: {nearest}");
        }
        // Cubes are too stiff in bending, with an error proportional to the square of their size: 22%, 5.3%, 1%.
        let [one, two, four] = errors[..] else { panic!() };
        assert!(
            one < 0.25 && two < 0.07 && two < one / 3.0 && four < two / 3.0 && four > -0.01,
            "{errors:?}"
        );
    }
}

#[test]
fn one_layer_of_second_order_tetrahedra_bends_as_a_beam() {
    let thickness = 0.05;
    let linear = bar_of_tets(DVec3::new(1.0, thickness, thickness), [10, 1, 1], STEEL);
    let (second_order, edges) = linear.elevated().unwrap();
    assert_eq!(second_order.vertices().len(), linear.vertices().len() + edges.len());
    let first = |solid: &Solid| {
        let clamped = |v: &u32| solid.vertices()[*v as usize].x == 0.0;
        let fixed: Vec<u32> = (0..solid.vertices().len() as u32).filter(clamped).collect();
        linear_modes(solid, &fixed, 4, &()).unwrap().frequencies()[0]
    };
    let expected = bending_frequency(1.875_104_069, thickness);
    let (coarse, found) = (first(&linear) / expected, first(&second_order) / expected);
    assert!(coarse > 1.5 && (found - 1.0).abs() < 0.02, "{coarse} {found}");
    let mass = |solid: &Solid| solid.mass_properties();
    assert!((mass(&second_order).mass / mass(&linear).mass - 1.0).abs() < 1e-12);
    assert!(mass(&second_order).inertia.abs_diff_eq(mass(&linear).inertia, 1e-10));
}

#[test]
fn tetrahedra_and_cubes_agree() {
    let (size, cells) = (DVec3::new(1.0, 0.7, 0.5), [10, 7, 5]);
    let of = |solid: Solid| linear_modes(&solid, &[], 8, &()).unwrap().frequencies();
    let (cubes, tets) =
        (of(bar(size, cells, Material::default())), of(bar_of_tets(size, cells, Material::default())));
    for (a, b) in cubes.iter().zip(&tets) {
        assert!(*b >= a * 0.999 && *b < a * 1.12, "tetrahedra are stiffer: {cubes:?} {tets:?}");
    }
}

#[test]
fn the_nonlinear_basis_contains_the_lowest_modes() {
    let solid = bar(DVec3::new(1.0, 0.2, 0.1), [12, 3, 2], Material::default());
    let fixed: Vec<u32> =
        (0..solid.vertices().len() as u32).filter(|v| solid.vertices()[*v as usize].x == 0.0).collect();
    for fixed in [&fixed[..], &[]] {
        let linear = linear_modes(&solid, fixed, 4, &()).unwrap();
        let nonlinear = nonlinear_modes(&solid, fixed, 12, &()).unwrap();
        let (lowest, found) = (linear.eigenvalues(), nonlinear.eigenvalues());
        assert_eq!(found.len(), 12);
        for (a, b) in lowest[..3].iter().zip(&found) {
            assert!(*b >= a * (1.0 - 1e-9) && *b < a * 1.05, "{lowest:?} {found:?}");
        }
        let Elasticity::Nonlinear(forces) = nonlinear.elasticity else { panic!("linear forces") };
        assert!(forces.asymmetry() < 1e-9);
    }
}

#[test]
fn bodies_without_a_spectrum_are_rejected() {
    let material = Material::default();
    let cube = bar(DVec3::ONE, [1, 1, 1], material);
    // A second cube that shares only an edge (corners 6 and 5) is a hinge; in the other case it shares nothing.
    for (shared, expected) in [(true, 7), (false, 12)] {
        let mut vertices = cube.vertices().to_vec();
        let start = vertices.len() as u32;
        vertices.extend(cube.vertices().iter().map(|p| *p + DVec3::new(1.0, 0.0, 1.0)));
        let mut second = cube.cubes()[0].map(|v| v + start);
        if shared {
            // Its lower left edge is the upper right edge of the first cube.
            let [_, b, c, ..] = [4, 5, 6, 7].map(|k| cube.cubes()[0][k]);
            second[0] = b;
            second[3] = c;
        }
        let used: Vec<u32> =
            (0..vertices.len() as u32).filter(|v| *v < start || second.contains(v)).collect();
        let number = |v: u32| used.iter().position(|w| *w == v).unwrap() as u32;
        let kept = used.iter().map(|v| vertices[*v as usize]).collect();
        let solid =
            Solid::uniform(kept, vec![], vec![cube.cubes()[0], second.map(number)], material).unwrap();
        let error = linear_modes(&solid, &[], 3, &()).unwrap_err();
        assert_eq!(error, ModesError::Mechanism { found: expected, expected: 6 });
    }
    let all: Vec<u32> = (0..8).collect();
    assert_eq!(linear_modes(&cube, &all, 1, &()).unwrap_err(), ModesError::AllFixed { vertices: 8 });
    assert_eq!(
        linear_modes(&cube, &[8], 1, &()).unwrap_err(),
        ModesError::FixedVertex { vertex: 8, vertices: 8 }
    );
    assert_eq!(
        linear_modes(&cube, &[], 19, &()).unwrap_err(),
        ModesError::TooManyModes { requested: 19, available: 18 }
    );
    assert_eq!(linear_modes(&cube, &[], 18, &()).unwrap().eigenvalues().len(), 18);
    assert!(matches!(nonlinear_modes(&cube, &[], 19, &()), Err(ModesError::TooManyModes { .. })));
    assert_eq!(nonlinear_modes(&cube, &[], 0, &()), Err(ModesError::Core(sscc::Error::RankZero)));
    let many = ModesError::NonlinearRank { requested: 101, max: 100 };
    assert_eq!(nonlinear_modes(&cube, &[], 101, &()), Err(many));
}

#[test]
fn one_free_vertex_has_three_modes() {
    let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let corners = vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., 1.)];
    let tet = Solid::uniform(corners, vec![[0, 1, 2, 3]], vec![], Material::default()).unwrap();
    let found = linear_modes(&tet, &[0, 1, 2], 3, &()).unwrap();
    assert!(found.eigenvalues().len() == 3 && found.eigenvalues()[0] > 0.0);
    assert!(linear_modes(&tet, &[0, 1, 2], 4, &()).is_err());
}

/// A bar with one half stiffer and heavier by a factor of 1e14 gives an error with the cause.
#[test]
fn an_uncertain_count_is_an_error_with_its_cause() {
    let one = bar(DVec3::new(5.0, 1.0, 1.0), [30, 5, 5], Material::default());
    let usual = Material::default();
    let (youngs_modulus, density) = (Some(1e14 * usual.youngs_modulus()), Some(1e14 * usual.density()));
    let hard = Material::new(&PartialMaterial { youngs_modulus, density, ..usual.into() }).unwrap();
    let cubes = one.cubes().to_vec();
    let of = cubes.iter().map(|cube| u32::from(one.vertices()[cube[0] as usize].x >= 2.49)).collect();
    let solid = Solid::new(one.vertices().to_vec(), vec![], cubes, vec![usual, hard], of).unwrap();
    let error = linear_modes(&solid, &[], 20, &()).unwrap_err();
    let ModesError::Uncounted { contrast, lowest } = error else { panic!("{error}") };
    assert!(contrast > 1e13 && lowest > 0.0, "{error}");
    assert!(
        error.to_string().contains("rounding errors prevent the check that no vibration is missing"),
        "{error}"
    );
}
