//! Errors of the computation of modes.

use crate::outside::Outside;

/// Error of a computation of modes; the message is one line with the cause.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModesError {
    /// Every triangle is a segment or a point, so no inner product over the surface exists.
    #[error("the surface has no area: polynomial modes need at least one triangle that is not degenerate")]
    NoArea,
    /// The surface is so far from the origin that its shape is lost in the rounding of its positions.
    #[error(
        "the surface (radius {radius:e}) is too small compared with its distance {distance:e} from the origin: move the surface closer to the origin"
    )]
    TooFarFromOrigin {
        /// Root mean square distance of the surface from its centroid (model unit).
        radius: f64,
        /// Root mean square distance of the surface from the origin (model unit).
        distance: f64,
    },
    /// The stiffness has another number of modes.
    #[error("the stiffness has {found} modes, but the model has {rank}: pass U'KU of these modes")]
    StiffnessRank {
        /// Modes of the stiffness.
        found: usize,
        /// Number of modes.
        rank: usize,
    },
    /// A load acts on a vertex that does not exist.
    #[error("there is no vertex {vertex} (counted from 0): the model has {vertices}")]
    LoadedVertex {
        /// The vertex, from 0.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A load acts along a direction without stiffness.
    #[error(
        "the load moves the body along modes without stiffness, so it has no static answer: fix vertices, or leave these modes out"
    )]
    NoStaticAnswer,
    /// The stiffness has a negative eigenvalue.
    #[error(
        "the stiffness has the eigenvalue {eigenvalue:e} (largest magnitude {largest:e}): none may be negative; compute it at rest"
    )]
    StiffnessIndefinite {
        /// The lowest eigenvalue.
        eigenvalue: f64,
        /// The largest magnitude of an eigenvalue.
        largest: f64,
    },
    /// The iteration for the eigenvalues of a dense matrix did not end. This is not known to happen.
    #[error(
        "the eigenvalues of a matrix of {rows} rows did not converge: request another number of modes, and please report it"
    )]
    NoEigenvalues {
        /// Its number of rows.
        rows: usize,
    },
    /// A mass, a stiffness or a product of them is beyond double precision.
    #[error(
        "the mass or the stiffness leaves the range of numbers (1e-308 to 1e308): use units in which size, density and Young's modulus are closer to 1"
    )]
    OutOfRange,
    /// Not all vibrations converged.
    #[error("{}", unconverged(*.converged, *.wanted, *.ratio, *.is_rounding))]
    Unconverged {
        /// Number of converged vibrations.
        converged: usize,
        /// Number of vibrations in the search: a few more than requested.
        wanted: usize,
        /// Highest frequency of the search over the lowest.
        ratio: f64,
        /// Whether the rounding errors of the lowest vibration are larger than the error allowed for the highest.
        is_rounding: bool,
    },
    /// Rounding errors are too large to count the vibrations, so one may be missing.
    #[error(
        "rounding errors prevent the check that no vibration is missing: the stiffness of vertices differs by a factor of {contrast:.0e}, and the lowest eigenvalue is {lowest:.0e} of the mean one; use elements and materials that differ less, or larger elements"
    )]
    Uncounted {
        /// The largest entry on the diagonal of the stiffness over the smallest.
        contrast: f64,
        /// The lowest eigenvalue over the mean one: small for slender bodies.
        lowest: f64,
    },
    /// A basis for large deformations could not be computed. This is not known to happen.
    #[error(
        "the modal derivatives have a relative residual of {residual:.0e}, because rounding is large where elements or materials differ much: use linear modes, or elements and materials that differ less"
    )]
    Derivatives {
        /// The largest residual, as a share of the force.
        residual: f64,
    },
    /// An eigenvalue is negative or not finite.
    #[error(
        "eigenvalue {index} (counted from 0) is {value:e}: it must be finite and at least 0; set small negative ones to 0"
    )]
    Eigenvalue {
        /// Index, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The parameter `ell` of the filter is not positive and finite.
    #[error("ell is {value:e}: it must be positive and finite; the paper uses 100")]
    Ell {
        /// Its value.
        value: f64,
    },
    /// A fixed vertex does not exist.
    #[error("vertex {vertex} (counted from 0) cannot be fixed: the solid has {vertices} vertices")]
    FixedVertex {
        /// The vertex, from 0.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// All vertices are fixed.
    #[error("all {vertices} vertices are fixed: leave some free")]
    AllFixed {
        /// Number of vertices.
        vertices: usize,
    },
    /// More modes were requested than the body has.
    #[error(
        "{requested} modes were requested, but the body has {available}: request fewer, or use a finer mesh"
    )]
    TooManyModes {
        /// Number of requested modes.
        requested: usize,
        /// Degrees of freedom, without fixed vertices and rigid motions.
        available: usize,
    },
    /// More nonlinear modes were requested than the limit.
    #[error(
        "{requested} nonlinear modes were requested, but their forces have rank^4 coefficients: request at most {max}"
    )]
    NonlinearRank {
        /// Number of requested modes.
        requested: usize,
        /// Maximum number of modes.
        max: usize,
    },
    /// A pivot of the stiffness is not positive.
    #[error(
        "the stiffness is not positive at free vertex {vertex} (counted from 0): check the elements and materials around it"
    )]
    NotDefinite {
        /// Vertex of the pivot, from 0, fixed vertices not counted.
        vertex: usize,
    },
    /// Parts are connected by less than a face.
    #[error(
        "the body has {found} motions without energy, but a connected body has {expected}: parts share only an edge, a vertex or nothing (join them, or fix more vertices), or rounding errors exceed the lowest vibrations of a very slender body or very different materials (use larger elements)"
    )]
    Mechanism {
        /// Motions found.
        found: usize,
        /// Motions of a body in one piece.
        expected: usize,
    },
    /// The number of modes found is not the number that exist. This is not known to happen.
    #[error(
        "the search found {found} modes where {counted} exist: request a few more or fewer, or check the mesh for tiny elements"
    )]
    MissedModes {
        /// Modes found below some eigenvalue.
        found: usize,
        /// Modes that exist below it.
        counted: usize,
    },
    /// Not enough memory for the factor of the stiffness.
    #[error("the stiffness of this body does not fit into memory: use a coarser mesh, or fewer cubes")]
    Memory,
    /// The surface has a hole, or its triangles are not oriented consistently.
    #[error(
        "the edge from vertex {from} to vertex {to} (counted from 0) has {forward} triangles in this direction and {backward} in the other: close the surface (fill its holes; vertices of exactly equal position already count as one), and orient its triangles alike"
    )]
    OpenEdge {
        /// The vertex at one end, from 0.
        from: u32,
        /// The vertex at the other end, from 0.
        to: u32,
        /// Triangles that pass the edge in this direction.
        forward: usize,
        /// Triangles that pass it in the other.
        backward: usize,
    },
    /// The surface encloses no volume.
    #[error("the surface encloses no volume: use a closed surface of a solid with volume")]
    NoVolume,
    /// The surface collides with itself at rest, so its inside is ambiguous.
    #[error(
        "triangles {a} and {b} (counted from 0) collide at rest: a lattice needs a surface that neither cuts nor touches itself; move them apart, remove one, or embed the surface in a solid from another file"
    )]
    CollidesAtRest {
        /// A triangle, from 0.
        a: u32,
        /// The other triangle, from 0.
        b: u32,
    },
    /// The number of lattice cells is 0 or too large.
    #[error("{cells} cells along the longest side were requested: for this surface, use 1 to {max}")]
    Resolution {
        /// Number of requested cells.
        cells: usize,
        /// Maximum for this surface.
        max: usize,
    },
    /// A part of the surface lies inside the solid, or is inside out.
    #[error(
        "the part of the surface with triangle {triangle} (counted from 0) lies inside the solid or is inside out: remove it, or reverse its triangles (outward, and for a cavity inward)"
    )]
    Nested {
        /// A triangle of that part, from 0.
        triangle: u32,
    },
    /// The solid has several components.
    #[error("the solid is in {count} separate pieces: make a lattice for each, or join them")]
    Pieces {
        /// Number of pieces.
        count: usize,
    },
    /// A surface leaves the solid in which it is embedded.
    #[error(
        "{_0}: more than a tenth of its size; use a solid that encloses the surface, in the same units and place"
    )]
    OutsideSolid(Outside),
    /// Elements of the solid in which a surface is embedded overlap too much.
    #[error(
        "the elements of the solid overlap so much that vertices of the surface lie in more than {max} of them in all: use a solid whose elements do not overlap"
    )]
    OverlappingElements {
        /// Maximum number of elements, summed over the vertices.
        max: usize,
    },
    /// A surface is to be embedded in tetrahedra of second order.
    #[error(
        "a surface can be embedded in tetrahedra of first order only: mesh the solid in first order, or take its own surface"
    )]
    EmbeddedInSecondOrder,
    /// An animation has fewer than two frames.
    #[error("{found} frames are too few: principal components need at least two")]
    TooFewFrames {
        /// Number of frames.
        found: usize,
    },
    /// An animation has too many frames of too many coordinates.
    #[error(
        "{frames} frames of {coordinates} coordinates (three for each vertex of a face) are too many for principal components: use at most {max} frames, or a mesh of at most {} vertices",
        .max / 3
    )]
    TooManyFrames {
        /// Number of frames.
        frames: usize,
        /// Number of coordinates of each frame, without unused vertices.
        coordinates: usize,
        /// Maximum of one of the two numbers; the other may then be larger.
        max: usize,
    },
    /// A frame belongs to another mesh.
    #[error(
        "frame {frame} (counted from 0) has {found} vertices, the mesh {expected}: all frames must be of the same mesh"
    )]
    FrameVertices {
        /// The frame, from 0.
        frame: usize,
        /// Its number of vertices.
        found: usize,
        /// The mesh's number of vertices.
        expected: usize,
    },
    /// A position of a frame is out of range.
    #[error(
        "vertex {vertex} of frame {frame} (counted from 0) has a coordinate that is not finite or beyond 2^200"
    )]
    FramePosition {
        /// The frame, from 0.
        frame: usize,
        /// The vertex, from 0.
        vertex: usize,
    },
    /// All frames are equal.
    #[error("all {frames} frames are equal, up to rounding: use frames that differ")]
    StillFrames {
        /// Number of frames.
        frames: usize,
    },
    /// More components were requested than the frames have.
    #[error(
        "{requested} components were requested, but the frames have {available} independent directions: request at most that many"
    )]
    TooManyComponents {
        /// Number of requested components.
        requested: usize,
        /// Number of independent components.
        available: usize,
    },
    /// Error of the crate `sscc-solid`.
    #[error(transparent)]
    Solid(#[from] sscc_solid::SolidError),
    /// Error of the crate `sscc`: a number of the modes or the metric is out of range, or the work was cancelled.
    #[error(transparent)]
    Core(#[from] sscc::Error),
}

/// Returns the message for vibrations that did not converge.
fn unconverged(converged: usize, wanted: usize, ratio: f64, is_rounding: bool) -> String {
    let found = format!("{converged} of {wanted} vibrations converged");
    match is_rounding {
        true => format!(
            "{found}: the highest frequency is about {ratio:.0} times the lowest, so the lowest is below the rounding errors; request fewer modes"
        ),
        false => format!(
            "{found} within the maximum number of iterations: request another number of modes, and please report it"
        ),
    }
}
