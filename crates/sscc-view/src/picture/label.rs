//! Lines of text in a picture.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::image::Image;

/// Size of letters.
const SIZE: RasterHeight = RasterHeight::Size20;

/// Height of a line (pixels).
pub const LINE: usize = SIZE.val();

/// Distance from one letter to the next (pixels).
const ADVANCE: usize = get_raster_width(FontWeight::Regular, SIZE);

/// Empty space beside a label (pixels).
const MARGIN: usize = 8;

/// Largest number of lines of a label.
const MAX_LINES: usize = 6;

/// Last line of a label that has more lines.
const ELLIPSIS: &str = "...";

/// Breaks a text into lines of at most this width (pixels): after blanks and punctuation if possible, else anywhere.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let fitting = (width.saturating_sub(2 * MARGIN) / ADVANCE).max(1 + ELLIPSIS.len());
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

/// Draws a line of text centred in a width (pixels) that begins at `left`.
pub fn draw(image: &mut Image, text: &str, left: usize, width: usize, top: usize) {
    let begin = left + width.saturating_sub(text.chars().count() * ADVANCE) / 2;
    for (i, letter) in text.chars().enumerate() {
        let raster = |letter| get_raster(letter, FontWeight::Regular, SIZE);
        let Some(raster) = raster(letter).or_else(|| raster(char::REPLACEMENT_CHARACTER)) else { continue };
        for (y, row) in raster.rows().enumerate() {
            for (x, share) in row.iter().enumerate() {
                image.ink(begin + i * ADVANCE + x, top + y, f64::from(*share) / 255.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_whole_and_break_at_punctuation() {
        assert_eq!(wrapped("jawOpen", 160), ["jawOpen"]);
        assert_eq!(wrapped("mouth_corner_pulls_left", 160), ["mouth_corner_", "pulls_left"]);
        assert_eq!(wrapped(&"x".repeat(30), 160), ["x".repeat(16), "x".repeat(14)]);
        assert_eq!(wrapped("", 160), [""]);
        let long = wrapped(&"y".repeat(100_000), 160);
        assert_eq!((long.len(), long[5].as_str()), (6, "yyyyyyyyyyyyy..."));
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
        // Letters with accents have their own shapes; all letters that the font lacks share one shape.
        let drawn = |text: &str| {
            let mut image = Image::new(20, 20);
            draw(&mut image, text, 0, 20, 0);
            (0..400).map(|i| image.at(i % 20, i / 20)).collect::<Vec<_>>()
        };
        assert!(drawn("\u{e4}") != drawn("a") && drawn("\u{e4}") != drawn("\u{7}"));
        assert!(drawn("\u{3b1}") == drawn("\u{7}") && drawn("\u{7}") != drawn(" "));
        // Outside the picture nothing is drawn.
        draw(&mut image, "beyond", 55, 4, 39);
    }
}
