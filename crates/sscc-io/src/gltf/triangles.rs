//! Triangles of a primitive, from its list of corners.

use super::json::{Mesh, Primitive};

/// Topology of a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Topology {
    List,
    Strip,
    Fan,
}

impl Topology {
    /// Returns the topology of a mode number of the file; the error is the name of a topology without triangles.
    pub fn from_mode(mode: Option<u32>) -> Result<Self, String> {
        Err(match mode {
            None | Some(4) => return Ok(Self::List),
            Some(5) => return Ok(Self::Strip),
            Some(6) => return Ok(Self::Fan),
            Some(0) => "points".into(),
            Some(1..=3) => "lines".into(),
            Some(other) => format!("the unknown topology {other}"),
        })
    }

    /// Returns the triangles of these corners, in order, with the winding of the standard. None if the number of
    /// corners is not a multiple of 3 in a list, or too small.
    ///
    /// Triangles of a strip with a repeated corner are left out: exporters use them to connect parts, and they would be
    /// segments that pierce the shape.
    pub fn triangles(self, corners: &[u32]) -> Option<Vec<[u32; 3]>> {
        if corners.len() < 3 {
            return None;
        }
        match self {
            Self::List => {
                let (triangles, rest) = corners.as_chunks::<3>();
                rest.is_empty().then(|| triangles.to_vec())
            }
            Self::Strip => {
                let triangle = |(i, w): (usize, &[u32])| {
                    if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] }
                };
                let is_proper = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
                Some(corners.windows(3).enumerate().map(triangle).filter(is_proper).collect())
            }
            Self::Fan => Some(corners[1..].windows(2).map(|pair| [pair[0], pair[1], corners[0]]).collect()),
        }
    }
}

/// Whether a primitive has triangles. Points and lines (modes 0 to 3) cannot collide, and players draw no primitive without
/// positions. An unknown mode may be one of triangles, so readers must refuse it.
pub(super) fn has_triangles(primitive: &Primitive) -> bool {
    !matches!(primitive.mode, Some(0..=3)) && primitive.attributes.position.is_some()
}

/// Returns the primitives of a mesh that have triangles, with their numbers in the mesh.
pub(super) fn with_triangles(mesh: &Mesh) -> impl Iterator<Item = (usize, &Primitive)> {
    mesh.primitives.iter().enumerate().filter(|(_, primitive)| has_triangles(primitive))
}

/// Returns the accessors of the positions and indices of a mesh's triangles; some may not exist.
pub(super) fn geometry_accessors(mesh: &Mesh) -> impl Iterator<Item = usize> {
    with_triangles(mesh).flat_map(|(_, p)| p.attributes.position.into_iter().chain(p.indices))
}

/// Number of morph targets of a mesh: the largest of its primitives'. Targets that a primitive lacks do not move it.
pub(super) fn morph_targets(mesh: &Mesh) -> usize {
    with_triangles(mesh).map(|(_, primitive)| primitive.targets.len()).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_strips_and_fans_have_the_triangles_of_the_standard() {
        let corners = [7, 1, 2, 3, 4, 5];
        assert_eq!(Topology::List.triangles(&corners).unwrap(), [[7, 1, 2], [3, 4, 5]]);
        let strip = Topology::Strip.triangles(&corners).unwrap();
        assert_eq!(strip, [[7, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]]);
        let fan = Topology::Fan.triangles(&corners).unwrap();
        assert_eq!(fan, [[1, 2, 7], [2, 3, 7], [3, 4, 7], [4, 5, 7]]);
        let two_strips = Topology::Strip.triangles(&[0, 1, 2, 2, 5, 5, 6, 7]).unwrap();
        assert_eq!(two_strips, [[0, 1, 2], [5, 7, 6]]);
        for topology in [Topology::List, Topology::Strip, Topology::Fan] {
            assert_eq!(topology.triangles(&[0, 1]), None);
        }
        assert_eq!(Topology::List.triangles(&[0, 1, 2, 3]), None);
    }

    #[test]
    fn unsupported_topologies_are_named() {
        assert_eq!(Topology::from_mode(Some(0)).unwrap_err(), "points");
        assert_eq!(Topology::from_mode(Some(3)).unwrap_err(), "lines");
        assert_eq!(Topology::from_mode(Some(7)).unwrap_err(), "the unknown topology 7");
        assert_eq!(Topology::from_mode(None), Topology::from_mode(Some(4)));
    }
}
