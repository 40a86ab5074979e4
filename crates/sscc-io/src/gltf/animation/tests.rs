use gltf::animation::Interpolation;
use gltf::animation::util::ReadOutputs;
use sscc::{Modes, TriMesh};

use super::*;

/// A tetrahedron with two modes whose numbers need rounding.
fn model() -> ReducedModel {
    let rest = [DVec3::ZERO, DVec3::X, DVec3::Y * 0.1, DVec3::Z].to_vec();
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let modes = Modes::from_matrix(4, 2, |row, k| 0.1 * row as f64 - 0.3 * k as f64).unwrap();
    ReducedModel::new(TriMesh::new(rest, faces).unwrap(), modes).unwrap()
}

fn track(name: &str, shift: f64) -> Track {
    let rotation = |angle: f64| DQuat::from_rotation_z(angle);
    Track {
        name: name.into(),
        model: 0,
        center: DVec3::new(0.25, 0.1, 0.0),
        positions: [0.0, 0.1, 0.2].map(|x| DVec3::new(x + shift, 2.0, -x)).to_vec(),
        orientations: vec![rotation(0.1), -rotation(0.2), rotation(0.3)],
        weights: vec![0.1 + shift, 0.0, -0.5, 0.7, 1.0, 2.0],
    }
}

const TIMES: [f64; 3] = [0.0, 0.04, 0.1];

#[test]
fn the_model_round_trips() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let model = model();
    write_animation(
        &path,
        &[NamedModel { name: "tetrahedron", model: &model }],
        &TIMES,
        &[track("a", 0.0), track("b", 3.0)],
    )
    .unwrap();
    let read = super::super::read(&path, None).unwrap();
    assert_eq!(read.mesh.faces(), model.mesh().faces());
    assert_eq!((read.mesh_name.as_str(), read.modes.rank()), ("tetrahedron", 2));
    let rounded = |p: DVec3| p.as_vec3().as_dvec3();
    for v in 0..4 {
        assert_eq!(read.mesh.rest_positions()[v], rounded(model.mesh().rest_positions()[v]));
        let expected: Vec<DVec3> = model.modes().of_vertex(v as u32).iter().copied().map(rounded).collect();
        assert_eq!(read.modes.of_vertex(v as u32), expected);
    }
}

/// The positions that another reader computes at each key frame are those of the reduced motion.
#[test]
fn another_reader_reproduces_the_motion() {
    let model = model();
    let tracks = [track("a", 0.0), track("b", 3.0)];
    let bytes =
        animation_to_bytes(&[NamedModel { name: "tetrahedron", model: &model }], &TIMES, &tracks).unwrap();
    let file = gltf::Gltf::from_slice(&bytes).unwrap();
    let blob = file.blob.clone().unwrap();
    let animation = file.animations().next().unwrap();
    assert_eq!((animation.channels().count(), file.meshes().count(), file.nodes().count()), (6, 1, 4));
    for (body, track) in tracks.iter().enumerate() {
        let carrier = file.scenes().next().unwrap().nodes().nth(body).unwrap();
        let shape = carrier.children().next().unwrap();
        assert_eq!((carrier.name(), shape.mesh().unwrap().index()), (Some(track.name.as_str()), 0));
        let (mut positions, mut rotations, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        let of_body = |node: usize| [carrier.index(), shape.index()].contains(&node);
        for channel in animation.channels().filter(|channel| of_body(channel.target().node().index())) {
            assert_eq!(channel.sampler().interpolation(), Interpolation::Linear);
            let reader = channel.reader(|_| Some(&blob));
            assert_eq!(reader.read_inputs().unwrap().collect::<Vec<_>>(), TIMES.map(|t| t as f32));
            match reader.read_outputs().unwrap() {
                ReadOutputs::Translations(read) => positions = read.collect(),
                ReadOutputs::Rotations(read) => rotations = read.into_f32().collect(),
                ReadOutputs::MorphTargetWeights(read) => weights = read.into_f32().collect::<Vec<f32>>(),
                ReadOutputs::Scales(_) => panic!(),
            }
        }
        // Each quaternion has the sign nearest to its predecessor.
        for pair in rotations.windows(2) {
            assert!(pair[0].iter().zip(pair[1]).map(|(a, b)| a * b).sum::<f32>() > 0.0);
        }
        let primitive = shape.mesh().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(&blob));
        let rest: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
        let targets: Vec<Vec<[f32; 3]>> =
            reader.read_morph_targets().map(|(position, ..)| position.unwrap().collect()).collect();
        assert_eq!(
            reader.read_indices().unwrap().into_u32().collect::<Vec<_>>(),
            model.mesh().faces().as_flattened()
        );
        let wide = |x: [f32; 3]| DVec3::from_array(x.map(f64::from));
        let inner = wide(shape.transform().decomposed().0);
        for frame in 0..TIMES.len() {
            let rotation = DQuat::from_array(rotations[frame].map(f64::from));
            let q = &track.weights[2 * frame..][..2];
            for v in 0..4 {
                let moved = (0..2).map(|k| wide(targets[k][v]) * f64::from(weights[2 * frame + k]));
                let local = wide(rest[v]) + moved.sum::<DVec3>() + inner;
                let shown = rotation * local + wide(positions[frame]);
                let exact = track.orientations[frame] * (model.position(v as u32, q) - track.center)
                    + track.positions[frame];
                assert!((shown - exact).length() < 1e-6, "{shown} {exact}");
            }
        }
    }
}

/// The extremes have one key frame each, for players that derive ranges from first key frames.
#[test]
fn extreme_weights_are_animations() {
    let model = model();
    let tracks = [track("a", 0.0), track("b", 3.0)];
    let bytes =
        animation_to_bytes(&[NamedModel { name: "tetrahedron", model: &model }], &TIMES, &tracks).unwrap();
    let file = gltf::Gltf::from_slice(&bytes).unwrap();
    let blob = file.blob.clone().unwrap();
    assert_eq!(file.animations().count(), 3);
    for (animation, is_maximum) in file.animations().skip(1).zip([false, true]) {
        assert_eq!(animation.channels().count(), tracks.len());
        for (channel, track) in animation.channels().zip(&tracks) {
            let reader = channel.reader(|_| Some(&blob));
            assert_eq!(reader.read_inputs().unwrap().count(), 1);
            let Some(ReadOutputs::MorphTargetWeights(weights)) = reader.read_outputs() else { panic!() };
            let expected = [0, 1].map(|k| {
                let of_mode = track.weights.chunks(2).map(|q| q[k] as f32);
                if is_maximum { of_mode.reduce(f32::max) } else { of_mode.reduce(f32::min) }.unwrap()
            });
            assert_eq!(weights.into_f32().collect::<Vec<_>>(), expected);
        }
    }
}

#[test]
fn invalid_animations_are_rejected() {
    let model = model();
    let models = [NamedModel { name: "t", model: &model }];
    let message = |times: &[f64], track: Track| animation_to_bytes(&models, times, &[track]).unwrap_err();
    let good = || track("a", 0.0);
    assert_eq!(message(&[0.0, 1.0], good()), "body a needs one entry for each of the 2 key frames");
    assert_eq!(
        message(&[0.0, 1.0, 1.0 + 1e-12], good()),
        "key frame 2 is not later than the one before it: times must increase"
    );
    assert_eq!(message(&TIMES, Track { model: 1, ..good() }), "body a refers to model 1, but there are 1");
    let mut wide = good();
    wide.weights[3] = 1e300;
    assert_eq!(
        message(&TIMES, wide),
        "a number of the animation is inf in single precision: scale the model down"
    );
    assert_eq!(
        animation_to_bytes(&models, &TIMES, &[]).unwrap_err(),
        "an animation needs a key frame and a body"
    );
    assert_eq!(message(&[], good()), "an animation needs a key frame and a body");
}

#[test]
fn key_frames_follow_the_rate() {
    assert_eq!(key_frames(11, 0.01, 50.0), [0, 2, 4, 6, 8, 10]);
    assert_eq!(key_frames(10, 0.01, 30.0), [0, 3, 7, 9]);
    assert_eq!(key_frames(4, 0.1, 60.0), [0, 1, 2, 3]);
    assert_eq!(key_frames(88_200, 1.0 / 44_100.0, 60.0).len(), 121);
    for no_rate in [0.0, -0.0, -60.0, f64::NEG_INFINITY, f64::NAN] {
        assert_eq!(key_frames(5, 0.01, no_rate), [0, 4], "{no_rate}");
    }
    assert_eq!(key_frames(3, 0.01, f64::INFINITY), [0, 1, 2]);
    // Single precision cannot distinguish these times.
    let (steps, step) = (20_000_001, 1.0 / 44_100.0);
    let frames = key_frames(steps, step, 44_100.0);
    assert!(frames.windows(2).all(|w| (w[0] as f64 * step) as f32 != (w[1] as f64 * step) as f32));
    assert_eq!((frames[0], frames.last()), (0, Some(&(steps - 1))));
    assert_eq!((key_frames(0, 0.1, 60.0), key_frames(1, 0.1, 60.0)), (vec![], vec![0]));
}
