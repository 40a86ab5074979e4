//! Frequencies scale as `sqrt(E / density) / size`, from soft to stiff, light to heavy and small to large bodies.

use glam::DVec3;
use sscc::TriMesh;
use sscc_modes::shapes::spring_of;
use sscc_modes::{EmbeddedSurface, SolidModes, linear_modes, nonlinear_modes};
use sscc_solid::{Material, PartialMaterial, Solid};

/// Factors of Young's modulus, density and size.
type Factors = [f64; 3];

/// Returns the expected factor of frequencies.
fn expected([youngs, density, size]: Factors) -> f64 {
    (youngs / density).sqrt() / size
}

fn scaled([youngs, density, _]: Factors) -> Material {
    let usual = Material::default();
    let (youngs_modulus, density) = (youngs * usual.youngs_modulus(), density * usual.density());
    let known =
        PartialMaterial { youngs_modulus: Some(youngs_modulus), density: Some(density), ..usual.into() };
    Material::new(&known).unwrap()
}

/// Returns the frequencies of a coarse spring in a coarse lattice, with enough modes for faer's divide and conquer (128
/// rows).
fn spring(factors: Factors, rank: usize) -> Vec<f64> {
    let mesh = spring_of(120, 6);
    let positions = mesh.rest_positions().iter().map(|p| *p * factors[2]).collect();
    let mesh = TriMesh::new(positions, mesh.faces().to_vec()).unwrap();
    let body = EmbeddedSurface::new(&mesh, Some(10), scaled(factors), &()).unwrap();
    linear_modes(body.solid(), &[], rank, &()).unwrap().frequencies()
}

#[test]
fn frequencies_scale_over_twelve_orders_of_magnitude() {
    let usual = spring([1.0; 3], 60);
    // Steel, a small body, and factors from 1e-6 to 1e6, one at a time.
    let mut cases = vec![[2e5, 7.85, 1.0], [1.0, 1.0, 0.01]];
    for at in 0..3 {
        for factor in [1e-6, 1e6] {
            let mut factors = [1.0; 3];
            factors[at] = factor;
            cases.push(factors);
        }
    }
    for factors in cases {
        let found = spring(factors, 60);
        for (k, (a, b)) in found.iter().zip(&usual).enumerate() {
            assert!((a / (b * expected(factors)) - 1.0).abs() < 1e-8, "{factors:?}, mode {k}: {a} {b}");
        }
    }
}

/// Returns a bar of 1 x 0.2 x 0.1 times its size.
fn bar(factors: Factors) -> Solid {
    let (cells, corners) = ([12, 3, 2], [[0, 0], [1, 0], [1, 1], [0, 1]]);
    let index = |p: [usize; 3]| (p[0] + 13 * (p[1] + 4 * p[2])) as u32;
    let (mut vertices, mut cubes) = (Vec::new(), Vec::new());
    for at in 0..13 * 4 * 3 {
        let p = [at % 13, at / 13 % 4, at / 52];
        vertices.push(factors[2] * DVec3::new(p[0] as f64 / 12.0, p[1] as f64 / 15.0, p[2] as f64 / 20.0));
        if (0..3).all(|k| p[k] < cells[k]) {
            let corner = |k: usize| [p[0] + corners[k % 4][0], p[1] + corners[k % 4][1], p[2] + k / 4];
            cubes.push(std::array::from_fn(|k| index(corner(k))));
        }
    }
    Solid::uniform(vertices, vec![], cubes, scaled(factors)).unwrap()
}

/// Factors that are powers of four cause no rounding, so only an absolute tolerance can change the result.
#[test]
fn powers_of_four_scale_results_exactly() {
    let modes = |factors: Factors, rank: usize| {
        let bar = bar(factors);
        (linear_modes(&bar, &[], 60, &()).unwrap(), nonlinear_modes(&bar, &[], rank, &()).unwrap())
    };
    let usual = modes([1.0; 3], 24);
    for exponents in [[20, 0, 0], [-20, 0, 0], [0, 20, 0], [0, -20, 0], [0, 0, 20], [0, 0, -20]] {
        let factors = exponents.map(|exponent| 2.0_f64.powi(exponent));
        let found = modes(factors, 24);
        let same = |a: &SolidModes, b: &SolidModes| {
            let scale = expected(factors) * expected(factors);
            a.eigenvalues().iter().zip(&b.eigenvalues()).all(|(a, b)| *a == b * scale)
        };
        assert!(same(&found.0, &usual.0), "linear, 2^{exponents:?}");
        assert!(same(&found.1, &usual.1), "nonlinear, 2^{exponents:?}");
    }
}
