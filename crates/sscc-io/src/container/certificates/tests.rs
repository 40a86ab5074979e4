use std::sync::Arc;

use std::sync::LazyLock;

use super::super::MODEL;
use super::*;
use glam::DVec3;
use sscc::{CertifyOptions, Clearance, Metric, MetricKind, Modes, ReducedModel, TriMesh, TriangleGroups};
use sscc_testing::{cases, threshold};

/// A strip of triangles folded over itself, with three modes, one of which moves nothing.
fn model() -> ReducedModel {
    strip(24)
}

/// The same strip with any number of vertices, folded repeatedly.
fn strip(vertices: u32) -> ReducedModel {
    let positions: Vec<DVec3> = (0..vertices)
        .map(|i| {
            let (s, side) = (f64::from(i / 2) * 0.5, f64::from(i % 2));
            DVec3::new(fold(s % 6.0), side, 0.3 * s)
        })
        .collect();
    let faces = (0..vertices - 2).map(|i| [i, i + 1, i + 2]).collect();
    let modes = Modes::from_matrix(vertices as usize, 3, |row, k| {
        if k == 2 { 0.0 } else { ((row * (k + 3)) % 7) as f64 - 3.0 }
    });
    ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes.unwrap()).unwrap()
}

/// Pairs that collide at rest in the model of [`certificates`].
const EXCEPTIONS: usize = 0;

/// Approximates a cosine; the tests only need a fold.
fn fold(x: f64) -> f64 {
    1.0 - x * x / 2.0 + x.powi(4) / 24.0 - x.powi(6) / 720.0
}

/// All options of a scope, in one file.
#[test]
fn every_scope_round_trips() {
    let options = CertifyOptions::default()
        .metric(
            Metric::from_factor(MetricKind::Given, 3, vec![1.0, 0.5, 0.0, 0.0, 2.0, 0.25, 0.0, 0.0, 1.0])
                .unwrap(),
        )
        .center(vec![0.5, -0.25, 1.0])
        .filter(ContactFilter::new(Neighbours::IncludeOneVertex).weld(true))
        .budget(16);
    let certificates = Certificates::compute(&model(), &options, &()).unwrap();
    let mut parts = certificates.parts().clone();
    Arc::make_mut(&mut parts.scope).filter = parts.scope.filter.clone().ignoring([(3, 1), (7, 9)]);
    Arc::make_mut(&mut parts.scope).exceptions = vec![(0, 5), (2, 3)];
    let changed = Certificates::try_from(parts).unwrap();
    for certificates in [certificates, changed] {
        let bytes = certificates_to_bytes(&certificates).unwrap();
        let read = certificates_from_bytes(&bytes).unwrap();
        assert_eq!(read, certificates);
        assert_eq!(certificates_to_bytes(&read).unwrap(), bytes);
    }
}

/// Certificates of the model with groups of triangles.
fn grouped(table: impl Fn(TriangleGroups) -> TriangleGroups) -> Certificates {
    let model = model();
    let of_triangle: Vec<u32> = (0..model.mesh().faces().len() as u32).map(|t| t / 6).collect();
    let filter = ContactFilter::default().with_groups(table(TriangleGroups::new(&of_triangle).unwrap()));
    let options = CertifyOptions::default().filter(filter).budget(16).local_budget(0);
    Certificates::compute(&model, &options, &()).unwrap()
}

#[test]
fn groups_round_trip() {
    let tables: [fn(TriangleGroups) -> TriangleGroups; 3] = [
        TriangleGroups::between_only,
        |groups| groups.ignoring([[0, 2], [3, 3]]).unwrap(),
        |groups| groups.only([[1, 3]]).unwrap(),
    ];
    for table in tables {
        let certificates = grouped(table);
        let bytes = certificates_to_bytes(&certificates).unwrap();
        assert_eq!(Container::parse(&bytes, CERTIFICATES).unwrap().version(), 5);
        let read = certificates_from_bytes(&bytes).unwrap();
        assert_eq!(read, certificates);
        assert!(read.filter().groups().is_some());
        read.check_model(&model()).unwrap();
        assert_eq!(certificates_to_bytes(&read).unwrap(), bytes);
    }
    // A file without groups has the version before.
    let plain = CertifyOptions::default().budget(16).local_budget(0);
    let plain = certificates_to_bytes(&Certificates::compute(&model(), &plain, &()).unwrap()).unwrap();
    assert_eq!(Container::parse(&plain, CERTIFICATES).unwrap().version(), 4);
    assert_eq!(certificates_to_bytes(&grouped(|groups| groups)).unwrap(), plain);
}

#[test]
fn clearances_round_trip_and_damaged_ones_are_rejected() {
    let clearance = Clearance::new(0.01).unwrap().beyond_rings(3);
    let options = CertifyOptions::default().clearance(clearance).budget(16);
    let certificates = Certificates::compute(&model(), &options, &()).unwrap();
    let bytes = certificates_to_bytes(&certificates).unwrap();
    let file = Container::parse(&bytes, CERTIFICATES).unwrap();
    assert_eq!(file.version(), 8);
    let read = certificates_from_bytes(&bytes).unwrap();
    assert_eq!((&read, read.clearance()), (&certificates, Some(clearance)));
    read.check_model(&model()).unwrap();
    assert_eq!(certificates_to_bytes(&read).unwrap(), bytes);
    let changed = |version: u32, distance: &[f64], rings: Option<u32>| {
        let mut writer = ContainerWriter::new(super::super::Kind { version, ..CERTIFICATES });
        copy(&file, &mut writer, &["clearance", "clearance_rings"]);
        if !distance.is_empty() {
            writer.f64("clearance", &[distance.len()], distance);
        }
        if let Some(rings) = rings {
            writer.u32("clearance_rings", &[1], &[rings]);
        }
        certificates_from_bytes(&writer.finish().unwrap())
    };
    let refused =
        |version, distance: &[f64], rings| changed(version, distance, rings).unwrap_err().to_string();
    assert!(refused(7, &[0.01], Some(3)).contains("not known in this version of the format"));
    for distance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(8, &[distance], Some(3)).contains("must be positive and finite"), "{distance}");
    }
    assert!(
        changed(8, &[0.01], None).is_err()
            && changed(8, &[], Some(3)).is_err()
            && changed(8, &[1.0, 2.0], Some(3)).is_err()
    );
    // Certificates with another clearance are read, but refused for the model.
    for (distance, rings) in [(&[0.02][..], Some(3)), (&[0.01], Some(2)), (&[], None)] {
        assert!(changed(8, distance, rings).unwrap().check_model(&model()).is_err());
    }
    for end in 0..bytes.len() {
        assert!(certificates_from_bytes(&bytes[..end]).is_err());
    }
    for at in (0..bytes.len()).step_by(7) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 1 << (at % 8);
        assert!(certificates_from_bytes(&flipped).is_err(), "{at}");
    }
}

#[test]
fn damaged_groups_are_rejected() {
    let bytes = certificates_to_bytes(&grouped(|groups| groups.only([[1, 3]]).unwrap())).unwrap();
    let file = Container::parse(&bytes, CERTIFICATES).unwrap();
    let message = |version: u32, change: &dyn Fn(&mut ContainerWriter)| {
        let mut writer = ContainerWriter::new(super::super::Kind { version, ..CERTIFICATES });
        copy(&file, &mut writer, &["groups", "group_pairs"]);
        change(&mut writer);
        certificates_from_bytes(&writer.finish().unwrap()).map_err(|error| error.to_string())
    };
    let write = |groups: &'static [u32], rule: &'static str, pairs: &'static [u32]| {
        move |w: &mut ContainerWriter| {
            _ = w.text("group_pairs", rule);
            _ = w.u32("groups", &[groups.len()], groups).u32("group_pairs", &[pairs.len() / 2, 2], pairs);
        }
    };
    const GROUPS: &[u32] = &[0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 3, 3, 3, 3];
    message(5, &write(GROUPS, "counted", &[1, 3])).unwrap().check_model(&model()).unwrap();
    let refused = |version, groups, rule, pairs| message(version, &write(groups, rule, pairs)).unwrap_err();
    assert!(refused(4, GROUPS, "counted", &[1, 3]).contains("not known in this version of the format"));
    assert!(refused(5, GROUPS, "other", &[1, 3]).contains("'other' is not known in this version"));
    assert!(refused(5, &GROUPS[1..], "counted", &[1, 3]).contains("not the number of triangles"));
    assert!(refused(5, &[65_536], "counted", &[]).contains("at most 65536 groups"));
    assert!(refused(5, GROUPS, "counted", &[1, 4]).contains("group 4 does not exist"));
    for pairs in [&[3, 1][..], &[1, 3, 0, 1], &[1, 3, 1, 3]] {
        assert!(refused(5, GROUPS, "counted", pairs).contains("pairs are not in order"));
    }
    assert!(
        message(5, &|w| _ = w.u32("group_pairs", &[0, 2], &[])).unwrap_err().contains("groups': missing")
    );
    assert!(message(5, &|w| _ = w.u32("groups", &[22], &[0; 22])).unwrap_err().contains("missing"));
    // Certificates with other groups, or another table, are refused for the model.
    let other = message(5, &write(GROUPS, "ignored", &[1, 3])).unwrap();
    assert!(other.check_model(&model()).is_err());
    assert!(message(5, &|_| ()).unwrap().check_model(&model()).is_err());
}

fn certificates() -> Certificates {
    static ONCE: LazyLock<Certificates> = LazyLock::new(|| {
        let options = CertifyOptions::default().budget(16).local_budget(512);
        Certificates::compute(&model(), &options, &()).unwrap()
    });
    ONCE.clone()
}

fn sample() -> Vec<u8> {
    certificates_to_bytes(&certificates()).unwrap()
}

/// Copies all tensors and text entries of a file except those in `absent`.
fn copy(file: &Container<'_>, writer: &mut ContainerWriter, absent: &[&str]) {
    for key in ["metric", "scheme", "neighbours", "weld"].iter().filter(|key| !absent.contains(*key)) {
        writer.text(key, file.text(key).unwrap());
    }
    let names = file.names();
    for tensor in names.iter().filter(|tensor| !absent.contains(&tensor.as_str())) {
        if let Ok(t) = file.f64(tensor) {
            writer.f64(tensor, &t.shape, &t.values);
        } else if let Ok(t) = file.u32(tensor) {
            writer.u32(tensor, &t.shape, &t.values);
        } else if let Ok(t) = file.f32(tensor) {
            writer.f32(tensor, &t.shape, &t.values);
        } else if let Ok(t) = file.u64(tensor) {
            writer.u64(tensor, &t.shape, &t.values);
        } else {
            let t = file.u8(tensor).unwrap();
            writer.u8(tensor, &t.shape, &t.values);
        }
    }
}

/// Reads a valid file with one entry replaced and a valid digest; returns the error message.
fn with(name: &str, change: impl Fn(&mut ContainerWriter)) -> String {
    let bytes = sample();
    let file = Container::parse(&bytes, CERTIFICATES).unwrap();
    let mut writer = ContainerWriter::new(CERTIFICATES);
    copy(&file, &mut writer, &[name]);
    change(&mut writer);
    certificates_from_bytes(&writer.finish().unwrap()).unwrap_err().to_string()
}

#[test]
fn round_trip_is_exact() {
    let (model, certificates) = (model(), certificates());
    let LocalCertificates { nodes, list_nodes, .. } = &*certificates.parts().local;
    assert!(nodes.len() > 1 && !list_nodes.is_empty());
    let read = certificates_from_bytes(&sample()).unwrap();
    assert_eq!(read, certificates);
    read.check_model(&model).unwrap();
    assert_eq!(certificates_to_bytes(&read).unwrap(), sample());
}

/// Reads certificates of the model as an older version wrote them, with the paper's scheme.
fn older(
    version: u32,
    absent: &[&str],
    change: impl Fn(&mut ContainerWriter),
) -> Result<Certificates, FormatError> {
    let options = CertifyOptions::default().max_exceptions(0).budget(0).local_budget(0);
    let certificates = Certificates::compute(&model(), &options, &()).unwrap();
    let bytes = certificates_to_bytes(&certificates).unwrap();
    let file = Container::parse(&bytes, CERTIFICATES).unwrap();
    let mut writer = ContainerWriter::new(super::super::Kind { version, ..CERTIFICATES });
    let tree = ["pair_limit", "pair_links", "pair_radii", "pair_starts"];
    copy(&file, &mut writer, &[absent, &tree].concat());
    change(&mut writer);
    let read = certificates_from_bytes(&writer.finish().unwrap())?;
    assert_eq!(read, certificates);
    Ok(read)
}

/// Version 1 has no contact filter options.
#[test]
fn version_1_is_read() {
    let read = older(1, &["ignored"], |w| _ = w.text("pairs", "root-children")).unwrap();
    read.check_model(&model()).unwrap();
    // The digest of this model as that version computed it.
    assert_eq!(read.parts().digest.short(), "01b8aa45");
}

/// Version 2 has no pair tree.
#[test]
fn version_2_is_read() {
    older(2, &[], |w| _ = w.text("pairs", "root-children")).unwrap();
    let message = |changed: Result<_, FormatError>| changed.unwrap_err().to_string();
    assert!(message(older(2, &[], |_| ())).ends_with("missing"));
    assert!(message(older(2, &[], |w| _ = w.text("pairs", "all"))).ends_with("of the format"));
    // This file was written by version 2 itself.
    let bytes = include_bytes!("version_2.sscc.safetensors");
    let file = Container::parse(bytes, CERTIFICATES).unwrap();
    assert_eq!((file.version(), file.text("pairs").unwrap()), (2, "root-children"));
    let read = certificates_from_bytes(bytes).unwrap();
    read.check_model(&model()).unwrap();
    assert_eq!((read.parts().pair_tree.limit(), read.exceptions().len()), (0.0, EXCEPTIONS));
    let again = certificates_to_bytes(&read).unwrap();
    assert_eq!(Container::parse(&again, CERTIFICATES).unwrap().text("scheme").unwrap(), "paper");
    assert_eq!(certificates_from_bytes(&again).unwrap(), read);
}

/// Pair trees of version 3 include pairs within buckets.
#[test]
fn version_3_is_read_without_its_pair_tree() {
    let options = CertifyOptions::default().budget(512).local_budget(0);
    let certificates = Certificates::compute(&strip(900), &options, &()).unwrap();
    assert!(!certificates.parts().pair_tree.is_empty());
    let bytes = certificates_to_bytes(&certificates).unwrap();
    let mut writer = ContainerWriter::new(super::super::Kind { version: 3, ..CERTIFICATES });
    copy(&Container::parse(&bytes, CERTIFICATES).unwrap(), &mut writer, &[]);
    let read = certificates_from_bytes(&writer.finish().unwrap()).unwrap();
    assert_eq!(read.parts().pair_tree, sscc::parts::PairTree::default());
    assert_eq!(read.parts().node_radii, certificates.parts().node_radii);
}

#[test]
fn infinite_radii_round_trip() {
    let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
    let still = ReducedModel::new(mesh, Modes::new(1, vec![DVec3::ZERO; 3]).unwrap()).unwrap();
    let certificates = Certificates::compute(&still, &CertifyOptions::default(), &()).unwrap();
    assert_eq!(certificates.global_radius(), f64::INFINITY);
    let read = certificates_from_bytes(&certificates_to_bytes(&certificates).unwrap()).unwrap();
    assert_eq!(read, certificates);
}

#[test]
fn every_flipped_byte_and_truncation_is_rejected() {
    let bytes = sample();
    for at in 0..bytes.len() {
        let mut flipped = bytes.clone();
        flipped[at] ^= 1 << (at % 8);
        assert!(certificates_from_bytes(&flipped).is_err(), "byte {at}");
        assert!(certificates_from_bytes(&bytes[..at]).is_err(), "length {at}");
    }
    assert!(certificates_from_bytes(&[&bytes[..], b"\0"].concat()).is_err());
}

#[test]
fn other_kinds_and_newer_versions_are_rejected() {
    let model_file = ContainerWriter::new(MODEL).finish().unwrap();
    let message = |bytes: &[u8]| certificates_from_bytes(bytes).unwrap_err().to_string();
    assert_eq!(message(&model_file), "this is a model file, a certificate file was expected");
    let newer = ContainerWriter::new(super::super::Kind { version: 9, ..CERTIFICATES }).finish().unwrap();
    assert!(message(&newer).contains("written by a newer sscc (format version 9"));
}

#[test]
fn unknown_values_and_tensors_are_rejected() {
    let unknown = "is not known in this version of the format";
    for key in ["scheme", "neighbours", "weld"] {
        assert!(with(key, |w| _ = w.text(key, "other")).ends_with(unknown), "{key}");
    }
    assert!(with("", |w| _ = w.u8("kinetic", &[1], &[0])).starts_with("tensor 'kinetic': not known"));
    assert!(with("center", |w| _ = w.f64("center", &[3], &[0.0, f64::NAN, 0.0])).contains("not finite"));
    assert!(with("center", |w| _ = w.f64("center", &[2], &[0.0; 2])).contains("[3] was expected"));
    for name in ["exceptions", "ignored"] {
        for pairs in [&[3, 1][..], &[1, 1], &[1, 3, 0, 2], &[0, 1, 0, 1]] {
            let message = with(name, |w| _ = w.u32(name, &[pairs.len() / 2, 2], pairs));
            assert!(message.ends_with("pairs are not in order"), "{message}");
        }
    }
}

#[test]
fn inconsistent_parts_are_rejected() {
    let nodes = certificates().parts().hierarchy.nodes().len();
    let order = |values: Vec<u32>| with("order", |w| _ = w.u32("order", &[values.len()], &values));
    assert!(order((0..21).collect()).contains("hierarchy: "));
    assert!(order(vec![0; 22]).contains("hierarchy: a triangle is listed twice"));
    assert!(with("nodes", |w| _ = w.u32("nodes", &[0, 4], &[])).contains("hierarchy: it has no nodes"));
    assert!(with("nodes", |w| _ = w.u32("nodes", &[1, 4], &[0, 22, 1, 4])).contains("hierarchy: "));
    assert!(with("nodes", |w| _ = w.u32("nodes", &[1, 4], &[0, 22, 0, 0])).contains("was expected"));
    for bad in [f64::NAN, -1.0] {
        let message = with("node_radii", |w| _ = w.f64("node_radii", &[nodes], &vec![bad; nodes]));
        assert!(message.contains("it does not agree") || message.contains("negative"), "{message}");
        assert!(with("epsilon", |w| _ = w.f64("epsilon", &[1], &[bad])).ends_with("between 0 and 1"));
        let limit = with("limit", |w| _ = w.f64("limit", &[1], &[bad]));
        assert!(limit.contains("does not agree") || limit.contains("not positive"), "{limit}");
    }
    assert!(with("node_states", |w| _ = w.u8("node_states", &[nodes], &vec![2; nodes])).contains("agree"));
    assert!(
        with("metric_scales", |w| _ = w.f64("metric_scales", &[2], &[1.0; 2])).contains("[2] was expected")
    );
    assert!(with("metric_scales", |w| _ = w.f64("metric_scales", &[0], &[])).contains("no modes"));
    assert!(with("metric", |w| _ = w.text("metric", "gold")).ends_with("unknown metric 'gold'"));
    assert!(with("model_digest", |w| _ = w.u8("model_digest", &[3], &[0; 3])).contains("[32] was expected"));
}

/// The scheme only names the content; the pair tree and local certificates decide.
#[test]
fn the_scheme_agrees_with_the_pair_tree() {
    assert!(with("scheme", |w| _ = w.text("scheme", "paper")).contains("does not agree"));
    for (budget, local_budget, scheme) in
        [(0, 0, "paper"), (0, 64, "full"), (16, 0, "full"), (16, 64, "full")]
    {
        let options = CertifyOptions::default().budget(budget).local_budget(local_budget);
        let bytes = certificates_to_bytes(&Certificates::compute(&model(), &options, &()).unwrap()).unwrap();
        let file = Container::parse(&bytes, CERTIFICATES).unwrap();
        assert_eq!(file.text("scheme").unwrap(), scheme, "{budget} {local_budget}");
        assert_eq!(file.version(), if local_budget == 0 { 4 } else { 7 });
        certificates_from_bytes(&bytes).unwrap();
    }
}

/// Replaces numbers of the pair tree and truncates its arrays: reading fails, or queries can traverse the tree.
#[test]
fn damaged_pair_trees_are_rejected_or_harmless() {
    let model = strip(900);
    let options = CertifyOptions::default().budget(512);
    let good = Certificates::compute(&model, &options, &()).unwrap();
    let tree = &good.parts().pair_tree;
    let (radii, links): (Vec<f32>, Vec<u32>) = tree.entries().unzip();
    let starts = tree.starts().to_vec();
    let ends = links.iter().filter(|link| **link << 4 == 0).count();
    assert!(ends > 20 && links.len() - ends > 20, "{ends} of {}", links.len());
    let bytes = certificates_to_bytes(&good).unwrap();
    let file = Container::parse(&bytes, CERTIFICATES).unwrap();
    let mut rejected = 0;
    let mut read = |limit: f64, starts: &[u32], radii: &[f32], links: &[u32]| {
        let mut writer = ContainerWriter::new(CERTIFICATES);
        copy(&file, &mut writer, &["pair_limit", "pair_links", "pair_radii", "pair_starts"]);
        writer
            .f64("pair_limit", &[1], &[limit])
            .u32("pair_starts", &[starts.len()], starts)
            .f32("pair_radii", &[radii.len()], radii)
            .u32("pair_links", &[links.len()], links);
        match certificates_from_bytes(&writer.finish().unwrap()) {
            Ok(certificates) => {
                let mut query = sscc::Query::new(&model, &certificates).unwrap();
                for q in [[0.01, 0.0, 0.0], [0.1, -0.1, 1.0], [1.0, 1.0, 0.0]] {
                    query.discrete(&q).unwrap();
                    query.continuous(&[0.0; 3], &q).unwrap();
                    query.safe_scale(&q).unwrap();
                }
                String::new()
            }
            Err(error) => {
                rejected += 1;
                error.to_string()
            }
        }
    };
    let limit = tree.limit();
    assert_eq!(read(limit, &starts, &radii, &links), "");
    for bad in [f64::NAN, -1.0, f64::INFINITY, 0.0, limit / 1e6] {
        assert!(!read(bad, &starts, &radii, &links).is_empty(), "limit {bad}");
    }
    for at in (0..starts.len()).step_by(starts.len().div_ceil(cases(32))) {
        for other in [0, 1, starts[at].wrapping_add(1), u32::MAX, u32::MAX - 1, 1 << 28] {
            let mut changed = starts.clone();
            changed[at] = other;
            let message = read(limit, &changed, &radii, &links);
            assert_eq!(message.is_empty(), changed == starts, "start {at}: {other}: {message}");
        }
        assert!(!read(limit, &starts[..at], &radii, &links).is_empty());
    }
    let stride = links.len().div_ceil(cases(24));
    for at in (0..links.len()).step_by(stride) {
        for bit in 0..32 {
            let mut changed = links.clone();
            changed[at] ^= 1 << bit;
            read(limit, &starts, &radii, &changed);
        }
        for other in [f32::NAN, -1.0, f32::INFINITY, f32::MAX] {
            let mut changed = radii.clone();
            changed[at] = other;
            assert!(!read(limit, &starts, &changed, &links).is_empty(), "radius {at}: {other}");
        }
        assert!(!read(limit, &starts, &radii[..at], &links[..at]).is_empty());
        assert!(!read(limit, &starts, &radii[..at], &links).is_empty());
    }
    assert!(
        !read(limit, &starts, &[&radii[..], &[0.0]].concat(), &[&links[..], &[1 << 31]].concat()).is_empty()
    );
    assert!(rejected > threshold(400), "{rejected} with {} links", links.len());
}

mod local_certificates;
