//! The curves in which the pairs of a frame intersect, as segments.

use glam::DVec3;
use sscc::parts::{Intersection, Surface, contact_curves, contact_curves_between};
use sscc::{Error, Pair};

/// Calls `take` with both ends of each segment: the segments of the curves, and the outlines of coplanar contacts. Pairs
/// without a common point at these positions (they meet between two frames) have no segments.
///
/// `other` has the second triangle of each pair; if None, `surface` has both triangles.
pub(super) fn contact_segments(
    surface: Surface<'_>,
    other: Option<Surface<'_>>,
    pairs: &[Pair],
    mut take: impl FnMut([DVec3; 2]),
) -> Result<(), Error> {
    if pairs.is_empty() {
        return Ok(());
    }
    let found = match other {
        Some(other) => contact_curves_between(surface, other, pairs)?,
        None => contact_curves(surface.faces, surface.positions, pairs)?,
    };
    for curve in &found.curves {
        let points = &curve.points;
        points.windows(2).for_each(|ends| take([ends[0].position, ends[1].position]));
        if let (true, [first, .., last]) = (curve.is_closed, &points[..]) {
            take([last.position, first.position]);
        }
    }
    for &contact in &found.polygons {
        let Intersection::Polygon(corners) = &found.contacts[contact as usize].intersection else { continue };
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).for_each(|(a, b)| take([a.position, b.position]));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the segments of two triangles: one in the plane z = 0, the other with these corners.
    fn segments(second: [[f64; 3]; 3]) -> Vec<[[f64; 3]; 2]> {
        let first = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let positions: Vec<DVec3> = first.iter().chain(&second).map(|p| DVec3::from_array(*p)).collect();
        let faces = [[0, 1, 2], [3, 4, 5]];
        let collect = |surface, other, pair| {
            let mut all = Vec::new();
            contact_segments(surface, other, &[pair], |ends| all.push(ends.map(|p| p.to_array()))).unwrap();
            all
        };
        let whole = collect(Surface { faces: &faces, positions: &positions }, None, (0, 1));
        let [x, y] =
            [0, 3].map(|start| Surface { faces: &faces[..1], positions: &positions[start..start + 3] });
        assert_eq!(collect(x, Some(y), (0, 0)).len(), whole.len());
        whole
    }

    #[test]
    fn segments_are_the_common_points() {
        let crossing = segments([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, -3.0, 1.0]]);
        let [ends] = crossing[..] else { panic!("{crossing:?}") };
        assert!(ends.contains(&[1.0, 1.0, 0.0]) && ends.contains(&[1.0, 0.0, 0.0]), "{ends:?}");
        let coplanar = segments([[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]]);
        assert_eq!(coplanar.len(), 3);
        assert!(
            coplanar
                .iter()
                .flatten()
                .all(|p| [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]].contains(p))
        );
        assert!(segments([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]).is_empty());
        assert!(segments([[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]).is_empty());
    }
}
