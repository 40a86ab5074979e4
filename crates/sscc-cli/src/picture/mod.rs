//! A picture of what is certified: the shape at the centre, and as far along single modes as the root's certificate
//! reaches (figures 4, 11 and 14 of the paper).

mod camera;
mod color;
mod panel;
mod raster;

use std::path::Path;

use anyhow::{Context, Result};
use glam::DVec3;
use sscc::{Certificates, ReducedModel};

use crate::load;
use camera::Camera;
use color::BACKGROUND;
use panel::{Panel, normals};

/// Modes that are drawn.
const MODES: usize = 4;

/// Refuses a file that cannot be written, before the work.
pub fn check(path: &Path, inputs: &[&Path]) -> Result<()> {
    load::check_output(path, ".png", inputs)
}

/// A picture, and what to say of one that shows less than was asked for.
pub struct Picture {
    pub png: Vec<u8>,
    pub note: Option<String>,
}

/// Draws the shape at the centre (left), and at `|z|` equal to the root's radius along the first modes: one column for
/// each, with `+` above `-`. All views have the same direction and scale; the colour tells how far a vertex is from
/// where it is at the centre. Where the radius is 0 or infinite, the shape at the centre stands alone.
pub fn draw(model: &ReducedModel, certificates: &Certificates) -> Result<Picture> {
    let root = certificates.root_radius();
    let modes = if root > 0.0 && root.is_finite() { MODES.min(model.rank()) } else { 0 };
    let note = (modes == 0).then(|| {
        let value = if root > 0.0 { "unlimited" } else { "0" };
        format!("the root radius is {value}: the picture shows the shape at the centre alone")
    });
    let center = model.positions(certificates.center())?;
    let along = |k: usize, z: f64| -> Result<Vec<DVec3>> {
        let mut scaled = vec![0.0; model.rank()];
        scaled[k] = z;
        let offset = certificates.metric().unscaled(&scaled);
        let q: Vec<f64> = certificates.center().iter().zip(offset).map(|(c, x)| c + x).collect();
        Ok(model.positions(&q)?)
    };
    // Row by row: the upper one, then the lower one.
    let deformed: Vec<Vec<DVec3>> = [root, -root]
        .into_iter()
        .flat_map(|z| (0..modes).map(move |k| along(k, z)))
        .collect::<Result<_>>()?;

    let used = model.mesh().used_vertices();
    let shapes = || deformed.iter().chain([&center]);
    let camera = Camera::around(shapes().flat_map(|shape| used.iter().map(|v| shape[*v as usize])));
    let moved = |shape: &[DVec3], v: u32| shape[v as usize].distance(center[v as usize]);
    let farthest =
        deformed.iter().flat_map(|shape| used.iter().map(|v| moved(shape, *v))).fold(0.0, f64::max);
    let panel = |shape: &[DVec3]| {
        let amount = |v: u32| if farthest > 0.0 { moved(shape, v) / farthest } else { 0.0 };
        let amounts: Vec<f64> = (0..shape.len() as u32).map(amount).collect();
        let faces = model.mesh().faces();
        Panel { faces, positions: shape, normals: &normals(faces, shape), amounts: &amounts }.draw(&camera)
    };
    let [width, height] = camera.size();
    let rows = if modes > 0 { 2 } else { 1 };
    let mut image = Image::new((1 + modes) * width, rows * height);
    image.put(0, (rows - 1) * height / 2, width, &panel(&center));
    for (at, shape) in deformed.iter().enumerate() {
        image.put((1 + at % modes) * width, at / modes * height, width, &panel(shape));
    }
    Ok(Picture { png: image.encode().context("the picture cannot be encoded")?, note })
}

/// RGB, eight bits each, row by row from above.
struct Image {
    width: usize,
    height: usize,
    bytes: Vec<u8>,
}

impl Image {
    fn new(width: usize, height: usize) -> Self {
        Self { width, height, bytes: BACKGROUND.repeat(width * height) }
    }

    /// Copies rows of pixels to a place, given by its upper left corner.
    fn put(&mut self, left: usize, top: usize, width: usize, pixels: &[u8]) {
        for (row, from) in pixels.chunks_exact(3 * width).enumerate() {
            let at = 3 * ((top + row) * self.width + left);
            self.bytes[at..at + from.len()].copy_from_slice(from);
        }
    }

    fn encode(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.bytes)?;
        writer.finish()?;
        Ok(bytes)
    }
}
