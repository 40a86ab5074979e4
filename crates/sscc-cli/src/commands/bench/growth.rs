//! The exponents of the scenario `growth` as text.

use sscc_bench::{Exponents, GROWTH_RANK};

/// Returns the growth exponents of costs over the number of triangles, one a line; no lines for a single size.
pub fn exponent_lines(exponents: &Exponents) -> Vec<String> {
    if exponents.certify_seconds.is_none() {
        return Vec::new();
    }
    let line = |name: &str, value: Option<f64>| {
        let value = value.map_or("-".into(), |value| format!("{value:.2}"));
        format!("  {name:<24}{value:>6}")
    };
    let mut lines = vec![
        format!("growth exponents over the number of triangles ({GROWTH_RANK} modes):"),
        line("seconds to certify", exponents.certify_seconds),
        line("peak memory", exponents.certify_peak_bytes),
    ];
    lines.extend(exponents.discrete_ms.0.iter().map(|(key, value)| line(key, *value)));
    lines
}
