//! The errors of the core.
//!
//! A message is one line: the place (a vertex, a triangle, a mode, counted from 0), the cause, and the remedy, if there is one.
//! Callers put the file or the argument in front.

/// Why the core refuses a mesh, modes, a metric, q, an option or certificates.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A thread whose floating-point mode is not that of the proofs.
    #[error(
        "the floating-point mode of this thread is not that of the proofs: {what}; set round to nearest and gradual underflow"
    )]
    Arithmetic {
        /// How the mode differs, as a clause.
        what: &'static str,
    },
    /// A mesh without faces.
    #[error("the mesh has no triangles")]
    NoFaces,
    /// More items than 32-bit numbers can count.
    #[error("{count} {what}: at most {} are supported", u32::MAX)]
    TooMany {
        /// The kind of the items.
        what: &'static str,
        /// Their number.
        count: usize,
    },
    /// A rest position or a given position out of range.
    #[error(
        "vertex {vertex} (counted from 0) has the position {position:?}: not finite, or beyond 2^200; change the unit"
    )]
    Position {
        /// The vertex, from 0.
        vertex: usize,
        /// Its position.
        position: [f64; 3],
    },
    /// Positions of another mesh.
    #[error("there are {found} positions, but the mesh has {vertices} vertices: are they of another mesh?")]
    PositionCount {
        /// Positions given.
        found: usize,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("triangle {face} (counted from 0) names vertex {vertex}, but there are {vertices}")]
    FaceIndex {
        /// The triangle, from 0.
        face: usize,
        /// The index it names, from 0.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A pair names a triangle that does not exist.
    #[error("pair {pair} (counted from 0) names triangle {triangle}, but there are {triangles}")]
    PairIndex {
        /// The pair, from 0.
        pair: usize,
        /// The triangle that it names, from 0.
        triangle: u32,
        /// Number of triangles.
        triangles: usize,
    },
    /// A mesh without an inside, the `first` or the `second` one, where the volume of bodies is needed.
    #[error(
        "the {0} mesh has no inside, because it is open or parts of it face inward: close its holes, and make its triangles \
         face outward"
    )]
    OpenMesh(&'static str),
    /// A contact filter with folded neighbours, where only distances can be bounded.
    #[error(
        "include-folded is for discrete queries of meshes without modes: triangles with a common edge have distance 0 in \
         every shape, so that {queries} cannot decide when they fold; use include-one-vertex"
    )]
    FoldedNeighbours {
        /// The queries that cannot decide them.
        queries: &'static str,
    },
    /// A colliding start of a search for a free configuration: the start must be free.
    #[error("the start collides; give a free q, or leave it out")]
    ResolveStart,
    /// No modes.
    #[error("the model has no modes (rank 0): at least one is needed")]
    RankZero,
    /// A number of displacements that is not a multiple of the rank.
    #[error("{len} displacements are not a multiple of the {rank} modes")]
    ModesLength {
        /// Number of displacement vectors.
        len: usize,
        /// Number of modes.
        rank: usize,
    },
    /// A mode entry out of range.
    #[error(
        "mode {mode} of vertex {vertex} (both counted from 0) is not finite, or beyond 2^200; rescale the mode"
    )]
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
    /// A weight that is not positive and finite.
    #[error("metric weight {index} (counted from 0) is {}: weights must be positive and finite", short_number(*value))]
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
    /// A dense metric that is not symmetric positive definite, too large or nearly singular.
    #[error("the metric's matrix cannot be used: {what}")]
    MetricMatrix {
        /// The reason.
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
    /// A q at which positions leave the range in which predicates are exact.
    #[error("q moves vertices beyond 2^200 (about 1.6e60): scale it or the model down")]
    CoordinatesRange,
    /// A mode that does not exist.
    #[error("there is no mode {mode}: the model has {rank} modes, counted from 0")]
    ModeIndex {
        /// The mode named.
        mode: usize,
        /// Number of modes.
        rank: usize,
    },
    /// A range of weights that is empty or not finite.
    #[error(
        "mode {mode} (counted from 0): the range from {} to {} is empty or not finite",
        short_number(*low),
        short_number(*high)
    )]
    SweepRange {
        /// The mode, from 0.
        mode: usize,
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// A text that names no value.
    #[error("'{name}' is no {what}: use one of {names}")]
    Name {
        /// The kind of value that it should name.
        what: &'static str,
        /// The text.
        name: String,
        /// The names of all values.
        names: String,
    },
    /// Too many collisions to list.
    #[error(
        "more than {most} pairs of triangles collide at rest or at the centre: repair the mesh, or choose another centre"
    )]
    TooManyCollisions {
        /// Maximum number of accepted pairs.
        most: usize,
    },
    /// More pairs around given ones than can be ignored or examined.
    #[error(
        "within {rings} rings of these pairs of triangles there are too many to ignore (at most {most}): choose fewer rings"
    )]
    TooManyIgnored {
        /// Maximum number of ignored pairs.
        most: usize,
        /// The given number of rings.
        rings: u32,
    },
    /// More colliding pairs than fit in an answer.
    #[error("more than {most} pairs of triangles collide: set a limit to get that many of them")]
    TooManyPairs {
        /// Maximum number of pairs of an answer without a limit.
        most: usize,
    },
    /// More pairs nearer than a clearance than fit in an answer.
    #[error("more than {most} pairs of triangles are nearer than the clearance: set a smaller one")]
    TooManyNearPairs {
        /// Maximum number of pairs of an answer.
        most: usize,
    },
    /// A clearance whose rings have more pairs than can be listed.
    #[error(
        "within {rings} rings of each other there are more than {most} pairs of triangles: choose fewer rings"
    )]
    TooManyRings {
        /// Maximum number of pairs.
        most: usize,
        /// The given number of rings.
        rings: u32,
    },
    /// An option out of range.
    #[error("{name} is {}: it must be {wanted}", short_number(*value))]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The values that it may have.
        wanted: &'static str,
    },
    /// Groups of triangles that cannot be used.
    #[error("groups: {what}")]
    Groups {
        /// The reason.
        what: String,
    },
    /// Certificates of another model.
    #[error(
        "the certificates are of another model: their digest is {certificates}, this model's is {model}; certify this model anew"
    )]
    OtherModel {
        /// Digest stored in the certificates (first bytes).
        certificates: String,
        /// Digest of the model (first bytes).
        model: String,
    },
    /// Certificates with a clearance, where collisions must be proven.
    #[error(
        "the certificates have a clearance, so they prove nothing about collisions: certify anew without one"
    )]
    ClearanceCertificates,
    /// Certificates of another contact filter than that of the query.
    #[error("the certificates are of another contact filter: {what}; certify anew")]
    OtherPairs {
        /// The difference.
        what: String,
    },
    /// Parts of certificates that do not fit together.
    #[error("the certificates are damaged: {0}; certify the model anew")]
    Certificates(String),
    /// An entry of certificates that could not be proven: the certificates or the program are wrong.
    #[error("{0}")]
    Unproven(String),
    /// A job or a result of certificates computed by several processes that is damaged, foreign or could not be computed.
    #[error("shards: {0}")]
    Shard(String),
    /// The caller cancelled.
    #[error("interrupted")]
    Cancelled,
}

/// Returns the number as people write it: huge and tiny ones with an exponent (`{}` alone prints 1e300 as 301 digits), whole
/// ones without a fraction.
pub fn short_number(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::short_number;

    #[test]
    fn numbers_have_few_digits() {
        let values = [0.0, -1.0, 5.0, 0.25, 1048577.0, 1e300, -2.5e-300, f64::NAN, f64::INFINITY];
        let texts = ["0", "-1", "5", "0.25", "1048577", "1e300", "-2.5e-300", "NaN", "inf"];
        assert_eq!(values.map(short_number), texts);
    }
}
