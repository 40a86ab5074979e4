//! Formats numbers and names for messages and tables.

use std::fmt::Write as _;
use std::path::Path;

/// Returns text with control characters escaped, so that it is one line. Errors name files, and names of files may have
/// line breaks.
pub fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() {
            let _ = write!(line, "{}", c.escape_debug());
        } else {
            line.push(c);
        }
    }
    line
}

/// Returns the name of a file without its folder.
pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Maximum length of a text that an error repeats.
const MAX_SHOWN: usize = 60;

/// Returns the beginning of a text on one line, in quotes.
pub fn quoted(text: &str) -> String {
    let mut shown: String = one_line(text.trim()).chars().take(MAX_SHOWN + 1).collect();
    if shown.chars().count() > MAX_SHOWN {
        shown.pop();
        shown += "...";
    }
    format!("'{shown}'")
}

/// Formats a radius or a length with four significant digits, and below 1e6 with all digits before the point;
/// "unlimited" if it is infinite.
pub fn length(value: f64) -> String {
    match value {
        0.0 => "0".into(),
        v if v.is_infinite() => "unlimited".into(),
        v if (1e-3..1e6).contains(&v.abs()) => {
            let decimals = (3 - v.abs().log10().floor() as i32).clamp(0, 6) as usize;
            format!("{v:.decimals$}")
        }
        v => format!("{v:.3e}"),
    }
}

/// Formats longest side (m), mass (kg) and first frequency (Hz) of a body. Wrong units of a size are visible in each of them.
/// Without a mass the text states that the body is held.
pub fn size_and_mass(side: f64, mass: Option<f64>, first: f64) -> String {
    let mass = mass.map_or_else(|| "held".into(), |mass| format!("mass {} kg", length(mass)));
    format!("longest side {} m, {mass}, first mode {} Hz", length(side), length(first))
}

/// Formats a number with its noun: "1 pair", "2 pairs".
pub fn counted(count: impl Into<u64>, noun: &str) -> String {
    match count.into() {
        1 => format!("1 {noun}"),
        n => format!("{} {noun}s", grouped(n)),
    }
}

/// Formats a number in groups of three digits: "1,234,567".
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Formats a time, given in microseconds, with a fitting unit.
pub fn duration(microseconds: f64) -> String {
    match microseconds {
        t if t < 1.0 => format!("{:.0} ns", t * 1e3),
        t if t < 1e3 => format!("{t:.1} us"),
        t if t < 1e6 => format!("{:.2} ms", t / 1e3),
        t => format!("{:.2} s", t / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_groups_units_and_four_digits() {
        assert_eq!([0, 999, 16_000, 1_234_567].map(grouped), ["0", "999", "16,000", "1,234,567"]);
        assert_eq!(counted(1_u32, "pair"), "1 pair");
        assert_eq!(counted(0_u32, "pair"), "0 pairs");
        assert_eq!(
            [0.0, f64::INFINITY, 0.012_345, 1234.56, 1e-9].map(length),
            ["0", "unlimited", "0.01235", "1235", "1.000e-9"]
        );
        assert_eq!([0.05, 3.21, 4500.0, 2e6].map(duration), ["50 ns", "3.2 us", "4.50 ms", "2.00 s"]);
    }

    #[test]
    fn any_text_fits_on_one_line() {
        assert_eq!(one_line("a\nb\u{1b}[1m'c'"), "a\\nb\\u{1b}[1m'c'");
    }
}
