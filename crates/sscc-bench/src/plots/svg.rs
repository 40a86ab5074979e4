//! SVG plots with a logarithmic or linear y axis.

use std::fmt::Write;

/// Width of a plot (pixels).
const WIDTH: f64 = 860.0;

/// Height of a plot (pixels).
const HEIGHT: f64 = 260.0;

/// Left margin of a plot (pixels).
const LEFT: f64 = 70.0;

/// Right margin of a plot (pixels).
const RIGHT: f64 = 20.0;

/// Upper margin of a plot (pixels).
const TOP: f64 = 34.0;

/// Lower margin of a plot (pixels).
const BOTTOM: f64 = 44.0;
/// Height of the title of a plot that is stacked.
const TITLE: f64 = 24.0;

/// Lines over a common x axis.
pub struct SvgPlot<'a> {
    /// The title, for screen readers and above stacked plots.
    pub title: String,
    /// The label of the x axis.
    pub x_label: &'a str,
    /// The label of the y axis.
    pub y_label: &'a str,
    /// The scale of the y axis.
    pub y_axis: YAxis,
    /// The lines.
    pub lines: Vec<Line<'a>>,
}

/// Scale of the y axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum YAxis {
    /// Powers of ten; numbers that are not positive are not drawn.
    Logarithmic,
    /// Linear, from 0.
    Linear,
}

/// A line of a plot, with a dot at each point.
#[derive(Clone)]
pub struct Line<'a> {
    /// Its label.
    pub label: &'a str,
    /// Its colour, in SVG syntax.
    pub color: &'a str,
    /// x and y, x ascending.
    pub points: Vec<[f64; 2]>,
}

impl SvgPlot<'_> {
    /// Returns the SVG element.
    pub fn svg(&self) -> String {
        let is_log = self.y_axis == YAxis::Logarithmic;
        let is_drawn =
            |p: &[f64; 2]| p[0].is_finite() && p[1].is_finite() && p[1] >= 0.0 && (p[1] > 0.0 || !is_log);
        let all = || self.lines.iter().flat_map(|line| &line.points).filter(|p| is_drawn(p));
        let [x_low, x_high] = range(all().map(|p| p[0]));
        let [low, high] = range(all().map(|p| p[1]));
        // Heights are linear in these values.
        let [low, high] = if is_log { [low.log10().floor(), high.log10().ceil()] } else { [0.0, high] };
        let high = high.max(low + 1.0);
        let span = if x_high > x_low { x_high - x_low } else { 1.0 };
        let x = |at: f64| LEFT + (at - x_low) / span * (WIDTH - LEFT - RIGHT);
        let height = |at: f64| HEIGHT - BOTTOM - (at - low) / (high - low) * (HEIGHT - TOP - BOTTOM);
        let y = |at: f64| height(if is_log { at.log10() } else { at });
        // Writing to a String never fails.
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" \
             font-family=\"sans-serif\" font-size=\"12\">\n<title>{}</title>\n",
            escaped(&self.title)
        );
        for tick in ticks(low, high, if is_log { 1.0 } else { 0.0 }) {
            let (at, label) = (height(tick), tick_label(if is_log { 10_f64.powf(tick) } else { tick }));
            let _ = writeln!(
                svg,
                "<path d=\"M{LEFT} {at:.1}H{:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{label}</text>",
                WIDTH - RIGHT,
                LEFT - 6.0,
                at + 4.0
            );
        }
        for tick in ticks(x_low, x_low + span, 0.0) {
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                x(tick),
                HEIGHT - BOTTOM + 22.0,
                tick_label(tick)
            );
        }
        for line in &self.lines {
            let drawn = line.points.iter().filter(|p| is_drawn(p));
            let points: Vec<String> = drawn.map(|[a, b]| format!("{:.1},{:.1}", x(*a), y(*b))).collect();
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.3\"/>",
                points.join(" "),
                line.color
            );
            for point in &points {
                let (cx, cy) = point.split_once(',').unwrap_or_default();
                let _ = writeln!(svg, "<circle cx=\"{cx}\" cy=\"{cy}\" r=\"2.5\" fill=\"{}\"/>", line.color);
            }
        }
        let mut at = LEFT;
        for Line { label, color, .. } in &self.lines {
            let _ = writeln!(
                svg,
                "<rect x=\"{at:.1}\" y=\"12\" width=\"14\" height=\"4\" fill=\"{color}\"/><text x=\"{:.1}\" \
                 y=\"18\">{}</text>",
                at + 18.0,
                escaped(label)
            );
            at += 40.0 + 6.6 * label.chars().count() as f64;
        }
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text><text x=\"16\" y=\"{:.1}\" \
             text-anchor=\"middle\" transform=\"rotate(-90 16 {:.1})\">{}</text>\n</svg>",
            (LEFT + WIDTH - RIGHT) / 2.0,
            HEIGHT - 6.0,
            escaped(self.x_label),
            HEIGHT / 2.0,
            HEIGHT / 2.0,
            escaped(self.y_label)
        );
        svg
    }
}

/// Returns one SVG element with the plots below each other, each below its title.
pub fn stacked(plots: &[SvgPlot<'_>]) -> String {
    let each = HEIGHT + TITLE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {}\" font-family=\"sans-serif\" \
         font-size=\"14\">\n",
        each * plots.len() as f64
    );
    for (i, plot) in plots.iter().enumerate() {
        let top = each * i as f64;
        let _ = writeln!(svg, "<text x=\"{LEFT}\" y=\"{:.1}\">{}</text>", top + 17.0, escaped(&plot.title));
        let _ = write!(
            svg,
            "<svg y=\"{:.1}\" width=\"{WIDTH}\" height=\"{HEIGHT}\">\n{}</svg>\n",
            top + TITLE,
            plot.svg()
        );
    }
    svg + "</svg>\n"
}

/// Escapes text for SVG.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    if low <= high { [low, high] } else { [0.1, 1.0] }
}

/// Returns round numbers of a range: about six at most, at least `smallest_step` apart.
fn ticks(low: f64, high: f64, smallest_step: f64) -> Vec<f64> {
    let raw_step = (high - low) / 6.0;
    let power = 10_f64.powf(raw_step.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= raw_step);
    let step = step.unwrap_or(raw_step).max(smallest_step);
    let first = (low / step).ceil();
    (0..20).map(|i| (first + f64::from(i)) * step).take_while(|tick| *tick <= high + 1e-9 * step).collect()
}

fn tick_label(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        x if (1e-3..1e5).contains(&x) => format!("{}", (value * 1e6).round() / 1e6),
        _ => format!("{value:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks(0.0, 2.0, 0.0), [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(ticks(-4.0, 1.0, 1.0), [-4.0, -3.0, -2.0, -1.0, 0.0, 1.0]);
        assert_eq!([1e-4, 1.0, 1000.0].map(tick_label), ["1e-4", "1", "1000"]);
        assert_eq!([0.0, 0.25, -1.5].map(tick_label), ["0", "0.25", "-1.5"]);
    }

    #[test]
    fn any_numbers_and_texts_make_a_plot() {
        for points in
            [vec![], vec![[0.0, 0.0]], vec![[0.0, f64::NAN], [1.0, 1e-300]], vec![[0.0, -1.0], [1.0, 5.0]]]
        {
            let line = Line { label: "<a & b>", color: "#000", points };
            for y_axis in [YAxis::Logarithmic, YAxis::Linear] {
                let lines = vec![line.clone()];
                let plot = SvgPlot { title: "\"".into(), x_label: "x", y_label: "y", y_axis, lines };
                for svg in [plot.svg(), stacked(&[plot])] {
                    assert!(
                        !svg.contains("NaN") && !svg.contains("inf") && svg.contains("&lt;a &amp; b&gt;"),
                        "{svg}"
                    );
                    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
                }
            }
        }
    }
}
