//! Compares lists and buckets of nodes with plain searches.

use std::sync::Arc;

use super::*;
use crate::certificates::LocalBounds;
use crate::test_models::{Random, strips};

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
