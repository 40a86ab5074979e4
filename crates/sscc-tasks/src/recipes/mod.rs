//! Models from recipes (a shape, a material and a kind of modes), computed once with certificates, then read from a
//! cache.

mod cache;
mod certified_model;
mod given_model;
mod key;
mod loaded_recipe;
mod recipe;
mod shape;
mod timed_certificates;

pub use cache::Cache;
pub use certified_model::{CertifiedModel, vibrations};
pub use given_model::ModelFiles;
pub use loaded_recipe::LoadedRecipe;
pub use recipe::{ModesSpec, Recipe};
pub use shape::{SPRING_RINGS, Shape, models_folder};
pub use timed_certificates::{CertificateCost, TimedCertificates};
