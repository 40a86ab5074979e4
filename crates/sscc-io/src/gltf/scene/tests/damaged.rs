//! Damaged files: an error of one line or a scene, and never a panic.

use proptest::prelude::*;

use super::file::{JSON, binary, changed, glb};
use crate::gltf::{SkinWeights, parse_contents, parse_placed_mesh, parse_scene};

#[test]
fn every_truncation_is_rejected() {
    let bytes = changed(&[]);
    for len in 0..bytes.len() {
        assert!(parse_placed_mesh(&bytes[..len], None).is_err() && parse_contents(&bytes[..len]).is_err());
        let error = parse_scene(&bytes[..len]).unwrap_err().to_string();
        assert!(!error.contains('\n') && error.len() < 400, "{len}: {error}");
    }
}

/// Evaluates everything that a file has. Asserts that errors have one line.
fn evaluate(bytes: &[u8]) {
    let one_line = |error: crate::FormatError| {
        let error = error.to_string();
        assert!(!error.contains('\n') && error.len() < 400, "{error}");
    };
    match parse_placed_mesh(bytes, None) {
        Ok(placed) => {
            for place in 0..placed.places() {
                match placed.to_mesh(place) {
                    Ok(mesh) => assert_eq!(mesh.rest_positions().len(), placed.rest_positions().len()),
                    Err(error) => one_line(error),
                }
            }
        }
        Err(error) => one_line(error),
    }
    match parse_contents(bytes) {
        Ok(contents) => {
            let of_meshes = contents.meshes.into_iter().filter_map(|mesh| mesh.size.err());
            let of_animations = contents.animations.into_iter().filter_map(|animation| animation.error);
            of_meshes.chain(of_animations).for_each(one_line);
        }
        Err(error) => one_line(error),
    }
    let scene = match parse_scene(bytes) {
        Ok(scene) => scene,
        Err(error) => return one_line(error),
    };
    let mut found = Vec::new();
    for animation in (0..scene.animations().len()).map(Some).chain([None]) {
        for time in [0.0, 1.2, 1e300] {
            match scene.pose(animation, time) {
                Ok(pose) => {
                    for mesh_node in scene.mesh_nodes() {
                        for weights in [SkinWeights::Normalized, SkinWeights::AsStored] {
                            match pose.positions(mesh_node.node(), weights, &mut found) {
                                Ok(()) => assert_eq!(found.len(), mesh_node.rest_positions().len()),
                                Err(error) => one_line(error),
                            }
                        }
                    }
                }
                Err(error) => one_line(error),
            }
        }
    }
}

proptest! {
    #[test]
    fn damaged_files_give_a_scene_or_an_error_of_one_line(
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        in_binary: bool,
    ) {
        let mut bytes = changed(&[]);
        let begin = if in_binary { bytes.len() - 512 } else { 0 };
        let len = bytes.len() - begin;
        for (at, value) in damage {
            bytes[begin + at.index(len)] = value;
        }
        evaluate(&bytes);
    }

    /// The JSON stays valid when numbers are exchanged.
    #[test]
    fn files_with_exchanged_numbers_give_a_scene_or_an_error_of_one_line(
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0_usize..12), 1..4),
    ) {
        const NUMBERS: [&str; 12] =
            ["0", "1", "2", "3", "4", "9", "12", "5121", "5123", "5126", "4294967295", "18446744073709551615"];
        let mut words: Vec<String> = Vec::new();
        for c in JSON.chars() {
            match words.last_mut() {
                Some(last) if last.ends_with(|l: char| l.is_ascii_digit()) == c.is_ascii_digit() => last.push(c),
                _ => words.push(c.into()),
            }
        }
        let digits: Vec<_> =
            (0..words.len()).filter(|i| words[*i].starts_with(|c: char| c.is_ascii_digit())).collect();
        for (at, number) in changes {
            words[digits[at.index(digits.len())]] = NUMBERS[number].into();
        }
        evaluate(&glb(&words.concat(), &binary()));
    }
}
