//! The options and the answer of [`Query::resolve`](crate::Query::resolve).

/// Options of [`Query::resolve`](crate::Query::resolve). Each method sets one option.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ResolveOptions {
    pub(super) start: Option<Vec<f64>>,
    pub(super) all: bool,
}

impl ResolveOptions {
    setters! {
        /// A free configuration from which the search begins (r entries); `None`: the centre of the certificates.
        start: impl Into<Option<Vec<f64>>>,
        /// Whether exceptions must be free as well. Otherwise they are ignored: they may collide at the start and in the
        /// answer.
        all: bool,
    }
}

/// A free configuration near a colliding one, if one was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// The free configuration (r entries): q itself if q is free; `None` if the centre collides and no start was
    /// given.
    pub q: Option<Vec<f64>>,
    /// The distance of the answer from q in the metric, `|S (answer - q)|`, rounded up; infinite without an answer.
    pub change: f64,
    /// The distance from q of the last free configuration on the straight line from the start to q, found by continuous
    /// queries: the change of a step back along this line. 0 if q is free; infinite without an answer.
    pub safe_scale_change: f64,
}

impl Resolved {
    /// The answer if no free configuration was found.
    pub(super) const NONE: Self = Self { q: None, change: f64::INFINITY, safe_scale_change: f64::INFINITY };

    /// Returns the answer q, which is free.
    pub(super) fn free(q: &[f64]) -> Self {
        Self { q: Some(q.to_vec()), change: 0.0, safe_scale_change: 0.0 }
    }

    /// Whether a free configuration was found.
    pub fn is_resolved(&self) -> bool {
        self.q.is_some()
    }
}
