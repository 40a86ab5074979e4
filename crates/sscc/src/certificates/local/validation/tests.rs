//! Tests that each inconsistent part is refused with a message of its own.

use std::sync::Arc;

use glam::DVec3;

use super::*;
use crate::certificates::test_models::ring;
use crate::certificates::{CertificateParts, Certificates};
use crate::test_models::square;
use crate::{CertifyOptions, Method, Modes, Query, ReducedModel};

const RANK: usize = 11;

fn parts() -> CertificateParts {
    let options = CertifyOptions::default().budget(0).local_budget(4096);
    Certificates::compute(&ring(300, RANK, 0.4), &options, &()).unwrap().parts().clone()
}

#[test]
fn each_inconsistent_part_is_refused() {
    let parts = parts();
    let LocalCertificates { nodes, mode_starts, list_starts, .. } = &*parts.local;
    assert!(nodes.len() > 4 && mode_starts[1] as usize == RANK && list_starts[2] > list_starts[1] + 1);
    assert!(parts.local.list_ratios.iter().any(|ratio| ratio.is_finite()));
    let changed = |change: &dyn Fn(&mut LocalCertificates)| {
        let mut parts = parts.clone();
        change(Arc::make_mut(&mut parts.local));
        match Certificates::try_from(parts) {
            Ok(certificates) => {
                let model = ring(300, RANK, 0.4);
                let mut query = Query::new(&model, &certificates).unwrap();
                query.discrete(&[0.1; RANK]).unwrap();
                query.continuous(&[0.1; RANK], &[0.2; RANK]).unwrap();
                String::new()
            }
            Err(error) => error.to_string(),
        }
    };
    assert_eq!(changed(&|_| ()), "");
    assert_eq!(changed(&|local| *local = LocalCertificates::default()), "");
    let infinite = |local: &mut LocalCertificates| {
        local.bounds[1].ratio = f64::INFINITY;
        local.bounds[2].flatness = f64::INFINITY;
        local.list_ratios[0] = f32::INFINITY;
    };
    assert_eq!(changed(&infinite), "");
    type Change<'c> = &'c dyn Fn(&mut LocalCertificates);
    let count = parts.hierarchy.nodes().len() as u32;
    let within = parts.hierarchy.nodes_within_buckets().iter().position(|within| *within).unwrap() as u32;
    let second = list_starts[1] as usize;
    let own = nodes[1];
    let all: [(&str, &[Change<'_>]); 13] = [
        (
            "they have numbers, but no nodes",
            &[&|local| local.nodes.clear(), &|local| {
                *local = LocalCertificates { mode_starts: vec![0], ..LocalCertificates::default() };
            }],
        ),
        (
            "nodes are out of order, do not exist, or are inside a bucket",
            &[
                &|local| local.nodes.swap(0, 1),
                &|local| local.nodes[1] = local.nodes[0],
                &|local| *local.nodes.last_mut().unwrap() = count,
                &|local| *local.nodes.last_mut().unwrap() = u32::MAX,
                &|local| {
                    *local.nodes.last_mut().unwrap() = within.max(local.nodes[local.nodes.len() - 2] + 1)
                },
            ],
        ),
        (
            "modes of certificates are out of order",
            &[
                &|local| _ = local.mode_starts.pop(),
                &|local| local.mode_starts[0] = 1,
                &|local| local.mode_starts.swap(1, 2),
                &|local| local.mode_starts[1] = u32::MAX,
                &|local| *local.mode_starts.last_mut().unwrap() += 1,
                &|local| local.modes.push(0),
                &|local| local.mode_starts.clear(),
            ],
        ),
        (
            "modes of a certificate are out of order, or do not exist",
            &[
                &|local| local.modes[1] = local.modes[0],
                &|local| local.modes.swap(2, 3),
                &|local| local.modes[RANK - 1] = RANK as u32,
                &|local| local.modes[RANK - 1] = u32::MAX,
            ],
        ),
        (
            "gradients or ellipsoids are not those of their modes",
            &[
                &|local| _ = local.gradients.pop(),
                &|local| local.gradients.extend([0.0; 8]),
                &|local| _ = local.ellipsoids.pop(),
                &|local| local.ellipsoids.extend([0; 8]),
                &|local| local.gradients.clear(),
                // With one mode less, the layout is another one.
                &|local| {
                    local.modes.remove(3);
                    local.mode_starts[1..].iter_mut().for_each(|start| *start -= 1);
                },
            ],
        ),
        (
            "a gradient is not finite",
            &[&|local| local.gradients[5] = f32::NAN, &|local| local.gradients[6] = f32::NEG_INFINITY],
        ),
        (
            "an ellipsoid is not finite",
            &[&|local| local.ellipsoids[7] = 0x7f80, &|local| local.ellipsoids[8] = 0xffff],
        ),
        (
            "the number of bounds is not the number of certificates",
            &[&|local| _ = local.bounds.pop(), &|local| local.bounds.push(LocalBounds::default())],
        ),
        (
            "a bound is out of range",
            &[
                &|local| local.bounds[0].ratio = f64::NAN,
                &|local| local.bounds[1].ratio = -1.0,
                &|local| local.bounds[0].per_factor = f64::INFINITY,
                &|local| local.bounds[2].per_factor = f64::NAN,
                &|local| local.bounds[0].per_error = -1e-300,
                &|local| local.bounds[1].per_error = f64::NAN,
                &|local| local.bounds[0].steepest = f64::NEG_INFINITY,
                &|local| local.bounds[0].widest = f64::NAN,
                &|local| local.bounds[0].widest = -1.0,
                &|local| local.bounds[0].across = [1.5, 0.0, 0.0],
                &|local| local.bounds[1].across = [0.0, f64::NAN, 0.0],
                &|local| local.bounds[2].across[2] = f64::INFINITY,
                &|local| local.bounds[0].flatness = f64::NAN,
                &|local| local.bounds[1].flatness = -1.0,
                &|local| local.bounds[0].flatness = f64::NEG_INFINITY,
            ],
        ),
        (
            "a ratio is negative or not a number",
            &[&|local| local.list_ratios[1] = f32::NAN, &|local| local.list_ratios[0] = -1.0],
        ),
        (
            "lists of certificates are out of order",
            &[
                &|local| _ = local.list_starts.pop(),
                &|local| local.list_starts[0] = 1,
                &|local| local.list_starts[1] = local.list_starts[2] + 1,
                &|local| local.list_starts[1] = u32::MAX,
                &|local| *local.list_starts.last_mut().unwrap() += 1,
                &|local| {
                    local.list_nodes.push(count - 1);
                    local.list_ratios.push(0.0);
                },
            ],
        ),
        (
            "nodes of a list are out of order, do not exist, or are inside a bucket",
            &[
                &|local| local.list_nodes[second + 1] = local.list_nodes[second],
                &|local| local.list_nodes[second] = u32::MAX,
                &|local| *local.list_nodes.last_mut().unwrap() = count,
            ],
        ),
        (
            "a node of a list has triangles of the certificate's node",
            &[&|local| local.list_nodes[second] = 0, &|local| {
                local.list_nodes.splice(second..local.list_starts[2] as usize, [own]);
                let removed = local.list_starts[2] - local.list_starts[1] - 1;
                local.list_ratios.truncate(local.list_nodes.len());
                local.list_starts[2..].iter_mut().for_each(|start| *start -= removed);
            }],
        ),
    ];
    for (cause, changes) in all {
        for (at, change) in changes.iter().enumerate() {
            let message = changed(change);
            assert!(message.contains(&format!("local certificates: {cause};")), "{cause}, {at}: {message}");
        }
    }
    assert!(changed(&|local| _ = local.list_ratios.pop()).contains("is not the number of nodes in lists"));
}

/// Would fail if a mode more than queries have room for were accepted.
#[test]
fn too_many_modes_are_refused() {
    let parts = parts();
    let many = |count: usize| {
        let mut local = LocalCertificates::clone(&parts.local);
        local.nodes.truncate(1);
        local.bounds.truncate(1);
        local.mode_starts = vec![0, count as u32];
        local.modes = (0..count as u32).collect();
        local.gradients = vec![0.0; gradient_len(count)];
        local.ellipsoids = vec![0; EllipsoidBlocks(count).len()];
        local.list_starts = vec![0, 0];
        local.list_nodes.clear();
        local.list_ratios.clear();
        local.check(&parts.hierarchy, 1000)
    };
    assert_eq!((many(0), many(1), many(MOST_MODES)), (Ok(()), Ok(()), Ok(())));
    assert_eq!(many(MOST_MODES + 1), Err("a certificate has too many modes"));
}

/// Certificates of models of any size pass: also of those whose root is a leaf or as small as a bucket.
#[test]
fn computed_certificates_are_accepted() {
    for (quads, rank, budget) in
        [(2, 1, 0), (4, 2, 64), (9, 3, 4096), (20, 2, 64), (40, 9, 4096), (300, 3, 64)]
    {
        let options = CertifyOptions::default().local_budget(budget);
        let certificates = Certificates::compute(&ring(quads, rank, 0.4), &options, &()).unwrap();
        let parts = certificates.parts();
        let read = Certificates::try_from(parts.clone());
        assert_eq!(read.map_err(|error| error.to_string()).as_ref(), Ok(&certificates), "{quads} quads");
        assert_eq!(parts.local.nodes.is_empty(), budget == 0, "{quads} quads, {budget}");
        // One of two neighbours lists the other one, also if the root is as small as a bucket.
        let children = parts.hierarchy.nodes()[0].child_count as usize;
        assert!(budget == 0 || parts.local.list_nodes.len() + 1 >= children, "{quads} quads");
        // Both budgets together limit all certificates, the hierarchy included.
        let (nodes, order) = (parts.hierarchy.nodes(), parts.hierarchy.order());
        let stored = size_of_val(nodes) + size_of_val(order) + size_of_val(&*parts.node_radii);
        let all = stored + 5 * nodes.len() + parts.pair_tree.bytes() + parts.local.bytes();
        assert!(budget == 0 || all <= (64 + budget) * 2 * quads + 8, "{quads} quads: {all}");
    }
}

/// Would fail if nodes that no mode moves were not certified like others.
#[test]
fn nodes_that_no_mode_moves_are_certified() {
    let whole = ring(150, 3, 0.4);
    let (mesh, rank) = (whole.mesh().clone(), whole.rank());
    for still in [rank, 1] {
        // The first `still` modes move nothing, the others the last vertices only.
        let is_still = |v: usize, k: usize| k < still || v < 200;
        let vertices = mesh.rest_positions().len();
        let displacements = (0..vertices)
            .flat_map(|v| whole.modes().of_vertex(v as u32).iter().enumerate().map(move |(k, u)| (v, k, *u)))
            .map(|(v, k, u)| if is_still(v, k) { DVec3::ZERO } else { u })
            .collect();
        let model = ReducedModel::new(mesh.clone(), Modes::new(rank, displacements).unwrap()).unwrap();
        let options = CertifyOptions::default().local_budget(4096);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let local = &certificates.parts().local;
        let free = |i: &usize| local.mode_starts[*i] == local.mode_starts[*i + 1];
        let counts = (0..local.nodes.len()).filter(free).filter(|i| local.bounds[*i].ratio < 1e-12).count();
        assert!(counts > 2 && (still == rank) == (counts == local.nodes.len()), "{counts}");
        let read = Certificates::try_from(certificates.parts().clone()).unwrap();
        assert_eq!(read, certificates);
        let mut query = Query::new(&model, &read).unwrap();
        let mut brute = Query::with_method(&model, &read, Method::BruteForce).unwrap();
        for scale in [0.0, 0.3, 3.0, 30.0] {
            let q = [scale; 3];
            let expected = brute.discrete(&q).unwrap();
            assert_eq!(query.discrete(&q).unwrap(), expected, "{scale}");
        }
    }
}

/// Returns consistent certificates of the root and of two of its four children, and their hierarchy. They have
/// three modes, one, and none.
fn consistent() -> (LocalCertificates, Hierarchy) {
    let mesh = square(40);
    let modes = Modes::from_matrix(mesh.rest_positions().len(), 1, |_, _| 1e-3).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let hierarchy = Hierarchy::build(&model, model.metric());
    assert_eq!(hierarchy.nodes()[0].children(), 1..5);
    let counts = [3, 1, 0];
    let bounds = LocalBounds {
        ratio: 0.5,
        per_factor: 1e-12,
        per_error: 2.0,
        steepest: 1.0,
        widest: 1.0,
        ..LocalBounds::default()
    };
    let local = LocalCertificates {
        nodes: vec![0, 1, 2],
        mode_starts: vec![0, 3, 4, 4],
        modes: vec![0, 4, 6, 5],
        gradients: vec![0.5; counts.iter().map(|count| gradient_len(*count)).sum()],
        ellipsoids: vec![0x3f80; counts.iter().map(|count| EllipsoidBlocks(*count).len()).sum()],
        bounds: vec![LocalBounds { across: [1.0, 0.0, 0.0], flatness: 0.0, ..bounds }, bounds, bounds],
        list_starts: vec![0, 0, 3, 4],
        list_nodes: vec![2, 3, 4, 1],
        list_ratios: vec![0.0, 0.7, f32::INFINITY, 0.9],
    };
    (local, hierarchy)
}

/// The seventh mode is the last one. In each case only one condition fails.
#[test]
fn each_condition_is_checked_by_itself() {
    type Change<'c> = &'c dyn Fn(&mut LocalCertificates);
    let (local, hierarchy) = consistent();
    let changed = |change: Change<'_>| {
        let mut local = local.clone();
        change(&mut local);
        local.check(&hierarchy, 7)
    };
    assert_eq!(changed(&|_| ()), Ok(()));
    assert_eq!(changed(&|local| *local = LocalCertificates::default()), Ok(()));
    let count = hierarchy.nodes().len() as u32;
    let within = hierarchy.nodes_within_buckets().iter().position(|within| *within).unwrap() as u32;
    assert!(within > 4);
    let all: [(&str, &[Change<'_>]); 13] = [
        ("they have numbers, but no nodes", &[&|local| local.nodes.clear()]),
        (
            "modes of certificates are out of order",
            &[
                &|local| local.mode_starts.push(4),
                &|local| local.mode_starts[0] = 1,
                &|local| local.mode_starts = vec![0, 4, 3, 4],
                &|local| local.modes.push(6),
            ],
        ),
        (
            "modes of a certificate are out of order, or do not exist",
            &[
                &|local| local.modes[1] = 0,
                &|local| local.modes.swap(0, 1),
                &|local| local.modes[2] = 7,
                &|local| local.modes[3] = 7,
            ],
        ),
        (
            "gradients or ellipsoids are not those of their modes",
            &[&|local| _ = local.gradients.pop(), &|local| local.ellipsoids.push(0)],
        ),
        (
            "a gradient is not finite",
            &[&|local| local.gradients[3] = f32::NAN, &|local| local.gradients[9] = f32::NEG_INFINITY],
        ),
        (
            "an ellipsoid is not finite",
            &[&|local| local.ellipsoids[0] = 0x7f80, &|local| local.ellipsoids[9] = 0xff81],
        ),
        (
            "the number of bounds is not the number of certificates",
            &[&|local| _ = local.bounds.pop(), &|local| local.bounds.push(LocalBounds::default())],
        ),
        (
            "a bound is out of range",
            &[
                &|local| local.bounds[0].ratio = -1.0,
                &|local| local.bounds[1].ratio = f64::NAN,
                &|local| local.bounds[2].flatness = -1.0,
                &|local| local.bounds[0].per_factor = f64::INFINITY,
                &|local| local.bounds[1].per_error = -1e-300,
                &|local| local.bounds[1].steepest = f64::NAN,
                &|local| local.bounds[2].widest = f64::INFINITY,
                &|local| local.bounds[0].across = [-1.5, 0.0, 0.0],
                &|local| local.bounds[0].across = [0.8, 0.0, -0.8],
                &|local| local.bounds[1].across = [0.0, 1.0 + 1e-11, 0.0],
                &|local| local.bounds[2].across[2] = f64::NAN,
            ],
        ),
        (
            "a ratio is negative or not a number",
            &[&|local| local.list_ratios[2] = f32::NAN, &|local| local.list_ratios[3] = -1e-30],
        ),
        (
            "nodes are out of order, do not exist, or are inside a bucket",
            &[
                &|local| local.nodes.swap(1, 2),
                &|local| local.nodes[2] = 1,
                &|local| local.nodes[2] = count,
                &|local| local.nodes[2] = within,
            ],
        ),
        (
            "lists of certificates are out of order",
            &[
                &|local| local.list_starts.push(4),
                &|local| local.list_starts = vec![1, 1, 3, 4],
                &|local| local.list_starts = vec![0, 3, 1, 4],
                &|local| {
                    local.list_nodes.push(3);
                    local.list_ratios.push(0.0);
                },
            ],
        ),
        (
            "nodes of a list are out of order, do not exist, or are inside a bucket",
            &[
                &|local| local.list_nodes.swap(0, 1),
                &|local| local.list_nodes[1] = 2,
                &|local| local.list_nodes[2] = count,
                &|local| local.list_nodes[2] = within,
            ],
        ),
        (
            "a node of a list has triangles of the certificate's node",
            &[&|local| local.list_nodes[3] = 2, &|local| local.list_nodes[3] = 0],
        ),
    ];
    for (cause, changes) in all {
        for (at, change) in changes.iter().enumerate() {
            assert_eq!(changed(change), Err(cause), "{at}");
        }
    }
    assert_eq!(
        changed(&|local| _ = local.list_ratios.pop()),
        Err("the number of ratios is not the number of nodes in lists")
    );
    let with_modes = |count: usize| {
        let one = LocalCertificates {
            nodes: vec![0],
            mode_starts: vec![0, count as u32],
            modes: (0..count as u32).collect(),
            gradients: vec![0.0; gradient_len(count)],
            ellipsoids: vec![0; EllipsoidBlocks(count).len()],
            bounds: vec![LocalBounds::default()],
            list_starts: vec![0, 0],
            ..LocalCertificates::default()
        };
        one.check(&hierarchy, 1000)
    };
    assert_eq!(with_modes(MOST_MODES), Ok(()));
    assert_eq!(with_modes(MOST_MODES + 1), Err("a certificate has too many modes"));
}

/// Larger starts would be those of another certificate.
#[test]
#[cfg(target_pointer_width = "64")]
fn starts_have_32_bits() {
    let most = (LANES << 32) - 1;
    assert!(is_addressed(0) && is_addressed(most) && !is_addressed(most + 1) && !is_addressed(usize::MAX));
}
