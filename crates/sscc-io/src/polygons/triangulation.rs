//! Replaces the fans that do not triangulate their polygons.

use glam::DVec3;

use super::ears::cut_ears;
use super::fan::is_fan_a_triangulation;
use super::plane::PlaneView;
use super::simple::is_simple;
use super::work::Work;
use crate::FormatError;

/// Thickness of a polygon over the diagonal of its box beyond which a caller is warned. The faces of rounded shapes
/// stay below it.
const MAX_THICKNESS: f64 = 0.05;

/// Maximum number of faces that a warning names.
const MAX_NAMED: usize = 5;

/// A polygon of more than 3 corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LargerPolygon {
    /// Number of its first triangle in the file.
    pub start: usize,
    /// Number of its triangles, at least 2.
    pub triangles: usize,
}

/// Triangulates polygons by ears where the fans around their first corners do not triangulate them. Returns warnings about
/// those that have no clear surface. Positions are within [`sscc::limits`], and indices are valid.
pub(super) fn triangulate(
    positions: &[DVec3],
    fans: &mut [[u32; 3]],
    larger: &[LargerPolygon],
) -> Result<Vec<String>, FormatError> {
    triangulate_within(positions, fans, larger, Work::new())
}

/// As [`triangulate`], with at most this work.
fn triangulate_within(
    positions: &[DVec3],
    fans: &mut [[u32; 3]],
    larger: &[LargerPolygon],
    mut work: Work,
) -> Result<Vec<String>, FormatError> {
    let (mut bent, mut crossing) = (NamedFaces::default(), NamedFaces::default());
    // Number of a face minus the number of its first triangle.
    let mut extra = 0;
    for polygon in larger {
        let face = polygon.start - extra;
        extra += polygon.triangles - 1;
        let triangles = &mut fans[polygon.start..][..polygon.triangles];
        let numbers = corners(triangles);
        let points: Vec<DVec3> = numbers.iter().map(|corner| positions[*corner as usize]).collect();
        let view = PlaneView::of(&points);
        if view.thickness > MAX_THICKNESS {
            bent.add(face);
        }
        if is_fan_a_triangulation(&view.points) {
            continue;
        }
        work.allow(numbers.len());
        let is_clear = match replace_fan(&view, &numbers, triangles, &mut work) {
            Some(is_clear) => is_clear,
            None => {
                let count = numbers.len();
                return Err(FormatError::whole(format!(
                    "face {face} (counted from 0) has {count} corners and takes too long to cut into triangles: triangulate \
                     it in the program that wrote the file"
                )));
            }
        };
        if !is_clear {
            crossing.add(face);
        }
    }
    let warnings = [
        bent.warning(
            larger.len(),
            "are not plane: their surface is that of the triangles into which they are cut",
        ),
        crossing.warning(larger.len(), "touch or cross themselves: their triangles may overlap"),
    ];
    Ok(warnings.into_iter().flatten().collect())
}

/// Returns the corners of a fan.
fn corners(fan: &[[u32; 3]]) -> Vec<u32> {
    fan[0][..2].iter().copied().chain(fan.iter().map(|triangle| triangle[2])).collect()
}

/// Replaces a fan by ears if there are ears. Returns whether the polygon is simple and was cut; None if that takes too long.
fn replace_fan(
    view: &PlaneView,
    numbers: &[u32],
    triangles: &mut [[u32; 3]],
    work: &mut Work,
) -> Option<bool> {
    // The orientation of a sliver may be wrong by rounding; only one of the two can succeed.
    let turn = if view.turns_left { 1 } else { -1 };
    let cut = match cut_ears(&view.points, turn, work).ok()? {
        None => cut_ears(&view.points, -turn, work).ok()?,
        found => found,
    };
    let Some(cut) = cut else { return Some(false) };
    for (triangle, ear) in triangles.iter_mut().zip(cut) {
        *triangle = ear.map(|corner| numbers[corner as usize]);
    }
    is_simple(&view.points, work).ok()
}

/// Faces of one kind: their number, and the first ones.
#[derive(Default)]
struct NamedFaces {
    count: usize,
    first: Vec<String>,
}

impl NamedFaces {
    fn add(&mut self, face: usize) {
        self.count += 1;
        if self.first.len() < MAX_NAMED {
            self.first.push(face.to_string());
        }
    }

    fn warning(&self, all: usize, what: &str) -> Option<String> {
        let more = if self.count > self.first.len() { ", ..." } else { "" };
        let names = self.first.join(", ");
        let of = format!("{} of the {all} faces with more than 3 corners", self.count);
        (self.count > 0).then(|| format!("{of} {what} (faces, counted from 0: {names}{more})"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soup(polygons: &[&[(f64, f64, f64)]]) -> (Vec<DVec3>, Vec<[u32; 3]>, Vec<LargerPolygon>) {
        let (mut positions, mut fans, mut larger) = (Vec::new(), Vec::new(), Vec::new());
        for polygon in polygons {
            let first = positions.len() as u32;
            positions.extend(polygon.iter().map(|(x, y, z)| DVec3::new(*x, *y, *z)));
            let count = polygon.len() as u32 - 2;
            if count > 1 {
                larger.push(LargerPolygon { start: fans.len(), triangles: count as usize });
            }
            fans.extend((0..count).map(|k| [first, first + k + 1, first + k + 2]));
        }
        (positions, fans, larger)
    }

    const TRIANGLE: &[(f64, f64, f64)] = &[(0., 0., 0.), (1., 0., 0.), (0., 1., 0.)];
    const SQUARE: &[(f64, f64, f64)] = &[(0., 0., 0.), (1., 0., 0.), (1., 1., 0.), (0., 1., 0.)];
    const ARROW: &[(f64, f64, f64)] = &[(0., 0., 0.), (4., 0., 0.), (4., 4., 0.), (2., 1., 0.), (0., 4., 0.)];
    const BOW: &[(f64, f64, f64)] = &[(0., 0., 0.), (4., 4., 0.), (4., 0., 0.), (0., 4., 0.)];
    const BENT: &[(f64, f64, f64)] = &[(0., 0., 0.), (1., 0., 0.), (1., 1., 1.), (0., 1., 0.)];

    #[test]
    fn only_fans_that_do_not_triangulate_are_replaced() {
        let (positions, fans, larger) = soup(&[TRIANGLE, SQUARE, ARROW, TRIANGLE]);
        let mut found = fans.clone();
        assert!(triangulate(&positions, &mut found, &larger).unwrap().is_empty());
        assert_eq!(found.len(), fans.len());
        assert_eq!((&found[..3], found[6]), (&fans[..3], fans[6]));
        let corners: Vec<u32> = found[3..6].iter().flatten().copied().collect();
        assert_ne!(found[3..6], fans[3..6]);
        assert!(corners.iter().all(|corner| (7..12).contains(corner)));
        // The notch is corner 10. The triangle that the fan has beside it would cover the notch.
        assert!(!found.contains(&[7, 9, 10]));
    }

    #[test]
    fn polygons_without_a_clear_surface_are_named() {
        let (positions, mut fans, larger) = soup(&[TRIANGLE, SQUARE, BOW, TRIANGLE, BENT]);
        let before = fans.clone();
        let warnings = triangulate(&positions, &mut fans, &larger).unwrap();
        assert_eq!(fans, before);
        assert_eq!(
            warnings,
            [
                "1 of the 3 faces with more than 3 corners are not plane: their surface is that of the triangles into which \
                 they are cut (faces, counted from 0: 4)",
                "1 of the 3 faces with more than 3 corners touch or cross themselves: their triangles may overlap (faces, \
                 counted from 0: 2)"
            ]
        );
        let (positions, mut fans, larger) = soup(&[BENT; 9]);
        let warnings = triangulate(&positions, &mut fans, &larger).unwrap();
        assert!(
            warnings[0].starts_with("9 of the 9 faces") && warnings[0].ends_with(": 0, 1, 2, 3, 4, ...)")
        );
    }

    #[test]
    fn slightly_bent_faces_keep_their_fans_without_a_warning() {
        for bend in [0.0, 1e-9, 0.05, -0.1] {
            let square = [(0., 0., 0.), (1., 0., 0.), (1., 1., bend), (0., 1., 0.)];
            let (positions, mut fans, larger) = soup(&[&square[..]; 4]);
            let before = fans.clone();
            assert!(triangulate(&positions, &mut fans, &larger).unwrap().is_empty(), "{bend}");
            assert_eq!(fans, before);
        }
    }

    #[test]
    fn polygons_that_take_too_long_are_refused() {
        // Long teeth across, which all overlap in both projections of their boxes.
        let count = 10_000;
        let teeth = (0..count - 2).map(|i| (f64::from(i) * 10.0, if i % 2 == 0 { 0.0 } else { 1e6 }));
        let teeth: Vec<(f64, f64, f64)> = teeth
            .chain([(1.1e6, -5.0), (-5.0, -5.0)])
            .map(|(along, across)| (along + across, along - across, 0.0))
            .collect();
        let (positions, mut fans, larger) = soup(&[TRIANGLE, &teeth]);
        let refused = triangulate_within(&positions, &mut fans, &larger, Work::of(1 << 20));
        let refused = refused.unwrap_err().to_string();
        assert!(
            refused.starts_with("face 1 (counted from 0) has 10000 corners and takes too long"),
            "{refused}"
        );
    }
}
