//! Vectors of eight single-precision numbers, in the instruction set that the processor has: AVX2, or the baseline.
//!
//! A [`Kernel`] is written once, over [`Vectors`], or over plain numbers that the compiler puts into vectors of the
//! instruction set, as the bounds of certificates do (docs/notes/bounds.md#time-of-certificates). [`InstructionSet`]
//! chooses the vectors at run time. Both kinds round each operation to nearest, and no product is fused with a sum, so a
//! kernel gives the same bits with both (docs/notes/broad-phase.md#instruction-sets).

use glam::{BVec4A, Mat4, Vec4};

/// The number of numbers in a vector.
pub(crate) const LANES: usize = 8;

/// The operations on vectors of eight numbers that kernels use.
pub(crate) trait Vectors: Copy {
    /// Eight numbers.
    type F32s: Copy;
    /// Eight truth values.
    type Mask: Copy;

    /// Returns the same number in all lanes.
    fn splat(self, x: f32) -> Self::F32s;

    /// Returns the numbers of an array.
    fn load(self, x: &[f32; LANES]) -> Self::F32s;

    /// Returns eight integers as numbers.
    fn convert(self, x: &[i16; LANES]) -> Self::F32s;

    /// Returns eight numbers of which the upper halves are given; the lower ones are 0.
    fn load_upper_halves(self, x: &[u16; LANES]) -> Self::F32s;

    /// Returns sums.
    fn add(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;

    /// Returns differences.
    fn subtract(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;

    /// Returns products.
    fn multiply(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;

    /// Returns `a * b + c`, rounded twice.
    fn multiply_add(self, a: Self::F32s, b: Self::F32s, c: Self::F32s) -> Self::F32s;

    /// Returns the magnitudes.
    fn abs(self, x: Self::F32s) -> Self::F32s;

    /// Returns the smaller numbers. None may be NaN.
    fn min(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;

    /// Returns the larger numbers. None may be NaN.
    fn max(self, a: Self::F32s, b: Self::F32s) -> Self::F32s;

    /// Returns the lanes in which the first number is greater.
    fn greater(self, a: Self::F32s, b: Self::F32s) -> Self::Mask;

    /// Returns the lanes of either mask.
    fn or(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;

    /// Returns bit i for lane i.
    fn bits(self, mask: Self::Mask) -> u32;

    /// Returns the lanes as an array.
    fn array(self, x: Self::F32s) -> [f32; LANES];

    /// Returns the points that have these coordinates along each axis, one for each lane; their fourth components are 0.
    fn points(self, coordinates: [Self::F32s; 3]) -> [Vec4; LANES];

    /// Returns the coordinates of eight points along each axis, without their fourth components.
    fn coordinates(self, points: [Vec4; LANES]) -> [Self::F32s; 3];
}

/// A computation on vectors. Implementations of `run` must be `#[inline(always)]`: only then are they compiled for the
/// instruction set of the vectors.
pub(crate) trait Kernel {
    type Output;

    fn run<V: Vectors>(self, vectors: V) -> Self::Output;
}

/// The instruction set of kernels.
#[derive(Clone, Copy)]
pub(crate) enum InstructionSet {
    /// The one that every processor of this kind has.
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2(pulp::x86::V3),
}

impl Default for InstructionSet {
    /// Returns the best one that the processor has.
    fn default() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            return Self::Avx2(simd);
        }
        Self::Baseline
    }
}

impl InstructionSet {
    /// Runs a kernel.
    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            Self::Baseline => kernel.run(Baseline),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(simd) => avx2::run(simd, kernel),
        }
    }

    /// Requests that the processor fetch all of a slice into its caches, where it has AVX2. Loads that depend on each other then
    /// wait for memory once, not one after the other (docs/notes/traversal.md#growth-with-triangles).
    #[inline(always)]
    pub(crate) fn prefetch<T>(self, data: &[T]) {
        match self {
            Self::Baseline => _ = data,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(simd) => avx2::prefetch(simd, data),
        }
    }
}

/// Two vectors of four numbers, which SSE2, NEON and WebAssembly have.
#[derive(Clone, Copy)]
pub(crate) struct Baseline;

impl Vectors for Baseline {
    type F32s = [Vec4; 2];
    type Mask = [BVec4A; 2];

    #[inline(always)]
    fn splat(self, x: f32) -> [Vec4; 2] {
        [Vec4::splat(x); 2]
    }

    #[inline(always)]
    fn load(self, [a, b, c, d, e, f, g, h]: &[f32; LANES]) -> [Vec4; 2] {
        [Vec4::new(*a, *b, *c, *d), Vec4::new(*e, *f, *g, *h)]
    }

    #[inline(always)]
    fn convert(self, x: &[i16; LANES]) -> [Vec4; 2] {
        self.load(&x.map(f32::from))
    }

    #[inline(always)]
    fn load_upper_halves(self, x: &[u16; LANES]) -> [Vec4; 2] {
        self.load(&x.map(|half| f32::from_bits(u32::from(half) << 16)))
    }

    #[inline(always)]
    fn add(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] + b[0], a[1] + b[1]]
    }

    #[inline(always)]
    fn subtract(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] - b[0], a[1] - b[1]]
    }

    #[inline(always)]
    fn multiply(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] * b[0], a[1] * b[1]]
    }

    #[inline(always)]
    fn multiply_add(self, a: [Vec4; 2], b: [Vec4; 2], c: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] * b[0] + c[0], a[1] * b[1] + c[1]]
    }

    #[inline(always)]
    fn abs(self, [low, high]: [Vec4; 2]) -> [Vec4; 2] {
        [low.abs(), high.abs()]
    }

    #[inline(always)]
    fn min(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0].min(b[0]), a[1].min(b[1])]
    }

    #[inline(always)]
    fn max(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0].max(b[0]), a[1].max(b[1])]
    }

    #[inline(always)]
    fn greater(self, a: [Vec4; 2], b: [Vec4; 2]) -> [BVec4A; 2] {
        [a[0].cmpgt(b[0]), a[1].cmpgt(b[1])]
    }

    #[inline(always)]
    fn or(self, a: [BVec4A; 2], b: [BVec4A; 2]) -> [BVec4A; 2] {
        [a[0] | b[0], a[1] | b[1]]
    }

    #[inline(always)]
    fn bits(self, [low, high]: [BVec4A; 2]) -> u32 {
        low.bitmask() | high.bitmask() << 4
    }

    #[inline(always)]
    fn array(self, [low, high]: [Vec4; 2]) -> [f32; LANES] {
        let ([a, b, c, d], [e, f, g, h]) = (low.to_array(), high.to_array());
        [a, b, c, d, e, f, g, h]
    }

    #[inline(always)]
    fn points(self, [x, y, z]: [[Vec4; 2]; 3]) -> [Vec4; LANES] {
        let [low, high] = [0, 1].map(|i| Mat4::from_cols(x[i], y[i], z[i], Vec4::ZERO).transpose());
        [low.x_axis, low.y_axis, low.z_axis, low.w_axis, high.x_axis, high.y_axis, high.z_axis, high.w_axis]
    }

    #[inline(always)]
    fn coordinates(self, [a, b, c, d, e, f, g, h]: [Vec4; LANES]) -> [[Vec4; 2]; 3] {
        let [low, high] = [Mat4::from_cols(a, b, c, d).transpose(), Mat4::from_cols(e, f, g, h).transpose()];
        [[low.x_axis, high.x_axis], [low.y_axis, high.y_axis], [low.z_axis, high.z_axis]]
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{__m256, _CMP_GT_OQ, _MM_HINT_T0};

    use glam::Vec4;
    use pulp::cast;
    use pulp::x86::V3;

    use super::{Kernel, LANES, Vectors};

    /// Runs a kernel, compiled for AVX2.
    #[inline]
    pub(super) fn run<K: Kernel>(simd: V3, kernel: K) -> K::Output {
        simd.vectorize(Run { simd, kernel })
    }

    /// The number of bytes in a line of the caches.
    const LINE: usize = 64;

    /// Requests each line of a slice.
    #[inline(always)]
    pub(super) fn prefetch<T>(simd: V3, data: &[T]) {
        let first = data.as_ptr().cast::<i8>();
        for line in 0..size_of_val(data).div_ceil(LINE) {
            simd.sse._mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(line * LINE));
        }
    }

    struct Run<K> {
        simd: V3,
        kernel: K,
    }

    impl<K: Kernel> pulp::NullaryFnOnce for Run<K> {
        type Output = K::Output;

        #[inline(always)]
        fn call(self) -> K::Output {
            self.kernel.run(self.simd)
        }
    }

    /// Returns two vectors side by side. It is a function, because closures are not inlined.
    #[inline(always)]
    fn pair(simd: V3, low: Vec4, high: Vec4) -> __m256 {
        simd.avx._mm256_insertf128_ps::<1>(simd.avx._mm256_castps128_ps256(low.into()), high.into())
    }

    impl Vectors for V3 {
        type F32s = __m256;
        type Mask = __m256;

        #[inline(always)]
        fn splat(self, x: f32) -> __m256 {
            self.avx._mm256_set1_ps(x)
        }

        #[inline(always)]
        fn load(self, x: &[f32; LANES]) -> __m256 {
            cast(*x)
        }

        #[inline(always)]
        fn convert(self, x: &[i16; LANES]) -> __m256 {
            self.avx._mm256_cvtepi32_ps(self.avx2._mm256_cvtepi16_epi32(cast(*x)))
        }

        #[inline(always)]
        fn load_upper_halves(self, x: &[u16; LANES]) -> __m256 {
            let wide = self.avx2._mm256_cvtepu16_epi32(cast(*x));
            cast(self.avx2._mm256_slli_epi32::<16>(wide))
        }

        #[inline(always)]
        fn add(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_add_ps(a, b)
        }

        #[inline(always)]
        fn subtract(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_sub_ps(a, b)
        }

        #[inline(always)]
        fn multiply(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_mul_ps(a, b)
        }

        #[inline(always)]
        fn multiply_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
            let sum = self.avx._mm256_add_ps(self.avx._mm256_mul_ps(a, b), c);
            with_mutant!(sum, MultiplyAddFused, self.fma._mm256_fmadd_ps(a, b, c))
        }

        #[inline(always)]
        fn abs(self, x: __m256) -> __m256 {
            self.avx._mm256_andnot_ps(self.avx._mm256_set1_ps(-0.0), x)
        }

        #[inline(always)]
        fn min(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_min_ps(a, b)
        }

        #[inline(always)]
        fn max(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_max_ps(a, b)
        }

        #[inline(always)]
        fn greater(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_cmp_ps::<_CMP_GT_OQ>(a, b)
        }

        #[inline(always)]
        fn or(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_or_ps(a, b)
        }

        #[inline(always)]
        fn bits(self, mask: __m256) -> u32 {
            self.avx._mm256_movemask_ps(mask) as u32
        }

        #[inline(always)]
        fn array(self, x: __m256) -> [f32; LANES] {
            cast(x)
        }

        #[inline(always)]
        fn points(self, [x, y, z]: [__m256; 3]) -> [Vec4; LANES] {
            let avx = self.avx;
            let zero = avx._mm256_set1_ps(0.0);
            // Lanes 0, 1, 4, 5 and 2, 3, 6, 7, as (x, z) and (y, 0).
            let [xz, xz_high] = [avx._mm256_unpacklo_ps(x, z), avx._mm256_unpackhi_ps(x, z)];
            let [y0, y0_high] = [avx._mm256_unpacklo_ps(y, zero), avx._mm256_unpackhi_ps(y, zero)];
            // Each has the points of lane i in its low half, and of lane i + 4 in its high half.
            let pairs = [
                avx._mm256_unpacklo_ps(xz, y0),
                avx._mm256_unpackhi_ps(xz, y0),
                avx._mm256_unpacklo_ps(xz_high, y0_high),
                avx._mm256_unpackhi_ps(xz_high, y0_high),
            ];
            let low = |i: usize| Vec4::from(avx._mm256_castps256_ps128(pairs[i]));
            let high = |i: usize| Vec4::from(avx._mm256_extractf128_ps::<1>(pairs[i]));
            [low(0), low(1), low(2), low(3), high(0), high(1), high(2), high(3)]
        }

        #[inline(always)]
        fn coordinates(self, [a, b, c, d, e, f, g, h]: [Vec4; LANES]) -> [__m256; 3] {
            let avx = self.avx;
            // Each has point i in its low half, and point i + 4 in its high half.
            let a = pair(self, a, e);
            let b = pair(self, b, f);
            let c = pair(self, c, g);
            let d = pair(self, d, h);
            // The x and y, and the z, of two points of each half side by side.
            let [xy_ab, xy_cd] = [avx._mm256_unpacklo_ps(a, b), avx._mm256_unpacklo_ps(c, d)];
            let [z_ab, z_cd] = [avx._mm256_unpackhi_ps(a, b), avx._mm256_unpackhi_ps(c, d)];
            [
                avx._mm256_shuffle_ps::<0b0100_0100>(xy_ab, xy_cd),
                avx._mm256_shuffle_ps::<0b1110_1110>(xy_ab, xy_cd),
                avx._mm256_shuffle_ps::<0b0100_0100>(z_ab, z_cd),
            ]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;

    /// Applies all operations to eight integers and eight numbers.
    struct AllOperations([i16; LANES], [f32; LANES]);

    impl Kernel for AllOperations {
        type Output = (Vec<u32>, u32);

        #[inline(always)]
        fn run<V: Vectors>(self, v: V) -> Self::Output {
            let (a, b, c) = (v.convert(&self.0), v.load(&self.1), v.splat(self.1[3]));
            let sum = v.multiply_add(a, b, c);
            let halves = v.load_upper_halves(&self.0.map(|x| x as u16));
            let mask = v.or(v.greater(a, b), v.greater(c, sum));
            let points = v.points([a, b, sum]);
            let again = v.coordinates(points);
            let numbers = v
                .array(sum)
                .into_iter()
                .chain(v.array(v.max(a, b)))
                .chain(points.iter().flat_map(|p| p.to_array()))
                .chain(v.array(halves))
                .chain(
                    [v.min(a, b), v.add(a, b), v.subtract(a, b), v.multiply(a, b), v.abs(b)]
                        .map(|x| v.array(x))
                        .concat(),
                )
                .chain(again.map(|x| v.array(x)).concat());
            (numbers.map(f32::to_bits).collect(), v.bits(mask))
        }
    }

    #[test]
    fn bits_do_not_depend_on_the_instruction_set() {
        let random = &mut Random(11);
        for case in 0..2000 {
            let size = 10.0_f64.powi(case % 70 - 35);
            let integers: [i16; LANES] = std::array::from_fn(|_| (random.signed() * 32767.0) as i16);
            let numbers: [f32; LANES] = std::array::from_fn(|_| (random.signed() * size) as f32);
            let [first, second] = [InstructionSet::default(), InstructionSet::Baseline]
                .map(|set| set.run(AllOperations(integers, numbers)));
            assert_eq!(first, second);
            for lane in 0..LANES {
                let [a, b, c] = [f32::from(integers[lane]), numbers[lane], numbers[3]];
                let sum = a * b + c;
                assert_eq!(first.0[lane], sum.to_bits());
                assert_eq!(first.0[LANES + lane], if a > b { a } else { b }.to_bits());
                assert_eq!(first.0[2 * LANES + 4 * lane..][..4], [a, b, sum, 0.0].map(f32::to_bits));
                assert_eq!(first.0[6 * LANES + lane], u32::from(integers[lane] as u16) << 16);
                assert_eq!(first.1 >> lane & 1 != 0, a > b || c > sum);
                let others = [if a < b { a } else { b }, a + b, a - b, a * b, b.abs(), a, b, sum];
                for (i, expected) in others.into_iter().enumerate() {
                    assert_eq!(first.0[(7 + i) * LANES + lane], expected.to_bits(), "operation {i}");
                }
            }
        }
    }
}
