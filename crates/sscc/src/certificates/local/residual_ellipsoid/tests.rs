//! Tests quotients of rows by W against exact arithmetic.

use sscc_testing::{Dyadic, Numbers};

use super::*;
use crate::vectors::InstructionSet;

fn exact(x: f64) -> Dyadic {
    Dyadic::new(x)
}

#[test]
fn images_times_the_matrix_are_the_rows() {
    let random = &mut Numbers(3);
    let mut worst = 0.0_f64;
    for case in 0..300 {
        // One block of columns, or several.
        let rank = if case % 20 == 19 { [8, 9, 15, 16, 17, 24][case / 20 % 6] } else { 1 + case % 7 };
        let row_len = rank.next_multiple_of(8);
        let [size, decay] = [random.power(-8.0, 8.0), random.power(-3.0, 0.0)];
        let mut row = || -> Vec<f64> {
            let entry = |k: usize| if k < rank { size * decay.powi(k as i32) * random.signed() } else { 0.0 };
            (0..row_len).map(entry).collect()
        };
        let blocks: Vec<f64> = (0..3 * (1 + case % 5)).flat_map(|_| row()).collect();
        let rows: Vec<f64> = (0..3).flat_map(|_| row()).collect();
        let fit = FitEllipsoid { blocks: &blocks, rank, row_len };
        let ellipsoid = InstructionSet::default().run(fit).unwrap();
        let mut images = rows.clone();
        ellipsoid.divide(&mut images);
        let (mut wrong, mut square) = (exact(0.0), exact(0.0));
        for (image, row) in images.chunks(row_len).zip(rows.chunks(row_len)) {
            for k in 0..rank {
                let product: Dyadic = (0..=k).map(|i| exact(image[i]) * exact(ellipsoid.entry(i, k))).sum();
                let error = product - exact(row[k]);
                wrong += &error * &error;
                square += exact(row[k]) * exact(row[k]);
            }
        }
        let defect = exact(ellipsoid.defect());
        assert!(wrong <= &defect * &defect * &square, "case {case}");
        // Entries are stored as they were used.
        let stored: Vec<u16> = ellipsoid.numbers().collect();
        let lanes = crate::vectors::LANES;
        for k in 0..rank {
            for i in 0..lanes {
                let expected = if i < rank { ellipsoid.entry(i, k) } else { 0.0 };
                // The first eight rows come first, with all their columns.
                assert_eq!(f64::from(upper_half_number(stored[lanes * k + i])), expected);
            }
            let square = |x: f64| exact(x) * exact(x);
            let column: Dyadic = (0..=k).map(|i| square(ellipsoid.entry(i, k))).sum();
            assert!(square(ellipsoid.largest_column()) >= column);
        }
        worst = worst.max(ellipsoid.defect());
    }
    assert!(worst > 1e-14 && worst < 1e-6, "{worst}");
}

#[test]
fn numbers_out_of_range_have_no_ellipsoid() {
    for odd in [f64::NAN, f64::INFINITY, 1e200, 1e30] {
        let blocks = [vec![odd], vec![0.5; 23]].concat();
        let fit = FitEllipsoid { blocks: &blocks, rank: 8, row_len: 8 };
        assert!(InstructionSet::default().run(fit).is_none(), "{odd}");
    }
}

fn norm(numbers: &[f64]) -> f64 {
    numbers.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Returns an ellipsoid of given rows, with any matrix as the inverse.
fn given(rank: usize, rows: Vec<f64>, inverse: Vec<f64>) -> ResidualEllipsoid {
    ResidualEllipsoid { rank, row_len: rank.next_multiple_of(8), rows, inverse }
}

/// Inverses that are wrong by far show the part of the product, and exact inverses that of rounding.
#[test]
fn defects_are_those_of_the_product_and_of_its_rounding() {
    let random = &mut Numbers(5);
    for rank in 1..=20_usize {
        let row_len = rank.next_multiple_of(8);
        let mut upper = || -> Vec<f64> {
            let mut entry = |i: usize, k: usize| {
                let x = 3.0 * random.signed();
                if (i..rank).contains(&k) { x } else { 0.0 }
            };
            (0..rank * row_len).map(|e| entry(e / row_len, e % row_len)).collect()
        };
        let (rows, inverse) = (upper(), upper());
        let mut square = 0.0;
        for (i, k) in (0..rank).flat_map(|i| (0..rank).map(move |k| (i, k))) {
            let product: f64 = (0..rank).map(|j| inverse[i * row_len + j] * rows[j * row_len + k]).sum();
            square += if i == k { (product - 1.0).powi(2) } else { product.powi(2) };
        }
        let excess = given(rank, rows, inverse).defect() / square.sqrt() - 1.0;
        assert!((0.9e-9..1.1e-9).contains(&excess), "rank {rank}: {excess}");
    }
    for case in 0..60_usize {
        let rank = 1 + case % 10;
        let row_len = rank.next_multiple_of(8);
        // W = D (I + N) with small integers N above the diagonal and powers of two in D.
        let scales: Vec<f64> = (0..rank).map(|_| 2.0_f64.powi(random.below(9) as i32 - 4)).collect();
        let (mut rows, mut inverse) = (vec![0.0; rank * row_len], vec![0.0; rank * row_len]);
        for i in (0..rank).rev() {
            let unit: Vec<f64> = (i + 1..rank).map(|_| random.below(3) as f64 - 1.0).collect();
            rows[i * row_len + i] = scales[i];
            inverse[i * row_len + i] = 1.0 / scales[i];
            for (j, x) in (i + 1..rank).zip(&unit) {
                rows[i * row_len + j] = scales[i] * x;
                for k in j..rank {
                    inverse[i * row_len + k] -= x * inverse[j * row_len + k];
                }
            }
        }
        let rounding = 4.0 * (rank as f64 + 4.0) * f64::EPSILON * norm(&inverse) * norm(&rows);
        let column = |k: usize| (0..rank).map(|i| rows[i * row_len + k].powi(2)).sum::<f64>().sqrt();
        let widest = (0..rank).map(column).fold(0.0, f64::max);
        let ellipsoid = given(rank, rows, inverse);
        let found = ellipsoid.defect();
        assert!((found / rounding - 1.0).abs() < 1e-12, "case {case}: {found} {rounding}");
        let found = ellipsoid.largest_column();
        assert!(found >= widest && found < widest * (1.0 + 1e-11), "case {case}: {found} {widest}");
    }
}

fn fitted(blocks: &[f64], rank: usize) -> ResidualEllipsoid {
    let fit = FitEllipsoid { blocks, rank, row_len: rank.next_multiple_of(8) };
    InstructionSet::default().run(fit).unwrap()
}

/// `W'W` of one block is its Gram matrix, apart from what is added to the diagonal and the digits of entries.
#[test]
fn the_ellipsoid_of_one_block_is_that_of_its_gram_matrix() {
    let random = &mut Numbers(6);
    for rank in 1..=20_usize {
        let row_len = rank.next_multiple_of(8);
        let mut block = vec![0.0; 3 * row_len];
        for (e, x) in block.iter_mut().enumerate().filter(|(e, _)| e % row_len < rank) {
            *x = random.signed() * [1.0, 0.3, 2.0][e / row_len];
        }
        let ellipsoid = fitted(&block, rank);
        let product = |k: usize, l: usize| -> f64 {
            (0..3).map(|c| block[c * row_len + k] * block[c * row_len + l]).sum()
        };
        let more = 1e-4 * (0..rank).map(|k| product(k, k)).sum::<f64>();
        for (k, l) in (0..rank).flat_map(|k| (0..rank).map(move |l| (k, l))) {
            let entry = |i: usize| ellipsoid.entry(i, k) * ellipsoid.entry(i, l);
            let found: f64 = (0..rank).map(entry).sum();
            let [expected, x, y] = [product(k, l), product(k, k) + more, product(l, l) + more];
            let expected = if k == l { x } else { expected };
            assert!((found - expected).abs() < 0.01 * (x * y).sqrt(), "rank {rank}: {k} {l}");
        }
        for i in 0..rank {
            assert!((0..i).all(|k| ellipsoid.entry(i, k) == 0.0), "rank {rank}: {i}");
        }
    }
}

/// Nine blocks along the first mode weigh as much together as one along the second, and a mode without
/// residuals has a hundredth of the root of the trace.
#[test]
fn blocks_of_many_equal_residuals_weigh_as_much_as_one() {
    for single in [0, 4, 9] {
        let mut blocks = vec![0.0; 10 * 24];
        for (i, block) in blocks.chunks_exact_mut(24).enumerate() {
            // The second row is that of the second axis.
            block[if i == single { 8 + 1 } else { 0 }] = 1.0;
        }
        let ellipsoid = fitted(&blocks, 3);
        for (i, expected) in [0.5_f64.sqrt(), 0.5_f64.sqrt(), 0.01].into_iter().enumerate() {
            let found = ellipsoid.entry(i, i);
            assert!((found / expected - 1.0).abs() < 0.01, "{single}: {found} {expected}");
        }
    }
}

#[test]
fn entries_are_rounded_to_the_nearest_even_half() {
    for (bits, half) in [
        (0x3f80_0000, 0x3f80),
        (0x3f80_7fff, 0x3f80),
        (0x3f80_8000, 0x3f80),
        (0x3f80_8001, 0x3f81),
        (0x3f81_7fff, 0x3f81),
        (0x3f81_8000, 0x3f82),
        (0xbf81_8000, 0xbf82),
        (0xbf80_8000, 0xbf80),
        (0, 0),
    ] {
        assert_eq!(upper_half(f32::from_bits(bits)), half, "{bits:x}");
    }
}
