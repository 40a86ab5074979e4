//! One view of one shape, as pixels.

use glam::DVec3;
use sscc::{Error, Progress};

use super::camera::Camera;
use super::color::{BACKGROUND, Linear, Palette, mean};
use super::raster::Raster;

/// Samples along each side of a pixel.
const SAMPLES: usize = 3;

/// Normals of two triangles are averaged if the cosine of their angle is larger (angles below 60 degrees).
const MIN_COSINE: f64 = 0.5;

/// Maximum number of faces of one vertex whose normals are averaged. It bounds the time: a vertex may have any number of faces.
const MAX_FACES: usize = 32;

/// A shape, with its normals and displacements.
pub struct Panel<'a> {
    pub faces: &'a [[u32; 3]],
    pub positions: &'a [DVec3],
    /// Normals of the corners of each face: see [`normals`].
    pub normals: &'a [[DVec3; 3]],
    /// The displacement of each vertex, from 0 to 1.
    pub amounts: &'a [f64],
}

impl Panel<'_> {
    /// Returns the pixels (RGB), row by row. Each triangle may fill the view, so cancellation is checked at each.
    ///
    /// # Errors
    /// If `progress` cancels.
    pub fn draw(&self, camera: &Camera, progress: &dyn Progress) -> Result<Vec<u8>, Error> {
        let mut raster = Raster::new(camera.size().map(|n| n * SAMPLES), Linear::of(BACKGROUND));
        let palette = Palette::new();
        let seen: Vec<DVec3> = self.positions.iter().map(|p| camera.project(*p, SAMPLES)).collect();
        for (face, normals) in self.faces.iter().zip(self.normals) {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let corners = face.map(|v| v as usize);
            // Both sides are drawn alike. The triangle decides which side is visible: along outlines averaged normals
            // point away too early.
            let flat = normal(corners.map(|v| self.positions[v]));
            let side = if camera.turn(flat).z < 0.0 { -1.0 } else { 1.0 };
            let [na, nb, nc] = normals.map(|n| camera.turn(n).normalize_or_zero() * side);
            let [ta, tb, tc] = corners.map(|v| self.amounts[v]);
            raster.fill(corners.map(|v| seen[v]), |[a, b, c]| {
                palette.lit((na * a + nb * b + nc * c).normalize_or_zero(), ta * a + tb * b + tc * c)
            });
        }
        Ok(raster.blocks(SAMPLES).flat_map(|block| mean(block).to_bytes()).collect())
    }
}

/// Returns the normals of the corners of all faces, not of unit length. The normal of a corner is the mean, weighted by
/// area, of the faces of its vertex whose normals are similar to that of its own face.
pub fn normals(faces: &[[u32; 3]], positions: &[DVec3]) -> Vec<[DVec3; 3]> {
    let flat: Vec<DVec3> = faces.iter().map(|face| normal(face.map(|v| positions[v as usize]))).collect();
    let units: Vec<DVec3> = flat.iter().map(|normal| normal.normalize_or_zero()).collect();
    let mut around = vec![Vec::new(); positions.len()];
    for (i, v) in faces.iter().enumerate().flat_map(|(i, face)| face.map(|v| (i, v as usize))) {
        if around[v].len() < MAX_FACES {
            around[v].push(i);
        }
    }
    let smooth = |own: usize, v: u32| {
        let alike = around[v as usize].iter().filter(|i| units[**i].dot(units[own]) > MIN_COSINE);
        alike.fold(DVec3::ZERO, |sum, i| sum + flat[*i])
    };
    let with_own = |own: usize, v: u32| match smooth(own, v) {
        DVec3::ZERO => flat[own],
        sum => sum,
    };
    faces.iter().enumerate().map(|(own, face)| face.map(|v| with_own(own, v))).collect()
}

/// Returns the normal of a triangle; its length is twice the area.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use sscc::CancelToken;

    use super::*;

    #[test]
    fn cancellation_ends_the_drawing() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let faces = [[0, 1, 2]];
        let panel = Panel {
            faces: &faces,
            positions: &positions,
            normals: &normals(&faces, &positions),
            amounts: &[0.0; 3],
        };
        let (camera, token) = (Camera::around(positions.into_iter()), CancelToken::new());
        let [width, height] = camera.size();
        assert_eq!(panel.draw(&camera, &token).unwrap().len(), 3 * width * height);
        token.cancel();
        assert_eq!(panel.draw(&camera, &token), Err(Error::Cancelled));
    }

    #[test]
    fn bent_surfaces_are_smooth_and_folds_are_not() {
        let bent = |height: f64| {
            let positions = [DVec3::ZERO, DVec3::Y, DVec3::NEG_X, DVec3::new(1.0, 0.0, height)];
            normals(&[[0, 1, 2], [0, 3, 1]], &positions)
        };
        let [left, right] = bent(0.5)[..] else { panic!() };
        assert!(left[0] == right[0] && left[1] == right[2] && left[2] == DVec3::Z);
        let [left, right] = bent(5.0)[..] else { panic!() };
        assert!(left == [DVec3::Z; 3] && right == [DVec3::new(-5.0, 0.0, 1.0); 3]);
        // The hub of a fan, and triangles without an area.
        let faces = vec![[0, 1, 2]; 1000];
        assert_eq!(normals(&faces, &[DVec3::ZERO, DVec3::X, DVec3::Y])[999][0], DVec3::Z * MAX_FACES as f64);
        assert_eq!(normals(&faces, &[DVec3::ZERO; 3])[0], [DVec3::ZERO; 3]);
    }
}
