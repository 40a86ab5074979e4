//! Calls the functions of certificates, queries and audits that may use threads, on a small model. `cargo xtask serial` runs this program without the feature
//! `parallel`, and `cargo test` with it: the expected bits are the same.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use glam::DVec3;
use sscc::{
    AuditOptions, CancelToken, Certificates, CertifyOptions, Error, KineticQuery, Method, ModeRange, Modes,
    Pair, Query, ReducedModel, ResolveOptions, TriMesh, audit,
};

/// Squares along each side of a sheet.
const SIDE: u32 = 6;

/// The expected digest of the root's radius, all pairs, all times, the ends of the sweep and the resolved q, with the feature
/// `parallel` and without it.
const EXPECTED: u64 = 0x777c_5166_4806_4a47;

/// Returns two sheets at a distance of 1. The modes bend, lower and tilt the upper one. All numbers are sums, products and
/// quotients, which are the same on every machine.
fn sheets() -> ReducedModel {
    let (mut positions, mut faces, mut displacements) = (Vec::new(), Vec::new(), Vec::new());
    for z in [0.0, 1.0] {
        let first = positions.len() as u32;
        for (i, j) in (0..=SIDE).flat_map(|i| (0..=SIDE).map(move |j| (i, j))) {
            let [x, y] = [i, j].map(|k| f64::from(k) / f64::from(SIDE) - 0.5);
            positions.push(DVec3::new(x + 0.03 * z, y + 0.05 * z, z));
            displacements.extend([4.0 * x * y - y * y, -1.0, 0.7 * x].map(|dz| DVec3::Z * (z * dz)));
        }
        for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
            let [a, b] = [i, i + 1].map(|i| first + i * (SIDE + 1) + j);
            faces.extend([[a, b, a + 1], [b, b + 1, a + 1]]);
        }
    }
    ReducedModel::new(TriMesh::new(positions, faces).unwrap(), Modes::new(3, displacements).unwrap()).unwrap()
}

/// Returns configurations, some of which collide.
fn samples() -> Vec<[f64; 3]> {
    (0..32).map(|i| f64::from(i) / 32.0).map(|t| [t - 0.4, 1.6 * t, 0.5 - t * t]).collect()
}

/// Adds a number to a digest by FNV-1a.
fn add(hash: &mut u64, number: u64) {
    number
        .to_le_bytes()
        .into_iter()
        .for_each(|byte| *hash = (*hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
}

fn add_pairs(hash: &mut u64, pairs: &[Pair]) {
    pairs.iter().for_each(|&(a, b)| add(hash, (u64::from(a) << 32) | u64::from(b)));
}

#[test]
fn all_answers_have_the_expected_bits() {
    let model = sheets();
    let certificates = Certificates::compute(&model, &CertifyOptions::default().threads(2), &()).unwrap();
    let hash = &mut 0xcbf2_9ce4_8422_2325;
    add(hash, certificates.root_radius().to_bits());

    let mut query = Query::new(&model, &certificates).unwrap();
    let mut brute = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
    let samples = samples();
    let batch = query.batch(&samples, Some(3), &()).unwrap();
    let mut colliding = 0;
    for (q, answer) in samples.iter().zip(&batch) {
        let pairs = brute.discrete(q).unwrap();
        assert_eq!(answer.pairs, pairs);
        assert_eq!(kinetic.discrete(q).unwrap(), pairs);
        colliding += usize::from(!pairs.is_empty());
        add_pairs(hash, pairs);
    }
    assert!(0 < colliding && colliding < samples.len());
    for step in samples.windows(2) {
        for impact in query.continuous(&step[0], &step[1]).unwrap() {
            add_pairs(hash, &[impact.pair]);
            add(hash, impact.time.to_bits());
        }
    }
    let range = ModeRange { mode: 1, low: 0.0, high: 2.0 };
    let sweeps = query.sweep_modes(&[0.0; 3], &[range], Some(2), &()).unwrap();
    let weights = sweeps.iter().filter_map(|sweep| sweep.first_free);
    weights.for_each(|weight| add(hash, weight.to_bits()));
    let free = query.resolve_batch(&samples, &ResolveOptions::default(), None, &()).unwrap();
    free.iter().filter_map(|found| found.q.as_ref()).flatten().for_each(|x| add(hash, x.to_bits()));
    assert_eq!(*hash, EXPECTED, "{hash:#018x}");
}

#[test]
fn an_audit_finds_no_violation() {
    let model = sheets();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let options = AuditOptions::default().samples(60).threads(2);
    let report = audit(&model, &certificates, &options, &()).unwrap();
    assert!(report.samples > 0 && report.violations.is_empty());
}

#[test]
fn a_cancelled_computation_ends() {
    let token = CancelToken::new();
    token.cancel();
    let cancelled = Certificates::compute(&sheets(), &CertifyOptions::default(), &token);
    assert!(matches!(cancelled, Err(Error::Cancelled)));
}
