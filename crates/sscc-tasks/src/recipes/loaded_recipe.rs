//! Loads the shape of a recipe and computes its modes.

use std::cell::OnceCell;
use std::path::Path;

use glam::DQuat;
use sscc::ReducedModel;
use sscc_io::ModelInfo;
use sscc_solid::Material;

use super::given_model::GivenModel;
use super::key::Key;
use super::recipe::{ModesSpec, Recipe};
use super::shape::{LoadedShape, Matter, Shape};
use crate::error::At;
use crate::models::{ElasticModes, Fix, ModesKind, SolidSource};
use crate::{Stage, TaskError, Watch};

/// A recipe with its shape; modes are not computed yet.
pub struct LoadedRecipe<'a> {
    recipe: &'a Recipe,
    /// Material of elements whose file states none: that of the recipe, with defaults for absent numbers.
    material: Material,
    matter: Matter,
    /// Factor on the lengths of its files.
    factor: f64,
    /// Origin of the shape.
    pub source: String,
    /// A note, such as the file that an embedded shape replaces, the numbers of a file that the material overrides, or
    /// warnings about a file.
    pub note: Option<String>,
    /// Rotation from the axes of the file to those of an upright shape, z up.
    pub upright: DQuat,
    /// The lattice around a surface.
    around: OnceCell<SolidSource>,
}

impl<'a> LoadedRecipe<'a> {
    /// Reads or generates the shape. `models` is the folder of real models; without it embedded shapes replace
    /// them.
    ///
    /// # Errors
    /// When a file cannot be read; when a resolution is given for a solid or a model; when the material or the size is
    /// out of range; when a surface leaves its solid; when a model has no forces or no mass, or is in other units than
    /// metres; when `watch` cancels.
    pub fn load(recipe: &'a Recipe, models: Option<&Path>, watch: &dyn Watch) -> Result<Self, TaskError> {
        watch.begin(Stage::Solid);
        let loaded = recipe.shape.load(models, &recipe.material, recipe.resize, watch)?;
        let LoadedShape { matter, source, note, factor } = loaded;
        if let Matter::Solid(solid) = &matter {
            solid.note().into_iter().for_each(|note| watch.note(&format!("{source}: {note}")));
        }
        if recipe.cells.is_some() && !matches!(matter, Matter::Surface(_)) {
            let cause = "resolution is for surfaces; the file of a solid has its own elements";
            return Err(TaskError::refused(source, cause));
        }
        // The files of bunny and dragon have y up, embedded shapes have z up.
        let is_turned = models.is_some() && matches!(recipe.shape, Shape::Bunny | Shape::Dragon);
        let upright =
            if is_turned { DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2) } else { DQuat::IDENTITY };
        let material = Material::new(&recipe.material).at(|| source.clone())?;
        Ok(Self { recipe, material, matter, factor, source, note, upright, around: OnceCell::new() })
    }

    /// Returns the recipe.
    pub fn recipe(&self) -> &Recipe {
        self.recipe
    }

    /// Returns the model of a recipe whose file contains modes.
    pub(crate) fn given(&self) -> Option<&GivenModel> {
        if let Matter::Model(given) = &self.matter { Some(given) } else { None }
    }

    /// Returns the key of a cached file that depends on this solid.
    pub(crate) fn key(&self, kind: &str) -> Key {
        let fix = self.fix();
        let key = Key::new(kind).text(&format!("{:?} {:?} {fix:?}", self.material, self.recipe.cells()));
        match &self.matter {
            Matter::Surface(mesh) => key.mesh(mesh),
            Matter::Solid(source) => key.text(&format!("{:?}", source.solid())).mesh(source.mesh()),
            Matter::Model(given) => key.model(&given.model),
        }
    }

    /// Returns the selection of fixed vertices, at the scale of the body.
    fn fix(&self) -> Option<Fix> {
        self.recipe.fix.as_ref().map(|fix| fix.scaled(self.factor))
    }

    /// Returns the solid with its surface; builds the lattice at the first call.
    fn solid(&self, watch: &dyn Watch) -> Result<&SolidSource, TaskError> {
        let mesh = match &self.matter {
            Matter::Solid(source) => return Ok(source),
            Matter::Surface(mesh) => mesh,
            Matter::Model(_) => {
                return Err(TaskError::refused(
                    self.source.as_str(),
                    "a model with modes has no solid of its own",
                ));
            }
        };
        if let Some(source) = self.around.get() {
            return Ok(source);
        }
        watch.begin(Stage::Solid);
        let Recipe { material, .. } = self.recipe;
        let around = SolidSource::around(mesh.clone(), self.recipe.cells(), material, watch);
        let around = around.at(|| self.source.clone())?;
        Ok(self.around.get_or_init(|| around))
    }

    /// Computes modes. This takes up to some minutes.
    pub(crate) fn modes(
        &self,
        modes: ModesSpec,
        watch: &dyn Watch,
    ) -> Result<(ReducedModel, ModelInfo), TaskError> {
        let source = self.solid(watch)?;
        let fixed = match self.fix() {
            Some(fix) => fix.vertices(source).at(|| format!("{}: fix", self.recipe.name))?,
            None => Vec::new(),
        };
        watch.begin(Stage::Modes);
        let (kind, rank) = match modes {
            ModesSpec::Linear(rank) => (ModesKind::Linear, Some(rank)),
            ModesSpec::Nonlinear(rank) => (ModesKind::Nonlinear, Some(rank)),
            ModesSpec::Polynomial => (ModesKind::Polynomial, None),
            ModesSpec::Given => {
                return Err(TaskError::refused(self.source.as_str(), "this file has no modes"));
            }
        };
        let ElasticModes { solid, on_surface, mass } =
            ElasticModes::new(source, kind, rank, &fixed, watch).at(|| self.source.clone())?;
        let model = ReducedModel::with_metric(source.mesh().clone(), on_surface, solid.energy_metric()?)?;
        let info = ModelInfo::new("", format!("{}, {modes:?}", self.source));
        Ok((model, info.with_elasticity(solid.elasticity).with_mass(mass)))
    }
}

#[cfg(test)]
mod tests {
    use sscc::MetricKind;
    use sscc_solid::PartialMaterial;

    use super::*;

    #[test]
    fn no_cells_and_the_default_cells_of_a_shape_have_the_same_key() {
        let key = |cells| {
            let recipe = Recipe { cells, ..Recipe::new("spring", Shape::SMALL_SPRING, ModesSpec::Linear(6)) };
            LoadedRecipe::load(&recipe, None, &()).unwrap().key("model").to_string()
        };
        assert_eq!(key(None), key(Some(30)));
        assert_ne!(key(None), key(Some(30 + 1)));
    }

    /// A tetrahedron of a soft material.
    const SOFT: &str = "*VERTICES\n4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n*ELEMENTS\nTET\n1 4 0\n1 1 2 3 4\n\
        *MATERIAL soft\nENU, 1000, 1e6, 0.4\n*REGION\nallElements, soft\n";

    #[test]
    fn the_material_of_a_scene_overrides_that_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("soft.veg");
        std::fs::write(&file, SOFT).unwrap();
        let first = |material: PartialMaterial| {
            let recipe = Recipe::new("soft", Shape::File(file.clone()), ModesSpec::Linear(6));
            let recipe = Recipe { material, ..recipe };
            let loaded = LoadedRecipe::load(&recipe, None, &()).unwrap();
            let (_, info) = loaded.modes(ModesSpec::Linear(6), &()).unwrap();
            let first = info.elasticity.unwrap().stiffness().entries()[0];
            (first, loaded.note.clone(), loaded.key("model").to_string())
        };
        let (own, nothing, key) = first(PartialMaterial::default());
        assert_eq!(nothing, None);
        let (stiff, note, of_stiff) =
            first(PartialMaterial { youngs_modulus: Some(4e6), ..Default::default() });
        assert!((stiff / own - 4.0).abs() < 1e-9, "{own} {stiff}");
        let expected = "the scene's material overrides numbers of soft.veg: youngs=4e6";
        assert_eq!(note.as_deref(), Some(expected));
        assert_ne!(key, of_stiff);
    }

    /// Keeps notes.
    #[derive(Default)]
    struct Notes(std::sync::Mutex<Vec<String>>);

    impl sscc::Progress for Notes {
        fn report(&self, _done: usize, _total: usize) {}
    }

    impl Watch for Notes {
        fn begin(&self, _stage: Stage) {}

        fn note(&self, note: &str) {
            self.0.lock().unwrap().push(note.into());
        }
    }

    #[test]
    fn warnings_about_an_embedded_surface_are_a_note() {
        let folder = tempfile::tempdir().unwrap();
        let [surface, solid] = ["bent.obj", "soft.veg"].map(|name| folder.path().join(name));
        let bent = "v 0.1 0.1 0.1\nv 0.3 0.1 0.1\nv 0.3 0.3 0.2\nv 0.1 0.3 0.1\nf 1 2 3 4\n";
        std::fs::write(&surface, bent).unwrap();
        std::fs::write(&solid, SOFT).unwrap();
        let recipe = Recipe::new("soft", Shape::Embedded { surface, solid }, ModesSpec::Linear(6));
        let notes = Notes::default();
        LoadedRecipe::load(&recipe, None, &notes).unwrap();
        let notes = notes.0.into_inner().unwrap();
        let is_of_surface =
            |note: &&String| note.starts_with("bent.obj in soft.veg: ") && note.contains("are not plane");
        assert_eq!(notes.iter().filter(is_of_surface).count(), 1, "{notes:?}");
    }

    #[test]
    fn faces_that_a_solid_leaves_out_are_a_note() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("sheet.mesh");
        let text = "MeshVersionFormatted 1\nDimension 3\nVertices 5\n0 0 0 0\n4 0 0 0\n0 4 0 0\n0 0 4 0\n1 1 -4 0\n\
                    Tetrahedra 2\n1 2 3 4 0\n1 3 2 5 0\nTriangles 1\n1 4 5 0\nEnd\n";
        std::fs::write(&file, text).unwrap();
        let recipe = Recipe::new("sheet", Shape::File(file), ModesSpec::Linear(6));
        let notes = Notes::default();
        LoadedRecipe::load(&recipe, None, &notes).unwrap();
        let expected = "sheet.mesh: 1 triangles of the file belong to no element of the solid: they have no elasticity and \
                        are left out";
        assert_eq!(notes.0.into_inner().unwrap(), [expected]);
    }

    #[test]
    fn amplitudes_are_the_units_of_certificates() {
        let plain = Recipe::new("spring", Shape::SMALL_SPRING, ModesSpec::Linear(6));
        let (model, _) =
            LoadedRecipe::load(&plain, None, &()).unwrap().modes(ModesSpec::Linear(6), &()).unwrap();
        assert_eq!(&plain.metric(&model).unwrap(), model.metric());
        let amplitudes = vec![0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
        let metric = Recipe { amplitudes: Some(amplitudes.clone()), ..plain }.metric(&model).unwrap();
        assert_eq!(metric.kind(), MetricKind::Given);
        assert!((metric.norm(&amplitudes).unwrap() - 6.0_f64.sqrt()).abs() < 1e-12);
    }
}
