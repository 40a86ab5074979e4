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
