//! Pseudo-random numbers, the same on every machine (SplitMix64; Steele, Lea and Flood 2014, *Fast Splittable
//! Pseudorandom Number Generators*). The state of a generator is one number, and every number is a state.

/// Difference of two consecutive states.
pub(crate) const INCREMENT: u64 = 0x9e37_79b9_7f4a_7c15;

/// Returns the next 64 bits of a generator.
pub fn next_bits(state: &mut u64) -> u64 {
    *state = state.wrapping_add(INCREMENT);
    let x = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Returns the next number of a generator, uniform in [0, 1).
pub fn next_uniform(state: &mut u64) -> f64 {
    (next_bits(state) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_those_of_the_reference() {
        // From the public-domain program of Vigna (2015), with the state 1234567.
        let state = &mut 1_234_567;
        let numbers = [(); 3].map(|()| next_bits(state));
        assert_eq!(
            numbers,
            [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]
        );
        assert!(next_uniform(state) < 1.0);
    }
}
