//! All that a scene needs before it moves: models, certificates, masses; made once, then from the cache.

use std::f64::consts::TAU;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use glam::{DMat3, DQuat, DVec3};
use sscc_dynamics::{Elasticity, Shape, SoundBank};
use sscc_io::{self as io, read_whole, write_whole};
use sscc_modes::{MassProperties, ReducedForces};

use crate::case::{self, Begun, Cache, Case, Kind, program};
use crate::scene::{ModelSpec, Scene};

/// The most memory that the sounds of all bodies may take: 2 GB.
const MOST_SOUND: usize = 2_000_000_000;

/// Bytes that a body takes for each of its triangles: positions and boxes of queries within it and beside others.
const OF_TRIANGLE: usize = 500;

/// The most memory that all bodies may take: 8 GB.
const MOST_BODIES: usize = 8_000_000_000;

/// The models of a scene, in its order.
pub struct Prepared {
    pub models: Vec<PreparedModel>,
}

/// One model.
pub struct PreparedModel {
    pub case: Case,
    pub shape: Shape,
    /// From the axes of its file to those of a shape that stands upright, z up.
    pub upright: DQuat,
    /// What its bodies sound like.
    pub sound: Option<SoundBank>,
}

impl Prepared {
    /// From the cache, or made now.
    pub fn get(scene: &Scene, models: Option<&Path>, cache: &Cache) -> Result<Self> {
        let one = |model: &ModelSpec| PreparedModel::get(scene, model, models, cache);
        let models: Vec<PreparedModel> = scene.models.iter().map(one).collect::<Result<_>>()?;
        let sum = |of: &dyn Fn(&PreparedModel) -> usize| -> usize {
            scene.bodies.iter().map(|body| of(&models[body.model])).sum()
        };
        let triangles = sum(&|model| model.case.model.mesh().faces().len());
        let bytes = triangles * OF_TRIANGLE;
        ensure!(
            bytes <= MOST_BODIES,
            "bodies: about {} MB for all {} (limit {} MB); take fewer, or of fewer triangles",
            bytes / 1_000_000,
            scene.bodies.len(),
            MOST_BODIES / 1_000_000
        );
        let sounds = sum(&|PreparedModel { case, sound, .. }| {
            sound.as_ref().map_or(0, |sound| 12 * sound.modes() * case.model.mesh().rest_positions().len())
        });
        ensure!(
            sounds <= MOST_SOUND,
            "sound: {} MB for all bodies; take fewer modes, or no sound",
            sounds / 1_000_000
        );
        Ok(Self { models })
    }

    /// The hash of all that decides what a simulation comes to, this program included.
    pub fn digest(&self, scene: &Scene) -> Result<[u8; 32]> {
        let mut hasher = blake3::Hasher::new();
        hasher.update(program()?.as_bytes()).update(scene.digest.as_bytes());
        for model in &self.models {
            hasher.update(&sscc::Digest::of(&model.case.model, &sscc::Scope::of(&model.case.model)).0);
        }
        Ok(*hasher.finalize().as_bytes())
    }
}

impl PreparedModel {
    fn get(scene: &Scene, spec: &ModelSpec, models: Option<&Path>, cache: &Cache) -> Result<Self> {
        let begun = spec.recipe.begin(models)?;
        let mass = mass(&begun, cache)?;
        let case = Case::get(&begun, cache)?;
        let elasticity = elasticity(&case, spec.is_linear)?;
        let first = diagonal(&case.elasticity).into_iter().fold(f64::INFINITY, f64::min).sqrt();
        let period = TAU / first;
        ensure!(
            2.0 * scene.step < period,
            "{}: steps of {:.3e} s are longer than half a period of its first mode ({period:.3e} s): take more steps in a second",
            case.name,
            scene.step
        );
        let sound = scene.sound.as_ref().map(|sound| {
            let rate = 1.0 / scene.step;
            let (model, elasticity) = case::modes(&begun, Kind::Linear(sound.modes), cache)?;
            let damping = sound.damping.unwrap_or(spec.damping);
            let square = sound.pitch * sound.pitch;
            let eigenvalues: Vec<f64> = diagonal(&elasticity).iter().map(|x| x * square).collect();
            anyhow::Ok(SoundBank::new(model.mesh(), model.modes(), &eigenvalues, damping, rate)?)
        });
        let shape = Shape::new(case.model.clone(), case.full.certificates.clone(), elasticity, mass)?;
        Ok(Self { case, shape, upright: begun.upright, sound: sound.transpose()? })
    }

    /// The point about which its bodies turn.
    pub fn center(&self) -> DVec3 {
        self.shape.mass().center
    }
}

/// The squared angular frequency of each mode.
fn diagonal(elasticity: &io::Elasticity) -> Vec<f64> {
    // Of modes without stiffness rounding may leave a little less than nothing.
    elasticity.stiffness().iter().step_by(elasticity.rank() + 1).map(|x| x.max(0.0)).collect()
}

fn elasticity(case: &Case, is_linear: bool) -> Result<Elasticity> {
    Ok(match &case.elasticity {
        linear if is_linear => Elasticity::Linear(diagonal(linear)),
        io::Elasticity::Linear(_) => {
            bail!("{}: {} modes have no forces of large deformations", case.name, case.model.rank())
        }
        io::Elasticity::Nonlinear(io::Cubic { rank, linear, quadratic, cubic }) => {
            Elasticity::Nonlinear(ReducedForces {
                rank: *rank,
                linear: linear.clone(),
                quadratic: quadratic.clone(),
                cubic: cubic.clone(),
            })
        }
    })
}

/// Mass, centre and inertia of a solid: 1, 3 and 9 numbers in a file.
fn mass(begun: &Begun<'_>, cache: &Cache) -> Result<MassProperties> {
    let name = format!("{}-{}.mass.json", begun.recipe().name, begun.key("mass"));
    let read = |path: &Path| {
        let in_file = || path.display().to_string();
        let numbers: Vec<f64> = serde_json::from_slice(&read_whole(path)?).with_context(in_file)?;
        let [mass, x, y, z, inertia @ ..] = &numbers[..] else { bail!("{}: too short", path.display()) };
        let inertia = <[f64; 9]>::try_from(inertia).with_context(in_file)?;
        let (center, inertia) = (DVec3::new(*x, *y, *z), DMat3::from_cols_array(&inertia));
        Ok(MassProperties { mass: *mass, center, inertia })
    };
    let write = |path: &Path, mass: &MassProperties| {
        let mut numbers = vec![mass.mass];
        numbers.extend(mass.center.to_array());
        numbers.extend(mass.inertia.to_cols_array());
        Ok(write_whole(path, &serde_json::to_vec(&numbers)?)?)
    };
    cache.get(&name, read, || Ok(begun.solid()?.solid().mass_properties()), write)
}
