//! Errors of volumetric meshes, solids, stiffness matrices and reduced forces.

use crate::MaterialError;

/// Invalid data of a solid or its forces; the message is one line with the place and the cause.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolidError {
    /// The mesh has no vertices.
    #[error("the mesh has no vertices")]
    NoVertices,
    /// The number of vertices exceeds 32-bit indices.
    #[error("the mesh has {count} vertices: 32-bit indices allow at most 2^32 - 1; use a coarser mesh")]
    TooManyVertices {
        /// Number of vertices.
        count: usize,
    },
    /// The mesh has no elements.
    #[error("the mesh has no elements: add tetrahedra or hexahedra")]
    NoElements,
    /// The material indices do not fit the elements.
    #[error(
        "the mesh has {found} material numbers for {elements} elements: give each element the number of an existing material"
    )]
    ElementMaterials {
        /// Number of elements.
        elements: usize,
        /// Number of material numbers.
        found: usize,
    },
    /// The volume fractions do not fit the cubes.
    #[error(
        "the number of volume fractions does not match {cubes} cubes: each cube needs eight, from 0 to 1"
    )]
    Fill {
        /// Number of cubes.
        cubes: usize,
    },
    /// An element or a listed face names a vertex that does not exist.
    #[error("an element names vertex {index} (counted from 0), but there are {vertices}")]
    ElementIndex {
        /// The vertex, from 0.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// An element or a listed face names a vertex twice.
    #[error("an element names vertex {index} (counted from 0) twice")]
    RepeatedCorner {
        /// The vertex, from 0.
        index: u32,
    },
    /// An element is duplicated, which would double its stiffness.
    #[error("{kind} {first} and {second} (counted from 0) have the same corners")]
    SameCorners {
        /// "tetrahedra" or "cubes".
        kind: &'static str,
        /// One of them, from 0.
        first: usize,
        /// The other one, from 0.
        second: usize,
    },
    /// A vertex belongs to no element, so it has neither mass nor stiffness.
    #[error("vertex {vertex} (counted from 0) of the solid belongs to no element: remove it")]
    OrphanVertex {
        /// The vertex, from 0.
        vertex: usize,
    },
    /// A vertex has a coordinate out of range.
    #[error(
        "vertex {vertex} (counted from 0) of the solid has a coordinate that is not finite or beyond 2^200"
    )]
    Vertex {
        /// The vertex, from 0.
        vertex: usize,
    },
    /// A tetrahedron has no volume.
    #[error(
        "tetrahedron {tet} (counted from 0, vertices {corners:?}) is flat: mesh the solid anew, or remove it"
    )]
    FlatTet {
        /// The tetrahedron, from 0.
        tet: usize,
        /// Its vertices.
        corners: [u32; 4],
    },
    /// A tetrahedron is so nearly flat that rounding decides whether it is, so that it has no second order.
    #[error(
        "tetrahedron {tet} (counted from 0, vertices {corners:?}) is too flat for second order: keep the solid in first order, or \
         mesh it anew"
    )]
    NearlyFlatTet {
        /// The tetrahedron, from 0.
        tet: usize,
        /// Its vertices.
        corners: [u32; 4],
    },
    /// A tetrahedron is inverted, while others are not.
    #[error(
        "tetrahedron {tet} (counted from 0, vertices {corners:?}) is inverted, one of {count}: exchange two of its vertices, or mesh the solid anew"
    )]
    InvertedTet {
        /// The tetrahedron, from 0.
        tet: usize,
        /// Its vertices.
        corners: [u32; 4],
        /// Number of inverted tetrahedra.
        count: usize,
    },
    /// A tetrahedron of second order is flat or inverted at some point.
    #[error(
        "the second-order tetrahedron {tet} (counted from 0, corners {corners:?}) is flat or inverted at one of its nodes or \
         integration points: move the nodes of its edges towards their middles (gmsh: -optimize_ho), or mesh in first order"
    )]
    InvertedSecondOrderTet {
        /// The tetrahedron, from 0.
        tet: usize,
        /// Its corners.
        corners: [u32; 4],
    },
    /// The nodes in the middles of the edges of a tetrahedron are exchanged, or in the order of another format.
    #[error(
        "the second-order tetrahedron {tet} (counted from 0, corners {corners:?}) has nodes of its edges in another order than those of \
         its format: each is nearer to the middle of another edge; exchange them"
    )]
    ExchangedMiddles {
        /// The tetrahedron, from 0.
        tet: usize,
        /// Its corners.
        corners: [u32; 4],
    },
    /// Only some tetrahedra are of second order, so the mesh has gaps at their edges.
    #[error(
        "{second_order} of {tets} tetrahedra are of second order: mesh the whole solid in first or in second order"
    )]
    MixedOrders {
        /// Number of tetrahedra.
        tets: usize,
        /// Number of those of second order.
        second_order: usize,
    },
    /// Two tetrahedra have different nodes in the middle of a common edge.
    #[error(
        "the edge of vertices {edge:?} (counted from 0) has the nodes {middles:?} in its middle: merge the equal nodes of the \
         mesh"
    )]
    DifferentMiddles {
        /// Corners of the edge.
        edge: [u32; 2],
        /// Nodes of two tetrahedra.
        middles: [u32; 2],
    },
    /// A cube is flat or inverted at some point.
    #[error(
        "cube {cube} (counted from 0) is flat or inverted at a corner or an integration point: list its corners around its lower face, then around its upper one"
    )]
    InvertedCube {
        /// The cube, from 0.
        cube: usize,
    },
    /// A face belongs to more than two elements.
    #[error(
        "the face of vertices {face:?} (counted from 0) belongs to more than two elements, so elements overlap: mesh the solid anew"
    )]
    OverlappingElements {
        /// Its vertices.
        face: Vec<u32>,
    },
    /// A property of a material is outside its range.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A material of elements has a stiffness that is not computed.
    #[error(
        "the material {name} is of the kind {kind}, whose stiffness is not computed: state both numbers of an isotropic \
         stiffness instead"
    )]
    UnsupportedMaterial {
        /// Name in the file.
        name: String,
        /// Kind in the file.
        kind: String,
    },
    /// The size of the stiffness does not fit the number of modes.
    #[error(
        "the stiffness has {found} entries, but {rank} modes need {rank} x {rank}: pass U'KU of these modes"
    )]
    StiffnessLength {
        /// Entries given.
        found: usize,
        /// Number of modes.
        rank: usize,
    },
    /// An entry of the stiffness is not finite or out of range.
    #[error(
        "the stiffness is {value:e} at row {row}, column {column} (counted from 0): not finite, or beyond 2^200; change its unit or repair it"
    )]
    StiffnessEntry {
        /// The row, from 0.
        row: usize,
        /// The column, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The stiffness is not symmetric up to rounding.
    #[error(
        "the stiffness is {entry:e} at row {row}, column {column} (counted from 0), but {mirrored:e} mirrored: it must be symmetric; pass all of it, not a triangle"
    )]
    StiffnessAsymmetric {
        /// The row, from 0.
        row: usize,
        /// The column, from 0.
        column: usize,
        /// The entry there.
        entry: f64,
        /// The entry with row and column exchanged.
        mirrored: f64,
    },
    /// The number of coefficients does not fit the rank.
    #[error("the forces have {found} coefficients of degree {degree}, but rank {rank} needs {expected}")]
    ForceLength {
        /// 2 or 3.
        degree: usize,
        /// Coefficients given.
        found: usize,
        /// Number of forces.
        rank: usize,
        /// Coefficients of that degree in forces of that rank.
        expected: usize,
    },
    /// A coefficient is not finite or out of range.
    #[error(
        "a coefficient of degree {degree} is {value:e} at row {row}, column {column} (counted from 0): not finite, or beyond 2^200"
    )]
    ForceEntry {
        /// 2 or 3.
        degree: usize,
        /// The force, from 0.
        row: usize,
        /// The monomial, from 0.
        column: usize,
        /// The coefficient.
        value: f64,
    },
    /// Error of the crate `sscc` for a mesh or modes.
    #[error(transparent)]
    Core(#[from] sscc::Error),
}
