//! The page of sscc: what it shows ([`Scene`], [`Arrays`]), reports in one file ([`Report`]), and
//! the server on this machine that answers a live page by the native queries ([`Live`]; the server itself with the cargo
//! feature `server`).
//!
//! The page is one HTML file without any other, built from the folder `viewer/` and kept in `page/`. In a report its
//! data stands in the file; live it is asked for. Both are the same JSON and the same arrays.

mod arrays;
mod error;
mod extremal;
mod levels;
mod live;
mod page;
mod playback;
mod plot;
mod report;
mod scene;
#[cfg(feature = "server")]
mod server;
mod simulation;

pub use arrays::Arrays;
pub use error::ViewError;
pub use extremal::{Extremal, extremal};
pub use levels::{Level, levels};
pub use live::Live;
pub use page::PAGE;
pub use playback::{Body, Colliding, Playback};
pub use plot::{Axis, Plot, Series};
pub use report::Report;
pub use scene::{ModelDetails, ModelScene, Scene};
#[cfg(feature = "server")]
pub use server::Server;
pub use simulation::simulation_report;
