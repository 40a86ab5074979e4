//! Checks that certificates were computed for a given model and contact filter. For any other they prove nothing.

use super::{Certificates, Digest};
use crate::{ContactFilter, Error, ReducedModel};

impl Certificates {
    /// Refuses a model for which these certificates were not computed.
    ///
    /// # Errors
    /// When faces, positions or modes differ in any bit from the certified ones, or when hierarchy, metric, centre,
    /// contact filter or exceptions do not fit the model.
    pub fn check_model(&self, model: &ReducedModel) -> Result<(), Error> {
        let (parts, scope) = (self.parts(), &self.parts().scope);
        let found = Digest::of(model, scope);
        if found != parts.digest {
            return Err(Error::OtherModel { certificates: parts.digest.short(), model: found.short() });
        }
        let damaged = |cause: &str| Err(Error::Certificates(cause.to_owned()));
        let triangles = model.mesh().faces().len();
        if parts.hierarchy.order().len() != triangles {
            return damaged("the hierarchy is of another mesh");
        }
        if scope.metric.rank() != model.rank() {
            return damaged("the metric is of another rank");
        }
        if scope.exceptions.iter().chain(scope.filter.ignored()).any(|(_, b)| *b as usize >= triangles) {
            return damaged("a pair names a triangle that does not exist");
        }
        scope.filter.check_model(triangles)?;
        model.check_coordinates(self.center()).map(|_| ())
    }
}

/// Refuses a contact filter under which other pairs count than those that were certified.
///
/// # Errors
/// When neighbours, weld, ignored pairs or groups differ.
pub fn check_filter(certificates: &Certificates, filter: &ContactFilter) -> Result<(), Error> {
    let certified = certificates.filter();
    let what = if certified.neighbours != filter.neighbours {
        let [certified, requested] = [certified, filter].map(|filter| filter.neighbours);
        format!("they have neighbours = {certified}, but {requested} was requested")
    } else if certified.weld != filter.weld {
        format!("they were computed with{} welding", if certified.weld { "" } else { "out" })
    } else if certified.ignored() != filter.ignored() {
        let [certified, requested] = [certified, filter].map(|filter| filter.ignored().len());
        format!("their {certified} ignored pairs differ from the {requested} requested ones")
    } else if certified.groups() != filter.groups() {
        match (certified.groups(), filter.groups()) {
            (None, _) => "they were computed without groups of triangles".to_owned(),
            (_, None) => "they leave out pairs of groups of triangles, which were not requested".to_owned(),
            _ => "their groups of triangles, or which pairs of them count, differ from the requested ones"
                .to_owned(),
        }
    } else {
        return Ok(());
    };
    Err(Error::OtherPairs { what })
}
