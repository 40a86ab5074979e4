//! A double as an integer times a power of two, for exact arithmetic.

/// A finite number as `mantissa * 2^(exponent - 1075)`, exactly. The exponent is at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Binary64 {
    pub(super) mantissa: i64,
    pub(super) exponent: u32,
}

impl Binary64 {
    pub(super) fn of(x: f64) -> Self {
        const FRACTION_BITS: u32 = 52;
        let bits = x.to_bits();
        let biased = (bits >> FRACTION_BITS) as u32 & 0x7ff;
        let fraction = (bits & ((1 << FRACTION_BITS) - 1)) as i64;
        // A denormal number has the exponent of the smallest normal ones, without their leading 1.
        let (mantissa, exponent) =
            if biased == 0 { (fraction, 1) } else { (fraction | 1 << FRACTION_BITS, biased) };
        Self { mantissa: if x < 0.0 { -mantissa } else { mantissa }, exponent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_decode_exactly() {
        for (x, mantissa, exponent) in [
            (0.0, 0, 1),
            (-0.0, 0, 1),
            (f64::from_bits(1), 1, 1),
            (-f64::MIN_POSITIVE, -(1 << 52), 1),
            (1.5, 3 << 51, 1023),
            (-f64::MAX, 1 - (1 << 53), 2046),
        ] {
            assert_eq!(Binary64::of(x), Binary64 { mantissa, exponent }, "{x:e}");
        }
    }
}
