//! The question and the answer of [`Query::resolve`](crate::Query::resolve).

/// How [`Query::resolve`](crate::Query::resolve) searches. Each method sets one option.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ResolveOptions {
    pub(super) start: Option<Vec<f64>>,
    pub(super) all: bool,
}

impl ResolveOptions {
    setters! {
        /// A free configuration from which the search begins (r entries); none: the centre of the certificates.
        start: impl Into<Option<Vec<f64>>>,
        /// Whether exceptions must be free as well. Otherwise they are left as they are: they may collide at the start
        /// and in the answer.
        all: bool,
    }
}

/// A free configuration near a colliding one, or that none was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// The free configuration (r entries): q itself where q is free; none where the centre collides and no start was
    /// given.
    pub q: Option<Vec<f64>>,
    /// The distance of the answer from q in the metric, `|S (answer - q)|`, rounded up; infinite without an answer.
    pub change: f64,
    /// The distance from q of the last free configuration on the straight line from the start to q, found by continuous
    /// queries: what stepping back along this line changes. 0 where q is free; infinite without an answer.
    pub safe_scale_change: f64,
}

impl Resolved {
    /// None was found.
    pub(super) const NONE: Self = Self { q: None, change: f64::INFINITY, safe_scale_change: f64::INFINITY };

    /// q itself, which is free.
    pub(super) fn free(q: &[f64]) -> Self {
        Self { q: Some(q.to_vec()), change: 0.0, safe_scale_change: 0.0 }
    }

    /// Whether a free configuration was found.
    pub fn is_resolved(&self) -> bool {
        self.q.is_some()
    }
}
