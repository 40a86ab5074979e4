use super::*;
use glam::DMat3;
use sscc::{Metric, MetricKind};
use sscc_solid::MassProperties;

/// Two triangles, three modes, numbers of all sizes and signs.
fn model() -> ReducedModel {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1e-300, -0.0, 0.1), DVec3::ONE];
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [4, 3, 2]]).unwrap();
    let modes = Modes::from_matrix(5, 3, |row, k| (row as f64 - 7.3) * 0.1_f64.powi(k as i32)).unwrap();
    let metric = Metric::from_scales(MetricKind::Given, vec![0.1, 1.0, 1e3]).unwrap();
    ReducedModel::with_metric(mesh, modes, metric).unwrap()
}

fn sample() -> Vec<u8> {
    model_to_bytes(&model(), &ModelInfo::new("cm", "by hand")).unwrap()
}

/// Returns a model file with one tensor, the faces or the metric replaced.
fn with(change: impl Fn(&str) -> Option<(Vec<usize>, Vec<f64>)>, faces: &[u32], metric: &str) -> Vec<u8> {
    let mut writer = ContainerWriter::new(MODEL);
    writer.text("metric", metric).text("units", "").text("provenance", "");
    writer.u32("faces", &[faces.len() / 3, 3], faces);
    for (name, shape) in
        [("rest_positions", vec![3, 3]), ("modes", vec![3, 3, 2]), ("metric_scales", vec![2])]
    {
        let size = shape.iter().product();
        let (shape, values) =
            change(name).unwrap_or_else(|| (shape, (0..size).map(|i| 1.0 + i as f64).collect()));
        writer.f64(name, &shape, &values);
    }
    writer.finish().unwrap()
}

#[test]
fn round_trip_is_exact() {
    let model = model();
    let (read, info) = model_from_bytes(&sample()).unwrap();
    assert_eq!(info, ModelInfo::new("cm", "by hand"));
    assert_eq!((read.mesh(), read.modes(), read.metric()), (model.mesh(), model.modes(), model.metric()));
    let bits = |m: &ReducedModel| m.mesh().rest_positions().iter().map(|p| p.y.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&read), bits(&model), "-0 stays -0");
    assert_eq!(model_to_bytes(&read, &info).unwrap(), sample());
}

fn mass() -> MassData {
    let inertia = DMat3::from_cols_array(&[2.0, 0.1, 0.0, 0.1, 3.0, 0.2, 0.0, 0.2, 4.0]);
    let properties = MassProperties { mass: 0.5, center: DVec3::new(0.1, -0.0, 7.0), inertia };
    MassData { properties, moments: [1.0, 0.1, -2.0].map(DVec3::splat).to_vec(), is_held: true }
}

#[test]
fn files_with_mass_and_support_have_version_2_and_round_trip() {
    let version = |bytes: &[u8]| Container::parse(bytes, MODEL).unwrap().version();
    assert_eq!(version(&sample()), 1);
    for is_held in [true, false] {
        let mass = MassData { is_held, ..mass() };
        let bytes = model_to_bytes(&model(), &ModelInfo::new("m", "").with_mass(mass.clone())).unwrap();
        assert_eq!((version(&bytes), model_from_bytes(&bytes).unwrap().1.mass), (2, Some(mass)));
        assert!((0..bytes.len()).all(|length| model_from_bytes(&bytes[..length]).is_err()));
    }
    let few = MassData { moments: vec![DVec3::X], ..mass() };
    let refused = model_to_bytes(&model(), &ModelInfo::new("m", "").with_mass(few)).unwrap_err();
    assert_eq!(refused.to_string(), "tensor 'mode_moments': it has 1 moments, but the model has 3 modes");
}

#[test]
fn files_with_deviations_have_version_3_and_round_trip() {
    let with_deviations = |deviations: &[f64]| ModelInfo {
        deviations: Some(deviations.to_vec()),
        ..ModelInfo::new("m", "").with_mass(mass())
    };
    let info = with_deviations(&[1.0, 0.0, 2.5]);
    let bytes = model_to_bytes(&model(), &info).unwrap();
    assert_eq!(Container::parse(&bytes, MODEL).unwrap().version(), 3);
    assert_eq!(model_from_bytes(&bytes).unwrap().1, info);
    assert!((0..bytes.len()).all(|length| model_from_bytes(&bytes[..length]).is_err()));
    let refused = model_to_bytes(&model(), &with_deviations(&[1.0])).unwrap_err();
    assert_eq!(refused.to_string(), "tensor 'deviations': it has 1 numbers, but the model has 3 modes");
    for wrong in [-1.0, f64::NAN, f64::INFINITY] {
        let values = [1.0, wrong, 1.0];
        let mut writer = ContainerWriter::new(MODEL);
        writer.f64(DEVIATIONS, &[3], &values);
        let bytes = writer.finish().unwrap();
        let read = read_deviations(&Container::parse(&bytes, MODEL).unwrap(), 3).unwrap_err();
        let written = model_to_bytes(&model(), &with_deviations(&values)).unwrap_err();
        let expected =
            format!("tensor 'deviations': a number is {wrong}: finite numbers of at least 0 were expected");
        assert_eq!([read.to_string(), written.to_string()], [expected.as_str(), &expected]);
    }
}

#[test]
fn invalid_mass_data_are_rejected() {
    let message = |mass: f64, moment: f64, support: &str, moments: usize| {
        let mut writer = ContainerWriter::new(MODEL);
        let mut properties = [1.0; 13];
        properties[0] = mass;
        writer.text("support", support).f64("mass_properties", &[13], &properties);
        writer.f64("mode_moments", &[moments, 3], &vec![moment; 3 * moments]);
        let bytes = writer.finish().unwrap();
        let read = mass_data::read(&Container::parse(&bytes, MODEL).unwrap(), 2);
        read.map_or_else(|error| error.to_string(), |_| String::new())
    };
    assert_eq!(message(1.0, 0.0, "free", 2), "");
    assert_eq!(
        message(0.0, 0.0, "free", 2),
        "tensor 'mass_properties': the mass is 0e0: it must be positive"
    );
    assert!(message(f64::NAN, 0.0, "free", 2).starts_with("tensor 'mass_properties': a number is NaN"));
    assert!(message(1.0, f64::INFINITY, "free", 2).starts_with("tensor 'mode_moments': a number is inf"));
    assert!(message(1.0, 0.0, "loose", 2).starts_with("metadata 'support': unknown support 'loose'"));
    assert!(message(1.0, 0.0, "free", 3).starts_with("tensor 'mode_moments': it has the shape [3, 3]"));
}

#[test]
fn modes_are_laid_out_for_numpy() {
    let bytes = sample();
    let modes = Container::parse(&bytes, MODEL).unwrap().f64("modes").unwrap();
    assert_eq!(modes.shape, [5, 3, 3]);
    // U[3 v + c, k] of the 15 x 3 matrix
    assert_eq!(modes.values[(3 * 4 + 1) * 3 + 2], model().modes().of_vertex(4)[2].y);
}

#[test]
fn every_flipped_byte_and_truncation_is_rejected() {
    let bytes = sample();
    for at in 0..bytes.len() {
        let mut flipped = bytes.clone();
        flipped[at] ^= 1 << (at % 8);
        assert!(model_from_bytes(&flipped).is_err(), "byte {at}");
        assert!(model_from_bytes(&bytes[..at]).is_err(), "length {at}");
    }
}

#[test]
fn content_with_a_valid_digest_is_checked() {
    let message = |bytes: Vec<u8>| model_from_bytes(&bytes).unwrap_err().to_string();
    let tensor = |name: &'static str, shape: &[usize], values: &[f64]| {
        let (shape, values) = (shape.to_vec(), values.to_vec());
        message(with(move |n| (n == name).then(|| (shape.clone(), values.clone())), &[0, 1, 2], "given"))
    };
    assert!(model_from_bytes(&with(|_| None, &[0, 1, 2], "given")).is_ok());
    assert!(message(with(|_| None, &[0, 1, 3], "given")).contains("names vertex 3"));
    assert!(message(with(|_| None, &[], "given")).contains("no triangles"));
    assert_eq!(message(with(|_| None, &[0, 1, 2], "gold")), "metadata 'metric': unknown metric 'gold'");
    assert!(
        tensor("rest_positions", &[9], &[0.0; 9])
            .starts_with("tensor 'rest_positions': it has the shape [9]")
    );
    assert!(tensor("modes", &[2, 3, 2], &[0.0; 12]).contains("[3, 3, any] was expected"));
    assert!(tensor("modes", &[3, 3, 0], &[]).contains("it has the shape [2], [0] was expected"));
    assert!(tensor("metric_scales", &[3], &[1.0; 3]).contains("[2] was expected"));
    assert!(tensor("metric_scales", &[2], &[1.0, -1.0]).contains("metric weight 1"));
    assert!(tensor("metric_scales", &[2], &[1e-300, 1.0]).contains("rescale the metric"));
    assert!(tensor("rest_positions", &[3, 3], &[f64::NAN; 9]).starts_with("vertex 0"));
    assert!(tensor("modes", &[3, 3, 2], &[f64::INFINITY; 18]).starts_with("mode 0 of vertex 0"));
}

#[test]
fn unknown_tensors_are_rejected() {
    let mut writer = ContainerWriter::new(MODEL);
    writer.u8("weld", &[1], &[1]);
    let message = model_from_bytes(&writer.finish().unwrap()).unwrap_err().to_string();
    assert_eq!(message, "tensor 'weld': not known in this version of the format");
}
