//! Simulations of scenes: what they need, how they go on after being killed, what becomes of them.

mod clock;
mod history;
mod log;
mod meter;
mod outputs;
mod page;
mod playback;
mod plot;
mod prepared;
mod run;
mod summary;

pub use history::{History, PARTS};
pub use log::Log;
pub use meter::Meter;
pub use outputs::write;
pub use page::Page;
pub use plot::{Line, Plot};
pub use prepared::Prepared;
pub use run::{Ran, run};
pub use summary::Summary;
