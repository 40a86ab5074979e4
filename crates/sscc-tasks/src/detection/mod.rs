//! Collisions of meshes without modes: at rest, in frames from files, or in an animation of a glTF file; with
//! themselves or with another mesh.
//!
//! [`detect`] answers a [`Detection`] query by query, in a fixed order, on several threads. [`check_rows`] answers
//! queries of a model with modes in the same form.

mod answer;
mod contacts;
mod detect;
mod ignored_between;
mod in_order;
mod interval_tree;
mod mesh_source;
mod moving_mesh;
mod near;
mod node_boxes;
mod node_pairs;
mod request;
mod rows;
mod scene_poses;
mod scene_size;
mod sides;
mod times;
mod weld_classes;
mod worker;

pub use answer::{DetectionAnswer, ShapeInMotion};
pub use contacts::ContactOptions;
pub use detect::detect;
pub use near::Near;
pub use request::{AnimationMotion, Detection, MeshMotion, OtherMesh, Times};
pub use rows::{RowQueries, check_rows};
