//! A picture of certified deformations: the shape at the centre, and along single modes at the root's radius (paper,
//! Figures 4, 11 and 14).

mod camera;
mod color;
mod image;
mod label;
mod panel;
mod raster;

use glam::DVec3;
use sscc::{Certificates, Progress, ReducedModel};

use crate::error::{ViewError, check_certificates};
use camera::Camera;
use image::Image;
use label::{LINE, wrapped};
use panel::{Panel, normals};

/// Largest number of modes in the picture.
const MAX_MODES: usize = 4;

/// A picture of certified deformations.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The bytes of its PNG file.
    pub png: Vec<u8>,
    /// The reason why the picture shows only the shape at the centre; `None` if it shows modes.
    pub note: Option<String>,
}

impl Picture {
    /// Draws the shape at the centre (left), and at `|z|` equal to the root's radius along the first modes: one column for
    /// each, with `+` above `-`. All views have the same direction and scale. The colour shows the displacement from the
    /// shape at the centre. Labels state the modes and their weights; `names` are the names of the modes, or empty. If the
    /// radius is 0 or infinite, the picture shows only the shape at the centre.
    ///
    /// # Errors
    /// If the certificates belong to another model or have a clearance, or the picture cannot be encoded.
    pub fn draw(
        model: &ReducedModel,
        certificates: &Certificates,
        names: &[String],
    ) -> Result<Self, ViewError> {
        Self::draw_until(model, certificates, names, &())
    }

    /// Draws as [`Picture::draw`], until `progress` cancels. It receives no reports.
    ///
    /// # Errors
    /// As [`Picture::draw`]; if `progress` cancels.
    pub fn draw_until(
        model: &ReducedModel,
        certificates: &Certificates,
        names: &[String],
        progress: &dyn Progress,
    ) -> Result<Self, ViewError> {
        check_certificates(model, certificates)?;
        let root = certificates.root_radius();
        let modes = if root > 0.0 && root.is_finite() { MAX_MODES.min(model.rank()) } else { 0 };
        let note = (modes == 0).then(|| {
            let value = if root > 0.0 { "unlimited" } else { "0" };
            format!("the root radius is {value}: the picture shows the shape at the centre alone")
        });
        let center = model.positions(certificates.center())?;
        // A dense metric scales mixtures of modes.
        let is_dense = certificates.metric().dense_factor().is_some();
        let along = |k: usize, z: f64| -> Result<View, ViewError> {
            let mut scaled = vec![0.0; model.rank()];
            scaled[k] = z;
            let offset = certificates.metric().unscaled(&scaled)?;
            let q: Vec<f64> = certificates.center().iter().zip(offset).map(|(c, x)| c + x).collect();
            let caption = match is_dense {
                true => format!("z{k} = {}", short(z)),
                false => format!("weight {}", short(q[k])),
            };
            Ok(View { positions: model.positions(&q)?, caption })
        };
        // The upper row, then the lower row.
        let deformed: Vec<View> = [root, -root]
            .into_iter()
            .flat_map(|z| (0..modes).map(move |k| along(k, z)))
            .collect::<Result<_, ViewError>>()?;
        let center = View { positions: center, caption: "centre".into() };

        let used = model.mesh().used_vertices();
        let shapes = || deformed.iter().chain([&center]).map(|view| &view.positions);
        let camera = Camera::around(shapes().flat_map(|shape| used.iter().map(|v| shape[*v as usize])));
        let moved = |shape: &[DVec3], v: u32| shape[v as usize].distance(center.positions[v as usize]);
        let farthest = shapes().flat_map(|shape| used.iter().map(|v| moved(shape, *v))).fold(0.0, f64::max);
        let panel = |shape: &[DVec3]| {
            let amount = |v: u32| if farthest > 0.0 { moved(shape, v) / farthest } else { 0.0 };
            let amounts: Vec<f64> = (0..shape.len() as u32).map(amount).collect();
            let faces = model.mesh().faces();
            Panel { faces, positions: shape, normals: &normals(faces, shape), amounts: &amounts }
                .draw(&camera, progress)
        };
        let [width, height] = camera.size();
        let name = |k: usize| match names.get(k) {
            _ if is_dense => format!("direction {k}"),
            Some(name) if !name.is_empty() => name.clone(),
            _ => format!("mode {k}"),
        };
        let headings: Vec<Vec<String>> = (0..modes).map(|k| wrapped(&name(k), width)).collect();
        let heading = headings.iter().map(Vec::len).max().unwrap_or(0) * LINE;
        let [rows, footer] = if modes > 0 { [2, LINE] } else { [1, 0] };
        let row = height + LINE;
        let mut image = Image::new((1 + modes) * width, heading + rows * row + footer);
        let mut put = |view: &View, left: usize, top: usize| -> Result<(), ViewError> {
            image.put(left, top, width, &panel(&view.positions)?);
            label::draw(&mut image, &view.caption, left, width, top + height);
            Ok(())
        };
        put(&center, 0, heading + (rows - 1) * row / 2)?;
        for (at, view) in deformed.iter().enumerate() {
            put(view, (1 + at % modes) * width, heading + at / modes * row)?;
        }
        for (k, lines) in headings.iter().enumerate() {
            for (line, text) in lines.iter().enumerate() {
                label::draw(&mut image, text, (1 + k) * width, width, line * LINE);
            }
        }
        if modes > 0 {
            let radius = format!("at the root's radius, |z| = {}", short(root));
            label::draw(&mut image, &radius, 0, (1 + modes) * width, heading + rows * row);
        }
        Ok(Self { png: image.encode()?, note })
    }
}

/// A shape and its label.
struct View {
    positions: Vec<DVec3>,
    caption: String,
}

/// Returns a number with four digits.
fn short(x: f64) -> String {
    let exponent = if x == 0.0 { 0 } else { libm::log10(x.abs()).floor() as i32 };
    match exponent {
        -4..=3 => format!("{x:.*}", (3 - exponent) as usize),
        _ => format!("{x:.3e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        let texts = [0.0, -1.0, 0.017_084, 12.345_6, 1234.4, 98_766.0, -3.2e-7].map(short);
        assert_eq!(texts, ["0.000", "-1.000", "0.01708", "12.35", "1234", "9.877e4", "-3.200e-7"]);
    }
}
