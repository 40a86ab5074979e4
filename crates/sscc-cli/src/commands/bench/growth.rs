//! The exponents of `growth` as text.

use sscc_bench::{Exponents, GROWTH_RANK};

/// With which powers of the number of triangles values grow; no lines for a single size.
pub fn exponent_lines(exponents: &Exponents) -> Vec<String> {
    if exponents.certify_seconds.is_none() {
        return Vec::new();
    }
    let line = |name: &str, value: Option<f64>| {
        let value = value.map_or("-".into(), |value| format!("{value:.2}"));
        format!("  {name:<24}{value:>6}")
    };
    let mut lines = vec![
        format!("grows with which power of the number of triangles ({GROWTH_RANK} modes):"),
        line("seconds to certify", exponents.certify_seconds),
        line("memory meanwhile", exponents.certify_peak_bytes),
    ];
    lines.extend(exponents.discrete_ms.0.iter().map(|(key, value)| line(key, *value)));
    lines
}
