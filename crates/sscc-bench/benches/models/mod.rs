//! Models of the benches.
#![allow(dead_code)]

use std::error::Error;

use sscc::{CertifyOptions, ReducedModel, TriMesh};
use sscc_io::{load_model, read_mesh};
use sscc_modes::{polynomial_modes, shapes};

/// Any error ends a bench.
pub type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A model with the options of its certificates.
pub struct Case {
    pub name: &'static str,
    pub model: ReducedModel,
    pub options: CertifyOptions,
}

/// Returns the embedded shapes and the available real models, the slowest last.
pub fn all() -> Result<Vec<Case>> {
    let polynomial = |name, mesh: TriMesh| -> Result<Case> {
        let modes = polynomial_modes(&mesh)?;
        Ok(Case::new(name, ReducedModel::new(mesh, modes)?))
    };
    let mut cases = vec![polynomial("spring", shapes::spring())?, polynomial("hare", shapes::hare())?];
    let Some(folder) = sscc_testing::models("the benches on real models") else { return Ok(cases) };
    let (letter, modes) = (folder.join("vega_A/A.obj"), folder.join("vega_A/A.URendering.float"));
    cases.insert(0, Case::new("vega_A", load_model(&letter, Some(&modes))?.0));
    cases.push(polynomial("bunny", read_mesh(&folder.join("bunny_14964_closed.obj"))?)?);
    if let Some((model, _)) = face()? {
        let case = Case::new("ict_face, rest ignored", model);
        cases.push(Case { options: case.options.ignore_rest(0), ..case });
    }
    cases.push(polynomial("dragon", read_mesh(&folder.join("dragon_77202_closed.ply"))?)?);
    Ok(cases)
}

impl Case {
    fn new(name: &'static str, model: ReducedModel) -> Self {
        Self { name, model, options: CertifyOptions::default() }
    }
}

/// Returns the face with its published configurations; None without real models.
pub fn face() -> Result<Option<(ReducedModel, Vec<Vec<f64>>)>> {
    let Some(folder) = sscc_testing::models("the benches on a face") else { return Ok(None) };
    let folder = folder.join("ict_face");
    let modes = folder.join("ict_face_expressions30.U.float");
    let (model, _) = load_model(&folder.join("ict_face_neutral.obj"), Some(&modes))?;
    let text = std::fs::read_to_string(folder.join("ict_face_selfcollision_cases.json"))?;
    let json: serde_json::Value = serde_json::from_str(&text)?;
    let cases = json["cases"].as_array().ok_or("cases")?;
    let q = cases.iter().map(|case| Ok(serde_json::from_value(case["q"].clone())?));
    Ok(Some((model, q.collect::<Result<_>>()?)))
}
