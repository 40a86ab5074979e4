//! Tests of tables of groups against sets of pairs.

use std::collections::BTreeSet;

use super::*;

/// Returns a pseudo-random number below n.
fn random(state: &mut u64, n: u64) -> u32 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    ((*state >> 33) % n) as u32
}

#[test]
fn tables_exclude_the_same_pairs_as_sets() {
    let state = &mut 5;
    for case in 0..400 {
        let count = 1 + random(state, 7);
        let of_triangle: Vec<u32> = (0..count).chain((0..9).map(|_| random(state, count.into()))).collect();
        let mut groups = TriangleGroups::new(&of_triangle).unwrap();
        let mut ignored = BTreeSet::new();
        let all = || (0..count).flat_map(|g| (g..count).map(move |h| (g, h)));
        for _ in 0..random(state, 4) {
            let pairs: Vec<[u32; 2]> = (0..random(state, 9))
                .map(|_| [random(state, count.into()), random(state, count.into())])
                .collect();
            let sorted: BTreeSet<(u32, u32)> = pairs.iter().map(|[a, b]| (*a.min(b), *a.max(b))).collect();
            match random(state, 4) {
                0 => {
                    groups = groups.only(pairs).unwrap();
                    ignored = all().filter(|pair| !sorted.contains(pair)).collect();
                }
                1 => {
                    groups = groups.between_only();
                    ignored.extend((0..count).map(|g| (g, g)));
                }
                _ => {
                    groups = groups.ignoring(pairs).unwrap();
                    ignored.extend(sorted);
                }
            }
        }
        for (a, g) in of_triangle.iter().enumerate() {
            for (b, h) in of_triangle.iter().enumerate() {
                let expected = !ignored.contains(&(*g.min(h), *g.max(h)));
                assert_eq!(groups.is_pair_counted(a as u32, b as u32), expected, "case {case}: {g} {h}");
            }
        }
        assert_eq!(groups.is_all_counted(), ignored.is_empty(), "case {case}");
        // However a table was made, it has one form, which lists at most half of the pairs.
        let again = TriangleGroups::new(&of_triangle).unwrap();
        assert_eq!(
            again.clone().ignoring(ignored.iter().map(|(a, b)| [*a, *b])).unwrap(),
            groups,
            "case {case}"
        );
        assert_eq!(
            again.only(all().filter(|pair| !ignored.contains(pair)).map(|(a, b)| [a, b])).unwrap(),
            groups,
            "case {case}"
        );
        assert!(2 * groups.listed().count() <= all().count(), "case {case}");
        assert!(groups.listed().is_sorted_by(|x, y| x < y) && groups.listed().all(|(g, h)| g <= h));
    }
}

#[test]
fn groups_out_of_range_are_refused() {
    let message = |result: Result<TriangleGroups, Error>| result.unwrap_err().to_string();
    assert_eq!(
        message(TriangleGroups::new(&[0, 65_536])),
        "groups: triangle 1 (counted from 0) is in group 65536: at most 65536 groups are supported, numbered from 0"
    );
    let groups = || TriangleGroups::new(&[0, 4, 65_535]).unwrap();
    assert_eq!(groups().group_count(), 65_536);
    assert!(!groups().between_only().is_pair_counted(1, 1));
    let other = || TriangleGroups::new(&[0, 4]).unwrap();
    assert_eq!(
        message(other().ignoring([[1, 5]])),
        "groups: group 5 does not exist: those of the triangles are 0 to 4"
    );
    assert!(message(other().only([[u32::MAX, 0]])).contains("group 4294967295 does not exist"));
    let none = || TriangleGroups::new(&[]).unwrap();
    assert!(message(none().ignoring([[0, 0]])).contains("there are no triangles"));
    assert!(none().between_only().is_all_counted());
}

#[test]
fn groups_are_split_between_meshes() {
    let scene = TriangleGroups::new(&[0, 1, 2, 0, 1]).unwrap().ignoring([[0, 1]]).unwrap();
    let of_meshes = scene.of_meshes(&[2, 0, 3]).unwrap();
    let numbers: Vec<Vec<u16>> = of_meshes.iter().map(|groups| groups.of_triangles().to_vec()).collect();
    assert_eq!(numbers, [vec![0, 1], vec![], vec![2, 0, 1]]);
    for groups in &of_meshes {
        assert!(groups.is_common_with(&of_meshes[0]));
        assert!(!groups.is_counted(0, 1) && groups.is_counted(0, 2));
    }
}

/// Groups with other numbers or another table are not equal, for certificates hold for one table alone. Files store tables as
/// they are here.
#[test]
fn groups_are_equal_if_the_same_pairs_count() {
    let groups = |of_triangle: [u32; 4]| TriangleGroups::new(&of_triangle).unwrap();
    let ignoring = groups([0, 1, 2, 1]).ignoring([[0, 1]]).unwrap();
    let only = groups([0, 1, 2, 1]).only([[0, 1]]).unwrap();
    assert_eq!(ignoring, ignoring.of_meshes(&[4]).unwrap()[0]);
    for other in [
        only.clone(),
        groups([0, 1, 2, 1]),
        groups([0, 1, 2, 1]).ignoring([[0, 2]]).unwrap(),
        groups([0, 1, 2, 2]).ignoring([[0, 1]]).unwrap(),
        groups([0, 1, 3, 1]).ignoring([[0, 1]]).unwrap(),
    ] {
        assert_ne!(ignoring, other);
    }
    for (groups, others_count) in [(&ignoring, true), (&only, false)] {
        let table = GroupTable::from(groups);
        assert_eq!((table.count, table.others_count, &table.listed[..]), (3, others_count, &[[0, 1]][..]));
        assert_eq!(table.of_triangles, [0, 1, 2, 1]);
        for (g, h) in (0..3_u16).flat_map(|g| (g..3).map(move |h| (g, h))) {
            assert_eq!(groups.is_counted(g, h), table.listed.contains(&[g, h]) != table.others_count);
        }
    }
}
