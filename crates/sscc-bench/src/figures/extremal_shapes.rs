//! Figures 11 and 14 of the paper: the shapes at the root's radius along the first modes, of vibrations and of quadratic
//! polynomials.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use sscc_tasks::{CertifiedModel, ModesSpec, Recipe, Shape};
use sscc_view::{Picture, ViewError};

use super::figure_record::FigureRecord;
use super::mode_displacements::largest_displacements;
use crate::error::Error;
use crate::record::Means;
use crate::sampling::half_diagonal;
use crate::setup::Setup;

/// Number of modes in the table, equal to that in the picture.
const MODES: usize = 4;

/// Returns Figure 11: the bunny with 30 vibrations.
pub fn of_vibrations(setup: &Setup<'_>) -> Result<FigureRecord, Error> {
    let model = setup.certified_model(&Recipe::new("bunny", Shape::Bunny, ModesSpec::Linear(30)))?;
    let percents = percents(&model);
    let row = |(mode, percent): (usize, &f64)| Means(vec![("mode", mode as f64), ("percent", *percent)]);
    let rows = percents.iter().take(MODES).enumerate().map(row).collect();
    let svg = pictures(&[("vibrations", &model)])?;
    Ok(FigureRecord { scenario: "figure11", source: model.source, note: model.note, rows, svg })
}

/// Returns Figure 14: the dragon with quadratic polynomials, and with vibrations.
pub fn of_polynomials(setup: &Setup<'_>) -> Result<FigureRecord, Error> {
    let dragon = |name: &str, modes| setup.certified_model(&Recipe::new(name, Shape::Dragon, modes));
    let polynomials = dragon("dragon-polynomial", ModesSpec::Polynomial)?;
    let vibrations = dragon("dragon", ModesSpec::Linear(30))?;
    let both = percents(&polynomials).into_iter().zip(percents(&vibrations)).take(MODES);
    let row = |(mode, (polynomial, vibration))| {
        Means(vec![
            ("mode", mode as f64),
            ("polynomial_percent", polynomial),
            ("vibration_percent", vibration),
        ])
    };
    let rows = both.enumerate().map(row).collect();
    let svg = pictures(&[("quadratic polynomials", &polynomials), ("vibrations", &vibrations)])?;
    let (source, note) = (polynomials.source, polynomials.note);
    Ok(FigureRecord { scenario: "figure14", source, note, rows, svg })
}

/// Returns the largest displacement at the root's radius along each mode alone, in percent of half the AABB's diagonal.
fn percents(model: &CertifiedModel) -> Vec<f64> {
    let radius = model.full.certificates.root_radius();
    let scales = model.full.certificates.metric().scales();
    let percent =
        |(largest, scale): (f64, f64)| 100.0 * largest * radius / scale / half_diagonal(&model.model);
    largest_displacements(&model.model).into_iter().zip(scales).map(percent).collect()
}

/// Returns one SVG element with the picture of each model below its title.
fn pictures(models: &[(&str, &CertifiedModel)]) -> Result<String, Error> {
    const TITLE: u32 = 28;
    let (mut body, mut width, mut top) = (String::new(), 0, 0);
    for (title, model) in models {
        let drawn = Picture::draw(&model.model, &model.full.certificates, &[])?;
        let [w, h] = size(&drawn.png).ok_or(ViewError::Range)?;
        body += &format!(
            "<text x=\"12\" y=\"{}\">{title}</text>\n<image y=\"{}\" width=\"{w}\" height=\"{h}\" \
             href=\"data:image/png;base64,{}\"/>\n",
            top + TITLE - 8,
            top + TITLE,
            BASE64.encode(&drawn.png)
        );
        width = width.max(w);
        top += TITLE + h;
    }
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {top}\" font-family=\"sans-serif\" \
         font-size=\"16\">\n{body}</svg>\n"
    ))
}

/// Returns the width and height of a PNG file, from its first chunk.
fn size(png: &[u8]) -> Option<[u32; 2]> {
    let (numbers, _) = png.get(16..24)?.as_chunks::<4>();
    Some([u32::from_be_bytes(*numbers.first()?), u32::from_be_bytes(*numbers.get(1)?)])
}
