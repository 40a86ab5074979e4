//! Rasterization of triangles with a depth buffer.

use glam::DVec3;

/// The depth and the colour of the nearest surface in each pixel.
pub struct Raster<T> {
    width: usize,
    pixels: Vec<(f64, T)>,
}

impl<T: Copy> Raster<T> {
    /// Returns a raster of one colour.
    pub fn new([width, height]: [usize; 2], background: T) -> Self {
        Self { width, pixels: vec![(f64::NEG_INFINITY, background); width * height] }
    }

    /// Fills the pixels with a centre in the triangle (x right, y down, z towards the viewer), unless a surface that is
    /// as near or nearer covers them. `color` receives the weights of the corners.
    pub fn fill(&mut self, [a, b, c]: [DVec3; 3], color: impl Fn([f64; 3]) -> T) {
        let height = self.pixels.len() / self.width;
        // `as` converts coordinates beyond the picture to the nearest pixel, and NaN to the first.
        let [lower, upper] = [a.min(b).min(c).floor(), a.max(b).max(c).ceil()];
        let columns = lower.x as usize..(upper.x as usize).min(self.width);
        let rows = lower.y as usize..(upper.y as usize).min(height);
        let cross = |u: DVec3, v: DVec3| u.x * v.y - u.y * v.x;
        let area = cross(b - a, c - a);
        if area == 0.0 {
            return; // no area in the picture
        }
        for (y, x) in rows.flat_map(|y| columns.clone().map(move |x| (y, x))) {
            let p = DVec3::new(x as f64 + 0.5, y as f64 + 0.5, 0.0);
            let weights = [cross(b - p, c - p), cross(c - p, a - p), cross(a - p, b - p)].map(|w| w / area);
            if weights.iter().all(|w| *w >= 0.0) {
                let depth = weights[0] * a.z + weights[1] * b.z + weights[2] * c.z;
                let pixel = &mut self.pixels[y * self.width + x];
                if depth > pixel.0 {
                    *pixel = (depth, color(weights));
                }
            }
        }
    }

    /// Returns the colours of square blocks with `side` pixels along each side, row by row.
    pub fn blocks(&self, side: usize) -> impl Iterator<Item = impl Iterator<Item = T>> {
        let rows = self.pixels.len() / self.width / side;
        let corners = (0..rows).flat_map(move |y| (0..self.width / side).map(move |x| (y * side, x * side)));
        corners.map(move |(top, left)| {
            let within = (0..side * side).map(move |i| (top + i / side, left + i % side));
            within.map(move |(y, x)| self.pixels[y * self.width + x].1)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(z: f64) -> [DVec3; 3] {
        [DVec3::new(0.0, 0.0, z), DVec3::new(4.0, 0.0, z), DVec3::new(0.0, 4.0, z)]
    }

    #[test]
    fn pixels_show_the_nearest_triangle_in_any_order() {
        for order in [[1.0, 2.0], [2.0, 1.0]] {
            let mut raster = Raster::new([4, 2], 0.0);
            for z in order {
                raster.fill(triangle(z), |_| z);
            }
            let colors: Vec<f64> = raster.blocks(1).flatten().collect();
            assert_eq!(colors, [2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 0.0]);
        }
    }

    #[test]
    fn weights_are_barycentric() {
        let mut raster = Raster::new([4, 4], [0.0; 3]);
        raster.fill(triangle(0.0), |weights| weights);
        let colors: Vec<[f64; 3]> = raster.blocks(1).flatten().collect();
        assert_eq!(colors[1], [0.5, 0.375, 0.125]);
        let sizes: Vec<usize> = raster.blocks(2).map(|block| block.count()).collect();
        assert_eq!(sizes, [4; 4]);
    }

    #[test]
    fn triangles_outside_the_picture_are_clipped() {
        let mut raster = Raster::new([3, 3], 0);
        for far in [1e300, -1e300, f64::INFINITY, f64::NAN] {
            raster.fill([DVec3::new(far, 0.0, 0.0), DVec3::new(0.0, far, 0.0), DVec3::ZERO], |_| 1);
        }
        raster.fill([DVec3::ZERO; 3], |_| 1);
        raster.fill([DVec3::ZERO, DVec3::X, DVec3::X * 2.0], |_| 1);
        assert_eq!(raster.blocks(3).count(), 1);
    }
}
