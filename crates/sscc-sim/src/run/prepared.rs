//! Models of a scene with certificates, masses and sounds: computed once, then read from the cache.

use std::path::Path;

use glam::{DQuat, DVec3};
use sscc_dynamics::{Shape, SoundBank};
use sscc_modes::natural_frequencies;
use sscc_solid::{Elasticity, MassData};
use sscc_tasks::{Cache, CertifiedModel, LoadedRecipe, ModesSpec, Watch, vibrations};

use crate::error::{At, Result, SimError};
use crate::scenes::{ModelSpec, Scene};

/// Maximum memory for the sounds of all bodies (2 GB).
const MAX_SOUND_BYTES: usize = 2_000_000_000;

/// Memory of a body for each of its triangles (bytes): positions and AABBs of queries within it and against others.
const TRIANGLE_BYTES: usize = 500;

/// Maximum memory for all bodies (8 GB).
const MAX_BODY_BYTES: usize = 8_000_000_000;

/// The models of a scene, in the order of the scene.
pub struct PreparedScene {
    /// One model for each model of the scene.
    pub models: Vec<PreparedModel>,
    /// The hash of this program.
    pub(super) program: String,
}

/// One model of a scene.
pub struct PreparedModel {
    /// The model and its certificates.
    pub certified: CertifiedModel,
    /// The shape of its bodies in a world.
    pub shape: Shape,
    /// Rotation from the axes of its file to those of an upright shape, z up.
    pub upright: DQuat,
    /// The sound of a body, if the scene has sound.
    pub sound: Option<SoundBank>,
}

impl PreparedScene {
    /// Reads the models from the cache, or computes them. `models` is the folder of real models.
    ///
    /// # Errors
    /// When a model cannot be computed, steps are too long for it, all bodies or their sounds need too much memory, or
    /// `watch` cancels.
    pub fn get(
        scene: &Scene,
        models: Option<&Path>,
        cache: &Cache,
        watch: &dyn Watch,
    ) -> Result<Self, SimError> {
        let one = |model: &ModelSpec| PreparedModel::get(scene, model, models, cache, watch);
        let models: Vec<PreparedModel> = scene.models.iter().map(one).collect::<Result<_>>()?;
        let sum = |of: &dyn Fn(&PreparedModel) -> usize| -> usize {
            scene.bodies.iter().map(|body| of(&models[body.model])).sum()
        };
        let triangles = sum(&|model| model.certified.model.mesh().faces().len());
        let bytes = triangles * TRIANGLE_BYTES;
        if bytes > MAX_BODY_BYTES {
            let cause = format!(
                "all {1} need about {0} MB (limit {2} MB); use fewer bodies, or models of fewer triangles",
                bytes / 1_000_000,
                scene.bodies.len(),
                MAX_BODY_BYTES / 1_000_000
            );
            return Err(SimError::refused("bodies", cause));
        }
        let sounds = sum(&|PreparedModel { certified, sound, .. }| {
            let vertices = certified.model.mesh().rest_positions().len();
            sound.as_ref().map_or(0, |sound| 12 * sound.modes() * vertices)
        });
        if sounds > MAX_SOUND_BYTES {
            let cause = format!("all bodies need {} MB; use fewer modes, or no sound", sounds / 1_000_000);
            return Err(SimError::refused("sound", cause));
        }
        Ok(Self { models, program: cache.program()?.to_owned() })
    }

    /// Returns the hash of all inputs of a simulation, this program included.
    pub fn digest(&self, scene: &Scene) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.program.as_bytes()).update(scene.digest.as_bytes());
        for model in &self.models {
            let certified = &model.certified;
            hasher.update(
                &sscc::parts::Digest::of(&certified.model, &sscc::parts::Scope::of(&certified.model)).0,
            );
            add_forces(&mut hasher, certified);
        }
        *hasher.finalize().as_bytes()
    }
}

impl PreparedModel {
    fn get(
        scene: &Scene,
        spec: &ModelSpec,
        models: Option<&Path>,
        cache: &Cache,
        watch: &dyn Watch,
    ) -> Result<Self> {
        let loaded = LoadedRecipe::load(&spec.recipe, models, watch)?;
        let certified = CertifiedModel::get(&loaded, cache, watch)?;
        let elasticity = elasticity(&certified, spec)?;
        let frequencies =
            natural_frequencies(certified.elasticity.stiffness()).at(|| certified.name.clone())?;
        let period = 1.0 / frequencies.iter().copied().fold(f64::INFINITY, f64::min);
        // NaN must fail this test, too.
        let is_resolved = 2.0 * scene.step < period;
        if !is_resolved {
            let cause = format!(
                "steps of {:.3e} s are longer than half a period of its first mode ({period:.3e} s): use more steps \
                 per second",
                scene.step
            );
            return Err(SimError::refused(certified.name.as_str(), cause));
        }
        let sound = scene.sound.as_ref().map(|sound| -> Result<SoundBank> {
            let rate = 1.0 / scene.step;
            let (modes, eigenvalues) =
                vibrations(&loaded, sound.modes, cache, watch).at(|| "sound: modes")?;
            let damping = sound.damping.unwrap_or(spec.damping);
            let square = sound.pitch * sound.pitch;
            let eigenvalues: Vec<f64> = eigenvalues.iter().map(|x| x * square).collect();
            Ok(SoundBank::new(certified.model.mesh(), &modes, &eigenvalues, damping, rate)?)
        });
        let MassData { properties, moments, .. } = certified.mass.clone();
        let certificates = certified.full.certificates.clone();
        let shape = Shape::new(certified.model.clone(), certificates, elasticity, properties)?;
        let shape = shape.with_moments(moments)?;
        Ok(Self { certified, shape, upright: loaded.upright, sound: sound.transpose()? })
    }

    /// Whether vertices of the model are fixed, so that its bodies have no rigid motion.
    pub fn is_held(&self) -> bool {
        self.certified.mass.is_held
    }

    /// Returns the centre of mass, about which its bodies rotate.
    pub fn center(&self) -> DVec3 {
        self.shape.mass().center
    }
}

/// Returns the elastic forces on a model's bodies.
fn elasticity(certified: &CertifiedModel, spec: &ModelSpec) -> Result<Elasticity> {
    match &certified.elasticity {
        // The forces of a file with modes already follow the scene.
        known if matches!(spec.recipe.modes, ModesSpec::Given) => Ok(known.clone()),
        known if spec.is_linear => Ok(known.linearized()),
        Elasticity::Linear(_) => {
            let cause = format!(
                "the {} modes have no forces of large deformations; use linear dynamics",
                certified.model.rank()
            );
            Err(SimError::refused(certified.name.as_str(), cause))
        }
        known => Ok(known.clone()),
    }
}

/// Adds forces and mass to a hash. The digest of a model covers only its surface and its modes.
fn add_forces(hasher: &mut blake3::Hasher, certified: &CertifiedModel) {
    let mut add = |numbers: &[f64]| {
        numbers.iter().for_each(|x| {
            hasher.update(&x.to_le_bytes());
        });
    };
    add(certified.elasticity.stiffness().entries());
    if let Elasticity::Nonlinear(forces) = &certified.elasticity {
        add(forces.quadratic());
        add(forces.cubic());
    }
    let MassData { properties, moments, is_held } = &certified.mass;
    add(&[properties.mass, f64::from(u8::from(*is_held))]);
    add(&properties.center.to_array());
    add(&properties.inertia.to_cols_array());
    moments.iter().for_each(|moment| add(&moment.to_array()));
}
