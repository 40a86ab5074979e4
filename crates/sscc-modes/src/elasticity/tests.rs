//! Reduced forces match forces in the full space, and both match the energy.

use glam::DVec3;
use sscc::Modes;
use sscc_solid::{Material, PartialMaterial, Solid};

use super::reduced_forces;
use super::stvk::{energy_and_forces, second_derivatives};

/// Returns a generator of pseudo-random numbers between -1 and 1.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Two cubes with two tetrahedra on top, all slightly distorted, of two materials.
fn solid() -> Solid {
    let mut next = random(3);
    let mut vertices = Vec::new();
    for z in 0..3 {
        for (x, y) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
            vertices.push(
                DVec3::new(x as f64, y as f64, z as f64) + 0.1 * DVec3::from_array([next(), next(), next()]),
            );
        }
    }
    vertices.push(DVec3::new(0.4, 0.5, 3.0));
    let cube = |k: u32| std::array::from_fn(|i| 4 * k + i as u32);
    let tets = vec![[8, 9, 10, 12], [8, 10, 11, 12]];
    let material = |density, youngs_modulus, poisson_ratio| {
        let (density, youngs_modulus, poisson_ratio) =
            (Some(density), Some(youngs_modulus), Some(poisson_ratio));
        Material::new(&PartialMaterial { density, youngs_modulus, poisson_ratio }).unwrap()
    };
    let (soft, hard) = (material(2.0, 3.0, 0.3), material(5.0, 20.0, -0.4));
    Solid::new(vertices, tets, vec![cube(0), cube(1)], vec![soft, hard], vec![0, 1, 0, 1]).unwrap()
}

fn displacement(modes: &Modes, q: &[f64]) -> Vec<DVec3> {
    let row = |u: &[DVec3]| u.iter().zip(q).map(|(u, q)| *u * *q).sum();
    modes.displacements().chunks_exact(q.len()).map(row).collect()
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[test]
fn reduced_forces_match_the_full_forces() {
    let (solid, mut next) = (solid(), random(1));
    for rank in [1, 2, 5, 9] {
        let entries: Vec<f64> = (0..39 * rank).map(|_| 0.3 * next()).collect();
        let modes = Modes::from_matrix(13, rank, |row, k| entries[row * rank + k]).unwrap();
        let reduced = reduced_forces(&solid, &modes, &()).unwrap();
        assert!(reduced.asymmetry() < 1e-12);
        for size in [1e-3, 1.0, 30.0] {
            let q: Vec<f64> = (0..rank).map(|_| size * next()).collect();
            let (energy, forces) = energy_and_forces(&solid, &displacement(&modes, &q));
            let full: Vec<f64> = (0..rank)
                .map(|k| {
                    forces
                        .iter()
                        .zip(modes.displacements().chunks_exact(rank))
                        .map(|(f, u)| f.dot(u[k]))
                        .sum()
                })
                .collect();
            let found = reduced.at(&q);
            let difference: Vec<f64> = found.iter().zip(&full).map(|(a, b)| a - b).collect();
            assert!(norm(&difference) < 1e-12 * norm(&full), "{rank} {size}: {found:?} {full:?}");
            assert!((reduced.energy(&q) - energy).abs() < 1e-12 * energy, "{rank} {size}");

            // The stiffness, by central differences; the polynomial is cubic, so the error is h^2.
            let stiffness = reduced.stiffness(&q);
            let h = 1e-4 * size;
            for j in 0..rank {
                let moved = |h: f64| {
                    let mut q = q.clone();
                    q[j] += h;
                    reduced.at(&q)
                };
                let (plus, minus) = (moved(h), moved(-h));
                for i in 0..rank {
                    let slope = (plus[i] - minus[i]) / (2.0 * h);
                    assert!((slope - stiffness[i * rank + j]).abs() < 1e-6 * norm(&stiffness));
                }
            }
        }
    }
}

#[test]
fn full_forces_are_the_gradient_of_the_energy() {
    let (solid, mut next) = (solid(), random(2));
    let mut field =
        || -> Vec<DVec3> { (0..13).map(|_| 0.2 * DVec3::from_array([next(), next(), next()])).collect() };
    let (u, along) = (field(), field());
    let at = |h: f64| -> Vec<DVec3> { u.iter().zip(&along).map(|(u, a)| *u + *a * h).collect() };
    let h = 1e-5;
    let slope = (energy_and_forces(&solid, &at(h)).0 - energy_and_forces(&solid, &at(-h)).0) / (2.0 * h);
    let forces = energy_and_forces(&solid, &u).1;
    let expected: f64 = forces.iter().zip(&along).map(|(f, a)| f.dot(*a)).sum();
    assert!((slope - expected).abs() < 1e-7 * expected.abs());
}

#[test]
fn second_derivatives_are_those_of_the_forces() {
    let (solid, mut next) = (solid(), random(4));
    let mut field =
        || -> Vec<DVec3> { (0..13).map(|_| DVec3::from_array([next(), next(), next()])).collect() };
    let (a, b) = (field(), field());
    // The mixed difference of forces at +-h a +- h b is 4 h^2 times the mixed derivative, plus O(h^4).
    let h = 1e-3;
    let at = |s: f64, t: f64| {
        let u: Vec<DVec3> = a.iter().zip(&b).map(|(a, b)| *a * (s * h) + *b * (t * h)).collect();
        energy_and_forces(&solid, &u).1
    };
    let [pp, pm, mp, mm] = [at(1.0, 1.0), at(1.0, -1.0), at(-1.0, 1.0), at(-1.0, -1.0)];
    // Enough pairs for several tasks.
    let pairs: Vec<(usize, usize)> = (0..20).map(|k| if k == 17 { (1, 2) } else { (0, k % 3) }).collect();
    let found = &second_derivatives(&solid, &[b.clone(), a, b], &pairs)[17];
    let size = found.iter().fold(0.0_f64, |m, f| m.max(f.length()));
    for i in 0..found.len() {
        let mixed = (pp[i] - pm[i] - mp[i] + mm[i]) / (4.0 * h * h);
        assert!((mixed - found[i]).length() < 1e-6 * size, "{mixed} {}", found[i]);
    }
}

#[test]
fn rotations_cost_no_energy() {
    let solid = solid();
    let rotation = glam::DMat3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 2.0);
    let u: Vec<DVec3> = solid.vertices().iter().map(|p| rotation * *p - *p + DVec3::splat(7.0)).collect();
    let (energy, forces) = energy_and_forces(&solid, &u);
    assert!(energy < 1e-20);
    assert!(forces.iter().all(|f| f.length() < 1e-10));
}
