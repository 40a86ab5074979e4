//! What can be wrong with a model, its certificates or a query.

/// A refusal of the core. One line, naming the place and the cause.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A mesh without faces.
    #[error("the mesh has no triangles")]
    NoFaces,
    /// Counts are stored in 32 bits.
    #[error("{count} {what}: more than {} are not supported", u32::MAX)]
    TooMany {
        /// What was counted.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// A rest position out of range.
    #[error("vertex {vertex} (counted from 0) has the position {position:?}: not finite, or beyond 2^200")]
    Position {
        /// The vertex, from 0.
        vertex: usize,
        /// Its position.
        position: [f64; 3],
    },
    /// A face names a vertex that does not exist.
    #[error("triangle {face} (counted from 0) names vertex {vertex}, but there are only {vertices} vertices")]
    FaceIndex {
        /// The triangle, from 0.
        face: usize,
        /// The index it names, from 0.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// No modes.
    #[error("the model has no modes (rank 0): at least one is needed")]
    RankZero,
    /// Displacements that do not fill whole vertices.
    #[error("{len} displacements are no whole number of vertices with {rank} modes each")]
    ModesLength {
        /// Number of displacement vectors.
        len: usize,
        /// Number of modes.
        rank: usize,
    },
    /// A mode entry out of range.
    #[error("mode {mode} of vertex {vertex} (both counted from 0) is not finite, or beyond 2^200")]
    ModeEntry {
        /// The vertex, from 0.
        vertex: usize,
        /// The mode, from 0.
        mode: usize,
    },
    /// Modes of another mesh.
    #[error("the modes are for {modes} vertices, the mesh has {mesh}: are they of another mesh?")]
    VertexCount {
        /// Vertices of the modes.
        modes: usize,
        /// Vertices of the mesh.
        mesh: usize,
    },
    /// A metric of another rank.
    #[error("the metric has {found} weights, the model has {rank} modes")]
    MetricLength {
        /// Weights given.
        found: usize,
        /// Number of modes.
        rank: usize,
    },
    /// A weight that is no positive number.
    #[error("metric weight {index} (counted from 0) is {value}: weights must be positive and finite")]
    MetricWeight {
        /// The mode, from 0.
        index: usize,
        /// Its weight.
        value: f64,
    },
    /// Scaled modes out of range.
    #[error(
        "the modes divided by the metric's scales reach {largest:e}: outside [2^-200, 2^200]; rescale the metric"
    )]
    MetricRange {
        /// The largest magnitude of an entry of `U S^-1`.
        largest: f64,
    },
    /// A dense metric that cannot be used.
    #[error("the metric's matrix cannot be used: {what}")]
    MetricMatrix {
        /// What is wrong with it.
        what: &'static str,
    },
    /// q of another length.
    #[error("q has {found} entries, the model has {rank} modes")]
    CoordinatesLength {
        /// Entries given.
        found: usize,
        /// Number of modes.
        rank: usize,
    },
    /// q with a NaN or an infinity.
    #[error("q[{index}] is {value}: every entry must be finite")]
    CoordinatesValue {
        /// The mode, from 0.
        index: usize,
        /// The entry.
        value: f64,
    },
    /// q so large that positions leave the range in which predicates are exact.
    #[error("q moves vertices beyond 2^200 (about 1.6e60): scale the model or q down")]
    CoordinatesRange,
    /// So many collisions that no list of them is of use.
    #[error(
        "the shape has more than {most} colliding pairs of triangles at rest or at the centre: is it a surface?"
    )]
    TooManyCollisions {
        /// How many would be accepted.
        most: usize,
    },
    /// An option out of range.
    #[error("{name} is {value}: it must be {wanted}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        wanted: &'static str,
    },
    /// Certificates computed for something else.
    #[error(
        "the certificates are of another model: their digest is {certificates}, this model's is {model}; certify this model anew"
    )]
    OtherModel {
        /// Digest that the certificates speak of (first bytes).
        certificates: String,
        /// Digest of the model at hand (first bytes).
        model: String,
    },
    /// Certificates for other pairs of triangles than those asked for.
    #[error("the certificates do not speak of the pairs asked for: {what}; certify anew")]
    OtherPairs {
        /// What differs.
        what: String,
    },
    /// Parts of certificates that do not fit together.
    #[error("the certificates are damaged: {0}")]
    Certificates(String),
    /// A job or a result of a computation in shards that cannot be used, or that could not be done.
    #[error("shards: {0}")]
    Shard(String),
    /// Stopped by the caller: to people an interrupt.
    #[error("interrupted")]
    Cancelled,
}
