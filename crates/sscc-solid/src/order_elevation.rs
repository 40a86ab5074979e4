//! The same solid with tetrahedra of second order.

use std::collections::BTreeMap;

use crate::second_order::EDGES;
use crate::{Solid, SolidError};

impl Solid {
    /// Returns this solid of tetrahedra with a further vertex in the middle of each edge, and for each of these vertices the
    /// corners of its edge. It has the same shape and the same vertices first.
    ///
    /// # Errors
    /// When it has cubes, whose edges would have no middles, or is of second order already; when a tetrahedron is so nearly
    /// flat that rounding decides whether it is.
    pub fn elevated(&self) -> Result<(Self, Vec<[u32; 2]>), SolidError> {
        let (tets, second_order) = (self.tets().len(), self.tets10().len());
        if !self.cubes().is_empty() || second_order > 0 {
            return Err(SolidError::MixedOrders { tets, second_order });
        }
        let (mut vertices, mut edges, mut numbers) = (self.vertices().to_vec(), Vec::new(), BTreeMap::new());
        let mut middle = |mut edge: [u32; 2]| {
            edge.sort_unstable();
            *numbers.entry(edge).or_insert_with(|| {
                let [a, b] = edge.map(|v| self.vertices()[v as usize]);
                edges.push(edge);
                vertices.push((a + b) / 2.0);
                vertices.len() as u32 - 1
            })
        };
        let middles: Vec<[u32; 6]> =
            self.tets().iter().map(|tet| EDGES.map(|edge| middle(edge.map(|k| tet[k])))).collect();
        let (materials, of_elements) = self.materials();
        let (materials, of_elements) = (materials.to_vec(), of_elements.to_vec());
        // The nodes are in the middles of the edges, so only a nearly flat tetrahedron is refused.
        let nearly_flat = |error| match error {
            SolidError::InvertedSecondOrderTet { tet, corners } => SolidError::NearlyFlatTet { tet, corners },
            other => other,
        };
        let solid =
            Self::with_middles(vertices, self.tets().to_vec(), &middles, vec![], materials, of_elements);
        Ok((solid.map_err(nearly_flat)?, edges))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::Material;

    /// Two tetrahedra on either side of a face.
    fn linear() -> Solid {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE];
        let tets = vec![[0, 1, 2, 3], [1, 2, 3, 4]];
        Solid::uniform(corners.to_vec(), tets, vec![], Material::default()).unwrap()
    }

    #[test]
    fn faces_of_second_order_are_four_triangles() {
        let (solid, edges) = linear().elevated().unwrap();
        assert_eq!((solid.vertices().len(), edges.len()), (14, 9));
        let mesh = solid.boundary().unwrap().mesh;
        let corner = |v: u32| mesh.rest_positions()[v as usize];
        let volume = |mesh: &[[u32; 3]]| -> f64 {
            mesh.iter().map(|f| f.map(corner)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
        };
        assert_eq!((mesh.faces().len(), mesh.rest_positions().len()), (24, 14));
        assert!((volume(mesh.faces()) - 0.5).abs() < 1e-15);
        // The edges of a closed surface.
        let mut edges: Vec<_> =
            mesh.faces().iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]).collect();
        edges.sort_unstable();
        assert!(edges.iter().all(|[a, b]| edges.binary_search(&[*b, *a]).is_ok()));
        assert!(matches!(solid.elevated(), Err(SolidError::MixedOrders { tets: 2, second_order: 2 })));
    }

    #[test]
    fn a_nearly_flat_tetrahedron_stays_in_first_order() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.25, 0.25, 5e-10)];
        let solid = Solid::uniform(corners, vec![[0, 1, 2, 3]], vec![], Material::default()).unwrap();
        let message = solid.elevated().map(drop).unwrap_err().to_string();
        let cause = "tetrahedron 0 (counted from 0, vertices [0, 1, 2, 3]) is too flat for second order: keep the solid in first \
                     order, or mesh it anew";
        assert_eq!(message, cause);
    }

    #[test]
    fn invalid_middles_are_rejected() {
        let (solid, _) = linear().elevated().unwrap();
        let middles: Vec<[u32; 6]> =
            solid.tets10().iter().map(|nodes| std::array::from_fn(|k| nodes[4 + k])).collect();
        let new = |vertices: Vec<DVec3>, tets: &[[u32; 4]], middles: &[[u32; 6]]| {
            let materials = vec![Material::default()];
            Solid::with_middles(vertices, tets.to_vec(), middles, vec![], materials, vec![0; 2])
        };
        let vertices = solid.vertices().to_vec();
        let message = |vertices: Vec<DVec3>, middles: &[[u32; 6]]| {
            let message = new(vertices, solid.tets(), middles).unwrap_err().to_string();
            assert!(!message.contains('\n'));
            message
        };
        assert!(
            message(vertices.clone(), &middles[..1]).starts_with("1 of 2 tetrahedra are of second order")
        );
        let mut other = middles.clone();
        other[1].swap(0, 2);
        let exchanged = message(vertices.clone(), &other);
        assert!(
            exchanged.starts_with("the second-order tetrahedron 1 (counted from 0, corners"),
            "{exchanged}"
        );
        assert!(
            exchanged.ends_with("each is nearer to the middle of another edge; exchange them"),
            "{exchanged}"
        );
        // The nodes are exchanged in every tetrahedron, as in files of another format: no edge has two nodes, but elements are
        // inverted.
        let all: Vec<_> = middles.iter().map(|m| [m[0], m[1], m[2], m[3], m[5], m[4]]).collect();
        let alone = Solid::with_middles(
            vertices.clone(),
            solid.tets()[..1].to_vec(),
            &all[..1],
            vec![],
            vec![Material::default()],
            vec![0],
        );
        let alone = alone.map(drop).unwrap_err().to_string();
        assert!(alone.contains("exchange them") || alone.contains("belongs to no element"), "{alone}");
        // An edge with two nodes at one place.
        let (mut doubled, mut others) = (vertices.clone(), middles.clone());
        let shared = others[1].iter_mut().find(|m| middles[0].contains(m)).unwrap();
        doubled.push(vertices[*shared as usize]);
        *shared = vertices.len() as u32;
        assert!(message(doubled, &others).contains("in its middle: merge"));
        let mut coincident = vertices.clone();
        coincident[middles[0][0] as usize] = DVec3::X;
        let inverted = message(coincident, &middles);
        assert!(
            inverted.starts_with("the second-order tetrahedron 0 (counted from 0, corners"),
            "{inverted}"
        );
        assert!(inverted.contains("move the nodes of its edges towards their middles"));

        // In a file of the opposite convention, all corners and middles are exchanged together.
        let reversed = |corners: &[u32; 4]| [corners[0], corners[1], corners[3], corners[2]];
        let tets: Vec<_> = solid.tets().iter().map(reversed).collect();
        let middles: Vec<_> = middles.iter().map(|m| [m[0], m[5], m[3], m[2], m[4], m[1]]).collect();
        let turned = new(vertices, &tets, &middles).unwrap();
        assert_eq!(turned.tets10(), solid.tets10());
    }
}
