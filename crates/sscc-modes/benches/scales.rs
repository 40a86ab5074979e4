//! Bench of modes of springs from soft to stiff, light to heavy and small to large: `cargo bench -p sscc-modes --bench
//! scales`.
//!
//! Frequencies scale as `sqrt(E / density) / size`. The bench fails if a relative error exceeds 1e-8. It prints the maximum
//! error, and the processor time relative to the default material, with interleaved repetitions; at most 1.3 is expected.
//! `--quick` uses only the small spring.
#![allow(clippy::print_stdout)]

use std::error::Error;

use cpu_time::ProcessTime;
use sscc::TriMesh;
use sscc_modes::{EmbeddedSurface, linear_modes, shapes::spring_of};
use sscc_solid::{Material, PartialMaterial};

/// Exponents of the factors (powers of ten) of stiffness, density and size.
const POWERS: [i32; 6] = [-6, -4, -2, 2, 4, 6];

/// Maximum relative error of a frequency.
const MAX_ERROR: f64 = 1e-8;

/// Number of repetitions; the fastest counts.
const REPETITIONS: usize = 3;

/// Size of a spring: rings and vertices of each, cubes along the spring, and numbers of modes.
struct Spring {
    name: &'static str,
    rings: [usize; 2],
    cells: usize,
    ranks: &'static [usize],
}

const SPRINGS: [Spring; 2] = [
    Spring { name: "coarse", rings: [120, 6], cells: 12, ranks: &[20, 100] },
    Spring { name: "default", rings: [500, 16], cells: 30, ranks: &[20, 100, 200] },
];

/// Scaled properties of a spring.
const CHANGES: [&str; 3] = ["stiffness", "density", "size"];

fn main() -> Result<(), Box<dyn Error>> {
    let quick = std::env::args().any(|arg| arg == "--quick");
    println!(
        "| spring | degrees of freedom | modes | changed | by 10^ | maximum relative error of frequencies | processor time, s | relative to the default |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for spring in SPRINGS.iter().take(if quick { 1 } else { SPRINGS.len() }) {
        for rank in spring.ranks {
            for changed in CHANGES {
                for power in POWERS {
                    compare(spring, *rank, changed, power)?;
                }
            }
        }
    }
    Ok(())
}

/// Measures a scaled spring and the default one, interleaved.
fn compare(spring: &Spring, rank: usize, changed: &str, power: i32) -> Result<(), Box<dyn Error>> {
    let factor = 10.0_f64.powi(power);
    let default_material = Material::default();
    let mut known = PartialMaterial::from(default_material);
    let (size, expected) = match changed {
        "stiffness" => {
            known.youngs_modulus = Some(default_material.youngs_modulus() * factor);
            (1.0, factor.sqrt())
        }
        "density" => {
            known.density = Some(default_material.density() * factor);
            (1.0, 1.0 / factor.sqrt())
        }
        _ => (factor, 1.0 / factor),
    };
    let material = Material::new(&known)?;
    let (mut default, mut found) = (Measurement::default(), Measurement::default());
    for _ in 0..REPETITIONS {
        default.repeat(spring, rank, default_material, 1.0)?;
        found.repeat(spring, rank, material, size)?;
    }
    let error = |(a, b): (&f64, &f64)| (a / (b * expected) - 1.0).abs();
    let worst = found.frequencies.iter().zip(&default.frequencies).map(error).fold(0.0, f64::max);
    println!(
        "| {} | {} | {rank} | {changed} | {power} | {worst:.1e} | {:.2} | {:.2} |",
        spring.name,
        found.freedom,
        found.seconds,
        found.seconds / default.seconds
    );
    if worst > MAX_ERROR {
        return Err(format!(
            "a frequency has the relative error {worst:e}: at most {MAX_ERROR:e} is allowed"
        )
        .into());
    }
    Ok(())
}

/// Frequencies, and the processor time (s) of the fastest repetition.
struct Measurement {
    freedom: usize,
    frequencies: Vec<f64>,
    seconds: f64,
}

impl Default for Measurement {
    fn default() -> Self {
        Self { freedom: 0, frequencies: Vec::new(), seconds: f64::INFINITY }
    }
}

impl Measurement {
    /// Runs one repetition.
    fn repeat(
        &mut self,
        spring: &Spring,
        rank: usize,
        material: Material,
        size: f64,
    ) -> Result<(), Box<dyn Error>> {
        let mesh = spring_of(spring.rings[0], spring.rings[1]);
        let positions = mesh.rest_positions().iter().map(|p| *p * size).collect();
        let mesh = TriMesh::new(positions, mesh.faces().to_vec())?;
        let start = ProcessTime::now();
        let body = EmbeddedSurface::new(&mesh, Some(spring.cells), material, &())?;
        let found = linear_modes(body.solid(), &[], rank, &())?;
        self.seconds = self.seconds.min(start.elapsed().as_secs_f64());
        self.freedom = 3 * body.solid().vertices().len();
        self.frequencies = found.frequencies();
        Ok(())
    }
}
