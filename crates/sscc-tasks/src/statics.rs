//! The static configuration of a model from a file under a load.

use glam::DVec3;
use sscc::ReducedModel;
use sscc_io::{ModelInfo, Setting};
use sscc_modes::{generalized_forces, static_configuration};

use crate::TaskError;
use crate::error::Result;

/// The linear static configuration under a load.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticAnswer {
    /// The configuration.
    pub q: Vec<f64>,
    /// The largest displacement of a vertex (m).
    pub largest: f64,
    /// That vertex.
    pub vertex: u32,
}

/// Returns the linear static configuration of a model with stiffness under forces on vertices (N), and under `gravity`
/// (m/s^2) on its whole mass: see [`static_configuration`].
///
/// # Errors
/// When the model has no stiffness, or for gravity no mass; when a vertex does not exist; when the load has no static
/// configuration, or has one that queries refuse.
pub fn static_answer(
    model: &ReducedModel,
    info: &ModelInfo,
    forces: &[(u32, DVec3)],
    gravity: Option<DVec3>,
) -> Result<StaticAnswer> {
    let Some(elasticity) = &info.elasticity else {
        let cause = "compute it from a solid with sscc modes " + Setting::Kind + " linear";
        return Err(TaskError::refused("the model has no stiffness", cause));
    };
    let mut generalized = generalized_forces(model.modes(), forces)?;
    if let Some(gravity) = gravity {
        let Some(mass) = &info.mass else {
            let cause = "compute it again with sscc modes, which states it";
            return Err(TaskError::refused("the model states no mass", cause));
        };
        generalized.iter_mut().zip(&mass.moments).for_each(|(sum, moment)| *sum += moment.dot(gravity));
    }
    let q = static_configuration(elasticity.stiffness(), &generalized)?;
    if model.check_coordinates(&q).is_err() {
        let cause = "its vertices would be beyond 2^200, where no shape is checked; give smaller forces";
        return Err(TaskError::refused("the load has no answer that is a shape", cause));
    }
    let displacement = |v: u32| -> f64 {
        model.modes().of_vertex(v).iter().zip(&q).map(|(u, q)| *u * *q).sum::<DVec3>().length()
    };
    let vertices = model.mesh().rest_positions().len() as u32;
    let larger =
        |found: (f64, u32), v: u32| if displacement(v) > found.0 { (displacement(v), v) } else { found };
    let (largest, vertex) = (0..vertices).fold((0.0, 0), larger);
    Ok(StaticAnswer { q, largest, vertex })
}
