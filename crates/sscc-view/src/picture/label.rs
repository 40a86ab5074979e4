//! Lines of text in a picture.

use super::glyphs::{HEIGHT, WIDTH, strokes};
use super::image::Image;

/// Height of a line (pixels).
pub const LINE: usize = 20;

/// Pixels for a unit of the grid of letters.
const SCALE: f64 = 1.7;

/// Distance from one letter to the next (pixels).
const ADVANCE: f64 = 10.0;

/// Half the width of a stroke (pixels).
const PEN: f64 = 0.75;

/// Samples along each side of a pixel.
const SAMPLES: usize = 4;

/// Empty space beside a label (pixels).
const MARGIN: f64 = 8.0;

/// Largest number of lines of a label.
const MAX_LINES: usize = 6;

/// Ends a label that has more lines.
const ELLIPSIS: &str = "...";

/// Breaks a text into lines for a width (pixels): after blanks and punctuation where there is any, else anywhere.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let fitting = ((width as f64 - 2.0 * MARGIN) / ADVANCE).max(1.0 + ELLIPSIS.len() as f64) as usize;
    let letters: Vec<char> = text.chars().take(fitting * MAX_LINES + 1).collect();
    let (mut lines, mut rest) = (Vec::new(), &letters[..]);
    while rest.len() > fitting {
        if lines.len() + 1 == MAX_LINES {
            let kept = &rest[..fitting - ELLIPSIS.len()];
            lines.push(kept.iter().copied().chain(ELLIPSIS.chars()).collect());
            return lines;
        }
        let is_break = |c: &char| matches!(c, ' ' | '_' | '.' | '-' | ':' | '/');
        let end = rest[..fitting].iter().rposition(is_break).map_or(fitting, |at| at + 1);
        lines.push(rest[..end].iter().collect());
        rest = &rest[end..];
    }
    lines.push(rest.iter().collect());
    lines
}

/// Draws a line of text in the middle of a width (pixels) from `left` on.
pub fn draw(image: &mut Image, text: &str, left: usize, width: usize, top: usize) {
    let count = text.chars().count() as f64;
    let length = (count - 1.0) * ADVANCE + WIDTH * SCALE;
    let begin = left as f64 + ((width as f64 - length) / 2.0).round();
    let upper = top as f64 + ((LINE as f64 - HEIGHT * SCALE) / 2.0).round() + 0.5;
    for (i, letter) in text.chars().enumerate() {
        draw_letter(image, letter, [begin + i as f64 * ADVANCE + 0.5, upper]);
    }
}

/// Draws a letter; `at`: the upper left corner of its grid.
fn draw_letter(image: &mut Image, letter: char, at: [f64; 2]) {
    let placed = |point: [f64; 2]| [0, 1].map(|axis| at[axis] + SCALE * point[axis]);
    let segments: Vec<[[f64; 2]; 2]> = strokes(letter)
        .flat_map(|stroke| {
            let ends = stroke.iter().skip(1).chain(stroke.last());
            stroke.iter().zip(ends).map(|(a, b)| [placed(*a), placed(*b)]).collect::<Vec<_>>()
        })
        .collect();
    // A pixel of space for the pen. `as` converts coordinates left of the picture or above it to 0.
    let [lower, upper] = [[0.0; 2], [WIDTH, HEIGHT]].map(placed);
    for y in (lower[1] - 1.0) as usize..=(upper[1] + 1.0) as usize {
        for x in (lower[0] - 1.0) as usize..=(upper[0] + 1.0) as usize {
            let offset = |i: usize| (i as f64 + 0.5) / SAMPLES as f64;
            let samples = (0..SAMPLES * SAMPLES)
                .map(|i| [x as f64 + offset(i % SAMPLES), y as f64 + offset(i / SAMPLES)]);
            let covered = samples.filter(|p| segments.iter().any(|s| is_covered(*s, *p))).count();
            image.ink(x, y, covered as f64 / (SAMPLES * SAMPLES) as f64);
        }
    }
}

/// Whether a point is at most the pen's half width from a segment.
fn is_covered([a, b]: [[f64; 2]; 2], p: [f64; 2]) -> bool {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = along[0] * along[0] + along[1] * along[1];
    let share = if square > 0.0 { (along[0] * to[0] + along[1] * to[1]) / square } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    let away = [to[0] - share * along[0], to[1] - share * along[1]];
    away[0] * away[0] + away[1] * away[1] <= PEN * PEN
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_whole_and_break_at_punctuation() {
        assert_eq!(wrapped("jawOpen", 160), ["jawOpen"]);
        assert_eq!(wrapped("mouth_corner_pulls_left", 160), ["mouth_corner_", "pulls_left"]);
        assert_eq!(wrapped(&"x".repeat(30), 160), ["x".repeat(14), "x".repeat(14), "xx".into()]);
        assert_eq!(wrapped("", 160), [""]);
        let long = wrapped(&"y".repeat(100_000), 160);
        assert_eq!((long.len(), long[5].as_str()), (6, "yyyyyyyyyyy..."));
        assert!(wrapped("abcdef", 0).iter().all(|line| line.len() <= 4));
    }

    #[test]
    fn letters_are_drawn_within_their_line() {
        let mut image = Image::new(60, 40);
        draw(&mut image, "Tg", 10, 40, 10);
        let inked: Vec<(usize, usize)> =
            (0..2400).map(|i| (i % 60, i / 60)).filter(|(x, y)| image.at(*x, *y) != image.at(0, 0)).collect();
        assert!(inked.len() > 30);
        assert!(inked.iter().all(|(x, y)| (20..40).contains(x) && (10..30).contains(y)), "{inked:?}");
        // The bar of the T is darkest in its middle.
        let dark = inked.iter().filter(|(x, y)| image.at(*x, *y)[0] < 90).count();
        assert!(dark > 10, "{dark}");
        // Beyond the picture nothing is drawn.
        draw(&mut image, "beyond", 55, 4, 39);
    }
}
