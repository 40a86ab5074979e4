//! Table of the compared methods.

use parry3d_f64::partitioning::BvhBuildStrategy;
use sscc::{Method, Query};
use sscc_tasks::CertifiedModel;

use super::engine::Engine;
use super::parry::Parry;
use crate::error::Error;

/// One column of the tables. If several columns have the same key, the one with the smallest mean is reported.
pub struct Column {
    /// Its name in tables and JSON.
    pub key: &'static str,
    /// Role, which determines the steps on which the method runs, and whether its answers are compared.
    pub role: Role,
    make: for<'a> fn(&'a CertifiedModel) -> Result<Box<dyn Engine + 'a>, Error>,
}

/// Role of a method in a bench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Our method: runs on all steps.
    Certified,
    /// A method for comparison: runs on a sample if there are many steps.
    Comparator,
    /// A comparator that may miss pairs.
    Approximate,
}

use Role::{Approximate, Certified, Comparator};

/// All methods, in the order in which they are interleaved.
pub const COLUMNS: &[Column] = &[
    Column { key: "traditional", role: Comparator, make: |model| uncertified(model, Method::Traditional) },
    Column { key: "bdtree", role: Comparator, make: |model| uncertified(model, Method::BdTree) },
    Column { key: "normal_cones", role: Comparator, make: |model| uncertified(model, Method::NormalCones) },
    Column { key: "normal_cones_approx", role: Approximate, make: approximate_cones },
    Column { key: "paper", role: Certified, make: paper },
    Column { key: "full", role: Certified, make: full },
    Column { key: "parry", role: Comparator, make: |model| parry(model, BvhBuildStrategy::Binned) },
    Column { key: "parry", role: Comparator, make: |model| parry(model, BvhBuildStrategy::Ploc) },
];

impl Column {
    /// Creates the method for one model.
    ///
    /// # Errors
    /// When the model lacks the certificates that the method needs, or they are of another model.
    pub fn engine<'a>(&self, model: &'a CertifiedModel) -> Result<Box<dyn Engine + 'a>, Error> {
        (self.make)(model)
    }
}

fn uncertified(model: &CertifiedModel, method: Method) -> Result<Box<dyn Engine + '_>, Error> {
    Ok(Box::new(Query::with_method(&model.model, &model.full.certificates, method)?))
}

fn approximate_cones(model: &CertifiedModel) -> Result<Box<dyn Engine + '_>, Error> {
    Ok(Box::new(Query::with_approximate_cones(&model.model, &model.full.certificates)?))
}

fn paper(model: &CertifiedModel) -> Result<Box<dyn Engine + '_>, Error> {
    let paper = model.paper.as_ref().ok_or(Error::NoPaperCertificates)?;
    Ok(Box::new(Query::new(&model.model, &paper.certificates)?))
}

fn full(model: &CertifiedModel) -> Result<Box<dyn Engine + '_>, Error> {
    Ok(Box::new(Query::new(&model.model, &model.full.certificates)?))
}

fn parry(model: &CertifiedModel, strategy: BvhBuildStrategy) -> Result<Box<dyn Engine + '_>, Error> {
    Ok(Box::new(Parry::new(&model.model, strategy)))
}
