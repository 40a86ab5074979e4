//! Positions match the definition.

use glam::{DQuat, DVec3};

use super::file::{JSON, assert_close, binary, glb, positions, scene, skinned};
use crate::gltf::{SkinWeights, parse_scene};

#[test]
fn stored_state_without_an_animation() {
    let half_turn = DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0);
    let scale = DVec3::new(1.0, 2.0, 1.0);
    assert_close(&positions(&scene(&[]), 3, None), &skinned(10.0, half_turn, scale, 0.0));
    // Without a skin, the node's transform applies, and its own weights are preferred to those of the mesh.
    let rigid = [
        DVec3::new(0.0, 0.0, 5.0),
        DVec3::new(-1.0, 0.0, 6.0),
        DVec3::new(0.0, 1.0, 5.0),
        DVec3::new(0.0, 1.0, 5.0),
    ];
    assert_close(&positions(&scene(&[]), 4, None), &rigid);
    let of_mesh = scene(&[(r#""name":"flag","#, r#""name":"flag","weights":[0.75],"#)]);
    assert_close(&positions(&of_mesh, 4, None), &rigid);
    assert_close(&positions(&of_mesh, 3, None), &skinned(10.0, half_turn, scale, 0.75));
}

#[test]
fn all_interpolations() {
    let scene = scene(&[]);
    let turn = |angle: f64| DQuat::from_rotation_z(angle);
    let pi = std::f64::consts::PI;
    for (time, height, angle, width, depth, weight) in [
        (-9.0, 10.0, pi, 1.0, 2.0, 1.0),
        (1.0, 10.0, pi, 1.0, 2.0, 1.0),
        (1.5, 10.0, pi / 2.0, 2.0, 2.0, 1.5),
        (1.999, 10.0, pi * 0.001, 2.999994002, 2.0, 1.999),
        (2.0, 20.0, 0.0, 3.0, 2.0, 2.0),
        (3.0, 20.0, 0.0, 2.0, 1.0, 3.0),
        (4.0, 40.0, 0.0, 1.0, 0.0, 4.0),
        (1e300, 40.0, 0.0, 1.0, 0.0, 4.0),
    ] {
        let expected = skinned(height, turn(angle), DVec3::new(width, depth, 1.0), weight);
        assert_close(&positions(&scene, 3, Some(time)), &expected);
    }
    // Node 4 has no channel.
    assert_eq!(positions(&scene, 4, Some(3.0)), positions(&scene, 4, None));
}

#[test]
fn missing_inverse_bind_matrices_are_the_identity() {
    let scene = scene(&[(r#","inverseBindMatrices":4"#, "")]);
    let found = positions(&scene, 3, None);
    // Joint 1: scale, 2 along z, half a turn, 10 along z.
    assert_close(&found[1..2], &[DVec3::new(-1.0, 0.0, 12.0)]);
}

#[test]
fn skin_weights_are_normalized_or_used_as_stored() {
    let mut binary = binary();
    for vertex in 0..4 {
        for (at, weight) in [[0.5_f32, 0.0], [0.0, 0.0], [0.5, 1.5], [1.5, 0.5]][vertex].iter().enumerate() {
            binary[112 + 16 * vertex + 4 * at..][..4].copy_from_slice(&weight.to_le_bytes());
        }
    }
    let scene = parse_scene(&glb(JSON, &binary)).unwrap();
    let expected = skinned(10.0, DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0), DVec3::new(1.0, 2.0, 1.0), 0.0);
    let mut found = Vec::new();
    scene.positions(3, None, 0.0, SkinWeights::Normalized, &mut found).unwrap();
    assert_close(&found, &expected);
    scene.positions(3, None, 0.0, SkinWeights::AsStored, &mut found).unwrap();
    let scaled = [expected[0] * 0.5, DVec3::ZERO, expected[2] * 2.0, expected[3] * 2.0];
    assert_close(&found, &scaled);
    assert_eq!(scene.mesh_nodes()[0].largest_weight_error(), 1.0);
    assert_eq!(scene.mesh_nodes()[0].weld_classes(), [0, 1, 2, 2]);
    assert_eq!(SkinWeights::default(), SkinWeights::Normalized);
}

#[test]
fn all_sets_of_joints_count() {
    let json = JSON
        .replace(r#""JOINTS_0":2,"WEIGHTS_0":3"#, r#""WEIGHTS_1":3,"JOINTS_0":2,"JOINTS_1":2,"WEIGHTS_0":3"#);
    let scene = parse_scene(&glb(&json, &binary())).unwrap();
    assert_eq!(scene.mesh_nodes()[0].largest_weight_error(), 1.0);
    let mut found = Vec::new();
    scene.positions(3, Some(0), 1.5, SkinWeights::Normalized, &mut found).unwrap();
    assert_close(&found, &positions(&super::file::scene(&[]), 3, Some(1.5)));
    let doubled = positions(&scene, 3, Some(1.5));
    assert_close(&doubled, &found.iter().map(|x| *x * 2.0).collect::<Vec<_>>());
}

#[test]
fn matrices_of_moved_nodes_are_split() {
    // Half a turn about z and 10 along z as matrices.
    let scene = scene(&[
        (r#""translation":[0,0,10]"#, r#""matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,10,1]"#),
        (r#""rotation":[0,0,1,0]"#, r#""matrix":[-1,0,0,0, 0,-1,0,0, 0,0,1,0, 0,0,0,1]"#),
    ]);
    let plain = super::file::scene(&[]);
    for time in [None, Some(1.0), Some(1.7), Some(3.0)] {
        assert_close(&positions(&scene, 3, time), &positions(&plain, 3, time));
    }
}
