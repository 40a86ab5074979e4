//! Tests of the nodes and pairs of nodes that count as proven in a search.

use std::sync::Arc;

use super::super::local_tables::tables_of;
use super::*;
use crate::certificates::LocalBounds;
use crate::certificates::{EllipsoidBlocks, FactorScales, gradient_len};
use crate::detect::vertex_motion::DeformedMotion;
use crate::test_models::square;
use crate::{Metric, Modes, ReducedModel};

/// Returns the certificate of one node with ratio 1 that allows ratios below `1 / |q|`, for two modes.
fn certificate(node: u32, list: &[(u32, f32)]) -> LocalCertificates {
    let mut ellipsoids = vec![0; EllipsoidBlocks(2).len()];
    [0, 9].iter().for_each(|at| ellipsoids[*at] = (1.0_f32.to_bits() >> 16) as u16);
    LocalCertificates {
        nodes: vec![node],
        mode_starts: vec![0, 2],
        modes: vec![0, 1],
        gradients: vec![0.0; gradient_len(2)],
        ellipsoids,
        bounds: vec![LocalBounds { ratio: 1.0, widest: 1.0, ..LocalBounds::default() }],
        list_starts: vec![0, list.len() as u32],
        list_nodes: list.iter().map(|(m, _)| *m).collect(),
        list_ratios: list.iter().map(|(_, ratio)| *ratio).collect(),
    }
}

/// Begins a search at q, and finds its proven nodes. The radii of the given nodes are not reached.
fn search(
    proofs: &mut LocalProofs<1>,
    (tables, hierarchy): (&LocalTables, &Hierarchy),
    certified: &[u32],
    q: &[f64; 2],
) {
    assert!(proofs.begin(tables, &DeformedMotion::new([&q[..]], 1.0)));
    let mut radii = vec![0.0; hierarchy.nodes().len()];
    certified.iter().for_each(|n| radii[*n as usize] = 2.0);
    proofs.prove(tables, hierarchy, &radii, 1.0);
}

#[test]
fn what_one_search_allowed_is_forgotten_in_the_next() {
    let local = certificate(0, &[]);
    let (tables, hierarchy) = tables_of(&local, &[0.0; 2], &Metric::identity(2));
    let mut proofs = LocalProofs::<1>::new(&tables);
    for (q, is_proven) in [([0.5, 0.0], true), ([1.5, 0.0], false), ([0.0, 0.7], true), ([0.0, 1.2], false)] {
        assert!(proofs.begin(&tables, &DeformedMotion::new([&q[..]], 1.0)));
        assert_eq!(proofs.prove_root(&tables), is_proven, "{q:?}");
        search(&mut proofs, (&tables, &hierarchy), &[], &q);
        assert_eq!(proofs.is_node_proven(&tables, 0), is_proven, "{q:?}");
        assert_eq!(proofs.leaves_most_open(), !is_proven, "{q:?}");
    }
    // The numbers of searches wrap around.
    for (q, is_proven) in [([0.5, 0.0], true), ([1.5, 0.0], false)] {
        proofs.search = u32::MAX;
        search(&mut proofs, (&tables, &hierarchy), &[], &q);
        assert_eq!((proofs.search, proofs.is_node_proven(&tables, 0)), (1, is_proven), "{q:?}");
    }
}

/// Returns a sheet of several buckets.
fn sheet() -> Hierarchy {
    let mesh = square(20);
    let modes = Modes::from_matrix(mesh.rest_positions().len(), 2, |_, _| 1e-3).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    Hierarchy::build(&model, model.metric())
}

#[test]
fn certificates_prove_their_node_and_its_pairs_with_their_list_alone() {
    let hierarchy = sheet();
    let nodes = hierarchy.nodes();
    let children: Vec<u32> = nodes[0].children().collect();
    let [n, a, b, c] = children[..] else { panic!("{children:?}") };
    let local = certificate(n, &[(a, 0.5), (b, 2.0), (c, 0.5)]);
    let scales = FactorScales { sizes: vec![1.0; 2], scale: 1.0, reach: 1.0 };
    let tables = LocalTables::new(&Arc::new(local), &hierarchy, &[0.0; 2], scales).unwrap();
    let first = nodes[n as usize].first_child;
    let range = &tables.buckets[n as usize];
    assert!(range.len() > 1, "{:?}", tables.buckets);
    let mut proofs = LocalProofs::<1>::new(&tables);
    // The radii of half of the buckets are reached, and half of these buckets are proven: enough to evaluate pairs.
    search(&mut proofs, (&tables, &hierarchy), &[b, c], &[0.9, 0.0]);
    // The first bucket of the root is proven.
    assert_eq!(tables.buckets[0].start, tables.buckets[n as usize].start);
    let proven = [0, n, first, a, b, c].map(|n| proofs.is_node_proven(&tables, n));
    assert_eq!(proven, [false, true, true, false, false, false]);
    for (pair, is_proven) in [
        ((n, a), true),
        ((c, n), true),
        ((n, b), false),
        // A part of the node with nodes of the list.
        ((first, a), true),
        ((b, first), false),
        // Two nodes of the list.
        ((a, c), false),
        ((c, a), false),
        ((0, a), false),
    ] {
        assert_eq!(proofs.is_pair_proven(&tables, pair), is_proven, "{pair:?}");
    }
    // Only the ratios of the list are allowed.
    search(&mut proofs, (&tables, &hierarchy), &[b, c], &[1.5, 0.0]);
    assert!(!proofs.is_node_proven(&tables, n) && !proofs.is_pair_proven(&tables, (n, a)));
}
