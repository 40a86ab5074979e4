//! glTF: contents, animations, skins, and their poses.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::{bounded, one_line};
use sscc_io::gltf::SkinWeights;

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    one_line(sscc_io::gltf::parse_contents(bytes));
    let Some(scene) = one_line(sscc_io::gltf::parse_scene(bytes)) else { return };
    for animation in [None, Some(0), Some(1)] {
        for time in [0.0, 0.3, -1.0, f64::INFINITY, f64::NAN] {
            let Some(pose) = one_line(scene.pose(animation, time)) else { continue };
            let mut positions = Vec::new();
            for node in scene.mesh_nodes().iter().take(4) {
                for weights in [SkinWeights::Normalized, SkinWeights::AsStored] {
                    one_line(pose.positions(node.node(), weights, &mut positions));
                }
            }
        }
    }
}
