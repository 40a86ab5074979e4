//! The kinds of numbers that predicates compute with.

/// A number whose sums and products are exact, or enclosed by intervals. It has no division: predicates need only signs.
pub trait Number: Clone {
    /// Returns the sum.
    fn plus(&self, other: &Self) -> Self;
    /// Returns the difference.
    fn minus(&self, other: &Self) -> Self;
    /// Returns the product.
    fn times(&self, other: &Self) -> Self;
    /// Returns -1, 0 or 1; None if the enclosure does not decide.
    fn sign(&self) -> Option<i8>;
}
