//! Natural vibrations against closed forms.

use glam::DVec3;
use sscc_modes::{Material, Solid, linear_modes, nonlinear_modes};

/// A bar of cubes along x.
fn bar(size: DVec3, cells: [usize; 3], material: Material) -> Solid {
    let [nx, ny, nz] = cells;
    let index = |x: usize, y: usize, z: usize| (x + (nx + 1) * (y + (ny + 1) * z)) as u32;
    let mut vertices = Vec::new();
    for z in 0..=nz {
        for y in 0..=ny {
            for x in 0..=nx {
                let share = DVec3::new(x as f64 / nx as f64, y as f64 / ny as f64, z as f64 / nz as f64);
                vertices.push(size * share);
            }
        }
    }
    let mut cubes = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let corner = |i: usize, j: usize, k: usize| index(x + i, y + j, z + k);
                cubes.push([
                    corner(0, 0, 0),
                    corner(1, 0, 0),
                    corner(1, 1, 0),
                    corner(0, 1, 0),
                    corner(0, 0, 1),
                    corner(1, 0, 1),
                    corner(1, 1, 1),
                    corner(0, 1, 1),
                ]);
            }
        }
    }
    Solid::uniform(vertices, vec![], cubes, material).unwrap()
}

#[test]
fn a_bar_sounds_as_the_closed_forms_say() {
    let material = Material { density: 7800.0, youngs_modulus: 2e11, poisson_ratio: 0.0 };
    let (length, thick) = (1.0, 0.05);
    let mut errors = Vec::new();
    for refinement in [1, 2] {
        let cells = [20 * refinement, refinement, refinement];
        let solid = bar(DVec3::new(length, thick, thick), cells, material);
        let modes = linear_modes(&solid, &[], 12, &()).unwrap();
        println!("{:?}", modes.frequencies());
        let axial = (2e11_f64 / 7800.0).sqrt() / 2.0 / length;
        let bending = 4.730_041_f64.powi(2) / std::f64::consts::TAU
            * (2e11 * thick.powi(2) / 12.0 / 7800.0_f64).sqrt()
            / (length * length);
        println!("axial {axial} bending {bending}");
        errors.push(modes.frequencies()[0] / bending - 1.0);
    }
    println!("{errors:?}");
    let solid = bar(DVec3::new(1.0, 0.2, 0.2), [20, 4, 4], material);
    let t = std::time::Instant::now();
    let modes = nonlinear_modes(&solid, &[0, 1, 30], 30, &()).unwrap();
    println!("{:?} {:?}", modes.frequencies(), t.elapsed());
    println!("{}", modes.forces.unwrap().asymmetry());
}
