//! Data types of elastic solids: elements, materials and reduced forces.
//!
//! `sscc-io` reads and writes these types, `sscc-modes` computes modes from them, and `sscc-dynamics` simulates them.
//!
//! - [`VolumeMesh`]: tetrahedra and cubes of a file, before the checks of geometry;
//! - [`Solid`]: elements of positive volume, each with a [`Material`]; [`VolumeMesh::solid`] creates one;
//! - [`PartialMaterial`]: the known properties of a material; [`Material::new`] fills in the others;
//! - [`Element`]: one tetrahedron, of first or second order, or cube with its integration points;
//! - [`Boundary`] and [`MassProperties`] of a solid, [`MassData`] of a reduced model;
//! - [`Stiffness`], [`ReducedForces`] and [`Elasticity`]: elastic forces as functions of q;
//!
//! Constructors check their data, so functions can rely on valid values.
//!
//! ```
//! use glam::DVec3;
//! use sscc_solid::{Material, PartialMaterial, Solid};
//!
//! # fn main() -> Result<(), sscc_solid::SolidError> {
//! // A tetrahedron of soft rubber; unset properties are those of the default material.
//! let soft = PartialMaterial { youngs_modulus: Some(1e5), ..PartialMaterial::default() };
//! let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let solid = Solid::uniform(corners, vec![[0, 1, 2, 3]], vec![], Material::new(&soft)?)?;
//! assert_eq!(solid.boundary()?.mesh.faces().len(), 4);
//! assert!((solid.mass_properties().mass - 1000.0 / 6.0).abs() < 1e-9);
//! # Ok(())
//! # }
//! ```

mod boundary;
mod elasticity;
mod element;
mod error;
mod forces;
mod integration_point;
mod interior;
mod mass;
mod mass_data;
mod material;
mod meshed_solid;
pub mod monomials;
mod order_elevation;
mod second_order;
mod solid;
mod stiffness;
mod volume_mesh;

pub use boundary::Boundary;
pub use elasticity::Elasticity;
pub use element::Element;
pub use error::SolidError;
pub use forces::ReducedForces;
pub use integration_point::IntegrationPoint;
pub use interior::tets_within;
pub use mass::MassProperties;
pub use mass_data::MassData;
pub use material::{Material, MaterialError, NamedMaterial, PartialMaterial};
pub use meshed_solid::MeshedSolid;
pub use solid::Solid;
pub use stiffness::Stiffness;
pub use volume_mesh::{VolumeMesh, VolumeMeshParts};
