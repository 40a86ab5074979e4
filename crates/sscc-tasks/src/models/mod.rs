//! Models of elastic solids, of surfaces and of frames, made from files or meshes.

mod elastic;
mod equal_vertices;
mod fix;
mod material;
mod new_model;
mod pca;
mod polynomial;
mod source;

pub(crate) use elastic::ElasticModes;
pub use elastic::{ModesKind, POLYNOMIAL_MODES_ERROR, elastic_model};
pub use equal_vertices::has_equal_vertices;
pub use fix::Fix;
pub use material::MaterialOrigin;
pub use new_model::{Components, NewModel, SolidFacts};
pub use pca::pca_model;
pub use polynomial::polynomial_model;
pub(crate) use source::read_embedded;
pub use source::read_surface;
pub use source::{SolidSource, is_solid};
