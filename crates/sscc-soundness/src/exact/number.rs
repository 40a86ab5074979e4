//! The numbers that predicates compute with.

/// A number whose sums and products are exact, or enclosed. No division: predicates need signs alone.
pub trait Number: Clone {
    /// The sum.
    fn plus(&self, other: &Self) -> Self;
    /// The difference.
    fn minus(&self, other: &Self) -> Self;
    /// The product.
    fn times(&self, other: &Self) -> Self;
    /// -1, 0 or 1; none if the enclosure does not decide.
    fn sign(&self) -> Option<i8>;
}
