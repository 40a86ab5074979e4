//! Products of rows of a matrix with a vector, in four lanes at a time.
//!
//! The products are compiled for AVX2 and for the baseline, and the processor decides which version runs. Both have the same
//! partial sums, and products are not fused with sums, so results do not depend on the instruction set.

use pulp::{Scalar256b, Simd, WithSimd};

/// Row lengths are multiples of this: the number of partial sums of a product.
pub(crate) const ROW_LANES: usize = 2 * LANES;

/// Lanes of a vector.
const LANES: usize = 4;

/// Runs an operation with AVX2 if the processor has it, else with the baseline.
pub(crate) fn dispatch<Op: WithSimd>(op: Op) -> Op::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        return Simd::vectorize(simd, op);
    }
    Simd::vectorize(Scalar256b, op)
}

/// Adds `sum_m weights[m] * rows[m]` to y, and returns the products of the rows with z.
#[inline(always)]
pub(crate) fn add_rows<S: Simd, const N: usize>(
    simd: S,
    rows: [&[f64]; N],
    weights: [f64; N],
    z: &[f64],
    y: &mut [f64],
) -> [f64; N] {
    let (z, _) = S::as_simd_f64s(z);
    let (y, _) = S::as_mut_simd_f64s(y);
    let rows = rows.map(|row| &S::as_simd_f64s(row).0[..z.len()]);
    let weights = weights.map(|weight| simd.splat_f64s(weight));
    let mut sums = [[simd.splat_f64s(0.0); 2]; N];
    let pairs = z.as_chunks::<2>().0.iter().zip(y.as_chunks_mut::<2>().0);
    for (c, (z, y)) in pairs.enumerate() {
        for half in 0..2 {
            let mut own = y[half];
            for m in 0..N {
                let row = rows[m][2 * c + half];
                sums[m][half] = simd.add_f64s(sums[m][half], simd.mul_f64s(row, z[half]));
                own = simd.add_f64s(own, simd.mul_f64s(row, weights[m]));
            }
            y[half] = own;
        }
    }
    sums.map(|sums| total(simd, sums))
}

/// Adds a row, times each of two weights, to each of two vectors. Returns its product with z.
#[inline(always)]
pub(crate) fn add_row_twice<S: Simd>(
    simd: S,
    row: &[f64],
    z: &[f64],
    weights: [f64; 2],
    [first, second]: [&mut [f64]; 2],
) -> f64 {
    let (row, z) = (S::as_simd_f64s(row).0, S::as_simd_f64s(z).0);
    let (first, second) = (S::as_mut_simd_f64s(first).0, S::as_mut_simd_f64s(second).0);
    let weights = weights.map(|weight| simd.splat_f64s(weight));
    let mut sums = [simd.splat_f64s(0.0); 2];
    let sources = row.as_chunks::<2>().0.iter().zip(z.as_chunks::<2>().0);
    let goals = first.as_chunks_mut::<2>().0.iter_mut().zip(second.as_chunks_mut::<2>().0);
    for ((row, z), (first, second)) in sources.zip(goals) {
        for half in 0..2 {
            sums[half] = simd.add_f64s(sums[half], simd.mul_f64s(row[half], z[half]));
            first[half] = simd.add_f64s(first[half], simd.mul_f64s(row[half], weights[0]));
            second[half] = simd.add_f64s(second[half], simd.mul_f64s(row[half], weights[1]));
        }
    }
    total(simd, sums)
}

/// Returns the products of the rows with z.
#[inline(always)]
pub(crate) fn products<S: Simd, const N: usize>(simd: S, rows: [&[f64]; N], z: &[f64]) -> [f64; N] {
    let (z, _) = S::as_simd_f64s(z);
    let rows = rows.map(|row| &S::as_simd_f64s(row).0[..z.len()]);
    let mut sums = [[simd.splat_f64s(0.0); 2]; N];
    for (c, z) in z.as_chunks::<2>().0.iter().enumerate() {
        for half in 0..2 {
            for m in 0..N {
                let product = simd.mul_f64s(rows[m][2 * c + half], z[half]);
                sums[m][half] = simd.add_f64s(sums[m][half], product);
            }
        }
    }
    sums.map(|sums| total(simd, sums))
}

/// Adds `sum_m weights[m] * rows[m]` to y.
#[inline(always)]
pub(crate) fn add_rows_to<S: Simd, const N: usize>(
    simd: S,
    rows: [&[f64]; N],
    weights: [f64; N],
    y: &mut [f64],
) {
    let (y, _) = S::as_mut_simd_f64s(y);
    let rows = rows.map(|row| &S::as_simd_f64s(row).0[..y.len()]);
    let weights = weights.map(|weight| simd.splat_f64s(weight));
    for (c, y) in y.iter_mut().enumerate() {
        for m in 0..N {
            *y = simd.add_f64s(*y, simd.mul_f64s(rows[m][c], weights[m]));
        }
    }
}

/// Returns the sum of all lanes.
#[inline(always)]
fn total<S: Simd>(simd: S, sums: [S::f64s; 2]) -> f64 {
    let mut lanes = [0.0; LANES];
    S::as_mut_simd_f64s(&mut lanes).0[0] = simd.add_f64s(sums[0], sums[1]);
    let [a, b, c, d] = lanes;
    (a + b) + (c + d)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of both functions, as bits.
    struct Sums([Vec<f64>; 3]);

    impl WithSimd for Sums {
        type Output = Vec<u64>;

        fn with_simd<S: Simd>(self, simd: S) -> Vec<u64> {
            let [a, b, z] = &self.0;
            let (mut y, mut first, mut second) = (z.clone(), a.clone(), b.clone());
            let mut all = add_rows(simd, [a, b], [0.1, -0.7], z, &mut y).to_vec();
            all.push(add_row_twice(simd, a, z, [0.3, 1.7], [&mut first, &mut second]));
            all.iter().chain(&y).chain(&first).chain(&second).map(|x| x.to_bits()).collect()
        }
    }

    #[test]
    fn bits_do_not_depend_on_the_instruction_set() {
        for length in [ROW_LANES, 5 * ROW_LANES] {
            let numbers = |phase: f64| (0..length).map(|k| libm::sin(k as f64 + phase)).collect();
            let vectors = || [0.0, 0.1, 0.2].map(numbers);
            assert_eq!(dispatch(Sums(vectors())), Simd::vectorize(Scalar256b, Sums(vectors())));
            // Partial sums round differently from one sum.
            let [a, _, z] = vectors();
            let expected: f64 = a.iter().zip(&z).map(|(a, z): (&f64, &f64)| a * z).sum();
            let sum = f64::from_bits(dispatch(Sums(vectors()))[0]);
            assert!((sum - expected).abs() <= 1e-14 * length as f64, "{sum} {expected}");
        }
    }
}
