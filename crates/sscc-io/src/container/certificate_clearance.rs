//! The clearance in certificate files: the optional tensors `clearance` and `clearance_rings`.

use sscc::Clearance;

use super::{Container, ContainerWriter};
use crate::{FormatError, Place};

/// Tensor: the clearance that triangles keep below the radii.
pub(super) const CLEARANCE: &str = "clearance";

/// Tensor: the number of rings within which pairs do not count.
pub(super) const RINGS: &str = "clearance_rings";

/// The first version with clearances.
pub(super) const VERSION: u32 = 8;

/// Writes the clearance, if there is one.
pub(super) fn write(writer: &mut ContainerWriter, clearance: Option<Clearance>) {
    if let Some(clearance) = clearance {
        writer.f64(CLEARANCE, &[1], &[clearance.distance()]).u32(RINGS, &[1], &[clearance.rings()]);
    }
}

/// Reads the clearance, if there is one.
pub(super) fn read(file: &Container<'_>) -> Result<Option<Clearance>, FormatError> {
    let Some(name) = file.names().into_iter().find(|name| name == CLEARANCE || name == RINGS) else {
        return Ok(None);
    };
    if file.version() < VERSION {
        return Err(FormatError::new(Place::Tensor(name), "not known in this version of the format"));
    }
    let (distance, rings) = (file.f64(CLEARANCE)?.shaped(&[1])?, file.u32(RINGS)?.shaped(&[1])?);
    let clearance =
        Clearance::new(distance.values[0]).map_err(|error| distance.refused(error.to_string()))?;
    Ok(Some(clearance.beyond_rings(rings.values[0])))
}
