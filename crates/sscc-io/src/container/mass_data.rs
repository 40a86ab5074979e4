//! Mass data in a model file: `mass_properties` (13 numbers), `mode_moments` (r x 3), and the text `support`.

use glam::{DMat3, DVec3};
use sscc_solid::{MassData, MassProperties};

use super::{Container, ContainerWriter};
use crate::error::quoted;
use crate::{FormatError, Place};

pub(super) const PROPERTIES: &str = "mass_properties";
pub(super) const MOMENTS: &str = "mode_moments";

/// Key of the text entry for fixed vertices.
const SUPPORT: &str = "support";
/// The values of this text: the body moves freely, or some of its vertices are fixed.
const SUPPORTS: [&str; 2] = ["free", "held"];

/// Number of mass properties: mass, centre (3), inertia (9).
const NUMBERS: usize = 13;

/// Adds the mass data of a model of rank r.
///
/// # Errors
/// When there is not one moment for each mode.
pub(super) fn write(writer: &mut ContainerWriter, data: &MassData, rank: usize) -> Result<(), FormatError> {
    let MassData { properties, moments, is_held } = data;
    if moments.len() != rank {
        let cause = format!("it has {} moments, but the model has {rank} modes", moments.len());
        return Err(FormatError::new(Place::Tensor(MOMENTS.into()), cause));
    }
    let mut numbers = vec![properties.mass];
    numbers.extend(properties.center.to_array());
    numbers.extend(properties.inertia.to_cols_array());
    let moments: Vec<f64> = moments.iter().flat_map(|moment| moment.to_array()).collect();
    writer.text(SUPPORT, SUPPORTS[usize::from(*is_held)]).f64(PROPERTIES, &[NUMBERS], &numbers).f64(
        MOMENTS,
        &[rank, 3],
        &moments,
    );
    Ok(())
}

/// Reads the mass data of a model of rank r; None if the file has none.
///
/// # Errors
/// When the mass is not positive, a number is not finite, the support is unknown, or an entry is missing or has another
/// type or shape.
pub(super) fn read(file: &Container<'_>, rank: usize) -> Result<Option<MassData>, FormatError> {
    let names = file.names();
    if ![PROPERTIES, MOMENTS].into_iter().any(|name| names.iter().any(|known| known == name)) {
        return Ok(None);
    }
    let properties = file.f64(PROPERTIES)?.shaped(&[NUMBERS])?.values;
    let moments = file.f64(MOMENTS)?.shaped(&[rank, 3])?.values;
    for (name, numbers) in [(PROPERTIES, &properties), (MOMENTS, &moments)] {
        if let Some(value) = numbers.iter().find(|value| !value.is_finite()) {
            let cause = format!("a number is {value}: finite numbers were expected");
            return Err(FormatError::new(Place::Tensor(name.into()), cause));
        }
    }
    let mass = properties[0];
    if mass <= 0.0 {
        let cause = format!("the mass is {mass:e}: it must be positive");
        return Err(FormatError::new(Place::Tensor(PROPERTIES.into()), cause));
    }
    let support = file.text(SUPPORT)?;
    let Some(is_held) = SUPPORTS.iter().position(|known| *known == support) else {
        let cause = format!("unknown support {}: free or held was expected", quoted(support));
        return Err(FormatError::new(Place::Key(SUPPORT.into()), cause));
    };
    let inertia = std::array::from_fn(|k| properties[4 + k]);
    Ok(Some(MassData {
        properties: MassProperties {
            mass,
            center: DVec3::from_slice(&properties[1..4]),
            inertia: DMat3::from_cols_array(&inertia),
        },
        moments: moments.as_chunks().0.iter().map(|moment| DVec3::from_array(*moment)).collect(),
        is_held: is_held == 1,
    }))
}
