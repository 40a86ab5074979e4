//! The page of sscc: its data ([`Scene`], [`Arrays`]), reports in one file ([`Report`], [`simulation_report`],
//! [`Animation`], [`MeshReport`]), and the answers of a live page by native queries ([`Live`]).
//!
//! The page is one HTML file that loads no other file, built from the folder `viewer/` and kept in `page/`. A report
//! has its data in the file; a live page requests them. Both use the same JSON and the same arrays. The cargo feature
//! `server` adds the server of live pages: programs that only write reports link no HTTP parser. The feature `picture`
//! adds pictures of certified deformations (`Picture`).

mod animation_report;
mod arrays;
mod checks;
mod error;
mod extremal;
mod levels;
mod limits;
mod live;
mod mesh_report;
mod metric_comparison;
mod page;
#[cfg(feature = "picture")]
mod picture;
mod playback;
mod plot;
mod reduced_facts;
mod report;
mod scene;
#[cfg(feature = "server")]
mod server;
mod simulation;

pub use animation_report::Animation;
pub use arrays::Arrays;
pub use checks::{Checks, WasmPackage};
pub use error::ViewError;
pub use extremal::{Extremal, extremal};
pub use levels::{Level, levels};
pub use limits::MAX_REPORT_BYTES;
pub use live::Live;
pub use mesh_report::MeshReport;
pub use metric_comparison::metric_comparison;
pub use page::PAGE;
#[cfg(feature = "picture")]
pub use picture::Picture;
pub use playback::{Body, Clock, Colliding, Contacts, Curves, Playback, Track};
pub use plot::{Axis, Plot, Series};
pub use reduced_facts::ModelDetails;
pub use report::Report;
pub use scene::{ModelScene, Scene};
#[cfg(feature = "server")]
pub use server::Server;
pub use simulation::simulation_report;
