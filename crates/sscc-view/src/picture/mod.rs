//! A picture of certified deformations: the shape at the centre, and along single modes at the root's radius (paper,
//! Figures 4, 11 and 14).

mod camera;
mod color;
mod image;
mod panel;
mod raster;

use glam::DVec3;
use sscc::{Certificates, ReducedModel};

use crate::error::ViewError;
use camera::Camera;
use image::Image;
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
    /// Draws the shape at the centre (left), and at `|z|` equal to the root's radius along the first modes: one column
    /// for each, with `+` above `-`. All views have the same direction and scale. The colour shows the displacement
    /// from the shape at the centre. If the radius is 0 or infinite, the picture shows only that shape.
    ///
    /// # Errors
    /// If the certificates belong to another model, or the picture cannot be encoded.
    pub fn draw(model: &ReducedModel, certificates: &Certificates) -> Result<Self, ViewError> {
        certificates.check_model(model)?;
        let root = certificates.root_radius();
        let modes = if root > 0.0 && root.is_finite() { MAX_MODES.min(model.rank()) } else { 0 };
        let note = (modes == 0).then(|| {
            let value = if root > 0.0 { "unlimited" } else { "0" };
            format!("the root radius is {value}: the picture shows the shape at the centre alone")
        });
        let center = model.positions(certificates.center())?;
        let along = |k: usize, z: f64| -> Result<Vec<DVec3>, ViewError> {
            let mut scaled = vec![0.0; model.rank()];
            scaled[k] = z;
            let offset = certificates.metric().unscaled(&scaled);
            let q: Vec<f64> = certificates.center().iter().zip(offset).map(|(c, x)| c + x).collect();
            Ok(model.positions(&q)?)
        };
        // The upper row, then the lower row.
        let deformed: Vec<Vec<DVec3>> = [root, -root]
            .into_iter()
            .flat_map(|z| (0..modes).map(move |k| along(k, z)))
            .collect::<Result<_, ViewError>>()?;

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
            Panel { faces, positions: shape, normals: &normals(faces, shape), amounts: &amounts }
                .draw(&camera)
        };
        let [width, height] = camera.size();
        let rows = if modes > 0 { 2 } else { 1 };
        let mut image = Image::new((1 + modes) * width, rows * height);
        image.put(0, (rows - 1) * height / 2, width, &panel(&center));
        for (at, shape) in deformed.iter().enumerate() {
            image.put((1 + at % modes) * width, at / modes * height, width, &panel(shape));
        }
        Ok(Self { png: image.encode()?, note })
    }
}
