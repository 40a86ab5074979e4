//! Tests that queries of the rows of a trajectory, answered in blocks, equal single queries.

#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use glam::DVec3;
use sscc::parts::Scope;
use sscc::{Answer, Method, Modes, Pair, Query, ReducedModel, TriMesh};
use sscc_io::Rows;
use sscc_tasks::{ContactOptions, RowQueries, TaskError, check_rows};

/// Returns a torus of 24 x 12 vertices. The first mode moves its halves towards each other and, from about -1.4, into each
/// other. The second bends it.
fn ring() -> ReducedModel {
    let (around, across) = (24, 12);
    let grid = || (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let vertices: Vec<DVec3> = grid()
        .map(|(i, j)| {
            let (u, v) = (TAU * f64::from(i) / f64::from(around), TAU * f64::from(j) / f64::from(across));
            let radius = 1.0 + 0.3 * v.cos();
            DVec3::new(radius * u.cos(), radius * u.sin(), 0.3 * v.sin())
        })
        .collect();
    let at = |i: u32, j: u32| i % around * across + j % across;
    let faces = grid().flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let faces = faces.collect();
    let modes =
        vertices.iter().flat_map(|p| [DVec3::X * p.x.clamp(-0.5, 0.5), DVec3::Z * p.x * p.x]).collect();
    ReducedModel::new(TriMesh::new(vertices, faces).unwrap(), Modes::new(2, modes).unwrap()).unwrap()
}

/// Returns 57 q in which halves move together and apart again.
fn trajectory() -> Rows {
    let rows = 57;
    let data = (0..rows).flat_map(|i| [-2.4 * (f64::from(i) / 9.0).sin().abs(), 0.1 * f64::from(i % 5)]);
    Rows { rows: rows as usize, columns: 2, data: data.collect() }
}

/// An answer, its duration and whether it is complete.
struct Row {
    answer: (usize, Vec<Pair>, Option<f64>, Option<bool>),
    counters: [u64; 3],
    penetrations: Option<usize>,
    is_complete: bool,
    microseconds: f64,
}

fn rows(
    query: &mut Query,
    requests: &RowQueries<'_>,
    mut last: impl FnMut(usize) -> bool,
) -> Result<Vec<Row>, TaskError> {
    let mut all = Vec::new();
    check_rows(query, requests, &(), |found| {
        all.push(Row {
            answer: (found.index, found.pairs.to_vec(), found.norm, found.root_certified),
            counters: [found.opened, found.box_tests, found.triangle_tests],
            penetrations: found.penetrations.map(<[_]>::len),
            is_complete: found.is_complete,
            microseconds: found.microseconds,
        });
        let next = if last(found.index) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        Ok::<_, TaskError>(next)
    })?;
    Ok(all)
}

/// Returns the number of rows that were answered together with the row before. Such rows have the same duration, bit for bit.
fn in_blocks(rows: &[Row]) -> usize {
    rows.windows(2).filter(|pair| pair[0].microseconds == pair[1].microseconds).count()
}

#[test]
fn rows_in_blocks_are_those_of_single_queries() {
    let (model, trajectory) = (ring(), trajectory());
    let scope = || Scope::of(&model);
    // A query by brute force takes longer than starting threads.
    let query = || Query::without_certificates(&model, scope(), Method::BruteForce).unwrap();
    let requests = |limit, threads| RowQueries {
        model: &model,
        rows: &trajectory,
        is_continuous: false,
        limit,
        clearance: None,
        threads,
        is_certified: false,
        contacts: ContactOptions { depths: true, curves: false },
    };
    let mut single = query();
    let expected: Vec<Answer> = trajectory
        .iter()
        .map(|q| {
            let pairs = single.discrete(q).unwrap().to_vec();
            Answer { pairs, statistics: single.statistics() }
        })
        .collect();
    assert!(expected.iter().filter(|answer| answer.pairs.is_empty()).count() > 5);
    assert!(expected.iter().filter(|answer| answer.pairs.len() > 5).count() > 5);

    for threads in [Some(1), Some(2), None] {
        let found = rows(&mut query(), &requests(None, threads), |_| false).unwrap();
        assert!(in_blocks(&found) > 40);
        assert_eq!(found.len(), expected.len());
        for (index, (row, expected)) in found.iter().zip(&expected).enumerate() {
            let Answer { pairs, statistics } = expected;
            assert_eq!(
                row.answer,
                (index, pairs.clone(), Some(statistics.norm), Some(statistics.root_certified))
            );
            let counters = [statistics.opened, statistics.box_tests, statistics.triangle_tests];
            assert_eq!(row.counters, counters);
            assert_eq!(row.penetrations, Some(pairs.len()));
            assert!(row.is_complete);
        }

        let limit = 3;
        let found = rows(&mut query(), &requests(Some(limit), threads), |_| false).unwrap();
        assert!(in_blocks(&found) > 40);
        for (row, expected) in found.iter().zip(&expected) {
            let all = &expected.pairs;
            assert_eq!(row.answer.1.len(), limit.min(all.len()));
            assert!(row.answer.1.iter().all(|pair| all.contains(pair)));
            assert!(if row.is_complete { all.len() <= limit } else { all.len() >= limit });
        }

        // The caller ends within a block.
        let found = rows(&mut query(), &requests(None, threads), |index| index == 40).unwrap();
        assert_eq!(found.len(), 41);
        assert_eq!(found[39].microseconds, found[40].microseconds);
    }
}

/// A row that is not a configuration ends the queries. All rows before it are answered.
#[test]
fn a_row_that_is_no_configuration_is_refused() {
    let (model, mut trajectory) = (ring(), trajectory());
    trajectory.data[2 * 50] = f64::NAN;
    let mut query = Query::without_certificates(&model, Scope::of(&model), Method::BruteForce).unwrap();
    let contacts = ContactOptions::default();
    let requests = RowQueries {
        model: &model,
        rows: &trajectory,
        is_continuous: false,
        limit: None,
        clearance: None,
        threads: None,
        is_certified: false,
        contacts,
    };
    let mut answered = 0;
    let result = rows(&mut query, &requests, |index| {
        answered = index;
        false
    });
    assert!(result.is_err());
    assert_eq!(answered, 49);
}
