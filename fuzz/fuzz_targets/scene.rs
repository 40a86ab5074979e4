//! Scenes of simulations.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line};

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    one_line(sscc_sim::Scene::parse(std::path::Path::new("scene.toml"), text));
}
