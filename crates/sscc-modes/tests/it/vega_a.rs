//! VegaFEM's reduced forces of the letter A.

use sscc::Modes;
use sscc_modes::diagonalize;

#[test]
fn the_forces_of_vega_a_are_a_gradient() {
    let Some(models) = sscc_testing::models("the_forces_of_vega_a_are_a_gradient") else { return };
    let forces = sscc_io::read_reduced_forces(&models.join("vega_A/A.cub")).unwrap();
    assert_eq!(forces.rank(), 20);
    assert!(forces.asymmetry() < 1e-12, "{}", forces.asymmetry());
    // The linear part is positive definite.
    let unit = Modes::from_matrix(20, 20, |row, k| f64::from(u8::from(row == k))).unwrap();
    let eigenvalues = diagonalize(&unit, forces.linear()).unwrap().eigenvalues;
    assert!(eigenvalues[0] > 0.0, "{eigenvalues:?}");
    // The derivative of the energy along a line, by central differences, matches the forces.
    let q: Vec<f64> = (0..20).map(|k| 0.01 * f64::from(k % 7 - 3)).collect();
    let at = |t: f64| forces.energy(&q.iter().map(|x| t * x).collect::<Vec<_>>());
    let slope = (at(1.0 + 1e-4) - at(1.0 - 1e-4)) / 2e-4;
    let expected: f64 = forces.at(&q).iter().zip(&q).map(|(f, q)| f * q).sum();
    assert!((slope / expected - 1.0).abs() < 1e-6);
}
