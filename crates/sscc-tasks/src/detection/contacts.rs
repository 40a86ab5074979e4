//! Penetration depths and contact curves of the pairs of an answer.

use sscc::parts::{
    ContactCurves, Penetration, Surface, contact_curves, contact_curves_between,
    penetration_triangle_triangle, weld_classes_of_positions,
};
use sscc::{Error, Pair};

/// Options of discrete queries for the contacts of their pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactOptions {
    /// Depth and direction of each pair.
    pub depths: bool,
    /// Contact curves of the last answer; answers about two nodes of a scene have none. Vertices at equal positions count as one,
    /// so that curves do not end at seams.
    pub curves: bool,
}

/// The contacts of the pairs of one answer.
#[derive(Default)]
pub(super) struct Contacts {
    pub penetrations: Option<Vec<Penetration>>,
    pub curves: Option<ContactCurves>,
}

impl Contacts {
    /// Computes the contacts of colliding pairs: within x, or between x and y.
    pub fn of(
        x: Surface<'_>,
        y: Option<Surface<'_>>,
        pairs: &[Pair],
        options: ContactOptions,
    ) -> Result<Self, Error> {
        let penetrations = options.depths.then(|| {
            let corners = |surface: Surface<'_>, triangle: u32| {
                surface.faces[triangle as usize].map(|vertex| surface.positions[vertex as usize])
            };
            let of_pair =
                |&(i, j): &Pair| penetration_triangle_triangle(&corners(x, i), &corners(y.unwrap_or(x), j));
            // Colliding pairs have a penetration, which is 0 where they touch.
            pairs.iter().filter_map(of_pair).collect()
        });
        let curves = match y {
            _ if !options.curves => None,
            None => Some(contact_curves(&joined_faces(x), x.positions, pairs)?),
            Some(y) => {
                let [x_faces, y_faces] = [x, y].map(joined_faces);
                let joined = [Surface { faces: &x_faces, ..x }, Surface { faces: &y_faces, ..y }];
                Some(contact_curves_between(joined[0], joined[1], pairs)?)
            }
        };
        Ok(Self { penetrations, curves })
    }
}

/// Returns the faces with one number for all vertices at the same position.
fn joined_faces(surface: Surface<'_>) -> Vec<[u32; 3]> {
    let numbers = weld_classes_of_positions(surface.positions);
    surface.faces.iter().map(|face| face.map(|vertex| numbers[vertex as usize])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// A square of two triangles without common vertices, cut by an upright triangle.
    #[test]
    fn curves_cross_seams() {
        let at = DVec3::new;
        let square = [
            at(0.0, 0.0, 0.0),
            at(4.0, 0.0, 0.0),
            at(0.0, 4.0, 0.0),
            at(4.0, 0.0, -0.0),
            at(4.0, 4.0, 0.0),
            at(0.0, 4.0, 0.0),
        ];
        let blade = [at(1.0, 1.0, -1.0), at(3.0, 3.0, -1.0), at(2.0, 2.0, 1.0)];
        let positions: Vec<DVec3> = square.into_iter().chain(blade).collect();
        let faces = [[0, 1, 2], [3, 4, 5], [6, 7, 8]];
        let pairs = [(0, 2), (1, 2)];
        let x = Surface { faces: &faces, positions: &positions };
        assert_eq!(joined_faces(x), [[0, 1, 2], [1, 4, 2], [6, 7, 8]]);
        assert_eq!(contact_curves(&faces, &positions, &pairs).unwrap().curves.len(), 2);
        let options = ContactOptions { depths: true, curves: true };
        let found = Contacts::of(x, None, &pairs, options).unwrap();
        assert_eq!(found.curves.unwrap().curves.len(), 1);
        let penetrations = found.penetrations.unwrap();
        let expected = pairs.map(|(i, j)| {
            let corners = |t: usize| faces[t].map(|v: u32| positions[v as usize]);
            penetration_triangle_triangle(&corners(i as usize), &corners(j as usize)).unwrap()
        });
        assert_eq!(penetrations, expected);
        // The second triangle leaves the first when it moves along the direction by slightly more than the depth.
        let Penetration { depth, direction } = penetrations[0];
        let moved: Vec<DVec3> = blade.iter().map(|x| *x + direction * depth * 1.000_001).collect();
        assert!(sscc::intersect_triangle_triangle(&[square[0], square[1], square[2]], &blade));
        assert!(!sscc::intersect_triangle_triangle(
            &[square[0], square[1], square[2]],
            &[moved[0], moved[1], moved[2]]
        ));

        let [below, above] = [&faces[..2], &[[0, 1, 2]]];
        let (x, y) =
            (Surface { faces: below, positions: &square }, Surface { faces: above, positions: &blade });
        let between = Contacts::of(x, Some(y), &[(0, 0), (1, 0)], options).unwrap();
        assert_eq!(between.curves.unwrap().curves.len(), 1);
        assert_eq!(between.penetrations.unwrap(), penetrations);
        let none = Contacts::of(x, Some(y), &[(0, 0)], ContactOptions::default()).unwrap();
        assert!(none.curves.is_none() && none.penetrations.is_none());
    }
}
