//! Compares lists and buckets of nodes with plain searches.

use std::sync::Arc;

use super::*;
use crate::certificates::LocalBounds;
use crate::test_models::{Random, square, strips};
use crate::{Modes, ReducedModel};

/// The lists set few bits or all bits.
#[test]
fn every_node_of_a_list_is_found_and_no_other() {
    let (model, _) = strips(&mut Random(3), 1);
    let hierarchy = Hierarchy::build(&model, model.metric());
    for (list, is_long) in [(vec![7, 64, 1 << 20], false), ((0..300).map(|i| 3 * i + 1).collect(), true)] {
        let ratio = |node: u32| node as f32 + 0.5;
        let local = LocalCertificates {
            nodes: vec![0],
            mode_starts: vec![0, 0],
            bounds: vec![LocalBounds::default()],
            list_starts: vec![0, list.len() as u32],
            list_ratios: list.iter().map(|node| ratio(*node)).collect(),
            list_nodes: list.clone(),
            ..LocalCertificates::default()
        };
        let scales = FactorScales { sizes: Vec::new(), scale: 1.0, reach: 1.0 };
        let tables = LocalTables::new(&Arc::new(local.clone()), &hierarchy, &[], scales).unwrap();
        assert_eq!(tables.list_bits[0] == u64::MAX, is_long);
        for node in (0..2000).chain([1 << 20, u32::MAX]) {
            assert_eq!(tables.ratio_with(0, node), list.contains(&node).then(|| ratio(node)), "{node}");
        }
    }
}

#[test]
fn numbers_and_buckets_begin_where_those_before_end() {
    let mesh = square(20);
    let modes = Modes::from_matrix(mesh.rest_positions().len(), 2, |_, _| 1e-3).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let hierarchy = Hierarchy::build(&model, model.metric());
    let nodes = hierarchy.nodes();
    // Certificates of 3, 17, 0, 8 and 9 modes.
    let local = LocalCertificates {
        nodes: (0..5).collect(),
        mode_starts: vec![0, 3, 20, 20, 28, 37],
        bounds: vec![LocalBounds::default(); 5],
        list_starts: vec![0; 6],
        ..LocalCertificates::default()
    };
    let scales = FactorScales { sizes: Vec::new(), scale: 1.0, reach: 1.0 };
    let tables = LocalTables::new(&Arc::new(local), &hierarchy, &[], scales).unwrap();
    assert_eq!(tables.starts, [[0, 0], [4, 3], [24, 30], [24, 30], [33, 38]]);
    let (mut buckets, mut stack) = (Vec::new(), vec![0_u32]);
    while let Some(n) = stack.pop() {
        let node = &nodes[n as usize];
        if node.fits_in_bucket() {
            buckets.push(node.first_triangle..node.first_triangle + node.triangle_count);
        } else {
            stack.extend(node.children());
        }
    }
    assert!(buckets.len() > 8);
    for (node, found) in nodes.iter().zip(&tables.buckets) {
        let last = node.first_triangle + node.triangle_count;
        let start = buckets.iter().filter(|bucket| bucket.end <= node.first_triangle).count() as u32;
        let end = buckets.iter().filter(|bucket| bucket.start < last).count() as u32;
        assert_eq!(*found, start..end);
    }
}
