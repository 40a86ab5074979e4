//! The curves in which a mesh intersects itself or another one, and the contact of each colliding pair of triangles.

mod contact_curves;
mod mesh_feature;
mod pair_contact;
mod polylines;
mod surface;

pub use contact_curves::{ContactCurve, ContactCurves, CurvePoint, contact_curves, contact_curves_between};
pub use mesh_feature::MeshFeature;
pub use pair_contact::PairContact;
pub use surface::Surface;
