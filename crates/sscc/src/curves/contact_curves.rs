//! The curves in which a mesh intersects itself or another one: the intersection segments of all colliding pairs, joined.
//!
//! An end of a segment lies on one feature of each triangle (vertex, edge or face), and it is the only common point of these two
//! features. So the two features of the mesh name the point, and segments are joined where their ends have the same name. There
//! is no tolerance: curves are joined correctly however close they pass each other.

use glam::DVec3;

use super::mesh_feature::MeshFeature;
use super::pair_contact::PairContact;
use super::polylines::{Polyline, Segment, join_segments};
use super::surface::Surface;
use crate::arithmetic::check_arithmetic;
use crate::geometry::{Intersection, IntersectionPoint};
use crate::{Error, Pair};

/// The contacts of colliding pairs, and the curves that their intersection segments form.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactCurves {
    /// One contact for each given pair that has a common point, in the order given.
    pub contacts: Vec<PairContact>,
    /// The segments of all contacts, joined to polylines, in the order of their first contacts. A segment that several
    /// pairs share (an edge that lies on a face belongs to two triangles) occurs once, by the first of these pairs.
    pub curves: Vec<ContactCurve>,
    /// The contacts whose triangles have one common point, in ascending order. It may be on a curve, too.
    pub points: Vec<u32>,
    /// The contacts whose triangles meet in a convex polygon (coplanar ones), in ascending order.
    pub polygons: Vec<u32>,
}

/// A polyline in which surfaces intersect.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactCurve {
    /// Whether the last point is joined to the first, by the last contact. Otherwise the curve ends where no segment
    /// follows (at a border, at a pair that was not given, at a polygon) or where more than two meet.
    pub is_closed: bool,
    /// At least two points. A closed curve does not repeat its first point at its end.
    pub points: Vec<CurvePoint>,
    /// For each segment, from a point to the next, the number of its contact.
    pub contacts: Vec<u32>,
}

/// A point of a curve: the only common point of two features.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// The position (model unit), rounded; see
    /// [`intersection_triangle_triangle`](crate::parts::intersection_triangle_triangle).
    pub position: DVec3,
    /// The two features on which the exact point lies. For two meshes, that of the first mesh comes first; for one mesh, they are
    /// in ascending order.
    pub features: [MeshFeature; 2],
}

/// Returns the contacts of the colliding pairs of one mesh, and the curves in which it intersects itself.
///
/// Takes `faces` (N, three vertex numbers each), `positions` (V, model unit), and `pairs` as a query or a detector lists them.
/// Pairs without a common point are left out. Pairs that share a vertex may be given: the vertex is a common point.
///
/// Curves are joined by vertex numbers. Where a file splits vertices along seams, give one number to all vertices of a
/// weld, or curves end at the seams. They end at degenerate triangles, too, and at pairs that are not given.
///
/// The result depends on the input alone. Each pair costs about four microseconds and 300 bytes. The time is O(n log n) in the
/// number n of pairs, plus a check of all faces and positions of the mesh.
///
/// # Errors
/// If a pair names a triangle, or a face a vertex, that does not exist, a position is not finite or beyond
/// [`limits::LARGEST`](crate::limits::LARGEST), there are more than `u32::MAX` pairs, or this thread's arithmetic is not that of
/// IEEE 754 ([`Error::Arithmetic`]).
///
/// ```
/// use glam::DVec3;
/// use sscc::parts::contact_curves;
///
/// // Two triangles, each of which has a corner below the other.
/// let faces = [[0, 1, 2], [3, 4, 5]];
/// let positions = [
///     DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0,
///     DVec3::new(1.0, 1.0, -0.25), DVec3::new(1.0, 1.0, 2.0), DVec3::new(2.0, 1.0, 2.0),
/// ];
/// let found = contact_curves(&faces, &positions, &[(0, 1)])?;
/// assert_eq!(found.contacts[0].depth, 0.25);
/// assert_eq!((found.curves.len(), found.curves[0].is_closed), (1, false));
/// # Ok::<(), sscc::Error>(())
/// ```
pub fn contact_curves(
    faces: &[[u32; 3]],
    positions: &[DVec3],
    pairs: &[Pair],
) -> Result<ContactCurves, Error> {
    check_arithmetic()?;
    let surface = Surface { faces, positions };
    surface.check()?;
    ContactCurves::of([surface; 2], pairs, |mut features| {
        features.sort_unstable();
        features
    })
}

/// Returns the contacts of the colliding pairs of two meshes (first a triangle of x, then one of y), and the curves in which the
/// meshes intersect, like [`contact_curves`].
///
/// # Errors
/// Those of [`contact_curves`].
pub fn contact_curves_between(
    x: Surface<'_>,
    y: Surface<'_>,
    pairs: &[Pair],
) -> Result<ContactCurves, Error> {
    check_arithmetic()?;
    x.check()?;
    y.check()?;
    ContactCurves::of([x, y], pairs, |features| features)
}

impl ContactCurves {
    /// Computes the contacts and joins their segments. `name` returns the name of a point from its two features.
    fn of(
        surfaces: [Surface<'_>; 2],
        pairs: &[Pair],
        name: impl Fn([MeshFeature; 2]) -> [MeshFeature; 2],
    ) -> Result<Self, Error> {
        if u32::try_from(pairs.len()).is_err() {
            return Err(Error::TooMany { what: "pairs", count: pairs.len() });
        }
        let mut found = Self::default();
        let mut ends: Vec<[CurvePoint; 2]> = Vec::new();
        let mut segment_contacts = Vec::new();
        for (i, &(s, t)) in pairs.iter().enumerate() {
            let [x, y] = surfaces;
            x.check_triangle(i, s)?;
            y.check_triangle(i, t)?;
            let Some(contact) = PairContact::of((s, t), &x.corners(s), &y.corners(t)) else { continue };
            let curve_point = |point: &IntersectionPoint| CurvePoint {
                position: point.position,
                features: name([
                    MeshFeature::of(point.features[0], s, x.faces[s as usize]),
                    MeshFeature::of(point.features[1], t, y.faces[t as usize]),
                ]),
            };
            let number = found.contacts.len() as u32;
            match &contact.intersection {
                Intersection::Point(_) => found.points.push(number),
                Intersection::Polygon(_) => found.polygons.push(number),
                Intersection::Segment(segment) => {
                    ends.push(segment.each_ref().map(curve_point));
                    segment_contacts.push(number);
                }
            }
            found.contacts.push(contact);
        }
        found.curves = join(&ends, &segment_contacts);
        Ok(found)
    }
}

/// Joins segments, given by their ends and contacts, where their ends have the same name.
fn join(ends: &[[CurvePoint; 2]], contacts: &[u32]) -> Vec<ContactCurve> {
    let mut nodes: Vec<CurvePoint> = ends.as_flattened().to_vec();
    nodes.sort_by_key(|node| node.features);
    nodes.dedup_by_key(|node| node.features);
    // Always found: the nodes are the ends.
    let node = |end: &CurvePoint| nodes.partition_point(|node| node.features < end.features) as u32;
    let segments = ends
        .iter()
        .zip(contacts)
        .map(|(ends, &contact)| Segment { nodes: ends.each_ref().map(node), contact });
    // Where two copies of one triangle intersect, both ends of a segment can have one name.
    let segments = segments.filter(|segment| segment.nodes[0] != segment.nodes[1]).collect();
    let polylines = join_segments(segments, nodes.len());
    let curve = |Polyline { nodes: along, contacts }: Polyline| ContactCurve {
        is_closed: along.len() == contacts.len(),
        points: along.into_iter().map(|node| nodes[node as usize]).collect(),
        contacts,
    };
    polylines.into_iter().map(curve).collect()
}
