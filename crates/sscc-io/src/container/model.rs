//! Reader and writer for models: `*.model.safetensors`.
//!
//! | tensor | type | shape | |
//! | --- | --- | --- | --- |
//! | `rest_positions` | F64 | V x 3 | model unit |
//! | `faces` | U32 | N x 3 | vertex numbers from 0 |
//! | `modes` | F64 | V x 3 x r | NumPy's `modes.reshape(3 * V, r)` is U |
//! | `metric_scales` | F64 | r | the diagonal of the default metric's factor S, or |
//! | `metric_factor` | F64 | r x r | S itself, upper triangular, where it is not diagonal |
//! | `stiffness` | F64 | r x r | optional: the reduced stiffness `K~` at rest, symmetric |
//! | `forces_quadratic` | F64 | r x r(r+1)/2 | optional, with `stiffness`: coefficients of `q_i q_j` in each force, i <= j |
//! | `forces_cubic` | F64 | r x r(r+1)(r+2)/6 | with `forces_quadratic`: coefficients of `q_i q_j q_k`, i <= j <= k, in lexicographic order |
//! | `mass_properties` | F64 | 13 | optional: mass, centre of mass, inertia about it (3 x 3) at rest |
//! | `mode_moments` | F64 | r x 3 | with `mass_properties`: the integral of each mode over the mass |
//! | `deviations` | F64 | r | optional, for principal components: the standard deviation of each entry of q |
//!
//! Text: `metric` (the kind of the metric), `units`, `provenance`. A file with a stiffness also has the text `mass`
//! with the value "identity": the modes are mass-orthonormal, and `M~` is the identity. The natural frequencies in Hz
//! are then the square roots of the stiffness's eigenvalues over 2 pi, if the unit of time is the second. A file with
//! mass properties has the text `support`: "held" if vertices of the body are fixed, else "free". Mass properties are new
//! in version 2 and deviations in version 3. A file is written in the first version that has all of its contents.

use std::path::Path;

use glam::DVec3;
use sscc::{Modes, ReducedModel, TriMesh};
use sscc_solid::{Elasticity, MassData};

use super::{ANY, Container, ContainerWriter, Kind, MODEL, elasticity, mass_data, metric};
use crate::file::{read_whole, write_whole};
use crate::{FormatError, IoError, Place};

/// Additional data of a model file. Texts have any content, and are empty if unknown.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ModelInfo {
    /// Unit of length ("m", "cm", ...).
    pub units: String,
    /// Source of the mesh and the modes.
    pub provenance: String,
    /// Elastic forces, if known.
    pub elasticity: Option<Elasticity>,
    /// Mass and support, if known.
    pub mass: Option<MassData>,
    /// The standard deviation of each entry of q (r), for modes from principal components.
    pub deviations: Option<Vec<f64>>,
}

/// The tensor of the standard deviations.
const DEVIATIONS: &str = "deviations";

/// Version of files with neither mass properties nor deviations, which earlier builds read.
const VERSION_WITHOUT_MASS: u32 = 1;

/// Version of files with mass properties but without deviations, which earlier builds read.
const VERSION_WITHOUT_DEVIATIONS: u32 = 2;

impl ModelInfo {
    /// Creates the data from these texts, without forces, mass and deviations.
    pub fn new(units: impl Into<String>, provenance: impl Into<String>) -> Self {
        Self { units: units.into(), provenance: provenance.into(), ..Self::default() }
    }

    /// Adds elastic forces of a model whose modes are mass-orthonormal.
    #[must_use]
    pub fn with_elasticity(self, elasticity: Elasticity) -> Self {
        Self { elasticity: Some(elasticity), ..self }
    }

    /// Adds mass and support.
    #[must_use]
    pub fn with_mass(self, mass: MassData) -> Self {
        Self { mass: Some(mass), ..self }
    }
}

/// Writes a model. Reading returns the same numbers, bit for bit.
///
/// # Errors
/// When the texts are beyond 1 MiB, elastic forces, mass data or deviations are of another rank, a deviation is negative or
/// not finite, or the file cannot be written.
pub fn write_model(path: &Path, model: &ReducedModel, info: &ModelInfo) -> Result<(), IoError> {
    write_whole(path, &model_to_bytes(model, info).map_err(|error| error.of(path))?)
}

/// Reads a model.
///
/// # Errors
/// When the file cannot be read, is damaged, of another kind or a newer version, or its content is not a valid model.
pub fn read_model(path: &Path) -> Result<(ReducedModel, ModelInfo), IoError> {
    model_from_bytes(&read_whole(path)?).map_err(|error| error.of(path))
}

/// Returns the bytes of a model file.
///
/// # Errors
/// When the texts are beyond 1 MiB, elastic forces, mass data or deviations are of another rank, or a deviation is negative
/// or not finite.
pub fn model_to_bytes(model: &ReducedModel, info: &ModelInfo) -> Result<Vec<u8>, FormatError> {
    let (mesh, modes) = (model.mesh(), model.modes());
    let (vertices, rank) = (modes.vertices(), modes.rank());
    let positions: Vec<f64> = mesh.rest_positions().iter().flat_map(|p| p.to_array()).collect();
    let by_axis: Vec<f64> = modes
        .displacements()
        .chunks_exact(rank)
        .flat_map(|of_vertex| (0..3).flat_map(move |axis| of_vertex.iter().map(move |u| u[axis])))
        .collect();
    let version = match (&info.deviations, &info.mass) {
        (Some(_), _) => MODEL.version,
        (None, Some(_)) => VERSION_WITHOUT_DEVIATIONS,
        (None, None) => VERSION_WITHOUT_MASS,
    };
    let mut writer = ContainerWriter::new(Kind { version, ..MODEL });
    metric::write(&mut writer, model.metric());
    if let Some(forces) = &info.elasticity {
        elasticity::write(&mut writer, forces, rank)?;
    }
    if let Some(mass) = &info.mass {
        mass_data::write(&mut writer, mass, rank)?;
    }
    if let Some(deviations) = &info.deviations {
        if deviations.len() != rank {
            let cause = format!("it has {} numbers, but the model has {rank} modes", deviations.len());
            return Err(FormatError::new(Place::Tensor(DEVIATIONS.into()), cause));
        }
        check_deviations(deviations)?;
        writer.f64(DEVIATIONS, &[rank], deviations);
    }
    writer
        .text("units", &info.units)
        .text("provenance", &info.provenance)
        .f64("rest_positions", &[vertices, 3], &positions)
        .u32("faces", &[mesh.faces().len(), 3], mesh.faces().as_flattened())
        .f64("modes", &[vertices, 3, rank], &by_axis);
    writer.finish()
}

/// Parses a model file.
///
/// # Errors
/// As [`read_model`], without the file's name.
pub fn model_from_bytes(bytes: &[u8]) -> Result<(ReducedModel, ModelInfo), FormatError> {
    let file = Container::parse(bytes, MODEL)?;
    file.only(&[
        DEVIATIONS,
        "faces",
        elasticity::CUBIC,
        elasticity::QUADRATIC,
        mass_data::MOMENTS,
        mass_data::PROPERTIES,
        metric::FACTOR,
        metric::SCALES,
        "modes",
        "rest_positions",
        elasticity::STIFFNESS,
    ])?;
    let positions = file.f64("rest_positions")?.shaped(&[ANY, 3])?;
    let vertices = positions.shape[0];
    let positions = positions.values.as_chunks().0.iter().map(|p| DVec3::from_array(*p)).collect();
    let faces = file.u32("faces")?.shaped(&[ANY, 3])?.values.as_chunks().0.to_vec();
    let modes = file.f64("modes")?.shaped(&[vertices, 3, ANY])?;
    let rank = modes.shape[2];
    let metric = metric::read(&file, rank)?;
    let mesh = TriMesh::new(positions, faces)?;
    let modes = Modes::from_matrix(vertices, rank, |row, k| modes.values[row * rank + k])?;
    let model = ReducedModel::with_metric(mesh, modes, metric)?;
    // The model has a vertex, so the size of its modes bounds the rank.
    let elasticity = elasticity::read(&file, rank)?;
    let mass = mass_data::read(&file, rank)?;
    let deviations = read_deviations(&file, rank)?;
    let info = ModelInfo::new(file.text("units")?, file.text("provenance")?);
    Ok((model, ModelInfo { elasticity, mass, deviations, ..info }))
}

/// Reads the standard deviations of a model of rank r; None if the file has none.
fn read_deviations(file: &Container<'_>, rank: usize) -> Result<Option<Vec<f64>>, FormatError> {
    if !file.names().iter().any(|name| name == DEVIATIONS) {
        return Ok(None);
    }
    let deviations = file.f64(DEVIATIONS)?.shaped(&[rank])?.values;
    check_deviations(&deviations)?;
    Ok(Some(deviations))
}

/// Returns an error if a standard deviation is negative or not finite.
fn check_deviations(deviations: &[f64]) -> Result<(), FormatError> {
    match deviations.iter().find(|deviation| !(deviation.is_finite() && **deviation >= 0.0)) {
        None => Ok(()),
        Some(wrong) => {
            let cause = format!("a number is {wrong}: finite numbers of at least 0 were expected");
            Err(FormatError::new(Place::Tensor(DEVIATIONS.into()), cause))
        }
    }
}

#[cfg(test)]
mod tests;
