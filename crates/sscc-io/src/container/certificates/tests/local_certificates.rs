//! Local certificates in files.

use std::sync::Arc;

use super::*;
use crate::container::local_certificates::TENSORS;

const VALUES: [f32; 3] = [f32::MIN_POSITIVE, 1.5e-40, 3.0];

/// Returns a larger model and its certificates.
fn large() -> (ReducedModel, Certificates) {
    let model = strip(900);
    let options = CertifyOptions::default().budget(8).local_budget(256);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    (model, certificates)
}

/// This test fails if a field is omitted, or two fields are exchanged.
#[test]
fn every_field_round_trips_bit_for_bit() {
    let (model, certificates) = large();
    let mut parts = certificates.parts().clone();
    let local = Arc::make_mut(&mut parts.local);
    assert!(local.nodes.len() > 20 && local.list_nodes.len() > 20);
    local.gradients[..3].copy_from_slice(&VALUES);
    local.list_ratios[..2].copy_from_slice(&[f32::INFINITY, VALUES[1]]);
    local.bounds[0].ratio = f64::INFINITY;
    local.ellipsoids[..4].copy_from_slice(&[0x8000, 0x7f7f, 1, 0xff7f]);
    local.bounds[1] = sscc::parts::LocalBounds {
        ratio: 5e-324,
        per_factor: 0.1,
        per_error: 1.0 + f64::EPSILON,
        steepest: 3.0,
        widest: 1e300,
        across: [0.6, -0.8, 1e-320],
        flatness: 0.25,
    };
    let changed = Certificates::try_from(parts).unwrap();
    for certificates in [certificates, changed] {
        let bytes = certificates_to_bytes(&certificates).unwrap();
        let file = Container::parse(&bytes, CERTIFICATES).unwrap();
        assert_eq!((file.version(), file.text("scheme").unwrap()), (7, "full"));
        let read = certificates_from_bytes(&bytes).unwrap();
        read.check_model(&model).unwrap();
        let [a, b] = [&read, &certificates].map(|certificates| &certificates.parts().local);
        assert_eq!(read, certificates);
        let bits = |numbers: &[f32]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<u32>>();
        assert_eq!(bits(&a.gradients), bits(&b.gradients));
        assert_eq!(bits(&a.list_ratios), bits(&b.list_ratios));
        assert_eq!(certificates_to_bytes(&read).unwrap(), bytes);
    }
}

/// A file may have groups and local certificates.
#[test]
fn files_with_groups_and_local_certificates_round_trip() {
    let groups = TriangleGroups::new(&(0..22).map(|t| t / 6).collect::<Vec<u32>>()).unwrap().between_only();
    let filter = ContactFilter::default().with_groups(groups);
    let options = CertifyOptions::default().filter(filter).local_budget(64);
    let certificates = Certificates::compute(&model(), &options, &()).unwrap();
    let bytes = certificates_to_bytes(&certificates).unwrap();
    assert_eq!(Container::parse(&bytes, CERTIFICATES).unwrap().version(), 7);
    let read = certificates_from_bytes(&bytes).unwrap();
    assert!(read.filter().groups().is_some() && !read.parts().local.nodes.is_empty());
    assert_eq!(read, certificates);
}

/// Certificates computed with and without local certificates differ in nothing else.
#[test]
fn local_certificates_change_nothing_else_in_the_file() {
    let (model, certificates) = large();
    let options = CertifyOptions::default().budget(8).local_budget(0);
    let plain = Certificates::compute(&model, &options, &()).unwrap();
    assert_eq!(plain.parts().digest, certificates.parts().digest);
    let without = sscc::parts::CertificateParts { local: Arc::default(), ..certificates.parts().clone() };
    let bytes = certificates_to_bytes(&plain).unwrap();
    assert_eq!(certificates_to_bytes(&Certificates::try_from(without).unwrap()).unwrap(), bytes);
    let file = Container::parse(&bytes, CERTIFICATES).unwrap();
    assert_eq!(file.version(), 4);
    assert!(file.names().iter().all(|name| !name.starts_with("local")));
}

/// A file of version 7 without the tensors has no local certificates; a file with one of the tensors needs all of them.
#[test]
fn incomplete_tensors_are_rejected() {
    let bytes = sample();
    let file = Container::parse(&bytes, CERTIFICATES).unwrap();
    let read = |version: u32, absent: &[&str], change: &dyn Fn(&mut ContainerWriter)| {
        let mut writer = ContainerWriter::new(crate::container::Kind { version, ..CERTIFICATES });
        copy(&file, &mut writer, absent);
        change(&mut writer);
        certificates_from_bytes(&writer.finish().unwrap())
    };
    assert_eq!(read(7, &[], &|_| ()).unwrap(), certificates());
    let without = read(7, &TENSORS, &|_| ()).unwrap();
    assert_eq!(*without.parts().local, LocalCertificates::default());
    without.check_model(&model()).unwrap();
    let refused = |version, absent: &[&str], change: &dyn Fn(&mut ContainerWriter)| {
        read(version, absent, change).unwrap_err().to_string()
    };
    for version in [4, 5] {
        assert!(refused(version, &[], &|_| ()).contains("not known in this version of the format"));
    }
    for name in TENSORS {
        assert!(refused(7, &[name], &|_| ()).contains(&format!("{name}': missing")), "{name}");
        let others: Vec<&str> = TENSORS.into_iter().filter(|other| *other != name).collect();
        assert!(refused(7, &others, &|_| ()).contains("missing"), "{name}");
        let of_type = refused(7, &[name], &|w| _ = w.u64(name, &[1], &[0]));
        assert!(of_type.contains("it has the type U64"), "{of_type}");
    }
    let empty = |w: &mut ContainerWriter| _ = w.u32("local_nodes", &[0], &[]);
    assert!(refused(7, &["local_nodes"], &empty).contains("local_nodes': it is empty"));
    let bounds = |w: &mut ContainerWriter| _ = w.f64("local_bounds", &[1, 9], &[0.0; 9]);
    assert!(refused(7, &["local_bounds"], &bounds).contains("was expected"));
    let ratios = |w: &mut ContainerWriter| _ = w.f32("local_list_ratios", &[0], &[]);
    assert!(refused(7, &["local_list_ratios"], &ratios).contains("was expected"));
    let starts = |w: &mut ContainerWriter| _ = w.u32("local_mode_starts", &[1], &[0]);
    let message = refused(7, &["local_mode_starts"], &starts);
    assert!(message.contains("local certificates: modes of certificates are out of order"), "{message}");
}

/// Replaces numbers of every tensor and truncates it: reading fails, or queries have an answer.
#[test]
fn damaged_tensors_are_rejected_or_harmless() {
    let (model, good) = large();
    let bytes = certificates_to_bytes(&good).unwrap();
    let file = Container::parse(&bytes, CERTIFICATES).unwrap();
    let (mut rejected, mut harmless) = (0, 0);
    let mut read = |name: &str, add: &dyn Fn(&mut ContainerWriter)| {
        let mut writer = ContainerWriter::new(CERTIFICATES);
        copy(&file, &mut writer, &[name]);
        add(&mut writer);
        match certificates_from_bytes(&writer.finish().unwrap()) {
            Ok(certificates) => {
                harmless += 1;
                let mut query = sscc::Query::new(&model, &certificates).unwrap();
                for q in [[0.01, 0.0, 0.0], [0.1, -0.1, 1.0], [1.0, 1.0, 0.0]] {
                    query.discrete(&q).unwrap();
                    // A short motion, which costs little in CCD.
                    query.continuous(&q.map(|x| 0.99 * x), &q).unwrap();
                    query.safe_scale(&q).unwrap();
                }
                true
            }
            Err(_) => {
                rejected += 1;
                false
            }
        }
    };
    for name in TENSORS {
        let places = |len: usize| (0..len).step_by(len.div_ceil(cases(12)).max(1));
        if let Ok(tensor) = file.u32(name) {
            let values = tensor.values;
            for at in places(values.len()) {
                for bit in 0..32 {
                    let mut changed = values.clone();
                    changed[at] ^= 1 << bit;
                    read(name, &|w| _ = w.u32(name, &[changed.len()], &changed));
                }
                assert!(!read(name, &|w| _ = w.u32(name, &[at], &values[..at])), "{name} {at}");
            }
        } else if let Ok(tensor) = file.f32(name) {
            let values = tensor.values;
            for at in places(values.len()) {
                for other in [0.0, f32::MAX, f32::MIN, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                    let mut changed = values.clone();
                    changed[at] = other;
                    let is_read = read(name, &|w| _ = w.f32(name, &[changed.len()], &changed));
                    assert!(!is_read || !other.is_nan(), "{name} {at}");
                }
                assert!(!read(name, &|w| _ = w.f32(name, &[at], &values[..at])), "{name} {at}");
            }
        } else {
            let values = file.f64(name).unwrap().values;
            for at in places(values.len()) {
                for other in [0.0, f64::MAX, f64::MIN, f64::NAN, f64::INFINITY, -1e-300] {
                    let mut changed = values.clone();
                    changed[at] = other;
                    let is_read = read(name, &|w| _ = w.f64(name, &[changed.len() / 9, 9], &changed));
                    let is_valid = match at % 9 {
                        0 | 8 => other >= 0.0,
                        5..=7 => other.abs() <= 1e-300,
                        _ => other >= 0.0 && other.is_finite(),
                    };
                    assert_eq!(is_read, is_valid, "{name} {at} {other}");
                }
                let rows = at / 9;
                assert!(!read(name, &|w| _ = w.f64(name, &[rows, 9], &values[..9 * rows])), "{name} {at}");
            }
        }
    }
    assert!(rejected > threshold(500) && harmless > threshold(100), "{rejected} {harmless}");
}

/// Files of version 6 have no flat patches.
#[test]
fn files_of_version_6_are_read() {
    let bytes = sample();
    let file = Container::parse(&bytes, CERTIFICATES).unwrap();
    let mut writer = ContainerWriter::new(crate::container::Kind { version: 6, ..CERTIFICATES });
    copy(&file, &mut writer, &["local_bounds"]);
    let mut expected = certificates().parts().clone();
    let bounds = &mut Arc::make_mut(&mut expected.local).bounds;
    let first = |b: &sscc::parts::LocalBounds| [b.ratio, b.per_factor, b.per_error, b.steepest, b.widest];
    let numbers: Vec<f64> = bounds.iter().flat_map(first).collect();
    writer.f64("local_bounds", &[bounds.len(), 5], &numbers);
    bounds.iter_mut().for_each(|b| (b.across, b.flatness) = ([0.0; 3], f64::INFINITY));
    let read = certificates_from_bytes(&writer.finish().unwrap()).unwrap();
    assert_eq!(read, Certificates::try_from(expected).unwrap());
}
