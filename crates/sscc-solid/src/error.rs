//! Why a volumetric mesh, a solid, a stiffness or reduced forces are refused.

use crate::MaterialError;

/// Data that are no solid, or no forces of one. One line that names the place and the cause.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolidError {
    /// A mesh without vertices.
    #[error("the mesh has no vertices")]
    NoVertices,
    /// More vertices than indices can name.
    #[error("{count} vertices are more than 32-bit indices can name")]
    TooManyVertices {
        /// Number of vertices.
        count: usize,
    },
    /// A mesh without elements.
    #[error("the mesh has no elements: no tetrahedra and no cubes (hexahedra)")]
    NoElements,
    /// Material numbers that do not fit the elements.
    #[error(
        "{found} material numbers for {elements} elements: each element needs one, of a material that is there"
    )]
    ElementMaterials {
        /// Number of elements.
        elements: usize,
        /// Number of material numbers.
        found: usize,
    },
    /// Filled shares that do not fit the cubes.
    #[error("the filled shares do not fit {cubes} cubes: each cube needs eight numbers, from 0 to 1")]
    Fill {
        /// Number of cubes.
        cubes: usize,
    },
    /// An element or a listed face of a vertex that is not there.
    #[error("an element names vertex {index} (counted from 0), but there are {vertices}")]
    ElementIndex {
        /// The vertex, from 0.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// An element or a listed face that names a vertex twice.
    #[error("an element names vertex {index} (counted from 0) twice")]
    RepeatedCorner {
        /// The vertex, from 0.
        index: u32,
    },
    /// An element that is there twice: it would be twice as stiff.
    #[error("{kind} {first} and {second} (counted from 0) have the same corners")]
    SameCorners {
        /// "tetrahedra" or "cubes".
        kind: &'static str,
        /// One of them, from 0.
        first: usize,
        /// The other one, from 0.
        second: usize,
    },
    /// A vertex that no element holds: it has neither mass nor stiffness.
    #[error("vertex {vertex} (counted from 0) of the solid belongs to no element: remove it")]
    OrphanVertex {
        /// The vertex, from 0.
        vertex: usize,
    },
    /// A vertex out of range.
    #[error(
        "vertex {vertex} (counted from 0) of the solid has a coordinate that is not finite or beyond 2^200"
    )]
    Vertex {
        /// The vertex, from 0.
        vertex: usize,
    },
    /// A tetrahedron without volume.
    #[error(
        "tetrahedron {tet} (counted from 0, vertices {corners:?}) is flat: mesh the solid anew, or remove it"
    )]
    FlatTet {
        /// The tetrahedron, from 0.
        tet: usize,
        /// Its vertices.
        corners: [u32; 4],
    },
    /// A tetrahedron that is turned the other way than most.
    #[error(
        "tetrahedron {tet} (counted from 0, vertices {corners:?}) is inverted, one of {count}: exchange two of its vertices, or mesh the solid anew"
    )]
    InvertedTet {
        /// The tetrahedron, from 0.
        tet: usize,
        /// Its vertices.
        corners: [u32; 4],
        /// How many are inverted.
        count: usize,
    },
    /// A cube that is flat or turned inside out somewhere.
    #[error(
        "cube {cube} (counted from 0) is flat or inverted at a corner: its corners go around its lower face, then around its upper one"
    )]
    InvertedCube {
        /// The cube, from 0.
        cube: usize,
    },
    /// A face of more than two elements.
    #[error(
        "the face of vertices {face:?} (counted from 0) belongs to more than two elements: some overlap; mesh the solid anew"
    )]
    OverlappingElements {
        /// Its vertices.
        face: Vec<u32>,
    },
    /// A number that no material has.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A stiffness of another number of modes.
    #[error("the stiffness has {found} entries, {rank} modes need {rank} x {rank}: pass U'KU of these modes")]
    StiffnessLength {
        /// Entries given.
        found: usize,
        /// Number of modes.
        rank: usize,
    },
    /// A stiffness with a NaN, an infinity or a number out of range.
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
    /// Mirrored entries differ by more than rounding.
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
    /// Reduced forces with another number of coefficients than their rank says.
    #[error("the forces have {found} coefficients of degree {degree}, rank {rank} needs {expected}")]
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
    /// A coefficient of reduced forces that is a NaN, an infinity or out of range.
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
    /// The core refused a mesh or modes.
    #[error(transparent)]
    Core(#[from] sscc::Error),
}
